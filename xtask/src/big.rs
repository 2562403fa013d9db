//! Big recordings: whether memory stays where it is however long a recording is.

mod write;

use std::fmt;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

pub use write::{Kind, SPEC};

/// How often a child is asked how much memory it has had.
const ASKED_EVERY: Duration = Duration::from_millis(2);
/// A recording of four times the length may take a quarter more memory, and so many KiB beside that: allocators round up.
const ALLOWED: u64 = 8 << 10;

/// What a child process took.
#[derive(Clone, Copy, Debug)]
pub struct Taken {
    /// Time on the clock.
    pub time: Duration,
    /// The most memory that it had at once, in KiB.
    pub peak: u64,
    /// How it ended.
    pub status: ExitStatus,
}

/// Runs a command, and asks the operating system (Linux) for the most memory that it has had.
pub fn run(command: &mut Command) -> io::Result<Taken> {
    let start = Instant::now();
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::null()).spawn()?;
    let about = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    let status = loop {
        // The mark only rises, and it is gone with the process: the last one seen counts.
        peak = fs::read_to_string(&about).ok().and_then(|text| high_water(&text)).unwrap_or(peak);
        if let Some(status) = child.try_wait()? {
            break status;
        }
        sleep(ASKED_EVERY);
    };
    match peak {
        0 => Err(io::Error::other("the operating system does not say how much memory a process has had")),
        peak => Ok(Taken { time: start.elapsed(), peak, status }),
    }
}

/// The most memory that a process has had, in KiB, from what Linux says of it.
fn high_water(status: &str) -> Option<u64> {
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix(" kB")?.parse().ok()
}

/// A recording and one of four times its length.
#[derive(Debug)]
pub struct Comparison {
    kind: Kind,
    bytes: u64,
    short: Taken,
    long: Taken,
}

impl Comparison {
    /// Writes recordings into a folder, the longer one of about so many bytes, and checks each with the command that `check` makes of it.
    pub fn new(kind: Kind, folder: &Path, bytes: u64, check: &dyn Fn(&Path) -> Command) -> io::Result<Comparison> {
        let one = |bytes: u64| {
            let path = folder.join(format!("big.{}", kind.ending()));
            kind.write(&path, bytes)?;
            let taken = run(&mut check(&path))?;
            fs::remove_file(&path)?;
            Ok::<_, io::Error>(taken)
        };
        Ok(Comparison { kind, bytes, short: one(bytes / 4)?, long: one(bytes)? })
    }

    /// Whether both were checked, and the longer one took no more memory than the shorter one.
    pub fn is_fine(&self) -> bool {
        let most = self.short.peak + self.short.peak / 4 + ALLOWED;
        self.short.status.success() && self.long.status.success() && self.long.peak <= most
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Comparison { kind, bytes, short, long } = self;
        let megabytes = *bytes as f64 / 1e6;
        let speed = megabytes / long.time.as_secs_f64();
        write!(f, "{:10} {megabytes:6.0} MB in {:6.2} s ({speed:5.0} MB/s), ", kind.ending(), long.time.as_secs_f64())?;
        write!(f, "{:6} KiB at most; a quarter of it: {:6} KiB", long.peak, short.peak)?;
        match (short.status.success() && long.status.success(), self.is_fine()) {
            (false, _) => write!(f, "; FAILED: {}, {}", short.status, long.status),
            (true, false) => write!(f, "; FAILED: memory grows with the length"),
            (true, true) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_memory_is_what_linux_says_of_a_process() {
        assert_eq!(high_water("Name:\tlapwing\nVmPeak:\t  900 kB\nVmHWM:\t    6724 kB\n"), Some(6724));
        assert_eq!(high_water("Name:\tlapwing\n"), None);
        let taken = run(Command::new("sleep").arg("0.1")).unwrap();
        assert!(taken.status.success() && taken.peak > 100 && taken.time > Duration::from_millis(90));
    }
}
