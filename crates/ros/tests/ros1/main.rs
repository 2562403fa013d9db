//! The node of ROS 1 among other people's: a real master, and nodes written with rospy.
//!
//! Needs what `tools/peers.sh` installs; without it a test fails and says so.

mod peers;

use std::time::Duration;

use lapwing_record::{Dialect, Encoder, Encoding, Library, MessageType, RawChannel};
use lapwing_ros::connector::{CallId, Definition, Happening};
use lapwing_stream::Value;

use peers::{Watch, World};

fn record(fields: &[(&str, Value)]) -> Value {
    Value::Record(fields.iter().map(|(name, value)| ((*name).into(), value.clone())).collect())
}

/// An encoder by a definition, and the channel that goes with it.
fn channel(topic: &str, type_name: &str, text: &str) -> (RawChannel, Encoder) {
    let layout = Library::default().layout(Dialect::Ros1, type_name, text).unwrap();
    let channel = RawChannel {
        topic: topic.to_owned(),
        type_name: type_name.to_owned(),
        encoding: "ros1msg".to_owned(),
        definition: text.as_bytes().to_vec(),
        messages: "ros1".to_owned(),
        ty: Ok(MessageType::Ros1(layout.clone())),
    };
    (channel, Encoder::new(layout, Encoding::Ros1))
}

fn message_text(watch: &mut Watch, type_name: &str) -> String {
    match watch.connector.definition(type_name) {
        Ok(Definition::Message(text)) => text,
        other => panic!("{type_name}: {other:?}"),
    }
}

#[test]
fn topics_are_found_with_their_types_and_every_message_arrives() {
    let world = World::new();
    let _core = world.roscore();
    let _first = world.node(&["talk", "/first", "/odom", "100"]);
    let _other = world.node(&["talk", "/somebody", "/elsewhere", "10"]);
    let mut watch = world.watch(&["/odom"]);
    let offer = watch.wait("a stream", |a| match &a.what {
        // Before that the master has spoken of it, without its definition.
        Happening::Stream(offer) if offer.channel.topic == "/odom" && offer.channel.ty.is_ok() => Some(offer.clone()),
        _ => None,
    });
    assert_eq!((offer.channel.type_name.as_str(), offer.latched), ("nav_msgs/Odometry", false));
    assert!(String::from_utf8_lossy(&offer.channel.definition).contains("MSG: geometry_msgs/PoseWithCovariance"));
    let mut last = None;
    for _ in 0..100 {
        let values = watch.message("/odom", &["pose.pose.position.x", "header.seq"]);
        let [Value::Num(x), Value::Num(_)] = values[..] else { panic!("{values:?}") };
        assert!(last.is_none_or(|last| x == last + 1.0), "{last:?}, {x}");
        last = Some(x);
    }
    // What nobody subscribed to is known by hearsay.
    let hearsay = watch.channels.iter().find(|(_, c)| c.topic == "/elsewhere").map(|(_, c)| c.clone());
    let hearsay = hearsay.unwrap_or_else(|| {
        watch.wait("the other topic", |a| match &a.what {
            Happening::Stream(offer) if offer.channel.topic == "/elsewhere" => Some(offer.channel.clone()),
            _ => None,
        })
    });
    assert!(hearsay.type_name == "nav_msgs/Odometry" && hearsay.ty.is_err());
    watch.connector.subscribe(&["/elsewhere".to_owned()]);
    watch.message("/elsewhere", &["pose.pose.position.x"]);
    assert_eq!(message_text(&mut watch, "nav_msgs/msg/Odometry").as_bytes(), offer.channel.definition);
}

#[test]
fn publishers_come_go_and_are_killed() {
    let world = World::new();
    let _core = world.roscore();
    let mut watch = world.watch(&["/odom"]);
    watch.blind("/odom", "nobody publishes it");
    let first = world.node(&["talk", "/first", "/odom", "50"]);
    watch.sees("/odom", "nobody publishes it");
    watch.message("/odom", &["header.seq"]);
    let second = world.node(&["talk", "/second", "/odom", "50"]);
    watch.publishers("/odom", 2);
    first.kill();
    watch.publishers("/odom", 1);
    watch.message("/odom", &["header.seq"]);
    second.kill();
    watch.blind("/odom", "disconnected");
    let _again = world.node(&["talk", "/second", "/odom", "50"]);
    watch.sees("/odom", "disconnected");
    watch.message("/odom", &["header.seq"]);
}

