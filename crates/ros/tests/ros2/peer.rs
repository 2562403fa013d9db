//! Nodes of others: rclpy and Cyclone DDS, each in a process that ends with its test; and what came of a connector.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use lapwing_record::{Decoder, RawChannel};
use lapwing_ros::connector::{Arrival, Cause, Connector, Happening, Offer, StreamId};
use lapwing_stream::Value;

/// Nothing in these tests takes longer, unless it fails.
pub const PATIENCE: Duration = Duration::from_secs(30);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The distribution that the tests talk to: `LAPWING_ROS2`, else Jazzy.
fn venv() -> PathBuf {
    let distribution = std::env::var("LAPWING_ROS2").unwrap_or_else(|_| "jazzy".to_owned());
    let venv = root().join(format!(".venv-{distribution}"));
    assert!(
        venv.join("bin/python").exists(),
        "there is no {}: `tools/ros2.sh {distribution}` makes it",
        venv.display()
    );
    venv
}

/// A share tree of the distribution.
pub fn share() -> PathBuf {
    venv().join("share")
}

/// A process with a node. Dropped, it is killed.
pub struct Peer {
    process: Child,
    /// The process ends with this.
    stdin: Option<ChildStdin>,
    lines: Receiver<String>,
}

impl Peer {
    /// A node by rclpy: see `peer.py` for what it can do.
    pub fn rclpy(domain: u16, words: &str) -> Peer {
        Peer::start(domain, "peer.py", words)
    }

    /// A participant by Cyclone DDS: see `cyclone.py`.
    pub fn cyclone(domain: u16, words: &str) -> Peer {
        Peer::start(domain, "cyclone.py", words)
    }

    fn start(domain: u16, script: &str, words: &str) -> Peer {
        let mut process = Command::new(venv().join("bin/python"))
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ros2").join(script))
            .args(words.split_whitespace())
            .env("ROS_DOMAIN_ID", domain.to_string())
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let stdout = BufReader::new(process.stdout.take().unwrap());
        let (sender, lines) = channel();
        std::thread::spawn(move || stdout.lines().map_while(Result::ok).all(|line| sender.send(line).is_ok()));
        let peer = Peer { stdin: process.stdin.take(), process, lines };
        peer.line("ready");
        peer
    }

    /// The next line that begins so.
    pub fn line(&self, begin: &str) -> String {
        self.line_within(begin, PATIENCE).unwrap_or_else(|| panic!("no line `{begin}…` of the peer"))
    }

    /// The next line that begins so, if it comes in that time.
    pub fn line_within(&self, begin: &str, patience: Duration) -> Option<String> {
        let deadline = Instant::now() + patience;
        loop {
            let line = self.lines.recv_timeout(deadline.saturating_duration_since(Instant::now())).ok()?;
            if line.starts_with(begin) {
                return Some(line);
            }
        }
    }

    /// Kills it, so that it cannot say goodbye.
    pub fn kill(mut self) {
        self.process.kill().unwrap();
    }

    /// Asks it to end, and lets it say goodbye.
    pub fn interrupt(&mut self) {
        let pid = self.process.id().to_string();
        assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
        self.process.wait().unwrap();
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        drop(self.stdin.take());
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A connector, and all that came of it.
pub struct Heard {
    pub connector: Box<dyn Connector>,
    pub all: Vec<Arrival>,
}

impl Heard {
    pub fn on(domain: u16, topics: &[&str]) -> Heard {
        Heard::with(domain, topics, &[])
    }

    pub fn with(domain: u16, topics: &[&str], trees: &[PathBuf]) -> Heard {
        let mut connector = lapwing_ros::ros2::connect_with(Some(domain), "/test/lapwing", trees).unwrap();
        connector.subscribe(&topics.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>());
        Heard { connector, all: Vec::new() }
    }

    /// Listens until something comes of which that is true.
    pub fn until<T>(&mut self, what: &str, find: impl FnMut(&Happening) -> Option<T>) -> T {
        self.within(PATIENCE, find).unwrap_or_else(|| panic!("{what} did not come; what came:\n{}", self.story()))
    }

    /// The same, if it comes in that time.
    fn within<T>(&mut self, patience: Duration, mut find: impl FnMut(&Happening) -> Option<T>) -> Option<T> {
        let deadline = Instant::now() + patience;
        while Instant::now() < deadline {
            let Some(arrival) = self.connector.next(Duration::from_millis(50)) else { continue };
            let found = find(&arrival.what);
            self.all.push(arrival);
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// The offer of a topic, with its definition.
    pub fn offer(&mut self, topic: &str) -> Offer {
        self.until(&format!("the offer of {topic}"), |what| match what {
            Happening::Stream(offer) if offer.channel.topic == topic && offer.channel.ty.is_ok() => Some(offer.clone()),
            _ => None,
        })
    }

    /// The next message of a stream.
    pub fn message(&mut self, stream: StreamId) -> Vec<u8> {
        self.until("a message", |what| match what {
            Happening::Message { stream: s, payload } if *s == stream => Some(payload.to_vec()),
            _ => None,
        })
    }

    /// The next message of a stream, if it comes in that time.
    pub fn message_within(&mut self, stream: StreamId, patience: Duration) -> Option<Vec<u8>> {
        self.within(patience, |what| match what {
            Happening::Message { stream: s, payload } if *s == stream => Some(payload.to_vec()),
            _ => None,
        })
    }

    /// The next blindness on a topic with a cause that is looked for.
    pub fn blind(&mut self, topic: &str, is_it: impl Fn(&Cause) -> bool) -> Cause {
        self.until("the blindness", |what| match what {
            Happening::Blind { topic: t, cause } if t == topic && is_it(cause) => Some(cause.clone()),
            _ => None,
        })
    }

    /// The end of a blindness.
    pub fn sees(&mut self, topic: &str, is_it: impl Fn(&Cause) -> bool) {
        self.until("sight", |what| {
            matches!(what, Happening::Sees { topic: t, cause } if t == topic && is_it(cause)).then_some(())
        });
    }

    /// How many messages of a stream are said to be lost.
    pub fn lost(&self) -> u64 {
        let count = |a: &Arrival| if let Happening::Lost { count, .. } = a.what { count } else { 0 };
        self.all.iter().map(count).sum()
    }

    fn story(&self) -> String {
        let tell = |a: &Arrival| match &a.what {
            Happening::Message { stream, payload } => format!("{stream:?}: {} bytes", payload.len()),
            Happening::Stream(offer) => format!(
                "{:?}: {} {} {:?}",
                offer.stream,
                offer.channel.topic,
                offer.channel.type_name,
                offer.channel.ty.as_ref().map(|_| ())
            ),
            other => format!("{other:?}"),
        };
        self.all.iter().map(tell).collect::<Vec<_>>().join("\n")
    }
}

/// Numbers in a message.
pub fn numbers(channel: &RawChannel, message: &[u8], fields: &[&str]) -> Vec<f64> {
    let number = |value: Value| match value {
        Value::Num(number) => number,
        other => panic!("{other:?} is no number"),
    };
    values(channel, message, fields).into_iter().map(number).collect()
}

/// Values in a message.
pub fn values(channel: &RawChannel, message: &[u8], fields: &[&str]) -> Vec<Value> {
    let paths: Vec<_> = fields.iter().map(|f| f.parse().unwrap()).collect();
    let mut decoder = Decoder::new(channel.ty.as_ref().unwrap(), &paths, 1 << 24).unwrap();
    let mut values = decoder.slots();
    decoder.decode(message, &mut values).unwrap();
    values
}
