//! One publisher of one topic: connects, hears it out, and when the connection breaks begins again.

use std::io::{self, BufReader, ErrorKind, Read};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bytes::Bytes;

use super::brake::Brake;
use super::frame;
use super::graph::{Graph, Heard};
use super::header::Header;
use super::master::{self, call};
use super::net::{Endpoint, Timed, is_timeout, words};
use super::sequence::Sequence;
use super::topic::Failure;
use super::xml::Value;
use crate::connector::{Cause, Happening};

/// How long a publisher may take to answer, and to say what it offers.
const PATIENCE: Duration = Duration::from_secs(3);
/// After so long without a message a publisher is asked whether it is still there: a cable that was pulled says nothing.
const SILENCE: Duration = Duration::from_secs(2);
/// The first pause before the next attempt, and the longest; each is twice the one before.
const PAUSES: (Duration, Duration) = (Duration::from_millis(100), Duration::from_secs(5));
/// How many bytes are asked of the system at once.
const CHUNK: usize = 128 << 10;

/// A publisher and what is wanted of it.
pub(crate) struct Link {
    pub graph: Arc<Graph>,
    pub topic: String,
    /// The address of the publisher's API.
    pub uri: String,
    pub brake: Arc<Brake>,
}

impl Link {
    /// Hears the publisher out, again and again, until the brake is pulled.
    pub fn run(&self) {
        let mut pause = PAUSES.0;
        while !self.brake.is_pulled() {
            let begin = Instant::now();
            let failure = self.hear();
            self.brake.release();
            if self.brake.is_pulled() {
                return;
            }
            self.graph.failed(&self.topic, &self.uri, failure);
            // What lasted for a while was no failed attempt.
            if begin.elapsed() > PAUSES.1 {
                pause = PAUSES.0;
            }
            self.brake.wait(pause);
            pause = (2 * pause).min(PAUSES.1);
        }
    }

    /// One connection, from its beginning to its end, and why that came.
    fn hear(&self) -> Failure {
        let stream = match self.connect() {
            Ok(stream) => stream,
            Err(failure) => return failure,
        };
        let header = match self.greet(&stream) {
            Ok(header) => header,
            Err(error) => return disconnected(format!("the publisher at {}: {}", self.uri, words(&error)), false),
        };
        let node = header.get("callerid").unwrap_or(&self.uri).to_owned();
        let heard = match self.graph.offered(&self.topic, &self.uri, &header) {
            Ok(Some(heard)) => heard,
            // It was let go meanwhile, which the brake knows as well.
            Ok(None) => return disconnected(format!("{node} was let go"), true),
            Err(failure) => return failure,
        };
        let mut reader =
            BufReader::with_capacity(CHUNK, Patient { stream: &stream, uri: &self.uri, graph: &self.graph });
        let mut sequence = Sequence::default();
        loop {
            match frame::read(&mut reader) {
                Ok(Some(payload)) => self.take(heard, &mut sequence, payload),
                Ok(None) => return disconnected(format!("{node} closed the connection"), false),
                Err(error) => return disconnected(format!("{node}: {}", words(&error)), false),
            }
        }
    }

    /// Hands a message on, and before it the news of those that were left out.
    fn take(&self, heard: Heard, sequence: &mut Sequence, payload: Bytes) {
        let Heard { stream, is_counted } = heard;
        if is_counted {
            match sequence.missed(&payload) {
                0 => {}
                count => self.graph.inbox.push(Happening::Lost { stream, count }),
            }
        }
        self.graph.inbox.push(Happening::Message { stream, payload });
    }

    /// Asks the publisher where its messages are to be had, and goes there.
    fn connect(&self) -> Result<TcpStream, Failure> {
        let api = Endpoint::parse(&self.uri).map_err(|what| disconnected(what, false))?;
        let protocols = Value::Array(vec![Value::Array(vec!["TCPROS".into()])]);
        let params = [self.graph.names.node().into(), self.topic.as_str().into(), protocols];
        let answer = call(&api, "requestTopic", &params, PATIENCE).map_err(|failure| {
            let is_gone = matches!(&failure, master::Failure::Unreached(e) if e.kind() == ErrorKind::ConnectionRefused);
            disconnected(format!("the publisher at {api} {failure}"), is_gone)
        })?;
        let place = match answer.items() {
            [protocol, host, port, ..] if protocol.text() == Some("TCPROS") => host.text().zip(port.int()),
            _ => None,
        };
        let place =
            place.and_then(|(host, port)| Some(Endpoint { host: host.to_owned(), port: u16::try_from(port).ok()? }));
        let place = place.ok_or_else(|| disconnected(format!("the publisher at {api} offers no TCPROS"), false))?;
        place.connect(Instant::now() + PATIENCE).map_err(|error| {
            let is_gone = error.kind() == ErrorKind::ConnectionRefused;
            disconnected(format!("the publisher at {place}: {}", words(&error)), is_gone)
        })
    }

    /// Says what is wanted, and reads what is offered.
    fn greet(&self, stream: &TcpStream) -> io::Result<Header> {
        self.brake.hold(stream)?;
        let mut timed = Timed { stream, deadline: Instant::now() + PATIENCE };
        let wanted = [
            ("callerid", self.graph.names.node()),
            ("topic", &self.topic),
            ("type", "*"),
            ("md5sum", "*"),
            ("tcp_nodelay", "1"),
        ];
        io::Write::write_all(&mut timed, &Header::of(&wanted).bytes())?;
        let header = Header::read(&mut timed)?;
        if let Some(error) = header.get("error") {
            return Err(io::Error::other(format!("it refuses: {error}")));
        }
        stream.set_read_timeout(Some(SILENCE))?;
        Ok(header)
    }
}

fn disconnected(what: String, is_gone: bool) -> Failure {
    Failure { cause: Cause::Disconnected(what), is_gone }
}

/// Reads for as long as the publisher is there, whether it says anything or not.
struct Patient<'l> {
    stream: &'l TcpStream,
    uri: &'l str,
    graph: &'l Graph,
}

impl Read for Patient<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.stream.read(into) {
                Err(error) if is_timeout(&error) => self.is_there()?,
                result => return result,
            }
        }
    }
}

impl Patient<'_> {
    fn is_there(&self) -> io::Result<()> {
        let api = Endpoint::parse(self.uri).map_err(io::Error::other)?;
        match call(&api, "getPid", &[self.graph.names.node().into()], PATIENCE) {
            Err(master::Failure::Unreached(error)) => Err(io::Error::new(
                ErrorKind::TimedOut,
                format!("it says nothing, and does not answer: {}", words(&error)),
            )),
            // Even one that says that it cannot is there.
            Ok(_) | Err(master::Failure::Refused(_)) => Ok(()),
        }
    }
}
