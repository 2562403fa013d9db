//! Stops a thread that waits, for a connection's bytes or for a while.

use std::io;
use std::net::{Shutdown, TcpStream};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A brake that is pulled once, and then stays so.
#[derive(Debug, Default)]
pub(crate) struct Brake {
    held: Mutex<Held>,
    pulled: Condvar,
}

#[derive(Debug, Default)]
struct Held {
    is_pulled: bool,
    stream: Option<TcpStream>,
}

impl Brake {
    /// Ends the connection that is held, and every wait.
    pub fn pull(&self) {
        let mut held = self.lock();
        held.is_pulled = true;
        if let Some(stream) = held.stream.take() {
            // Where it is closed already it has ended as well.
            drop(stream.shutdown(Shutdown::Both));
        }
        self.pulled.notify_all();
    }

    pub fn is_pulled(&self) -> bool {
        self.lock().is_pulled
    }

    /// From now on the brake ends that connection, at once where it has been pulled.
    pub fn hold(&self, stream: &TcpStream) -> io::Result<()> {
        let stream = stream.try_clone()?;
        let mut held = self.lock();
        if held.is_pulled {
            return stream.shutdown(Shutdown::Both);
        }
        held.stream = Some(stream);
        Ok(())
    }

    /// Lets the connection go.
    pub fn release(&self) {
        self.lock().stream = None;
    }

    /// Waits, no longer than until the brake is pulled.
    pub fn wait(&self, pause: Duration) {
        let held = self.lock();
        drop(self.pulled.wait_timeout_while(held, pause, |held| !held.is_pulled));
    }

    /// What is held is whole at any time.
    fn lock(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
