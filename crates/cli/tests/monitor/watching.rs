//! Verdicts as they happen, and the report at the end.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::graph::{Graph, LIMIT};
use crate::lapwing::Lapwing;

const SPEC: &str = "\
decl speed /speed Float64.data
calm: never speed > 2
on violation of calm {
    publish /brake std_msgs/Float64 { data: 0.25 }
    call /halt std_srvs/Trigger {}
}
";

fn violates_brakes_and_agrees(graph: &Graph) {
    let mut robot = graph.robot();
    robot.does("offer /speed");
    robot.does("hear /brake");
    robot.does("serve /halt");
    robot.does("diagnose");
    let lapwing = Lapwing::watches(graph, SPEC, "--format ndjson --record run.mcap --quiet");
    lapwing.says("\"type\":\"start\"");
    // Publishers and subscribers take their time to find each other, and what was said before is lost: a new episode each time, until the robot has heard.
    let begin = Instant::now();
    while robot.0.line_within("heard /brake 0.25", Duration::from_millis(200)).is_none() {
        robot.does("say /speed 1");
        robot.does("say /speed 3.5");
        assert!(begin.elapsed() < LIMIT, "the robot was never told to brake");
    }
    let violation: serde_json::Value = serde_json::from_str(&lapwing.says("\"type\":\"violation\"")).unwrap();
    assert_eq!((&violation["name"], &violation["values"]["speed"]), (&"calm".into(), &3.5.into()));
    robot.0.line_with("called /halt");
    robot.0.line_with("diagnosed lapwing:calm 2");
    let ended = lapwing.ends_by("TERM");
    assert_eq!(ended.code, 1, "{}", ended.stdout);
    assert!(ended.stdout.contains("\"type\":\"end\""), "{}", ended.stdout);
}

#[test]
fn a_violation_is_told_and_reacted_to_on_ros1() {
    violates_brakes_and_agrees(&Graph::ros1());
}

#[test]
fn a_violation_is_told_and_reacted_to_on_ros2() {
    violates_brakes_and_agrees(&Graph::ros2());
}

const ANSWERED: &str = "\
decl asked /asked Float64.data
decl done /done Float64.data
answered: whenever becomes asked > 0, eventually within 500 ms done > 0
";

/// A deadline passes in silence, a publisher leaves, and the recording gives the same report, to the nanosecond.
fn is_never_silent_and_agrees(graph: &Graph) {
    let mut robot = graph.robot();
    robot.does("offer /asked");
    robot.does("offer /done");
    let spec = format!("{ANSWERED}decl speed /speed Float64.data\ncalm: never speed > 2\n");
    let lapwing = Lapwing::watches(graph, &spec, "--format ndjson --record run.mcap");
    lapwing.says("/speed cannot be seen: nobody publishes it");
    robot.does("offer /speed");
    lapwing.says("/speed is published now");
    // What is said before a subscriber has been found is lost: it is asked again, until silence is all that comes.
    lapwing.says_while("\"type\":\"violation\"", Duration::from_secs(1), || {
        ["say /asked 0", "say /done 0", "say /speed 1", "say /asked 1"].iter().for_each(|line| robot.does(line));
    });
    robot.does("leave /speed");
    lapwing.says("/speed cannot be seen: nobody publishes it");
    let ended = lapwing.ends_by("INT");
    assert_eq!(ended.code, 1);
    let of = |name: &str| {
        let mut lines = ended.stdout.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
        lines.find(|line| line["type"] == "verdict" && line["name"] == name).unwrap()
    };
    assert_eq!(of("answered")["verdict"], "violated");
    assert_eq!(of("calm")["verdict"], "inconclusive");
    assert!(of("calm")["cause"].as_str().unwrap().contains("nobody publishes it"));
    let checked = ended.checked();
    for (number, name) in ["answered", "calm"].iter().enumerate() {
        for key in ["verdict", "cause", "obligations", "violations"] {
            assert_eq!(checked["properties"][number][key], of(name)[key], "{name}: {key}");
        }
    }
}

