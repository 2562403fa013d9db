//! The network is cut between Lapwing and the robot, and mended: each is in a network namespace of its own, with a cable between them that can be
//! pulled (`ip netns`, a pair of `veth`).
//!
//! Namespaces need privileges. Where the machine refuses them these tests fail, and say what to do.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::graph::Process;
use crate::lapwing::checked;

/// Two namespaces and the cable between them, gone when this is dropped.
struct Cable {
    ours: String,
    theirs: String,
}

/// The addresses at both ends: those that are kept for documents, which nobody else has.
const OURS: &str = "192.0.2.1";
const THEIRS: &str = "192.0.2.2";

/// What to do where no namespace can be made.
const HELP: &str = "run `tools/peers.sh` once, which installs `ip`, and this test as root; where there are no namespaces, \
     leave the tests that need them out by `-- --skip cut::`";

impl Cable {
    /// Lays it. The second of two namespaces may be refused as well as the first: what was made is taken away either way.
    fn lay(number: u8) -> Cable {
        let own = format!("lw{number}-{}", std::process::id());
        let cable = Cable { ours: format!("{own}-a"), theirs: format!("{own}-b") };
        for space in [&cable.ours, &cable.theirs] {
            ip(&["netns", "add", space])
                .unwrap_or_else(|why| panic!("no network namespace can be made: {why}: {HELP}"));
        }
        let (a, b) = (format!("va{number}-{}", std::process::id()), format!("vb{number}-{}", std::process::id()));
        ip(&["link", "add", &a, "netns", &cable.ours, "type", "veth", "peer", "name", &b, "netns", &cable.theirs])
            .unwrap();
        for (space, link, address) in [(&cable.ours, &a, OURS), (&cable.theirs, &b, THEIRS)] {
            ip(&["-n", space, "link", "set", link, "name", "cable"]).unwrap();
            ip(&["-n", space, "addr", "add", &format!("{address}/24"), "dev", "cable"]).unwrap();
            ip(&["-n", space, "link", "set", "lo", "up"]).unwrap();
            ip(&["-n", space, "link", "set", "cable", "up"]).unwrap();
            ip(&["-n", space, "route", "add", "224.0.0.0/4", "dev", "cable"]).unwrap();
        }
        cable
    }

    fn pull(&self) {
        ip(&["-n", &self.theirs, "link", "set", "cable", "down"]).unwrap();
    }

    fn mend(&self) {
        ip(&["-n", &self.theirs, "link", "set", "cable", "up"]).unwrap();
        // What goes to everybody lost its way with the cable.
        ip(&["-n", &self.theirs, "route", "replace", "224.0.0.0/4", "dev", "cable"]).unwrap();
    }

    /// Waits until the master can be reached from this side.
    fn wait_for(&self, port: u16) {
        let reach = format!("import socket; socket.create_connection(('{THEIRS}', {port}), 1)");
        let begin = std::time::Instant::now();
        loop {
            let mut python = self.command(&self.ours, Path::new("/usr/bin/python3"), OURS, port);
            if python.args(["-c", &reach]).output().unwrap().status.success() {
                return;
            }
            assert!(begin.elapsed() < crate::graph::LIMIT, "the master does not come up");
        }
    }

    /// A command in one of the namespaces.
    fn command(&self, space: &str, program: &Path, address: &str, master: u16) -> Command {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", space]).arg(program);
        command
            .env("ROS_MASTER_URI", format!("http://{THEIRS}:{master}"))
            .env("ROS_IP", address)
            .env("ROS_HOSTNAME", address);
        command.env("ROS_DOMAIN_ID", "149").env("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET");
        command.env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").env("PYTHONUNBUFFERED", "1");
        command
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        for space in [&self.ours, &self.theirs] {
            // Of what was never made nothing is left.
            drop(ip(&["netns", "del", space]));
        }
    }
}

fn ip(words: &[&str]) -> Result<(), String> {
    let done = Command::new("ip").args(words).output().map_err(|e| e.to_string())?;
    if done.status.success() { Ok(()) } else { Err(format!("{words:?}: {}", String::from_utf8_lossy(&done.stderr))) }
}

const SPEC: &str = "decl speed /speed Float64.data stale after 2 s\ncalm: never speed > 2\n";

/// `word` is the transport, `told` what is said of the cut.
fn survives_a_cut(number: u8, word: &str, told: &str) {
    let cable = Cable::lay(number);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let _master = (word == "ros1").then(|| {
        let mut master = cable.command(&cable.theirs, Path::new("rosmaster"), THEIRS, port);
        master.args(["--core", "-p", &port.to_string()]);
        let master = Process::start(master, "tools/peers.sh");
        cable.wait_for(port);
        master
    });
    let python = if word == "ros1" { PathBuf::from("/usr/bin/python3") } else { root.join(".venv-jazzy/bin/python") };
    let mut robot = cable.command(&cable.theirs, &python, THEIRS, port);
    robot.arg(root.join("crates/cli/tests/monitor/robot.py")).arg(word);
    let mut robot = Process::start(robot, "tools/peers.sh and tools/ros2.sh");
    robot.line_with("ready");

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.rv"), SPEC).unwrap();
    let mut lapwing = cable.command(&cable.ours, Path::new(env!("CARGO_BIN_EXE_lapwing")), OURS, port);
    let clock = format!("monitor robot.rv --{word} --format ndjson --quiet --clock wall --record run.mcap");
    lapwing.args(clock.split_whitespace()).current_dir(folder.path());
    let mut lapwing = Process::start(lapwing, "cargo build");
    lapwing.line_with("/speed cannot be seen: nobody publishes it");
    robot.write("offer /speed");
    robot.line_with("done");
    says_until(&mut robot, &lapwing, "/speed is published now");
    (0..30).for_each(|_| speak(&mut robot));
    cable.pull();
    lapwing.line_with(told);
    cable.mend();
    says_until(&mut robot, &lapwing, "/speed is back after");
    lapwing.signal("INT");
    let report = lapwing.rest().join("\n");
    assert_eq!(lapwing.child.wait().unwrap().code(), Some(3), "{report}");
    let checked = checked(folder.path());
    let verdict = report.lines().find(|line| line.contains("\"type\":\"verdict\"")).unwrap();
    let live: serde_json::Value = serde_json::from_str(verdict).unwrap();
    assert_eq!(live["verdict"], "inconclusive");
    for key in ["verdict", "cause", "obligations"] {
        assert_eq!(live[key], checked["properties"][0][key], "{key}");
    }
}

fn speak(robot: &mut Process) {
    robot.write("say /speed 1");
    robot.line_with("done");
    std::thread::sleep(Duration::from_millis(50));
}

/// The robot speaks until Lapwing has said something.
fn says_until(robot: &mut Process, lapwing: &Process, text: &str) {
    let begin = std::time::Instant::now();
    while lapwing.line_within(text, Duration::from_millis(50)).is_none() {
        if begin.elapsed() > crate::graph::LIMIT {
            lapwing.signal("INT");
            panic!("never `{text}`:\n{}", lapwing.rest().join("\n"));
        }
        speak(robot);
    }
}

#[test]
fn a_cut_of_the_network_is_told_and_survived_on_ros1() {
    survives_a_cut(1, "ros1", "nothing came on /speed for longer than 2 s");
}

#[test]
fn a_cut_of_the_network_is_told_and_survived_on_ros2() {
    survives_a_cut(2, "ros2", "nothing came on /speed for longer than 2 s");
}
