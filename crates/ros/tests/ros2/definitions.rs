//! The definition that messages follow is found, wherever it is, and told apart from one that they do not follow.

use std::fs;
use std::path::Path;

use lapwing_record::Library;
use lapwing_ros::connector::{Cause, Definition};
use lapwing_ros::ros2::description::Description;
use lapwing_stream::Value;

use crate::peer::{self, Heard, Peer, numbers};

/// The hash of every message of the distribution's packages is what their own generator says.
#[test]
fn hashes_are_those_of_the_distribution() {
    let share = peer::share();
    let library = Library::new(std::slice::from_ref(&share));
    let mut checked = 0;
    for package in fs::read_dir(&share).unwrap().map(|e| e.unwrap().path()) {
        let messages = fs::read_dir(package.join("msg")).into_iter().flatten().map(|e| e.unwrap().path());
        for file in messages.filter(|f| f.extension().is_some_and(|e| e == "json")) {
            let name = type_name(&package, &file);
            let said: serde_json::Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
            let text = library.text(&name).unwrap().unwrap();
            let description = Description::of_text(&name, &text).unwrap();
            assert_eq!(description.hash().to_string(), said["type_hashes"][0]["hash_string"], "{name}");
            checked += 1;
        }
    }
    assert!(checked > 100, "{checked}");
}

fn type_name(package: &Path, file: &Path) -> String {
    format!("{}/msg/{}", package.file_name().unwrap().to_str().unwrap(), file.file_stem().unwrap().to_str().unwrap())
}

/// The type is not bundled, and not installed here: the node knows it.
#[test]
fn a_node_describes_its_types() {
    assert!(lapwing_record::bundled_text("shape_msgs/SolidPrimitive").is_none());
    let _peer = Peer::rclpy(121, "publish /shape shape_msgs/SolidPrimitive");
    let mut heard = Heard::on(121, &["/shape"]);
    let offer = heard.offer("/shape");
    let text = String::from_utf8(offer.channel.definition.clone()).unwrap();
    assert!(text.contains("CYLINDER=3") && text.contains("MSG: geometry_msgs/Polygon"), "{text}");
    let message = heard.message(offer.stream);
    let read = numbers(&offer.channel, &message, &["type", "dimensions[0]", "dimensions[1]"]);
    assert!(read[0] == 3.0 && read[1] >= 1.0 && read[2] == 0.5, "{read:?}");
}

/// A share tree of another version of a message.
fn other_twist() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir_all(dir.path().join("geometry_msgs/msg")).unwrap();
    fs::write(dir.path().join("geometry_msgs/msg/Twist.msg"), "float64 confidence\nVector3 linear\nVector3 angular\n")
        .unwrap();
    dir
}

#[test]
fn a_definition_that_differs_is_not_used() {
    let dir = other_twist();
    let _peer = Peer::rclpy(122, "publish /cmd_vel geometry_msgs/Twist");
    let mut heard = Heard::with(122, &["/cmd_vel"], &[dir.path().to_owned()]);
    let offer = heard.offer("/cmd_vel");
    let message = heard.message(offer.stream);
    assert!(numbers(&offer.channel, &message, &["linear.x"])[0] > 0.0);
}

/// And where the node is mute, that is said.
#[test]
fn a_definition_that_differs_and_a_node_that_is_mute() {
    let dir = other_twist();
    let _peer = Peer::rclpy(123, "publish /cmd_vel geometry_msgs/Twist --mute --node mute");
    let mut heard = Heard::with(123, &["/cmd_vel"], &[dir.path().to_owned()]);
    // Whose publisher it is may be known later than that there is one: then that is told, and told anew.
    let is_final =
        |cause: &Cause| matches!(cause, Cause::Undefined(why) if why.contains("RIHS01_") && why.contains("/mute"));
    let Cause::Undefined(why) = heard.blind("/cmd_vel", is_final) else { panic!() };
    assert!(why.matches("RIHS01_").count() == 2, "{why}");
}

/// What services say of themselves comes on topics, whose types only the node knows.
#[test]
fn events_of_a_service_are_seen() {
    let _peer = Peer::rclpy(124, "serve /arm --introspect");
    let mut heard = Heard::on(124, &["/arm/_service_event"]);
    let offer = heard.offer("/arm/_service_event");
    assert_eq!(offer.channel.type_name, "std_srvs/srv/SetBool_Event");
    let request = [0, 1, 0, 0, 1];
    let fields = ["info.event_type", "info.sequence_number"];
    // What was called before the node had found this reader is not told again: it is called until something comes.
    let deadline = std::time::Instant::now() + peer::PATIENCE;
    let received = loop {
        heard.connector.call("/arm", "std_srvs/srv/SetBool", &request, peer::PATIENCE).unwrap();
        let told = heard.message_within(offer.stream, std::time::Duration::from_secs(1));
        // The first that comes may be the end of a call.
        match told.filter(|told| numbers(&offer.channel, told, &fields)[0] == 1.0) {
            Some(received) => break received,
            None => assert!(std::time::Instant::now() < deadline, "no call was told of"),
        }
    };
    assert_eq!(peer::values(&offer.channel, &received, &["request[0].data"]), [Value::Bool(true)]);
    let call = numbers(&offer.channel, &received, &fields)[1];
    let sent = loop {
        let told = heard.message(offer.stream);
        if numbers(&offer.channel, &told, &fields) == [2.0, call] {
            break told;
        }
    };
    assert_eq!(peer::values(&offer.channel, &sent, &["response[0].message"]), [Value::from("it was True")]);
}

#[test]
fn the_graph_is_asked_for_what_the_machine_does_not_have() {
    let _peer = Peer::rclpy(125, "publish /shape shape_msgs/SolidPrimitive");
    let mut heard = Heard::on(125, &[]);
    let Ok(Definition::Message(text)) = heard.connector.definition("shape_msgs/msg/SolidPrimitive") else { panic!() };
    assert!(text.contains("MSG: geometry_msgs/Polygon"), "{text}");
    let Ok(Definition::Service(request, answer)) = heard.connector.definition("std_srvs/srv/SetBool") else { panic!() };
    assert!(request.contains("bool data") && answer.contains("string message"));
    for gone in ["gone/msg/Away", "gone/srv/Away"] {
        assert!(heard.connector.definition(gone).is_err_and(|e| e.0.contains(gone) && e.0.contains("--msgs")));
    }
}
