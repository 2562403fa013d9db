//! What a program told, in MCAP: it is read as NDJSON is.

use std::collections::BTreeMap;
use std::path::Path;

use lapwing_record::{Format, Item, Options, Wanted, open};

/// Messages `(topic, encoding, stamp, payload)` as a file.
fn write(path: &Path, messages: &[(&str, &str, u64, &str)]) {
    let mut writer = mcap::WriteOptions::new().compression(None).create(std::fs::File::create(path).unwrap()).unwrap();
    let mut channels = BTreeMap::new();
    for (topic, encoding, log_time, payload) in messages {
        let channel_id = *channels.entry(*topic).or_insert_with(|| {
            let schema = writer.add_schema(topic, "jsonschema", b"{}").unwrap();
            writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap()
        });
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: *log_time, publish_time: 0 };
        writer.write_to_known_channel(&header, payload.as_bytes()).unwrap();
    }
    writer.finish().unwrap();
}

/// Every item in words, and what went wrong.
fn read(path: &Path) -> (Format, Vec<String>) {
    let recording = open(path, Options::default()).unwrap();
    let format = recording.format();
    let wanted = [Wanted { topic: "/pose".into(), fields: vec!["x".parse().unwrap()] }];
    let mut reader = recording.read(&wanted);
    let mut told = Vec::new();
    while let Some(item) = reader.next() {
        told.push(match item {
            Ok(Item::Message { time, topic, values, .. }) => format!("{} {topic} {values:?}", time.0),
            Ok(Item::Row { time, cells }) => format!("{} {:?}", time.0, cells.iter().collect::<Vec<_>>()),
            Ok(Item::Event { time, name, fields }) => {
                format!("{} {name} {:?}", time.0, fields.iter().collect::<Vec<_>>())
            }
            Err(e) => format!("error: {e}"),
        });
    }
    told.extend(reader.losses().iter().map(|loss| format!("loss: {loss}")));
    (format, told)
}

const MESSAGES: [(&str, &str, u64, &str); 5] = [
    ("/lapwing/rows", "json", 1, "{\"speed\": 1.5,\n \"ok\": true}"),
    ("/lapwing/events/kick", "json", 2, "{}"),
    ("/lapwing/events/a \"b\"", "json", 2, "{\"power\": NaN}"),
    ("/pose", "json", 3, "{\"x\": 7}"),
    ("/lapwing/rows", "json", 4, "{\"speed\": 2"),
];

#[test]
fn rows_events_and_messages_are_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("told.mcap");
    write(&path, &MESSAGES);
    let (format, told) = read(&path);
    assert_eq!(format, Format::Ndjson);
    assert_eq!(
        told[..4],
        [
            "1 [(\"speed\", Num(1.5)), (\"ok\", Bool(true))]",
            "2 kick []",
            "2 a \"b\" [(\"power\", Num(NaN))]",
            "3 /pose [Num(7.0)]",
        ]
    );
    assert!(told.len() == 5 && told[4].contains("line 5"), "{told:?}");
}

#[test]
fn a_file_with_other_messages_is_what_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("told.mcap");
    write(&path, &[MESSAGES[0], ("/scan", "cdr", 2, "")]);
    assert_eq!(read(&path).0, Format::Mcap);
}

#[test]
fn damage_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("told.mcap");
    write(&path, &MESSAGES);
    let whole = std::fs::read(&path).unwrap();
    for length in (whole.len() / 8..whole.len() - 8).step_by(7) {
        std::fs::write(&path, &whole[..length]).unwrap();
        let Ok(recording) = open(&path, Options::default()) else { continue };
        let mut reader = recording.read(&[]);
        let mut failed = false;
        while let Some(item) = reader.next() {
            failed |= item.is_err();
        }
        assert!(failed || !reader.losses().is_empty(), "{length} of {} bytes", whole.len());
    }
}
