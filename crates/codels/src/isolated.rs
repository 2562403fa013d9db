//! Codels in a process of their own: what crashes there is an error here, and what hangs there is ended.
//!
//! Both ends speak over a socket that the other process has as its standard input, so that codels may print. A frame is its length in 4 bytes; a call
//! is its number (8), the codel (4) and its bytes; an answer its number, whether it is one (0) or a complaint (1), and its bytes.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use lapwing_components::{Trouble, TroubleKind};

use crate::{Border, LoadError};

/// A frame is no longer.
const MOST_BYTES: usize = 64 << 20;

/// How often a process that is not needed any more is looked after, 5 ms apart, before it is ended.
const FAREWELL: u32 = 100;

/// How codels are isolated.
#[derive(Clone, Debug)]
pub struct Isolation {
    /// The program that calls [`crate::serve`], with what it must be told before the library and the component.
    pub program: PathBuf,
    /// What it must be told.
    pub arguments: Vec<String>,
    /// How long a codel may be away before its process is ended.
    pub patience: Duration,
}

/// What comes back for a call: its answer, or a complaint.
type Reply = Result<Vec<u8>, String>;

#[derive(Default)]
struct Waiting {
    calls: BTreeMap<u64, Sender<Reply>>,
    next: u64,
    /// How the process ended.
    ended: Option<String>,
}

/// A process with the codels of a component.
pub(crate) struct Process {
    to: Mutex<UnixStream>,
    child: Mutex<Child>,
    waiting: Arc<Mutex<Waiting>>,
    patience: Duration,
    interface: Option<String>,
}

impl Process {
    /// Starts one, and asks it what it has.
    pub fn start(isolation: &Isolation, library: &Path, component: &str) -> Result<Process, LoadError> {
        let cannot = |why: String| LoadError(format!("no process for the codels of `{component}`: {why}"));
        let (ours, theirs) = UnixStream::pair().map_err(|e| cannot(e.to_string()))?;
        let mut command = Command::new(&isolation.program);
        command.args(&isolation.arguments).arg(library).arg(component);
        command.stdin(Stdio::from(std::os::fd::OwnedFd::from(theirs)));
        // What codels print must not stand between the lines of a report.
        command.stdout(Stdio::from(std::io::stderr()));
        let child = command.spawn().map_err(|e| cannot(e.to_string()))?;
        drop(command);
        let mut from = ours.try_clone().map_err(|e| cannot(e.to_string()))?;
        let hello =
            read_frame(&mut from).ok_or_else(|| cannot("it ended before it had loaded the library".to_owned()))?;
        let hello = String::from_utf8_lossy(&hello).into_owned();
        let interface = match hello.split_once(' ') {
            Some(("has", print)) => Some(print.to_owned()),
            Some(("error", why)) => return Err(LoadError(why.to_owned())),
            _ => None,
        };
        let waiting = Arc::new(Mutex::new(Waiting::default()));
        let hears = waiting.clone();
        thread::Builder::new()
            .name(format!("codels of {component}"))
            .spawn(move || listen(&mut from, &hears))
            .map_err(|e| cannot(e.to_string()))?;
        let (to, child) = (Mutex::new(ours), Mutex::new(child));
        Ok(Process { to, child, waiting, patience: isolation.patience, interface })
    }

    /// What its library says of its interface; `None` where it has no codels of the component.
    pub fn interface(&self) -> Option<&str> {
        self.interface.as_deref()
    }

    /// How the process ended, in words: it is waited for.
    fn end(&self) -> String {
        let status = lock(&self.child).wait();
        let words = match status {
            Ok(status) => status.to_string(),
            Err(error) => error.to_string(),
        };
        let mut waiting = lock(&self.waiting);
        waiting.ended.get_or_insert(words).clone()
    }

    fn crashed(&self) -> Trouble {
        let message = format!("its process died: {}", self.end());
        Trouble { kind: TroubleKind::Crashed, message }
    }
}

impl Border for Process {
    fn cross(&self, _: &str, codel: u32, call: &[u8]) -> Result<Vec<u8>, Trouble> {
        let (reply, heard) = mpsc::channel();
        let number = {
            let mut waiting = lock(&self.waiting);
            if let Some(ended) = &waiting.ended {
                let message = format!("its process died before it was called: {ended}");
                return Err(Trouble { kind: TroubleKind::Crashed, message });
            }
            waiting.next += 1;
            let number = waiting.next;
            waiting.calls.insert(number, reply);
            number
        };
        let mut frame = Vec::with_capacity(call.len() + 12);
        frame.extend(number.to_ne_bytes());
        frame.extend(codel.to_ne_bytes());
        frame.extend(call);
        if !write_frame(&mut lock(&self.to), &frame) {
            return Err(self.crashed());
        }
        match heard.recv_timeout(self.patience) {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(why)) => Err(Trouble { kind: TroubleKind::Wrong, message: why }),
            Err(RecvTimeoutError::Disconnected) => Err(self.crashed()),
            Err(RecvTimeoutError::Timeout) => {
                drop(lock(&self.child).kill());
                let message =
                    format!("it has not returned for {} s, and its process was ended", self.patience.as_secs_f64());
                Err(Trouble { kind: TroubleKind::Hung, message })
            }
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Without anybody to ask it, it ends by itself, and what its codels have printed is written out.
        drop(lock(&self.to).shutdown(Shutdown::Both));
        let mut child = lock(&self.child);
        for _ in 0..FAREWELL {
            if !matches!(child.try_wait(), Ok(None)) {
                return;
            }
            thread::sleep(Duration::from_millis(5));
        }
        drop(child.kill());
        drop(child.wait());
    }
}

/// Hands answers to those who wait for them, until there are no more: then nobody waits in vain.
fn listen(from: &mut UnixStream, waiting: &Mutex<Waiting>) {
    while let Some(frame) = read_frame(from) {
        let Some((number, rest)) = frame.split_first_chunk::<8>() else { break };
        let Some((kind, bytes)) = rest.split_first() else { break };
        let reply = lock(waiting).calls.remove(&u64::from_ne_bytes(*number));
        let Some(reply) = reply else { continue };
        let answer = match kind {
            0 => Ok(bytes.to_vec()),
            _ => Err(String::from_utf8_lossy(bytes).into_owned()),
        };
        drop(reply.send(answer));
    }
    lock(waiting).calls.clear();
}

pub(crate) fn read_frame(from: &mut UnixStream) -> Option<Vec<u8>> {
    let mut length = [0; 4];
    from.read_exact(&mut length).ok()?;
    let length = u32::from_ne_bytes(length) as usize;
    if length > MOST_BYTES {
        return None;
    }
    // Memory comes with the bytes, not with what is said of them.
    let mut frame = Vec::new();
    let read = from.take(length as u64).read_to_end(&mut frame).ok()?;
    (read == length).then_some(frame)
}

pub(crate) fn write_frame(to: &mut UnixStream, frame: &[u8]) -> bool {
    let Ok(length) = u32::try_from(frame.len()) else { return false };
    to.write_all(&length.to_ne_bytes()).and_then(|()| to.write_all(frame)).is_ok()
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
