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
    /// Why no more answers come, if none do.
    silence: Option<Silence>,
}

/// Why there are no more frames.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Silence {
    /// The other end is closed.
    Closed,
    /// What came is no frame: what is wrong with it.
    Garbled(String),
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
        let (to, child, waiting) = (Mutex::new(ours), Mutex::new(child), Arc::new(Mutex::new(Waiting::default())));
        // From here on the process is ended and reaped wherever this ends.
        let mut process = Process { to, child, waiting, patience: isolation.patience, interface: None };
        let mut from = lock(&process.to).try_clone().map_err(|e| cannot(e.to_string()))?;
        let (hears, (says, hello)) = (process.waiting.clone(), mpsc::channel());
        let work = move || {
            let hello = read_frame(&mut from);
            let goes_on = hello.is_ok();
            if says.send(hello).is_ok() && goes_on {
                listen(&mut from, &hears);
            }
        };
        let named = thread::Builder::new().name(format!("codels of {component}"));
        named.spawn(work).map_err(|e| cannot(e.to_string()))?;
        // Loading a library may run code of its own, which can hang as codels can.
        let hello = match hello.recv_timeout(isolation.patience) {
            Ok(Ok(hello)) => hello,
            Ok(Err(Silence::Closed)) | Err(RecvTimeoutError::Disconnected) => {
                return Err(cannot("it ended before it had loaded the library".to_owned()));
            }
            Ok(Err(Silence::Garbled(why))) => {
                return Err(cannot(format!("what it says cannot be understood: {why}")));
            }
            Err(RecvTimeoutError::Timeout) => {
                drop(lock(&process.child).kill());
                let waited = isolation.patience.as_secs_f64();
                return Err(cannot(format!(
                    "it has not loaded {} for {waited} s, and was ended: what the library does when it is loaded hangs, or needs more patience",
                    library.display()
                )));
            }
        };
        let hello = String::from_utf8_lossy(&hello).into_owned();
        process.interface = match hello.split_once(' ') {
            Some(("has", print)) => Some(print.to_owned()),
            Some(("error", why)) => return Err(LoadError(why.to_owned())),
            _ => None,
        };
        Ok(process)
    }

    /// What its library says of its interface; `None` where it has no codels of the component.
    pub fn interface(&self) -> Option<&str> {
        self.interface.as_deref()
    }

    /// Why there is no answer, and will be none. The process is over then.
    fn trouble(&self) -> Trouble {
        let status = {
            let mut child = lock(&self.child);
            // It may be alive, and only not be understood. One that has died keeps how it died.
            drop(child.kill());
            child.wait()
        };
        if let Some(Silence::Garbled(why)) = &lock(&self.waiting).silence {
            let message = format!("what its process answers cannot be understood, and it was ended: {why}");
            return Trouble { kind: TroubleKind::Wrong, message };
        }
        let how = status.map_or_else(|e| e.to_string(), |status| status.to_string());
        Trouble { kind: TroubleKind::Crashed, message: format!("its process died: {how}") }
    }
}

