//! The live page in a real browser: `look.py` opens it in headless Chromium and says by lines what the robot is to do next.
//! `tools/browser.sh` installs both.

use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::graph::{Graph, LIMIT, Process};
use crate::lapwing::Lapwing;

const SPEC: &str = "\
decl speed /speed Float64.data
decl word /word String.data
calm: never speed > 2
polite: never word == \"<img src=x onerror=alert(1)>\"
slow: whenever becomes speed > 1.5, eventually within 1 s speed < 1
machine gear {
  initial first
  state first when speed < 3
  state second when speed >= 3
  first -> second
}
";

#[test]
fn a_person_sees_what_happens_when_it_happens() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let graph = Graph::ros1();
    let mut robot = graph.robot();
    robot.does("offer /speed");
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let lapwing = Lapwing::watches(&graph, SPEC, &format!("--format ndjson --quiet --serve {port}"));
    lapwing.says("\"type\":\"start\"");

    // They ask and never read, or never ask: nobody else is to mind.
    let mut stuck: Vec<TcpStream> = (0..20).map(|_| TcpStream::connect(("127.0.0.1", port)).unwrap()).collect();
    for stream in stuck.iter_mut().step_by(2) {
        stream.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    }

    let mut look = Command::new(root.join(".venv/bin/python"));
    look.arg(root.join("crates/cli/tests/monitor/look.py")).arg(format!("http://127.0.0.1:{port}/"));
    let mut look = Process::start(look, "tools/browser.sh");
    // The robot does what the browser waits for, over and over, until it has seen it.
    let mut doing = vec!["say /speed 1".to_owned(), "tell /word hello".to_owned()];
    let (mut checks, mut ends) = (0, false);
    let mut heard = Instant::now();
    while !ends {
        let Some(line) = look.line_within("", Duration::from_millis(100)) else {
            doing.iter().for_each(|line| robot.does(line));
            assert!(look.child.try_wait().unwrap().is_none(), "the browser's script failed: see above");
            assert!(heard.elapsed() < LIMIT, "the browser's script says nothing any more after {checks} checks");
            continue;
        };
        heard = Instant::now();
        match line.split_once(' ') {
            Some(("ok", _)) => checks += 1,
            Some(("do", what)) => doing = what.split(';').filter(|w| !w.is_empty()).map(str::to_owned).collect(),
            Some(("once", what)) => {
                robot.does(what);
                look.write("done");
            }
            Some(("end", _)) => lapwing.signal("TERM"),
            _ if line == "bye" => ends = true,
            _ => panic!("{line}"),
        }
    }
    assert!(checks >= 11, "{checks} checks");
    let ended = lapwing.ends_by("INT");
    assert_eq!(ended.code, 1, "{}", ended.stdout);
}
