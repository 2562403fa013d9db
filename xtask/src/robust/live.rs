//! What other nodes of a live graph send, from bytes that nobody has checked.

use lapwing_ros::ros2::describe;
use lapwing_ros::ros2::description::{Description, TypeHash};
use lapwing_ros::ros2::graph::{Graph, Participant};

/// A connection header, framed messages, an HTTP request with XML-RPC in it, a definition: whatever ROS 1 makes of the bytes.
pub fn tcpros(data: &[u8]) {
    lapwing_ros::ros1::fuzz(data);
}

/// IDL's `char`, which `.msg` texts have no word of their own for.
const IDL_CHAR: u8 = 13;

/// A byte for what it is, and that: what a participant tells of its nodes, a node's description of a type, a definition, or what an endpoint announces.
pub fn ros2(data: &[u8]) {
    let Some((&choice, rest)) = data.split_first() else { return };
    match choice % 4 {
        0 => participant(rest),
        1 => {
            let Ok(answer) = describe::answer(rest) else { return };
            let text = answer.text();
            if !answer.description.types.values().flatten().any(|f| f.type_id % 48 == IDL_CHAR) {
                assert_eq!(Description::of_text(&answer.description.root, &text), Ok(answer.description), "{text}");
            }
        }
        2 => {
            let Ok(description) = Description::of_text("p/T", &String::from_utf8_lossy(rest)) else { return };
            assert!(description.is_sound(), "{description:?}");
            let again = Description::of_text("p/T", &description.text()).expect("its own text is a definition");
            assert_eq!(again.hash(), description.hash());
        }
        _ => {
            if let Some(hash) = TypeHash::announced(rest) {
                assert_eq!(TypeHash::parse(&hash.to_string()), Some(hash));
            }
        }
    }
}

/// What was understood is written and understood again, and what comes goes without a trace.
fn participant(message: &[u8]) {
    let Ok(participant) = Participant::decode(message) else { return };
    assert_eq!(Participant::decode(&participant.encode()), Ok(participant.clone()));
    let mut graph = Graph::default();
    let (gid, nodes) = (participant.gid, participant.nodes.len());
    let endpoint = participant.nodes.iter().find_map(|n| n.readers.first()).copied();
    graph.note(participant);
    assert_eq!(graph.forget(gid).len(), nodes);
    assert!(endpoint.is_none_or(|gid| graph.owner(&gid).is_none()));
}
