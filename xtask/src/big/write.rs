//! Recordings of any length, written as they go: a small topic that is read, and a large one that is not.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// What the recordings are checked against: it reads the small topic, or the column, and all of it holds.
pub const SPEC: &str = "decl x /small Sample.x\n\
                        never x > 2\n\
                        whenever x < 0.4, always for 100 ms x < 0.9\n\
                        whenever x > 0.5, once within 2 s x < 0.5\n";

/// The definition of the messages: a number, and bytes that nobody reads.
const DEFINITION: &str = "float64 x\nuint8[] data\n";
/// The bytes of a large message.
const LARGE: usize = 200_000;
/// So many small messages come before each large one.
const SMALL_ONES: u64 = 10;
/// The time from one message to the next, in nanoseconds.
const PERIOD: u64 = 10_000_000;
/// The bytes of a chunk, about.
const CHUNK: usize = 1 << 20;

/// A format in which big recordings are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// MCAP with chunks in lz4.
    Mcap,
    /// The database of a rosbag2.
    Db3,
    /// A ROS 1 bag with plain chunks.
    Bag,
    /// A table.
    Csv,
    /// Lines of values.
    Ndjson,
}

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 5] = [Kind::Mcap, Kind::Db3, Kind::Bag, Kind::Csv, Kind::Ndjson];

    /// What the names of such files end with.
    pub fn ending(self) -> &'static str {
        match self {
            Kind::Mcap => "mcap",
            Kind::Db3 => "db3",
            Kind::Bag => "bag",
            Kind::Csv => "csv",
            Kind::Ndjson => "ndjson",
        }
    }

    /// Writes a recording of about so many bytes, before compression.
    pub fn write(self, path: &Path, bytes: u64) -> io::Result<()> {
        match self {
            Kind::Mcap => mcap(path, bytes),
            Kind::Db3 => db3(path, bytes),
            Kind::Bag => bag(path, bytes),
            Kind::Csv => rows(path, bytes, "time,x,y,on\n", |time, x, on| format!("{time},{x},{},{on}\n", x * 3.0)),
            Kind::Ndjson => rows(path, bytes, "", |time, x, on| {
                format!("{{\"t\":{time},\"values\":{{\"x\":{x},\"y\":{},\"on\":{on}}}}}\n", x * 3.0)
            }),
        }
    }
}

/// The value of the small topic in its k-th message.
fn x(k: u64) -> f64 {
    (k % 100) as f64 / 100.0
}

/// What is written one after the other: the time, the number of the topic, the value, and the bytes.
fn messages(bytes: u64) -> impl Iterator<Item = (u64, usize, f64, Vec<u8>)> {
    let each = LARGE as u64 + SMALL_ONES * 100;
    (0..bytes.div_ceil(each) * (SMALL_ONES + 1)).map(|k| {
        let is_large = k % (SMALL_ONES + 1) == SMALL_ONES;
        let data = if is_large { (0..LARGE).map(|j| (j as u64 * k >> 5) as u8).collect() } else { vec![7; 40] };
        (k * PERIOD, usize::from(is_large), x(k), data)
    })
}

const TOPICS: [&str; 2] = ["/small", "/large"];

/// A message in CDR.
fn cdr(x: f64, data: &[u8]) -> Vec<u8> {
    [&[0, 1, 0, 0], &*packed(x, data)].concat()
}

/// A message as ROS 1 has it.
fn packed(x: f64, data: &[u8]) -> Vec<u8> {
    [&x.to_le_bytes()[..], &(data.len() as u32).to_le_bytes(), data].concat()
}

fn mcap(path: &Path, bytes: u64) -> io::Result<()> {
    let options = mcap::WriteOptions::new().compression(Some(mcap::Compression::Lz4)).chunk_size(Some(CHUNK as u64));
    let mut writer = options.create(BufWriter::new(File::create(path)?)).map_err(io::Error::other)?;
    let schema = writer.add_schema("big/msg/Sample", "ros2msg", DEFINITION.as_bytes()).map_err(io::Error::other)?;
    let mut channels = Vec::new();
    for topic in TOPICS {
        channels.push(writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).map_err(io::Error::other)?);
    }
    for (time, topic, x, data) in messages(bytes) {
        let header = mcap::records::MessageHeader {
            channel_id: channels[topic],
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        writer.write_to_known_channel(&header, &cdr(x, &data)).map_err(io::Error::other)?;
    }
    writer.finish().map(drop).map_err(io::Error::other)
}

