//! Connections with an end in time: nobody who is slow, or silent, holds a thread up for longer than it was given.

use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// A host and a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Endpoint {
    /// A name or an address, without brackets.
    pub host: String,
    pub port: u16,
}

impl Endpoint {
    /// That of a URI such as `http://robot:11311/`, whatever its scheme; without a scheme and a port, those of a master.
    pub fn parse(uri: &str) -> Result<Endpoint, String> {
        let wrong = || format!("`{uri}` is no address: write it as in `http://127.0.0.1:11311`");
        let rest = uri.split_once("://").map_or(uri, |(_, rest)| rest);
        let authority = rest.split('/').next().unwrap_or_default();
        let (host, port) = match authority.strip_prefix('[').and_then(|a| a.split_once(']')) {
            Some((host, rest)) => (host, rest.strip_prefix(':')),
            None => authority.rsplit_once(':').map_or((authority, None), |(host, port)| (host, Some(port))),
        };
        let is_host = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'.' | b'-' | b'_' | b':' | b'%');
        if host.is_empty() || !host.bytes().all(is_host) {
            return Err(wrong());
        }
        let port = match port {
            Some(port) => port.parse().map_err(|_| wrong())?,
            None => 11311,
        };
        Ok(Endpoint { host: host.to_owned(), port })
    }

    /// A connection to it, made before the deadline.
    pub fn connect(&self, deadline: Instant) -> io::Result<TcpStream> {
        let mut last = io::Error::new(ErrorKind::NotFound, format!("{} has no address", self.host));
        for address in (self.host.as_str(), self.port).to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, left(deadline)?) {
                Ok(stream) => {
                    stream.set_nodelay(true)?;
                    return Ok(stream);
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.host.contains(':') {
            write!(f, "[{}]:{}", self.host, self.port)
        } else {
            write!(f, "{}:{}", self.host, self.port)
        }
    }
}

/// A stream that gives up at a deadline, however little comes at a time.
pub(crate) struct Timed<'s> {
    pub stream: &'s TcpStream,
    pub deadline: Instant,
}

impl Read for Timed<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(left(self.deadline)?))?;
        self.stream.read(into).map_err(in_words)
    }
}

impl Write for Timed<'_> {
    fn write(&mut self, from: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(left(self.deadline)?))?;
        self.stream.write(from).map_err(in_words)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What is left until a deadline.
fn left(deadline: Instant) -> io::Result<Duration> {
    let left = deadline.saturating_duration_since(Instant::now());
    if left.is_zero() { Err(too_late()) } else { Ok(left) }
}

/// Whether a read or a write ended because its time was over.
pub(crate) fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

fn in_words(error: io::Error) -> io::Error {
    if is_timeout(&error) { too_late() } else { error }
}

fn too_late() -> io::Error {
    io::Error::new(ErrorKind::TimedOut, "no answer in time")
}

/// An error in as few words as say it: without the number that the system has for it.
pub(crate) fn words(error: &io::Error) -> String {
    let text = error.to_string();
    let plain = text.split(" (os error").next().unwrap_or_default();
    let mut letters = plain.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read() {
        for (uri, host, port) in [
            ("http://127.0.0.1:11411/", "127.0.0.1", 11411),
            ("http://localhost:11311", "localhost", 11311),
            ("rosrpc://robot-1.local:40000", "robot-1.local", 40000),
            ("robot", "robot", 11311),
            ("robot:1234", "robot", 1234),
            ("http://[::1]:11311/RPC2", "::1", 11311),
        ] {
            assert_eq!(Endpoint::parse(uri), Ok(Endpoint { host: host.to_owned(), port }));
        }
        for wrong in ["", "http://", "http://:11311", "http://a:b", "http://a:99999", "http://a b:1", "http://a\r\nb:1"]
        {
            assert!(Endpoint::parse(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn who_says_nothing_is_given_up() {
        let listener = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let to = Endpoint { host: "127.0.0.1".to_owned(), port: listener.local_addr().unwrap().port() };
        let deadline = Instant::now() + Duration::from_millis(50);
        let stream = to.connect(deadline).unwrap();
        let error = Timed { stream: &stream, deadline }.read(&mut [0; 1]).unwrap_err();
        assert_eq!((error.kind(), words(&error).as_str()), (ErrorKind::TimedOut, "no answer in time"));
    }
}
