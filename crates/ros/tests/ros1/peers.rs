//! Other people's nodes for the tests: a real master on a port of its own, and nodes written with rospy. Each ends with its guard.

use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use lapwing_record::{Decoder, RawChannel};
use lapwing_ros::connector::{Arrival, Connector, Happening, StreamId};
use lapwing_ros::ros1::connect;
use lapwing_stream::Value;

/// Nothing that a test waits for takes so long, on however busy a machine.
pub const LIMIT: Duration = Duration::from_secs(60);

/// A process and its children, which end with it.
pub struct Peer {
    child: Child,
    lines: Receiver<String>,
}

impl Peer {
    fn start(mut command: Command) -> Peer {
        let what = format!("{command:?}");
        let started =
            command.stdout(Stdio::piped()).stderr(Stdio::null()).stdin(Stdio::null()).process_group(0).spawn();
        let mut child =
            started.unwrap_or_else(|e| panic!("{what}: {e}: run tools/peers.sh once, then this test again"));
        let output = child.stdout.take().expect("its output is a pipe");
        let (send, lines) = channel();
        std::thread::spawn(move || {
            BufReader::new(output).lines().map_while(Result::ok).try_for_each(|line| send.send(line))
        });
        Peer { child, lines }
    }

    /// The next line that it prints.
    pub fn line(&self) -> String {
        self.lines.recv_timeout(LIMIT).expect("a peer says nothing: are all installed? tools/peers.sh installs them")
    }

    /// Lines up to one that has the text in it.
    pub fn line_with(&self, text: &str) -> String {
        let begin = Instant::now();
        loop {
            let line = self.line();
            if line.contains(text) {
                return line;
            }
            assert!(begin.elapsed() < LIMIT, "no line with {text}");
        }
    }

    /// Ends it as a power cut would.
    pub fn kill(self) {}
}

impl Drop for Peer {
    fn drop(&mut self) {
        // The whole group: some of ROS's tools have children.
        let group = format!("-{}", self.child.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).status();
        let _ = self.child.wait();
    }
}

/// A master's port, and a folder for what its nodes write.
pub struct World {
    pub port: u16,
    home: tempfile::TempDir,
}

impl World {
    pub fn new() -> World {
        let free = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        World { port: free.local_addr().unwrap().port(), home: tempfile::tempdir().unwrap() }
    }

    pub fn uri(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("ROS_MASTER_URI", self.uri()).env("ROS_HOME", self.home.path());
        command.env("ROS_IP", "127.0.0.1").env("ROS_HOSTNAME", "127.0.0.1").env("PYTHONUNBUFFERED", "1");
        command
    }

    /// The master that roscore starts, once it answers. By itself, as roscore puts what it starts out of the reach of its own guard.
    pub fn roscore(&self) -> Peer {
        let mut command = self.command("rosmaster");
        command.args(["--core", "-p", &self.port.to_string()]);
        let peer = Peer::start(command);
        let begin = Instant::now();
        while std::net::TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            assert!(begin.elapsed() < LIMIT, "roscore does not come up");
            std::thread::sleep(Duration::from_millis(50));
        }
        peer
    }

    /// A node of `peer.py`, once it is ready.
    pub fn node(&self, arguments: &[&str]) -> Peer {
        let peer = self.script(arguments);
        peer.line_with("ready");
        peer
    }

    pub fn script(&self, arguments: &[&str]) -> Peer {
        let mut command = self.command("/usr/bin/python3");
        command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ros1/peer.py")).args(arguments);
        Peer::start(command)
    }

    /// One of ROS's own tools.
    pub fn tool(&self, program: &str, arguments: &[&str]) -> Peer {
        let mut command = self.command(program);
        command.args(arguments);
        Peer::start(command)
    }

    /// Lapwing's node in this world.
    pub fn watch(&self, topics: &[&str]) -> Watch {
        let mut connector = connect(Some(&self.uri()), "/lapwing").unwrap();
        connector.subscribe(&topics.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>());
        Watch { connector, channels: Vec::new() }
    }
}

/// Lapwing's node, and what it has seen so far.
pub struct Watch {
    pub connector: Box<dyn Connector>,
    pub channels: Vec<(StreamId, RawChannel)>,
}

impl Watch {
    /// What happens next that is wanted, of all that happens.
    pub fn wait<T>(&mut self, what: &str, mut wanted: impl FnMut(&Arrival) -> Option<T>) -> T {
        let begin = Instant::now();
        let mut seen = Vec::new();
        while begin.elapsed() < LIMIT {
            let Some(arrival) = self.connector.next(Duration::from_millis(100)) else { continue };
            if let Happening::Stream(offer) = &arrival.what {
                self.channels.push((offer.stream, offer.channel.clone()));
            }
            if let Some(found) = wanted(&arrival) {
                return found;
            }
            if seen.len() < 50 {
                seen.push(format!("{:?}", arrival.what).chars().take(300).collect::<String>());
            }
        }
        panic!("{what} does not happen; instead:\n{}", seen.join("\n"))
    }

    /// The fields of the next message of a topic.
    pub fn message(&mut self, topic: &str, fields: &[&str]) -> Vec<Value> {
        let channels = self.channels.clone();
        let mut channels = channels;
        self.wait(&format!("a message of {topic}"), |arrival| {
            if let Happening::Stream(offer) = &arrival.what {
                channels.push((offer.stream, offer.channel.clone()));
            }
            let Happening::Message { stream, payload } = &arrival.what else { return None };
            let (_, channel) = channels.iter().rev().find(|(id, c)| id == stream && c.topic == topic)?;
            let paths: Vec<_> = fields.iter().map(|f| f.parse().unwrap()).collect();
            let mut decoder = Decoder::new(channel.ty.as_ref().unwrap(), &paths, 1000).unwrap();
            let mut values = decoder.slots();
            decoder.decode(payload, &mut values).unwrap();
            Some(values)
        })
    }

    pub fn blind(&mut self, topic: &str, says: &str) {
        self.wait(&format!("{topic}: {says}"), |arrival| match &arrival.what {
            Happening::Blind { topic: t, cause } if t == topic && cause.to_string().contains(says) => Some(()),
            _ => None,
        });
    }

    pub fn sees(&mut self, topic: &str, says: &str) {
        self.wait(&format!("{topic} again: {says}"), |arrival| match &arrival.what {
            Happening::Sees { topic: t, cause } if t == topic && cause.to_string().contains(says) => Some(()),
            _ => None,
        });
    }

    pub fn note(&mut self, says: &str) -> String {
        self.wait(says, |arrival| match &arrival.what {
            Happening::Note(text) if text.contains(says) => Some(text.clone()),
            _ => None,
        })
    }

    pub fn publishers(&mut self, topic: &str, wanted: usize) {
        let channels = self.channels.clone();
        self.wait(&format!("{wanted} publishers of {topic}"), |arrival| match &arrival.what {
            Happening::Publishers { stream, count } => {
                let is_it = channels.iter().any(|(id, c)| id == stream && c.topic == topic);
                (is_it && *count == wanted).then_some(())
            }
            _ => None,
        });
    }
}
