//! Takes connections in, each into a thread of its own.

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
pub(crate) struct Server {
    address: SocketAddr,
    is_over: Arc<AtomicBool>,
}

impl Server {
    /// Handles what comes in; beyond so many at once, connections are closed as they come.
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
