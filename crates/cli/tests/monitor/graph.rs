//! Graphs with a robot on them: processes of others, driven by the lines of `robot.py`.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicU16, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Nothing that a test waits for takes so long, on however busy a machine.
pub const LIMIT: Duration = Duration::from_secs(60);

/// Domains of these tests: others have theirs elsewhere.
static NEXT_DOMAIN: AtomicU16 = AtomicU16::new(0);
const FIRST_DOMAIN: u16 = 150;

/// A graph of its own.
pub enum Graph {
    Ros1 { port: u16, _master: Box<Process> },
    Ros2 { domain: u16 },
}

impl Graph {
    /// A ROS 1 graph with a master.
    pub fn ros1() -> Graph {
        let port = TcpListener::bind(("127.0.0.1", 0)).unwrap().local_addr().unwrap().port();
        let mut master = Command::new("rosmaster");
        master.args(["--core", "-p", &port.to_string()]);
        let master = Process::start(with_ros1(master, port), "tools/peers.sh");
        let begin = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(begin.elapsed() < LIMIT, "the master does not come up");
            std::thread::sleep(Duration::from_millis(50));
        }
        Graph::Ros1 { port, _master: Box::new(master) }
    }

    /// A ROS 2 domain.
    pub fn ros2() -> Graph {
        let number = NEXT_DOMAIN.fetch_add(1, Ordering::Relaxed);
        Graph::Ros2 { domain: FIRST_DOMAIN + (std::process::id() % 10) as u16 * 8 + number % 8 }
    }

    /// The words with which Lapwing joins it.
    pub fn words(&self) -> String {
        match self {
            Graph::Ros1 { port, .. } => format!("--ros1 http://127.0.0.1:{port}"),
            Graph::Ros2 { domain } => format!("--ros2 --domain {domain}"),
        }
    }

    /// A robot on it.
    pub fn robot(&self) -> Robot {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/monitor/robot.py");
        let (python, word, installs) = match self {
            Graph::Ros1 { .. } => (PathBuf::from("/usr/bin/python3"), "ros1", "tools/peers.sh"),
            Graph::Ros2 { .. } => {
                let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
                (root.join(".venv-jazzy/bin/python"), "ros2", "tools/ros2.sh jazzy")
            }
        };
        let mut command = Command::new(python);
        command.arg(script).arg(word);
        let process = Process::start(self.around(command), installs);
        process.line_with("ready");
        Robot(process)
    }

    /// A command that knows of this graph, and of no other.
    pub fn around(&self, mut command: Command) -> Command {
        match self {
            Graph::Ros1 { port, .. } => with_ros1(command, *port),
            Graph::Ros2 { domain } => {
                command.env("ROS_DOMAIN_ID", domain.to_string()).env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
                command.env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").env("PYTHONUNBUFFERED", "1");
                command
            }
        }
    }
}

fn with_ros1(mut command: Command, port: u16) -> Command {
    command.env("ROS_MASTER_URI", format!("http://127.0.0.1:{port}")).env("PYTHONUNBUFFERED", "1");
    command.env("ROS_IP", "127.0.0.1").env("ROS_HOSTNAME", "127.0.0.1");
    command
}

/// A process with its children, which end with it.
pub struct Process {
    pub child: Child,
    stdin: Option<ChildStdin>,
    lines: Receiver<String>,
    /// The lines that nobody has asked for yet.
    kept: RefCell<Vec<String>>,
}

impl Process {
    /// Starts one; where it is not there, `installs` is what installs it.
    pub fn start(mut command: Command, installs: &str) -> Process {
        let what = format!("{command:?}");
        let started = command.stdin(Stdio::piped()).stdout(Stdio::piped()).process_group(0).spawn();
        let mut child = started.unwrap_or_else(|e| panic!("{what}: {e}: run {installs} once, then this test again"));
        let stdout = BufReader::new(child.stdout.take().unwrap());
        let (send, lines) = channel();
        std::thread::spawn(move || stdout.lines().map_while(Result::ok).try_for_each(|line| send.send(line)));
        Process { stdin: child.stdin.take(), child, lines, kept: RefCell::default() }
    }

    /// The first line with that text in it that nobody has asked for.
    pub fn line_with(&self, text: &str) -> String {
        self.line_within(text, LIMIT).unwrap_or_else(|| panic!("no line with `{text}`"))
    }

    /// The same, if it comes in that time. Each line is found once; what is passed over is kept for who asks for it later.
    pub fn line_within(&self, text: &str, patience: Duration) -> Option<String> {
        let deadline = Instant::now() + patience;
        let mut kept = self.kept.borrow_mut();
        loop {
            if let Some(found) = kept.iter().position(|line| line.contains(text)) {
                return Some(kept.remove(found));
            }
            kept.push(self.lines.recv_timeout(deadline.saturating_duration_since(Instant::now())).ok()?);
        }
    }

    /// All lines that nobody has asked for, when it has ended.
    pub fn rest(&self) -> Vec<String> {
        let mut kept = self.kept.take();
        kept.extend(std::iter::from_fn(|| self.lines.recv_timeout(LIMIT).ok()));
        kept
    }

    /// A line for its standard input.
    pub fn write(&mut self, line: &str) {
        writeln!(self.stdin.as_mut().unwrap(), "{line}").unwrap();
    }

    /// Ends its standard input.
    pub fn close(&mut self) {
        self.stdin = None;
    }

    /// Sends a signal: `INT`, `TERM`, `HUP`, `KILL`.
    pub fn signal(&self, name: &str) {
        let sent = Command::new("kill").args([&format!("-{name}"), &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let group = format!("-{}", self.child.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).stderr(Stdio::null()).status();
        let _ = self.child.wait();
    }
}

/// A robot, see `robot.py`.
pub struct Robot(pub Process);

impl Robot {
    /// Does one thing.
    pub fn does(&mut self, line: &str) {
        self.0.write(line);
        self.0.line_with("done");
    }

    /// Says a number ten times a second, for so many seconds.
    pub fn keeps_saying(&mut self, topic: &str, number: f64, seconds: f64) {
        for _ in 0..(seconds * 10.0) as usize {
            self.does(&format!("say {topic} {number}"));
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}
