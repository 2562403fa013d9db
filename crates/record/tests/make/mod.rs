//! Small recordings, made byte by byte or by the libraries of their formats.

#![allow(dead_code, reason = "each test file uses some of it")]

use std::collections::BTreeMap;
use std::path::Path;

use lapwing_record::{Item, Loss, OpenError, Options, Wanted, open};
use lapwing_stream::Value;

/// The definition of the messages made here, in both versions of ROS.
pub const DEFINITION: &str = "float64 x\nstring name\nfloat32[] ranges\n";
/// How many messages each recording holds.
pub const COUNT: usize = 12;

/// The k-th message in CDR.
pub fn cdr(k: usize) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend((k as f64 / 2.0).to_le_bytes());
    let name = format!("n{k}\0");
    bytes.extend((name.len() as u32).to_le_bytes());
    bytes.extend(name.as_bytes());
    bytes.resize((bytes.len() - 4).next_multiple_of(4) + 4, 0);
    bytes.extend((k as u32).to_le_bytes());
    (0..k).for_each(|j| bytes.extend((j as f32).to_le_bytes()));
    bytes
}

/// The k-th message, packed.
pub fn ros1(k: usize) -> Vec<u8> {
    let mut bytes = (k as f64 / 2.0).to_le_bytes().to_vec();
    let name = format!("n{k}");
    bytes.extend((name.len() as u32).to_le_bytes());
    bytes.extend(name.as_bytes());
    bytes.extend((k as u32).to_le_bytes());
    (0..k).for_each(|j| bytes.extend((j as f32).to_le_bytes()));
    bytes
}

/// The values of the k-th message.
pub fn values(k: usize) -> [Value; 3] {
    [(k as f64 / 2.0).into(), Value::Str(format!("n{k}")), Value::Nums((0..k).map(|j| j as f64).collect())]
}

pub fn wanted() -> [Wanted; 1] {
    [Wanted { topic: "/a".into(), fields: ["x", "name", "ranges"].map(|p| p.parse().unwrap()).to_vec() }]
}

/// An MCAP file of two topics, `/a` and `/b`, a few messages to a chunk.
pub fn mcap(compression: Option<mcap::Compression>, chunks: bool) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(compression).use_chunks(chunks).chunk_size(Some(200));
    let mut writer = options.create(&mut file).unwrap();
    let schema = writer.add_schema("p/msg/T", "ros2msg", DEFINITION.as_bytes()).unwrap();
    let channels = ["/a", "/b"].map(|topic| writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap());
    for k in 0..COUNT {
        for (j, channel_id) in channels.into_iter().enumerate() {
            let time = (1000 * k + j) as u64;
            let header =
                mcap::records::MessageHeader { channel_id, sequence: k as u32, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, &cdr(k)).unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

/// A rosbag2 database of the topic `/a`, in small pages.
pub fn db3(path: &Path) {
    long_db3(path, COUNT);
}

/// The same with so many messages.
pub fn long_db3(path: &Path, count: usize) {
    let db = rusqlite::Connection::open(path).unwrap();
    db.execute_batch(
        "PRAGMA page_size = 512; PRAGMA journal_mode = OFF;
         CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
         CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT, encoding TEXT, encoded_message_definition TEXT);
         INSERT INTO topics VALUES (7, '/a', 'p/msg/T', 'cdr', '');",
    )
    .unwrap();
    db.execute("INSERT INTO message_definitions VALUES (1, 'p/msg/T', 'ros2msg', ?1)", [DEFINITION]).unwrap();
    db.execute_batch("BEGIN").unwrap();
    for k in 0..count {
        db.execute("INSERT INTO messages VALUES (NULL, 7, ?1, ?2)", rusqlite::params![1000 * k as i64, cdr(k)])
            .unwrap();
    }
    db.execute_batch("COMMIT").unwrap();
}

/// A record of a ROS 1 bag.
pub fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut header = Vec::new();
    for (name, value) in fields {
        header.extend((name.len() as u32 + 1 + value.len() as u32).to_le_bytes());
        header.extend(name.as_bytes());
        header.push(b'=');
        header.extend(*value);
    }
    let mut record = (header.len() as u32).to_le_bytes().to_vec();
    record.extend(header);
    record.extend((data.len() as u32).to_le_bytes());
    record.extend(data);
    record
}

fn connection() -> Vec<u8> {
    let fields: &[(&str, &[u8])] =
        &[("topic", b"/a"), ("type", b"p/T"), ("md5sum", b"*"), ("message_definition", DEFINITION.as_bytes())];
    let about = record(fields, b"");
    let length = u32::from_le_bytes([about[0], about[1], about[2], about[3]]) as usize;
    record(&[("op", &[7]), ("conn", &0u32.to_le_bytes()), ("topic", b"/a")], &about[4..4 + length])
}

/// A ROS 1 bag of the topic `/a` in two chunks, closed or as it is while it is recorded.
pub fn bag(closed: bool) -> Vec<u8> {
    let mut bag = b"#ROSBAG V2.0\n".to_vec();
    let head = |index: u64| {
        record(&[("op", &[3]), ("index_pos", &index.to_le_bytes()), ("conn_count", &[1, 0, 0, 0])], &[b' '; 50])
    };
    bag.extend(head(0));
    let mut infos = Vec::new();
    for half in [0..COUNT / 2, COUNT / 2..COUNT] {
        let mut chunk = if half.start == 0 { connection() } else { Vec::new() };
        infos.push(record(&[("op", &[6])], &[0u32.to_le_bytes(), (half.len() as u32).to_le_bytes()].concat()));
        for k in half {
            let time = [0u32.to_le_bytes(), (1000 * k as u32).to_le_bytes()].concat();
            chunk.extend(record(&[("op", &[2]), ("conn", &0u32.to_le_bytes()), ("time", &time)], &ros1(k)));
        }
        bag.extend(record(
            &[("op", &[5]), ("compression", b"none"), ("size", &(chunk.len() as u32).to_le_bytes())],
            &chunk,
        ));
    }
    if closed {
        let index = bag.len() as u64;
        bag.splice(13..13 + head(0).len(), head(index));
        bag.extend(connection());
        infos.into_iter().for_each(|info| bag.extend(info));
    }
    bag
}

/// What came of reading a recording.
pub struct Outcome {
    /// Time, topic and values of each message.
    pub messages: Vec<(i64, String, Option<Vec<Value>>)>,
    pub losses: Vec<Loss>,
}

/// Reads a recording to its end.
pub fn read(path: &Path, options: Options) -> Result<Outcome, OpenError> {
    let mut reader = open(path, options)?.read(&wanted());
    let mut messages = Vec::new();
    while let Some(item) = reader.next() {
        if let Item::Message { time, wanted, topic, values } = item.unwrap() {
            messages.push((time.0, topic.to_owned(), wanted.map(|_| values.to_vec())));
        }
    }
    Ok(Outcome { messages, losses: reader.losses().to_vec() })
}
