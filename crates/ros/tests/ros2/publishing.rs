//! What is published here is heard by others, services answer, and the node is seen on the graph.

use std::time::Duration;

use lapwing_record::RawChannel;
use lapwing_ros::connector::{CallId, Connector, Encoding, Happening, PublisherId};

use crate::peer::{Heard, PATIENCE, Peer};

fn channel(topic: &str, type_name: &str) -> RawChannel {
    RawChannel {
        topic: topic.to_owned(),
        type_name: type_name.to_owned(),
        encoding: "ros2msg".to_owned(),
        definition: Vec::new(),
        messages: "cdr".to_owned(),
        ty: Err("not needed".to_owned()),
    }
}

/// A `std_msgs/String` in CDR.
fn text(text: &str) -> Vec<u8> {
    let length = u32::try_from(text.len() + 1).unwrap().to_le_bytes();
    [&[0, 1, 0, 0], &length[..], text.as_bytes(), &[0]].concat()
}

/// A `geometry_msgs/Twist` in CDR.
fn twist(linear: f64, angular: f64) -> Vec<u8> {
    let numbers = [linear, 0.0, 0.0, 0.0, 0.0, angular].map(f64::to_le_bytes).concat();
    [vec![0, 1, 0, 0], numbers].concat()
}

/// Publishes until a peer has heard it: it may not have found the publisher at first.
fn until_heard(connector: &mut dyn Connector, publisher: PublisherId, message: &[u8], peer: &Peer) -> String {
    for _ in 0..600 {
        connector.publish(publisher, message).unwrap();
        if let Some(line) = peer.line_within("heard", Duration::from_millis(50)) {
            return line;
        }
    }
    panic!("the peer heard nothing");
}

#[test]
fn a_command_reaches_the_robot() {
    let robot = Peer::rclpy(131, "listen /cmd_vel geometry_msgs/Twist");
    let mut heard = Heard::on(131, &[]);
    assert_eq!(heard.connector.encoding(), Encoding::Cdr);
    let publisher = heard.connector.advertise(&channel("/cmd_vel", "geometry_msgs/msg/Twist"), false).unwrap();
    let line = until_heard(&mut *heard.connector, publisher, &twist(-0.25, 1.5), &robot);
    assert_eq!(line, "heard -0.25 1.5");
}

#[test]
fn what_is_latched_here_reaches_who_comes_late() {
    let mut heard = Heard::on(132, &[]);
    let publisher = heard.connector.advertise(&channel("/verdict", "std_msgs/String"), true).unwrap();
    heard.connector.publish(publisher, &text("violated")).unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let late = Peer::rclpy(132, "listen /verdict std_msgs/String --latched");
    assert_eq!(late.line("heard"), "heard violated");
}

#[test]
fn a_subscriber_that_asks_for_more_than_is_offered_is_noted() {
    let mut heard = Heard::on(133, &[]);
    heard.connector.advertise(&channel("/verdict", "std_msgs/String"), false).unwrap();
    let _demanding = Peer::rclpy(133, "listen /verdict std_msgs/String --latched --node demanding");
    let note = heard.until("a note", |what| match what {
        Happening::Note(note) if note.contains("hear") => Some(note.clone()),
        _ => None,
    });
    assert!(note.contains("Durability"), "{note}");
}

fn answer(heard: &mut Heard, call: CallId) -> Result<Vec<u8>, String> {
    heard.until("the answer", |what| match what {
        Happening::Reply { call: c, answer } if *c == call => Some(answer.clone().map(|a| a.to_vec())),
        _ => None,
    })
}

fn arm(peer: &Peer, domain: u16) {
    let mut heard = Heard::on(domain, &[]);
    for (data, success, message) in [(true, 0, "it was True"), (false, 1, "it was False")] {
        let request = [0, 1, 0, 0, u8::from(data)];
        let call = heard.connector.call("/arm", "std_srvs/srv/SetBool", &request, PATIENCE).unwrap();
        let answer = answer(&mut heard, call).unwrap();
        assert_eq!(answer[4], success);
        assert_eq!(&answer[12..12 + message.len()], message.as_bytes());
        assert_eq!(peer.line("asked"), format!("asked {}", if data { "True" } else { "False" }));
    }
}

#[test]
fn a_service_of_fast_dds_answers() {
    let peer = Peer::rclpy(134, "serve /arm");
    arm(&peer, 134);
}

#[test]
fn a_service_of_cyclone_dds_answers() {
    let peer = Peer::cyclone(135, "serve /arm");
    arm(&peer, 135);
}

#[test]
fn a_service_that_nobody_offers() {
    let mut heard = Heard::on(136, &[]);
    let call =
        |heard: &mut Heard, ty| heard.connector.call("/arm", ty, &[0, 1, 0, 0, 1], Duration::from_millis(300)).unwrap();
    let id = call(&mut heard, "std_srvs/SetBool");
    assert!(answer(&mut heard, id).is_err_and(|e| e.contains("/arm") && e.contains("nobody")));
    let id = call(&mut heard, "SetBool");
    assert!(answer(&mut heard, id).is_err_and(|e| e.contains("std_srvs/srv/Trigger")));
}

#[test]
fn the_node_is_on_the_graph() {
    let heard = Heard::on(137, &[]);
    assert_eq!(heard.connector.name(), "ROS 2, domain 137");
    let peer = Peer::rclpy(137, "nodes");
    while !peer.line("nodes").split(' ').any(|name| name == "/test/lapwing") {}
}

#[test]
fn only_plain_cdr_of_little_endian_is_published() {
    let mut heard = Heard::on(138, &[]);
    let publisher = heard.connector.advertise(&channel("/x", "std_msgs/msg/Float64"), false).unwrap();
    assert!(heard.connector.publish(publisher, &[0, 0, 0, 0, 1]).is_err());
    assert!(heard.connector.publish(PublisherId(99), &twist(0.0, 0.0)).is_err());
    assert!(heard.connector.advertise(&channel("/x", "no type"), false).is_err_and(|e| e.0.contains("no type")));
}
