//! A page that shows how things stand, for a browser, and the same as metrics, for Prometheus. Read-only: it answers `GET` and nothing else, and
//! nothing that is asked of it reaches the robot.
//!
//! It is HTTP/1.1 by hand, a thread for each connection, each of them bounded in number, size and time: there are four pages, and none takes an argument.

mod metrics;
mod state;

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use lapwing::live::View;

use crate::complain::Complaint;

/// What a browser shows.
const PAGE: &str = include_str!("serve/page.html");

/// So many connections are answered at once.
const MOST_CONNECTIONS: usize = 32;

/// A request has so many bytes at most.
const MOST_BYTES: u64 = 16 << 10;

/// A connection takes so long at most.
const PATIENCE: Duration = Duration::from_secs(5);

/// So many events are kept for the page.
const MOST_EVENTS: usize = 200;

/// Where how things stand is put up.
#[derive(Clone, Default)]
pub struct Board {
    shared: Arc<Mutex<Posted>>,
}

#[derive(Default)]
struct Posted {
    view: View,
    /// Lines of JSON, the latest last.
    events: VecDeque<String>,
}

impl Board {
    /// Something happened, as a line of JSON.
    pub fn event(&self, json: &str) {
        let mut posted = self.lock();
        if posted.events.len() >= MOST_EVENTS {
            posted.events.pop_front();
        }
        posted.events.push_back(json.trim_end().to_owned());
    }

    /// How things stand now.
    pub fn view(&self, view: &View) {
        self.lock().view = view.clone();
    }

    /// What is posted is whole at any moment, also after a thread that held the lock was given up.
    fn lock(&self) -> MutexGuard<'_, Posted> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A server that runs.
pub struct Server {
    address: SocketAddr,
    board: Board,
}

impl Server {
    /// Listens at a port of this machine, or at an address.
    pub fn start(at: &str) -> Result<Server, Complaint> {
        let wrong = |why: String| {
            Complaint::new(format!("--serve {at}: {why}"))
                .help("write a port (8080), or an address and a port (127.0.0.1:8080)")
        };
        let address = address(at).map_err(wrong)?;
        let listener = TcpListener::bind(address).map_err(|e| wrong(e.to_string()))?;
        let address = listener.local_addr().map_err(|e| wrong(e.to_string()))?;
        let board = Board::default();
        let shown = board.clone();
        let listen = move || listen(&listener, address, &shown);
        thread::Builder::new().name("lapwing-serve".to_owned()).spawn(listen).map_err(|e| wrong(e.to_string()))?;
        Ok(Server { address, board })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What it shows.
    pub fn board(&self) -> Board {
        self.board.clone()
    }
}

/// `8080`, `:8080` and `127.0.0.1:8080`; other machines only where an address says so.
fn address(text: &str) -> Result<SocketAddr, String> {
    let here = |port: u16| SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port);
    if let Ok(port) = text.trim_start_matches(':').parse::<u16>() {
        return Ok(here(port));
    }
    let mut found = text.to_socket_addrs().map_err(|e| format!("it is no address: {e}"))?;
    found.next().ok_or_else(|| "it is no address".to_owned())
}

fn listen(listener: &TcpListener, address: SocketAddr, board: &Board) {
    let open = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming().flatten() {
        if open.fetch_add(1, Ordering::Relaxed) >= MOST_CONNECTIONS {
            open.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let (board, open) = (board.clone(), open.clone());
        thread::spawn(move || {
            // Whoever asked is gone, or was too slow: nothing is to be done about it.
            drop(answer(&stream, address, &board));
            open.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

fn answer(stream: &TcpStream, address: SocketAddr, board: &Board) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let request = Request::read(&mut BufReader::new(stream.take(MOST_BYTES)))?;
    let answer = request.answer(address, board);
    let mut to = stream;
    to.write_all(answer.head().as_bytes())?;
    if request.method != "HEAD" {
        to.write_all(answer.body.as_bytes())?;
    }
    to.flush()
}

/// What is asked.
#[derive(Debug, Default)]
struct Request {
    method: String,
    path: String,
    host: String,
}

/// What is answered.
struct Answer {
    status: &'static str,
    kind: &'static str,
    body: String,
}

impl Request {
    fn read(from: &mut impl BufRead) -> io::Result<Request> {
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

    fn answer(&self, address: SocketAddr, board: &Board) -> Answer {
        let text = |status, body: &str| Answer { status, kind: "text/plain; charset=utf-8", body: body.to_owned() };
        if !matches!(self.method.as_str(), "GET" | "HEAD") {
            return text("405 Method Not Allowed", "only GET: nothing here changes anything\n");
        }
        // A page of somebody else that gave its name this address must not read what is shown here.
        if address.ip().is_loopback() && !is_this_machine(&self.host) {
            return text("403 Forbidden", "this is shown on this machine only, by its own name\n");
        }
        let posted = board.lock();
        match self.path.split('?').next().unwrap_or_default() {
            "/" => Answer { status: "200 OK", kind: "text/html; charset=utf-8", body: PAGE.to_owned() },
            "/state.json" => {
                let body = state::json(&posted.view, posted.events.iter().map(String::as_str));
                Answer { status: "200 OK", kind: "application/json", body }
            }
            "/metrics" => Answer {
                status: "200 OK",
                kind: "text/plain; version=0.0.4; charset=utf-8",
                body: metrics::text(&posted.view),
            },
            _ => text("404 Not Found", "there is /, /state.json and /metrics\n"),
        }
    }
}

impl Answer {
    fn head(&self) -> String {
        format!(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             X-Content-Type-Options: nosniff\r\nContent-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; \
             style-src 'unsafe-inline'; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n",
            self.status,
            self.kind,
            self.body.len()
        )
    }
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
        board.event("{\"type\":\"start\"}\n");
        request.answer(SocketAddr::from(([127, 0, 0, 1], 8080)), &board)
    }

    #[test]
    fn only_what_is_there_is_answered_and_nothing_is_changed() {
        let host = "Host: localhost:8080\r\n\r\n";
        assert!(asked(&format!("GET / HTTP/1.1\r\n{host}")).body.contains("<!doctype html>"));
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
    fn other_machines_are_spoken_to_only_where_an_address_says_so() {
        assert_eq!(address("8080").unwrap().to_string(), "127.0.0.1:8080");
        assert_eq!(address(":8080").unwrap().to_string(), "127.0.0.1:8080");
        assert_eq!(address("0.0.0.0:9").unwrap().to_string(), "0.0.0.0:9");
        assert!(address("here").is_err() && address("70000").is_err());
        assert!(is_this_machine("127.0.0.1:80") && is_this_machine("[::1]:80") && is_this_machine("LOCALHOST"));
        assert!(!is_this_machine("example.com") && !is_this_machine("127.0.0.1.evil.example"));
    }
}
