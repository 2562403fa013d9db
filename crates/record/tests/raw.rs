//! Messages as they lie in a recording, out of every container.

mod make;

use std::path::Path;

use lapwing_record::{Options, RawChannel, open};
use make::{COUNT, DEFINITION, cdr, ros1};

/// The messages of `/a`: stamps and bytes, and the channel that they are of.
fn raw(path: &Path) -> (Vec<(i64, Vec<u8>)>, RawChannel, usize) {
    let mut reader = open(path, Options::default()).unwrap().read_raw(&["a".to_owned()]);
    let (mut found, mut others, mut channel) = (Vec::new(), 0, None);
    while let Some(message) = reader.next() {
        let message = message.unwrap();
        let number = message.channel;
        match message.payload {
            Some(bytes) => found.push((message.time.0, bytes.to_vec())),
            None => {
                others += 1;
                continue;
            }
        }
        channel = reader.channel(number).cloned();
    }
    assert!(reader.losses().is_empty());
    (found, channel.unwrap(), others)
}

fn check(path: &Path, message: fn(usize) -> Vec<u8>, said: [&str; 3]) -> usize {
    let (found, channel, others) = raw(path);
    let expected: Vec<(i64, Vec<u8>)> = (0..COUNT).map(|k| (1000 * k as i64, message(k))).collect();
    assert_eq!(found, expected);
    assert_eq!([&*channel.type_name, &*channel.encoding, &*channel.messages], said);
    assert_eq!((&*channel.topic, channel.definition), ("/a", DEFINITION.as_bytes().to_vec()));
    assert!(channel.ty.is_ok());
    others
}

#[test]
fn messages_come_as_they_were_recorded_with_what_is_known_of_their_types() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (k, compression) in [None, Some(mcap::Compression::Zstd)].into_iter().enumerate() {
        let file = path(&format!("{k}.mcap"));
        std::fs::write(&file, make::mcap(compression, true)).unwrap();
        assert_eq!(check(&file, cdr, ["p/msg/T", "ros2msg", "cdr"]), COUNT, "messages of /b");
    }
    make::db3(&path("a.db3"));
    assert_eq!(check(&path("a.db3"), cdr, ["p/msg/T", "ros2msg", "cdr"]), 0);
    std::fs::write(path("a.bag"), make::bag(true)).unwrap();
    assert_eq!(check(&path("a.bag"), ros1, ["p/T", "ros1msg", "ros1"]), 0);
}

#[test]
fn rows_and_events_are_no_messages() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.csv");
    std::fs::write(&file, "time,x\n0,1\n").unwrap();
    let mut reader = open(&file, Options::default()).unwrap().read_raw(&["x".to_owned()]);
    assert!(reader.next().is_none());
}