impl Border for Process {
    fn cross(&self, codel: u32, call: &[u8]) -> Result<Vec<u8>, Trouble> {
        let (reply, heard) = mpsc::channel();
        let number = {
            let mut waiting = lock(&self.waiting);
            if waiting.silence.is_some() {
                drop(waiting);
                return Err(self.trouble());
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
            return Err(self.trouble());
        }
        match heard.recv_timeout(self.patience) {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(why)) => Err(Trouble { kind: TroubleKind::Wrong, message: why }),
            Err(RecvTimeoutError::Disconnected) => Err(self.trouble()),
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
    let silence = loop {
        let frame = match read_frame(from) {
            Ok(frame) => frame,
            Err(silence) => break silence,
        };
        let Some((number, [kind, bytes @ ..])) = frame.split_first_chunk::<8>() else {
            break Silence::Garbled(format!("an answer of {} bytes", frame.len()));
        };
        let reply = lock(waiting).calls.remove(&u64::from_ne_bytes(*number));
        let Some(reply) = reply else { continue };
        let answer = match kind {
            0 => Ok(bytes.to_vec()),
            _ => Err(String::from_utf8_lossy(bytes).into_owned()),
        };
        drop(reply.send(answer));
    };
    let mut waiting = lock(waiting);
    waiting.silence = Some(silence);
    waiting.calls.clear();
}

/// Reads a frame, of which every byte may be wrong.
pub(crate) fn read_frame(from: &mut impl Read) -> Result<Vec<u8>, Silence> {
    let mut length = [0; 4];
    from.read_exact(&mut length).map_err(|_| Silence::Closed)?;
    let length = u32::from_ne_bytes(length) as usize;
    if length > MOST_BYTES {
        return Err(Silence::Garbled(format!("{length} bytes at once are more than {MOST_BYTES}")));
    }
    // Memory comes with the bytes, not with what is said of them.
    let mut frame = Vec::new();
    let read = from.take(length as u64).read_to_end(&mut frame).map_err(|_| Silence::Closed)?;
    if read == length { Ok(frame) } else { Err(Silence::Closed) }
}

pub(crate) fn write_frame(to: &mut UnixStream, frame: &[u8]) -> bool {
    let Ok(length) = u32::try_from(frame.len()) else { return false };
    to.write_all(&length.to_ne_bytes()).and_then(|()| to.write_all(frame)).is_ok()
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program of the shell that speaks to us on its standard input. It is given the library and the component as `$0` and `$1`.
    fn start(script: &str, library: &Path) -> Result<Process, LoadError> {
        start_with(script, library, Duration::from_secs(600))
    }

    fn start_with(script: &str, library: &Path, patience: Duration) -> Result<Process, LoadError> {
        let arguments = ["-c", script].map(str::to_owned).to_vec();
        let isolation = Isolation { program: "/bin/sh".into(), arguments, patience };
        Process::start(&isolation, library, "C")
    }

    /// Says that it has codels, if numbers are as on most machines.
    const HELLO: &str = "printf '\\005\\000\\000\\000has x' >&0; head -c 1 >/dev/null;";

    #[test]
    fn a_process_that_is_alive_and_talks_nonsense_is_ended() {
        if cfg!(target_endian = "big") {
            return;
        }
        for (nonsense, words) in [("\\377\\377\\377\\377", "4294967295 bytes"), ("\\001\\000\\000\\000x", "of 1 bytes")]
        {
            let script = format!("{HELLO} printf '{nonsense}' >&0; exec sleep 600");
            let process = start(&script, Path::new("lib")).unwrap();
            assert_eq!(process.interface(), Some("x"));
            for _ in 0..2 {
                let trouble = process.cross(0, &[]).unwrap_err();
                assert_eq!(trouble.kind, TroubleKind::Wrong);
                assert!(trouble.message.contains(words), "{trouble}");
            }
        }
    }

    #[test]
    fn a_process_that_says_nothing_is_not_waited_for_for_ever() {
        let folder = tempfile::tempdir().unwrap();
        let note = folder.path().join("pid");
        let script = "echo $$ > \"$0\"; exec sleep 600";
        let error = loop {
            match start_with(script, &note, Duration::from_millis(300)) {
                Ok(_) => panic!("it has said nothing"),
                // A slow machine may have ended it before it had written its number.
                Err(error) if std::fs::read_to_string(&note).is_ok_and(|pid| !pid.trim().is_empty()) => break error,
                Err(_) => {}
            }
        };
        assert!(error.0.contains("has not loaded") && error.0.contains("0.3 s"), "{error}");
        let pid = std::fs::read_to_string(&note).unwrap();
        let alive = Command::new("kill").args(["-0", pid.trim()]).stderr(Stdio::null()).status().unwrap();
        assert!(!alive.success(), "{pid}");
    }

    #[test]
    fn a_process_that_cannot_be_used_is_not_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let note = folder.path().join("pid");
        let script = "echo $$ > \"$0\"; printf '\\377\\377\\377\\377' >&0; exec sleep 600";
        let Err(error) = start(script, &note) else { panic!("it has said nothing") };
        assert!(error.0.contains("4294967295 bytes"), "{error}");
        let pid = std::fs::read_to_string(&note).unwrap();
        let alive = Command::new("kill").args(["-0", pid.trim()]).stderr(Stdio::null()).status().unwrap();
        assert!(!alive.success(), "{pid}");
    }
}
