//! A page that shows how things stand, for a browser, and the same as metrics, for Prometheus. Read-only: it answers `GET` and nothing else, and
//! nothing that is asked of it reaches the robot.
//!
//! It is HTTP/1.1 by hand ([`http`]), a thread for each connection, each of them bounded in number, size and time: there are three answers, and no
//! argument but how much the browser knows already. What happens is put up on a [`board`], with what was shown lately ([`past`]); nothing is
//! remembered of who asks, so that one who is slow, or never reads, costs a thread for a few seconds.

mod board;
mod http;
mod metrics;
mod past;
mod state;

use std::io::{self, BufReader, Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::Duration;

use board::Board;
use http::{MOST_BYTES, Patient, Request};
use lapwing::live::View;
use lapwing_react::Event;
use lapwing_ros::server::Server as Listening;

use super::audience::Audience;
use crate::complain::Complaint;

/// So many connections are answered at once.
const MOST_CONNECTIONS: usize = 64;

/// A connection takes so long at most.
const PATIENCE: Duration = Duration::from_secs(5);

/// A server that runs, until it is dropped.
pub struct Server {
    listening: Listening,
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
        // Whoever asked is gone, or was too slow: nothing is to be done about it.
        let work = move |stream: TcpStream| drop(answer(&stream, address, &shown));
        let listening = Listening::start("lapwing-serve", listener, MOST_CONNECTIONS, work);
        Ok(Server { listening: listening.map_err(|e| wrong(e.to_string()))?, board })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.listening.address()
    }
}

impl Audience for Server {
    fn begin(&mut self) {
        self.board.begin();
    }

    fn event(&mut self, _: Event<'_>, json: &str) {
        self.board.event(json);
    }

    fn look(&mut self, view: &View) {
        self.board.view(view);
    }
}

/// `8080`, `:8080` and `127.0.0.1:8080`; other machines only where an address says so.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    let here = |port: u16| SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port);
    if let Ok(port) = text.trim_start_matches(':').parse::<u16>() {
        return Ok(here(port));
    }
    let mut found = text.to_socket_addrs().map_err(|e| format!("it is no address: {e}"))?;
    found.next().ok_or_else(|| "it is no address".to_owned())
}

fn answer(stream: &TcpStream, address: SocketAddr, board: &Board) -> io::Result<()> {
    let mut patient = Patient::new(stream, PATIENCE);
    let request = Request::read(&mut BufReader::new((&mut patient).take(MOST_BYTES)))?;
    let answer = request.answer(address, board);
    patient.write_all(answer.head().as_bytes())?;
    if request.method != "HEAD" {
        patient.write_all(answer.body.as_bytes())?;
    }
    patient.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_machines_are_spoken_to_only_where_an_address_says_so() {
        assert_eq!(address("8080").unwrap().to_string(), "127.0.0.1:8080");
        assert_eq!(address(":8080").unwrap().to_string(), "127.0.0.1:8080");
        assert_eq!(address("0.0.0.0:9").unwrap().to_string(), "0.0.0.0:9");
        assert!(address("here").is_err() && address("70000").is_err());
    }

    #[test]
    fn who_is_slow_or_never_reads_keeps_nobody_from_an_answer() {
        let server = Server::start("127.0.0.1:0").unwrap();
        let connect = || TcpStream::connect(server.address()).unwrap();
        // One never asks, one asks and never reads, one sends a byte and no more.
        let mut stuck: Vec<TcpStream> = (0..MOST_CONNECTIONS - 8).map(|_| connect()).collect();
        for (number, stream) in stuck.iter_mut().enumerate() {
            match number % 3 {
                0 => {}
                1 => stream.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap(),
                _ => stream.write_all(b"G").unwrap(),
            }
        }
        let mut stream = connect();
        stream.write_all(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        // Who sends a byte now and then is given up as well.
        let mut patient = Patient::new(&stuck[0], Duration::ZERO);
        assert_eq!(patient.read(&mut [0]).unwrap_err().kind(), io::ErrorKind::TimedOut);
    }
}
