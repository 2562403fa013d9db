//! Foxglove's WebSocket protocol, with a client written by others: `foxglove.py` subscribes by the `websockets` of Python. Wants the feature `foxglove`.

use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::graph::{Graph, Process};
use crate::lapwing::Lapwing;

const SPEC: &str = "decl speed /speed Float64.data\ncalm: never speed > 2\n";

#[test]
fn a_client_hears_of_verdicts_diagnostics_and_signals() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let graph = Graph::ros1();
    let mut robot = graph.robot();
    robot.does("offer /speed");
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let lapwing = Lapwing::watches(&graph, SPEC, &format!("--format ndjson --quiet --foxglove {port}"));
    lapwing.says("\"type\":\"start\"");
    let mut client = Command::new(root.join(".venv/bin/python"));
    client.arg(root.join("crates/cli/tests/monitor/foxglove.py")).arg(port.to_string());
    let client = Process::start(client, "tools/peers.sh");
    let mut speed = 1.0;
    let mut heard: Vec<String> = Vec::new();
    let hears = |heard: &Vec<String>, text: &str| heard.iter().any(|line| line.contains(text));
    let begin = std::time::Instant::now();
    while !["refused", "/lapwing/verdicts", "/diagnostics 2", "/lapwing/signals/speed 3.5"]
        .iter()
        .all(|text| hears(&heard, text))
    {
        assert!(begin.elapsed() < crate::graph::LIMIT, "{heard:#?}");
        robot.does(&format!("say /speed {speed}"));
        heard.extend(client.line_within("", Duration::from_millis(100)));
        // Once it has subscribed and sees the speed, the robot goes too fast.
        if hears(&heard, "/lapwing/signals/speed 1") && hears(&heard, "/diagnostics 0") {
            speed = 3.5;
        }
    }
    let verdict = heard.iter().find(|line| line.starts_with("/lapwing/verdicts")).unwrap();
    assert_eq!(verdict, "/lapwing/verdicts violation calm 3.5");
    assert_eq!(lapwing.ends_by("INT").code, 1);
}
