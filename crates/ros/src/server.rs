//! Takes connections in, each into a thread of its own: for whatever this process serves, on a graph or beside it.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// How long to wait where the system gives no more connections or threads.
const BREATH: Duration = Duration::from_millis(50);

/// A listener at work; it ends when this is dropped, those that were taken in do not.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    is_over: Arc<AtomicBool>,
}

impl Server {
    /// Handles what comes in; beyond `most` at once, connections are closed as they come. `name` is that of its thread. An error says why there is no
    /// thread, or no address.
    pub fn start(
        name: &str,
        listener: TcpListener,
        most: usize,
        handle: impl Fn(TcpStream) + Send + Sync + 'static,
    ) -> io::Result<Server> {
        let address = listener.local_addr()?;
        let is_over = Arc::new(AtomicBool::new(false));
        let (stop, handle, open) = (is_over.clone(), Arc::new(handle), Arc::new(AtomicUsize::new(0)));
        let (main, each) = (name.to_owned(), format!("{name}-in"));
        thread::Builder::new().name(main).spawn(move || {
            while !stop.load(Ordering::Acquire) {
                let Ok((stream, _)) = listener.accept() else {
                    thread::sleep(BREATH);
                    continue;
                };
                if stop.load(Ordering::Acquire) || open.load(Ordering::Acquire) >= most {
                    continue;
                }
                open.fetch_add(1, Ordering::AcqRel);
                let place = Place(open.clone());
                let handle = handle.clone();
                let run = move || {
                    let _place = place;
                    handle(stream);
                };
                // Without a thread the connection is closed, and its other end tries again.
                drop(thread::Builder::new().name(each.clone()).spawn(run));
            }
        })?;
        Ok(Server { address, is_over })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Release);
        // The listener waits for a connection: here is one.
        let ip = if self.address.ip().is_unspecified() { IpAddr::from(Ipv4Addr::LOCALHOST) } else { self.address.ip() };
        drop(TcpStream::connect_timeout(&SocketAddr::new(ip, self.address.port()), Duration::from_secs(1)));
    }
}

/// A connection that is counted for as long as it lasts.
struct Place(Arc<AtomicUsize>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::AcqRel);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;
    use std::time::Instant;

    use super::*;

    #[test]
    fn a_place_is_given_back_also_by_who_panicked() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let is_first = AtomicBool::new(true);
        let handle = move |mut stream: TcpStream| {
            assert!(!is_first.swap(false, Ordering::Relaxed), "on purpose: this is a test");
            io::Write::write_all(&mut stream, b"here").unwrap();
        };
        let server = Server::start("test", listener, 1, handle).unwrap();
        let begin = Instant::now();
        // The first is let down, and until its thread is gone there is no place for another.
        loop {
            let mut answer = String::new();
            let mut stream = TcpStream::connect(server.address()).unwrap();
            // Closed before it was read, or while it was: no answer, either way.
            if stream.read_to_string(&mut answer).is_ok() && answer == "here" {
                return;
            }
            assert!(begin.elapsed() < Duration::from_secs(30), "nobody is answered any more");
            thread::sleep(Duration::from_millis(5));
        }
    }
}
