//! Calls of services.

use std::io::{Read, Write};
use std::time::{Duration, Instant};

use bytes::Bytes;
use lapwing_record::normal_name;

use super::frame;
use super::graph::Graph;
use super::header::Header;
use super::net::{Endpoint, Timed, words};

/// A request on its way.
pub(crate) struct Call {
    pub service: String,
    /// `std_srvs/Trigger`, or with `/srv/` between.
    pub type_name: String,
    /// The checksum of the type, or `*` where its definition is not known.
    pub checksum: String,
    pub request: Vec<u8>,
    pub patience: Duration,
}

impl Call {
    /// Carries it out: the answer's bytes, or why there are none.
    pub fn carry_out(&self, graph: &Graph) -> Result<Bytes, String> {
        let deadline = Instant::now() + self.patience;
        let uri = graph.master.lookup_service(&self.service)?;
        let place = Endpoint::parse(&uri)?;
        let broken = |error: std::io::Error| format!("{} at {place}: {}", self.service, words(&error));
        let stream = place.connect(deadline).map_err(broken)?;
        let mut timed = Timed { stream: &stream, deadline };
        let wanted =
            Header::of(&[("callerid", graph.names.node()), ("service", &self.service), ("md5sum", &self.checksum)]);
        timed.write_all(&wanted.bytes()).map_err(broken)?;
        let offered = Header::read(&mut timed).map_err(broken)?;
        self.check(&offered)?;
        timed.write_all(&frame::write(&self.request)).map_err(broken)?;
        let (mut is_good, mut length) = ([0], [0; 4]);
        timed.read_exact(&mut is_good).and_then(|()| timed.read_exact(&mut length)).map_err(broken)?;
        let answer = frame::body(&mut timed, u32::from_le_bytes(length)).map_err(broken)?;
        if is_good == [0] {
            return Err(format!("{} failed: {}", self.service, String::from_utf8_lossy(&answer)));
        }
        Ok(answer)
    }

    /// Whether the server serves what is asked for.
    fn check(&self, offered: &Header) -> Result<(), String> {
        if let Some(error) = offered.get("error") {
            return Err(format!("{} refuses: {error}", self.service));
        }
        let wanted = plain(&self.type_name);
        match offered.get("type") {
            Some(ty) if plain(ty) != wanted => Err(format!("{} is a {ty}, not a {wanted}", self.service)),
            _ => Ok(()),
        }
    }
}

/// A service's type without `/srv/` in it.
pub(crate) fn plain(type_name: &str) -> String {
    normal_name(&type_name.replacen("/srv/", "/", 1))
}