fn db3(path: &Path, bytes: u64) -> io::Result<()> {
    let error = io::Error::other::<rusqlite::Error>;
    let db = rusqlite::Connection::open(path).map_err(error)?;
    db.execute_batch(
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;
         CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
         CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
         CREATE TABLE message_definitions(
             id INTEGER PRIMARY KEY, topic_type TEXT, encoding TEXT, encoded_message_definition TEXT);
         INSERT INTO topics VALUES (0, '/small', 'big/msg/Sample', 'cdr'), (1, '/large', 'big/msg/Sample', 'cdr');",
    )
    .map_err(error)?;
    let definition = "INSERT INTO message_definitions VALUES (1, 'big/msg/Sample', 'ros2msg', ?1)";
    db.execute(definition, [DEFINITION]).map_err(error)?;
    db.execute_batch("BEGIN").map_err(error)?;
    let mut insert = db.prepare("INSERT INTO messages VALUES (NULL, ?1, ?2, ?3)").map_err(error)?;
    for (time, topic, x, data) in messages(bytes) {
        insert.execute(rusqlite::params![topic as i64, time as i64, cdr(x, &data)]).map_err(error)?;
    }
    drop(insert);
    db.execute_batch("COMMIT").map_err(error)
}

fn bag(path: &Path, bytes: u64) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    file.write_all(b"#ROSBAG V2.0\n")?;
    let count = TOPICS.len() as u32;
    let head = |index: u64| {
        record(&[("op", &[3]), ("index_pos", &index.to_le_bytes()), ("conn_count", &count.to_le_bytes())], &[b' '; 50])
    };
    file.write_all(&head(0))?;
    let connections: Vec<u8> = (0..count).flat_map(connection).collect();
    let mut chunk = connections.clone();
    let mut chunks = 0u32;
    let mut length = 13 + head(0).len() as u64;
    let mut put = |chunk: &mut Vec<u8>, file: &mut BufWriter<File>| {
        let size = (chunk.len() as u32).to_le_bytes();
        let whole = record(&[("op", &[5]), ("compression", b"none"), ("size", &size)], chunk);
        chunk.clear();
        chunks += 1;
        length += whole.len() as u64;
        file.write_all(&whole)
    };
    for (time, topic, x, data) in messages(bytes) {
        let stamp = [(time / 1_000_000_000) as u32, (time % 1_000_000_000) as u32].map(u32::to_le_bytes).concat();
        let header: &[(&str, &[u8])] = &[("op", &[2]), ("conn", &(topic as u32).to_le_bytes()), ("time", &stamp)];
        chunk.extend(record(header, &packed(x, &data)));
        if chunk.len() >= CHUNK {
            put(&mut chunk, &mut file)?;
        }
    }
    put(&mut chunk, &mut file)?;
    file.write_all(&connections)?;
    // A closed bag says where its connections stand, and has a record for each of its chunks.
    (0..chunks).try_for_each(|_| file.write_all(&record(&[("op", &[6])], &[])))?;
    let mut file = file.into_inner()?;
    io::Seek::seek(&mut file, io::SeekFrom::Start(13))?;
    file.write_all(&head(length))
}

fn connection(number: u32) -> Vec<u8> {
    let topic = TOPICS[number as usize].as_bytes();
    let about: &[(&str, &[u8])] =
        &[("topic", topic), ("type", b"big/Sample"), ("md5sum", b"*"), ("message_definition", DEFINITION.as_bytes())];
    record(&[("op", &[7]), ("conn", &number.to_le_bytes()), ("topic", topic)], &fields(about))
}

/// A record of a ROS 1 bag: a counted header, and counted data.
fn record(header: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let header = fields(header);
    let lengths = [header.len() as u32, data.len() as u32].map(u32::to_le_bytes);
    [&lengths[0][..], &header, &lengths[1], data].concat()
}

fn fields(all: &[(&str, &[u8])]) -> Vec<u8> {
    let field = |(name, value): &(&str, &[u8])| {
        let length = (name.len() + 1 + value.len()) as u32;
        [&length.to_le_bytes()[..], name.as_bytes(), b"=", value].concat()
    };
    all.iter().flat_map(field).collect()
}

/// Rows, each made of a time in seconds, the value, and a truth value.
fn rows(path: &Path, bytes: u64, head: &str, row: impl Fn(&str, f64, bool) -> String) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    file.write_all(head.as_bytes())?;
    let (mut written, mut k) = (0, 0);
    while written < bytes {
        let time = format!("{}.{:02}", k / 100, k % 100);
        let row = row(&time, x(k), k % 2 == 0);
        file.write_all(row.as_bytes())?;
        written += row.len() as u64;
        k += 1;
    }
    file.flush()
}