#[test]
fn what_a_publisher_drops_is_counted() {
    let world = World::new();
    let _core = world.roscore();
    let _skips = world.node(&["skip", "/skips", "/odom"]);
    let mut watch = world.watch(&["/odom"]);
    for _ in 0..2 {
        let lost =
            watch.wait("a loss", |a| if let Happening::Lost { count, .. } = a.what { Some(count) } else { None });
        assert_eq!(lost, 3);
    }
}

#[test]
fn who_leaves_as_it_should_is_no_broken_connection() {
    let world = World::new();
    let _core = world.roscore();
    let mut watch = world.watch(&["/text"]);
    let _short = world.node(&["leave", "/short", "/text", "2"]);
    watch.message("/text", &["data"]);
    watch.blind("/text", "nobody publishes it");
}

#[test]
fn what_is_latched_and_what_is_made_at_run_time_is_read() {
    let world = World::new();
    let _core = world.roscore();
    let _latched = world.node(&["latch", "/early", "/map_name", "kitchen"]);
    let _models = world.node(&["models", "/gazebo", "/gazebo/model_states"]);
    let mut watch = world.watch(&["/map_name", "/gazebo/model_states"]);
    assert_eq!(watch.message("/map_name", &["data"]), ["kitchen".into()]);
    let models = watch.message("/gazebo/model_states", &["name[1]", "pose[1].position.x"]);
    assert_eq!(models, ["robot".into(), 1.5.into()]);
    assert_eq!(watch.connector.simulates_time(), Some(false));
    let setter = world.node(&["simulated", "/setter"]);
    watch.wait("simulated time", |_| None::<()>.or(Some(())));
    let begin = std::time::Instant::now();
    while watch.connector.simulates_time() != Some(true) {
        assert!(begin.elapsed() < peers::LIMIT);
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(setter);
}

#[test]
fn a_master_that_restarts_costs_nothing_that_stands() {
    let world = World::new();
    let core = world.roscore();
    let _talker = world.node(&["talk", "/talker", "/odom", "20"]);
    let mut watch = world.watch(&["/odom", "/late"]);
    let text = message_text(&mut watch, "geometry_msgs/Twist");
    let (twist, encoder) = channel("/cmd_vel", "geometry_msgs/Twist", &text);
    let publisher = watch.connector.advertise(&twist, true).unwrap();
    watch.connector.publish(publisher, &encoder.encode(&Value::Missing).unwrap()).unwrap();
    watch.message("/odom", &["header.seq"]);
    core.kill();
    watch.note("does not answer");
    watch.message("/odom", &["header.seq"]);
    let _core = world.roscore();
    watch.note("answers again");
    let _late = world.node(&["talk", "/latecomer", "/late", "20"]);
    watch.message("/late", &["header.seq"]);
    watch.message("/odom", &["header.seq"]);
    // What is published here is known to the new master as well.
    let _hearer = world.tool("rostopic", &["echo", "-n", "1", "/cmd_vel"]);
    assert!(_hearer.line_with("linear").contains("linear"));
}

#[test]
fn services_answer_fail_and_are_not_there() {
    let world = World::new();
    let _core = world.roscore();
    let _server = world.node(&["serve", "/server", "/arm"]);
    let mut watch = world.watch(&[]);
    let Ok(Definition::Service(request, answer)) = watch.connector.definition("std_srvs/srv/SetBool") else { panic!() };
    let (_, encoder) = channel("/arm", "std_srvs/SetBool", &request);
    let asks = encoder.encode(&record(&[("data", true.into())])).unwrap();
    let mut ask = |service: &str, ty: &str| {
        let id: CallId = watch.connector.call(service, ty, &asks, Duration::from_secs(20)).unwrap();
        watch.wait("an answer", |a| match &a.what {
            Happening::Reply { call, answer } if *call == id => Some(answer.clone()),
            _ => None,
        })
    };
    let reply = ask("/arm", "std_srvs/srv/SetBool").unwrap();
    let (answered, _) = channel("/arm", "std_srvs/SetBoolResponse", &answer);
    let paths = ["success".parse().unwrap(), "message".parse().unwrap()];
    let mut decoder = lapwing_record::Decoder::new(&answered.ty.unwrap(), &paths, 10).unwrap();
    let mut values = decoder.slots();
    decoder.decode(&reply, &mut values).unwrap();
    assert_eq!(values, [true.into(), "asked for True".into()]);
    let failed = ask("/arm", "std_srvs/SetBool").unwrap_err();
    assert!(failed.contains("once is enough"), "{failed}");
    let other = ask("/arm", "std_srvs/Trigger").unwrap_err();
    assert!(other.contains("md5sum") || other.contains("std_srvs/SetBool"), "{other}");
    let nobody = ask("/nowhere", "std_srvs/Trigger").unwrap_err();
    assert!(nobody.contains("nowhere") || nobody.contains("no provider"), "{nobody}");
}

#[test]
fn what_is_published_is_heard_by_rospy_and_by_rostopic() {
    let world = World::new();
    let _core = world.roscore();
    let mut watch = world.watch(&[]);
    let text = message_text(&mut watch, "geometry_msgs/msg/Twist");
    let (twist, encoder) = channel("/cmd_vel", "geometry_msgs/Twist", &text);
    let publisher = watch.connector.advertise(&twist, false).unwrap();
    assert!(watch.connector.advertise(&twist, false).unwrap_err().0.contains("already"));
    let hearer = world.node(&["hear", "/hearer", "/cmd_vel"]);
    let echo = world.tool("rostopic", &["echo", "/cmd_vel/linear/x"]);
    let says = |x: f64| record(&[("linear", record(&[("x", x.into())])), ("angular", record(&[("z", (-x).into())]))]);
    // Nobody is told when a subscriber has come: it is told until it hears.
    let stop = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                watch.connector.publish(publisher, &encoder.encode(&says(0.25)).unwrap()).unwrap();
                std::thread::sleep(Duration::from_millis(50));
            }
        });
        let heard = hearer.line_with("{");
        let echoed = echo.line_with("0.25");
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        assert_eq!((heard.as_str(), echoed.as_str()), ("{\"x\": 0.25, \"z\": -0.25}", "0.25"));
    });
    let (wrong, _) = channel("/other", "my/Twist", "float64 x");
    watch.connector.advertise(&wrong, false).unwrap();
    let _hearer = world.node(&["hear", "/confused", "/other"]);
    let note = watch.note("/confused wants /other");
    assert!(note.contains("geometry_msgs/Twist"), "{note}");
}

