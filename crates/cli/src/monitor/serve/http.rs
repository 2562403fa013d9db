//! As much of HTTP/1.1 as a browser and a scraper of metrics need: a request is read, an answer is written, the connection is closed. Both ends
//! have a time by which they must be done, whatever the other side does.

use std::io::{self, BufRead, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use super::board::Board;
use super::{metrics, state};

/// A request has so many bytes at most.
pub const MOST_BYTES: u64 = 16 << 10;

/// A stream that is given up at a time, also where the other side sends or takes a byte now and then.
pub struct Patient<'s> {
    stream: &'s TcpStream,
    until: Instant,
}

impl<'s> Patient<'s> {
    /// From now on for so long.
    pub fn new(stream: &'s TcpStream, patience: Duration) -> Patient<'s> {
        Patient { stream, until: Instant::now() + patience }
    }

    fn left(&self) -> io::Result<Option<Duration>> {
        match self.until.saturating_duration_since(Instant::now()) {
            Duration::ZERO => Err(io::ErrorKind::TimedOut.into()),
            left => Ok(Some(left)),
        }
    }
}

impl Read for Patient<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(buffer)
    }
}

impl Write for Patient<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// What is asked.
#[derive(Debug, Default)]
pub struct Request {
    /// `GET`, usually.
    pub method: String,
    path: String,
    host: String,
}

/// What is answered.
pub struct Answer {
    status: &'static str,
    kind: &'static str,
    /// What a browser may do with it.
    policy: String,
    /// The answer itself.
    pub body: String,
}

impl Request {
    /// Reads one, with its headers.
    pub fn read(from: &mut impl BufRead) -> io::Result<Request> {
        let mut line = String::new();
        from.read_line(&mut line)?;
        let mut words = line.split_whitespace();
        let mut word = || words.next().unwrap_or_default().to_owned();
        let mut request = Request { method: word(), path: word(), host: String::new() };
        loop {
            line.clear();
            if from.read_line(&mut line)? == 0 || line.trim_end().is_empty() {
                return Ok(request);
            }
            if let Some((name, value)) = line.split_once(':')
                && name.eq_ignore_ascii_case("host")
            {
                value.trim().clone_into(&mut request.host);
            }
        }
    }

    /// What is answered at that address.
    pub fn answer(&self, address: SocketAddr, board: &Board) -> Answer {
        let text = |status, body: &str| Answer::new(status, "text/plain; charset=utf-8", body.to_owned());
        if !matches!(self.method.as_str(), "GET" | "HEAD") {
            return text("405 Method Not Allowed", "only GET: nothing here changes anything\n");
        }
        // A page of somebody else that gave its name this address must not read what is shown here.
        if address.ip().is_loopback() && !is_this_machine(&self.host) {
            return text("403 Forbidden", "this is shown on this machine only, by its own name\n");
        }
        let (path, query) = self.path.split_once('?').unwrap_or((&self.path, ""));
        match path {
            "/" => Answer {
                policy: lapwing_page::live_policy(),
                ..Answer::new("200 OK", "text/html; charset=utf-8", lapwing_page::live())
            },
            "/state.json" => Answer::new("200 OK", "application/json", state::json(&board.posted(), known(query))),
            "/metrics" => {
                Answer::new("200 OK", "text/plain; version=0.0.4; charset=utf-8", metrics::text(&board.posted().view))
            }
            _ => text("404 Not Found", "there is /, /state.json and /metrics\n"),
        }
    }
}

impl Answer {
    fn new(status: &'static str, kind: &'static str, body: String) -> Answer {
        Answer { status, kind, policy: "default-src 'none'".to_owned(), body }
    }

    /// Everything before the body.
    pub fn head(&self) -> String {
        format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Content-Security-Policy: {}; frame-ancestors 'none'\r\n\r\n",
            self.status,
            self.kind,
            self.body.len(),
            self.policy,
        )
    }
}

/// The run and the revision that a browser has: `run=1&since=57`.
fn known(query: &str) -> Option<(u64, u64)> {
    let of = |key: &str| {
        let mut pairs = query.split('&').filter_map(|pair| pair.split_once('='));
        pairs.find(|(name, _)| *name == key)?.1.parse().ok()
    };
    Some((of("run")?, of("since")?))
}

/// Whether a `Host` names this machine.
fn is_this_machine(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.split(':').next().unwrap_or_default(),
    };
    name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(request: &str) -> Answer {
        let request = Request::read(&mut request.as_bytes()).unwrap();
        let board = Board::default();
        board.begin();
        board.event("{\"type\":\"start\"}\n");
        request.answer(SocketAddr::from(([127, 0, 0, 1], 8080)), &board)
    }

    #[test]
    fn only_what_is_there_is_answered_and_nothing_is_changed() {
        let host = "Host: localhost:8080\r\n\r\n";
        assert!(asked(&format!("GET / HTTP/1.1\r\n{host}")).body.contains("<!DOCTYPE html>"));
        assert!(asked(&format!("GET /state.json?x HTTP/1.1\r\n{host}")).body.contains("\"type\":\"start\""));
        assert!(asked(&format!("GET /metrics HTTP/1.1\r\n{host}")).body.contains("# TYPE lapwing_"));
        for (request, status) in [
            (format!("POST / HTTP/1.1\r\n{host}"), "405"),
            (format!("GET /etc/passwd HTTP/1.1\r\n{host}"), "404"),
            ("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n".to_owned(), "403"),
            ("GET / HTTP/1.1\r\n\r\n".to_owned(), "403"),
            ("\u{0}\u{0}".to_owned(), "405"),
            (String::new(), "405"),
        ] {
            assert!(asked(&request).status.starts_with(status), "{request:?}");
        }
    }

    #[test]
    fn who_knows_a_revision_is_told_only_what_is_new() {
        let of = |query: &str| {
            let answer = asked(&format!("GET /state.json?{query} HTTP/1.1\r\nHost: localhost\r\n\r\n"));
            serde_json::from_str::<serde_json::Value>(&answer.body).unwrap()
        };
        let all = of("");
        let (run, revision) = (all["run"].as_u64().unwrap(), all["revision"].as_u64().unwrap());
        assert_eq!((all["events"].as_array().unwrap().len(), &all["since"]), (1, &0.into()));
        assert_eq!(of(&format!("run={run}&since={revision}"))["events"].as_array().unwrap().len(), 0);
        // Of another run, or a revision that has not been: everything.
        for query in [format!("run={}&since=1", run + 1), format!("run={run}&since=999"), "run=x&since=-1".to_owned()] {
            assert_eq!(of(&query)["events"].as_array().unwrap().len(), 1, "{query}");
        }
    }

    #[test]
    fn this_machine_has_few_names() {
        assert!(is_this_machine("127.0.0.1:80") && is_this_machine("[::1]:80") && is_this_machine("LOCALHOST"));
        assert!(!is_this_machine("example.com") && !is_this_machine("127.0.0.1.evil.example"));
    }
}
