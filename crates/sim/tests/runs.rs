//! Runs are the same whenever they are run, and recordings say what was published.

use std::collections::BTreeMap;
use std::io::Cursor;

use lapwing_record::{Item, Options as Reading, Wanted, open};
use lapwing_sim::scenario::BUNDLED;
use lapwing_sim::{Options, Scenario, record, recording};
use lapwing_stream::Value;

fn scenario(name: &str) -> Scenario {
    Scenario::bundled(name).unwrap().unwrap()
}

fn options(seed: u64, seconds: f64, faults: &[&str]) -> Options {
    Options { seed, duration: Some(seconds), faults: faults.iter().map(|f| f.parse().unwrap()).collect() }
}

fn bytes(name: &str, options: &Options) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    record(&scenario(name), options, &mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    for (name, _) in BUNDLED {
        let run = |seed| bytes(name, &options(seed, 3.0, &[]));
        let first = run(7);
        assert!(first == run(7), "{name}: two runs of one seed differ");
        assert!(first != run(8), "{name}: two seeds give one run");
    }
}

#[test]
fn every_fault_changes_nothing_but_what_it_is_about() {
    // Until a fault begins a run is the one without it.
    let until = |faults: &[&str]| {
        let file = tempfile::NamedTempFile::with_suffix(".mcap").unwrap();
        std::fs::write(file.path(), bytes("patrol", &options(3, 4.0, faults))).unwrap();
        values(file.path()).into_iter().filter(|(t, ..)| *t < 2_000_000_000).collect::<Vec<_>>()
    };
    let healthy = until(&[]);
    assert!(healthy.len() > 300);
    for about in lapwing_sim::fault::ALL {
        let faulty = until(&[&format!("{}@2", about.name)]);
        // A clock that jumps back shows the same time twice.
        let same = faulty.iter().zip(&healthy).take_while(|(a, b)| a == b).count();
        assert!(same >= healthy.len() - 1, "{}: {same} of {}", about.name, healthy.len());
    }
}

/// Everything in a recording: time, topic, and a few of the values.
fn values(path: &std::path::Path) -> Vec<(i64, String, Vec<Value>)> {
    let recording = open(path, Reading::default()).unwrap();
    let fields: BTreeMap<String, Vec<&str>> = [
        ("/odom", vec!["pose.pose.position.x", "twist.twist.linear.x", "header.stamp.nanosec"]),
        ("/scan", vec!["ranges"]),
        ("/cmd_vel", vec!["linear.x", "angular.z"]),
        ("/gazebo/model_states", vec!["name", "pose[1].position.x"]),
    ]
    .into_iter()
    .map(|(topic, fields)| (topic.to_owned(), fields))
    .collect();
    let wanted: Vec<Wanted> = fields
        .into_iter()
        .map(|(topic, fields)| Wanted { topic, fields: fields.iter().map(|f| f.parse().unwrap()).collect() })
        .collect();
    read(recording.read(&wanted))
}

fn read(mut reader: lapwing_record::Reader) -> Vec<(i64, String, Vec<Value>)> {
    let mut all = Vec::new();
    while let Some(item) = reader.next() {
        match item.unwrap() {
            Item::Message { time, topic, values, .. } => all.push((time.0, topic.to_owned(), values.to_vec())),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(reader.losses(), []);
    all
}

#[test]
fn a_file_and_a_feed_say_the_same() {
    for (name, _) in BUNDLED {
        let options = options(5, 4.0, &[]);
        let file = tempfile::NamedTempFile::with_suffix(".mcap").unwrap();
        std::fs::write(file.path(), bytes(name, &options)).unwrap();
        let written = open(file.path(), Reading::default()).unwrap();
        let topics: Vec<_> = written.topics().iter().map(|t| (t.name.clone(), t.type_name.clone())).collect();
        // Whole messages of every topic, decoded from the file and from the feed.
        let wanted: Vec<Wanted> = topics
            .iter()
            .map(|(topic, _)| Wanted { topic: topic.clone(), fields: vec![lapwing_record::Path::new([])] })
            .collect();
        let fed = recording(&scenario(name), &options).unwrap();
        assert!(topics.iter().all(|(topic, ty)| fed.topics().iter().any(|t| t.name == *topic && t.type_name == *ty)));
        let (from_file, from_feed) = (read(written.read(&wanted)), read(fed.read(&wanted)));
        assert!(from_file.len() > 500, "{name}: {}", from_file.len());
        // NaN is not equal to itself: the texts are compared.
        assert!(format!("{from_file:?}") == format!("{from_feed:?}"), "{name}: file and feed differ");
    }
}
