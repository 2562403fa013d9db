//! Recordings by other people's writers: every value must come out as it went in.
//!
//! Needs what `tools/peers.sh` installs; without it the test fails and says so.

use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_record::{Item, Options, Wanted, open};
use lapwing_stream::Value;
use serde_json::Value as Json;

/// Runs the writers, in a folder that is removed afterwards.
fn write() -> tempfile::TempDir {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = here.join("../../.venv/bin/python");
    assert!(python.exists(), "the other recorders are not installed: run tools/peers.sh once, then this test again");
    let folder = tempfile::tempdir().unwrap();
    let done = Command::new(python).arg(here.join("tests/others/write.py")).arg(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(
        done.status.success(),
        "the other recorders failed; run tools/peers.sh, which installs what is missing\n{said}"
    );
    folder
}

/// The wanted topics with all fields that any of their expected messages names.
fn wanted(messages: &[Json]) -> Vec<Wanted> {
    let mut all: Vec<Wanted> = Vec::new();
    for message in messages {
        let topic = message["topic"].as_str().unwrap();
        if all.iter().all(|w| w.topic != topic) {
            let fields = message["values"].as_object().unwrap().keys().map(|path| path.parse().unwrap()).collect();
            all.push(Wanted { topic: topic.to_owned(), fields });
        }
    }
    all
}

fn same(expected: &Json, value: &Value) -> bool {
    match (expected, value) {
        (Json::Null, Value::Missing) => true,
        (Json::Bool(a), Value::Bool(b)) => a == b,
        (Json::Number(a), Value::Num(b)) => a.as_f64() == Some(*b),
        (Json::String(a), Value::Num(b)) => a.parse::<f64>().is_ok_and(|a| a == *b || a.is_nan() && b.is_nan()),
        (Json::String(a), Value::Str(b)) => a == b,
        (Json::Array(a), Value::Nums(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, &Value::Num(*b)))
        }
        (Json::Array(a), Value::List(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        _ => false,
    }
}

fn check(path: &Path, messages: &[Json]) {
    let wanted = wanted(messages);
    let recording = open(path, Options::default()).unwrap();
    for topic in recording.topics() {
        let count = messages.iter().filter(|m| m["topic"] == topic.name.as_str()).count() as u64;
        assert!(topic.messages.is_none_or(|n| n == count), "{path:?}: {topic:?}");
        assert!(topic.schema.is_ok(), "{path:?}: {topic:?}");
    }
    assert_eq!(recording.topics().len(), wanted.len(), "{path:?}");
    let mut reader = recording.read(&wanted);
    let mut read = 0;
    while let Some(item) = reader.next() {
        let Item::Message { time, wanted: Some(k), topic, values } = item.unwrap() else {
            panic!("{path:?}: no message {read}")
        };
        let expected = &messages[read];
        assert_eq!(
            (topic, time.0),
            (expected["topic"].as_str().unwrap(), expected["t"].as_i64().unwrap()),
            "{path:?}: message {read}"
        );
        for (field, value) in wanted[k].fields.iter().zip(values) {
            let expected = &expected["values"][field.to_string()];
            assert!(same(expected, value), "{path:?}: message {read}, {field}: {value:?} where {expected} was written");
        }
        read += 1;
    }
    assert_eq!(reader.losses(), [], "{path:?}");
    assert_eq!(read, messages.len(), "{path:?}");
}

#[test]
fn what_others_write_is_read_value_by_value() {
    let folder = write();
    let expected = std::fs::read_to_string(folder.path().join("expected.json")).unwrap();
    let recordings: Vec<Json> = serde_json::from_str(&expected).unwrap();
    assert!(recordings.len() >= 20);
    for recording in &recordings {
        let path: PathBuf = folder.path().join(recording["name"].as_str().unwrap());
        check(&path, recording["messages"].as_array().unwrap());
    }
}