#[test]
fn silence_is_told_and_the_recording_agrees_on_ros1() {
    is_never_silent_and_agrees(&Graph::ros1());
}

#[test]
fn silence_is_told_and_the_recording_agrees_on_ros2() {
    is_never_silent_and_agrees(&Graph::ros2());
}

const CALLS: &str = "\
event asked = request /halt
event answered = reply /halt
event obeyed = reply /halt when success
prompt: whenever asked, eventually within 20 s answered
stubborn: never obeyed
";

/// A service of which the node tells the graph: its halves are events, live and on the recording.
#[test]
fn calls_of_a_service_are_events_on_ros2() {
    let graph = Graph::ros2();
    let mut robot = graph.robot();
    robot.does("serve /halt");
    robot.does("introspect /halt");
    let lapwing = Lapwing::watches(&graph, CALLS, "--format ndjson --record run.mcap --quiet");
    lapwing.says("\"type\":\"start\"");
    // What was called before Lapwing had found the topic is not told again.
    let violation =
        lapwing.says_while("\"type\":\"violation\"", Duration::from_millis(300), || robot.does("call /halt"));
    assert!(violation.contains("\"stubborn\""), "{violation}");
    let ended = lapwing.ends_by("INT");
    let verdicts: Vec<serde_json::Value> = ended
        .stdout
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .filter(|l: &serde_json::Value| l["type"] == "verdict")
        .collect();
    assert_eq!([&verdicts[0]["verdict"], &verdicts[1]["verdict"]], ["holds", "violated"], "{}", ended.stdout);
    let checked = ended.checked();
    for (number, live) in verdicts.iter().enumerate() {
        for key in ["verdict", "obligations", "violations"] {
            assert_eq!(checked["properties"][number][key], live[key], "{number}: {key}");
        }
    }
}

#[test]
fn specifications_are_read_again_and_how_things_stand_is_shown() {
    let graph = Graph::ros1();
    let mut robot = graph.robot();
    robot.does("offer /speed");
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let spec = "decl speed /speed Float64.data\ncalm: never speed > 2\n";
    let lapwing = Lapwing::watches(&graph, spec, &format!("--format ndjson --serve {port} --record run.mcap"));
    lapwing.says("\"type\":\"start\"");
    let good = "lapwing_property_state{property=\"calm\",file=\"robot.rv\"} 0";
    let begin = Instant::now();
    while !get(port, "/metrics").contains(good) {
        robot.keeps_saying("/speed", 1.0, 0.2);
        assert!(begin.elapsed() < LIMIT, "{}", get(port, "/metrics"));
    }
    let metrics = get(port, "/metrics");
    assert!(metrics.contains("lapwing_topic_publishers{topic=\"/speed\"} 1"), "{metrics}");
    assert!(get(port, "/").contains("<!DOCTYPE html>"));

    std::fs::write(lapwing.folder.path().join("robot.rv"), "decl speed /speed Float64.data\nnever speed >\n").unwrap();
    lapwing.signal("HUP");
    robot.keeps_saying("/speed", 1.0, 1.0);
    assert!(get(port, "/metrics").contains("property=\"calm\""), "what is wrong is not taken");

    std::fs::write(lapwing.folder.path().join("robot.rv"), "decl speed /speed Float64.data\nslow: never speed > 0.5\n")
        .unwrap();
    lapwing.signal("HUP");
    lapwing.says("\"type\":\"end\"");
    let violation =
        lapwing.says_while("\"type\":\"violation\"", Duration::from_millis(100), || robot.does("say /speed 1"));
    assert!(violation.contains("\"slow\""), "{violation}");
    let ended = lapwing.ends_by("INT");
    assert_eq!(ended.code, 1);
    assert!(ended.folder.path().join("run.2.mcap").exists());
}

fn get(port: u16, path: &str) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    answer
}