#[test]
fn lies_are_told_and_the_truth_is_heard_in_the_end() {
    let world = World::new();
    let _core = world.roscore();
    let _liar = world.node(&["lie", "/liar", "/text", &world.uri()]);
    let mut watch = world.watch(&["/text"]);
    for says in ["is the most", "malformed", "are said to have 00000000", "announces a message"] {
        watch.blind("/text", says);
    }
    assert_eq!(watch.message("/text", &["data"]), ["true at last".into()]);
}

#[test]
fn a_master_that_is_not_there_is_waited_for() {
    let world = World::new();
    let mut watch = world.watch(&["/odom"]);
    watch.note("does not answer");
    watch.blind("/odom", "connection refused");
    let _core = world.roscore();
    watch.note("answers again");
    let _talker = world.node(&["talk", "/talker", "/odom", "20"]);
    watch.message("/odom", &["header.seq"]);
    assert!(lapwing_ros::ros1::connect(Some("no address:x"), "/a").is_err());
    assert!(lapwing_ros::ros1::connect(None, "no name").is_err());
}

#[test]
fn the_checksums_are_those_that_ros_has() {
    let world = World::new();
    let script = world.script(&["sums"]);
    let mut watch = world.watch(&[]);
    let mut count = 0;
    while count < 120 {
        let line = script.line();
        let field = |name: &str| {
            let (_, rest) = line.split_once(&format!("\"{name}\": \"")).unwrap();
            rest.split('"').next().unwrap().to_owned()
        };
        let (name, sum) = (field("type"), field("sum"));
        let text = message_text(&mut watch, &name);
        assert_eq!(lapwing_ros::ros1::checksum(&name, &text), Ok(sum), "{name}");
        count += 1;
    }
}
