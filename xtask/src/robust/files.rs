//! Recordings of every format, message definitions and messages, from bytes that nobody has checked.

use std::io::{self, Write};

use lapwing_record::{
    Decoder, Dialect, Item, Library, Limits, MessageType, Options, Part, Path, TimeSource, Wanted, open,
};
use lapwing_stream::{Duration, Name, Schema, Type};
use tempfile::NamedTempFile;

/// At most so many fields are asked for, and so many items read.
const FIELDS: usize = 24;
const ITEMS: usize = 100_000;

/// An MCAP file.
pub fn mcap(data: &[u8]) {
    recording(b"\x89MCAP0\r\n", data);
}

/// A ROS 1 bag.
pub fn bag(data: &[u8]) {
    recording(b"#ROSBAG V2.0\n", data);
}

/// The database of a rosbag2.
pub fn db3(data: &[u8]) {
    recording(b"SQLite format 3\0", data);
}

/// A table.
pub fn csv(data: &[u8]) {
    recording(b"time", data);
}

/// Lines of JSON.
pub fn ndjson(data: &[u8]) {
    recording(b"{", data);
}

/// How a hostile file is read: it may not ask for much.
fn options(by_header: bool) -> Options {
    let limits = Limits {
        chunk: 1 << 20,
        record: 1 << 20,
        file: 1 << 22,
        elements: 1 << 12,
        line: 1 << 16,
        names: 1 << 8,
        held: 64,
        losses: 16,
    };
    let time = if by_header { TimeSource::Header } else { TimeSource::Log };
    Options { time, reorder: Duration::from_nanos(1_000_000), limits, ..Options::default() }
}

/// How a file is read: all its bytes decide, so that every way is tried.
#[derive(Clone, Copy)]
struct Choice(u8);

impl Choice {
    fn of(bytes: &[u8]) -> Choice {
        Choice(bytes.iter().fold(0, |all, byte| all.rotate_left(1) ^ byte))
    }

    fn is(self, bit: u32) -> bool {
        self.0 >> bit & 1 == 1
    }
}

/// Reads topics of a file that begins with `magic`, whatever the data begins with: all of them, or every other one, which leaves the rest
/// to the index; rows with all their values, or with those that are named.
fn recording(magic: &[u8], data: &[u8]) {
    let mut bytes = magic.to_vec();
    bytes.extend(data.get(magic.len()..).unwrap_or_default());
    let file = temporary(&bytes).expect("a temporary file can be written");
    let choice = Choice::of(&bytes);
    let options = options(choice.is(0));
    let most = options.limits.losses + 1;
    let Ok(recording) = open(file.path(), options) else { return };
    // A whole message of Protobuf cannot be had: what asks for it would decode nothing.
    let whole = usize::from(choice.is(1));
    let topics = recording.topics().iter().skip(usize::from(choice.is(2))).step_by(1 + usize::from(choice.is(2)));
    let wanted: Vec<Wanted> = topics
        .map(|t| Wanted { topic: t.name.clone(), fields: paths(t.schema.as_deref().ok()).split_off(whole) })
        .collect();
    let signals: Vec<Name> =
        recording.columns().iter().step_by(2).chain(recording.columns().first()).cloned().collect();
    let mut reader = if choice.is(3) { recording.read_signals(&wanted, &signals) } else { recording.read(&wanted) };
    for _ in 0..ITEMS {
        match reader.next() {
            Some(Ok(Item::Message { wanted: Some(topic), values, .. })) => {
                assert_eq!(values.len(), wanted[topic].fields.len())
            }
            Some(Ok(Item::Row { cells, .. })) if choice.is(3) => assert_eq!(cells.names(), signals),
            Some(Ok(_)) => {}
            Some(Err(_)) | None => break,
        }
    }
    assert!(reader.losses().len() <= most, "{} losses are listed", reader.losses().len());
    reader.losses().iter().for_each(|loss| assert!(!loss.to_string().is_empty()));
}

fn temporary(bytes: &[u8]) -> io::Result<NamedTempFile> {
    let mut file = NamedTempFile::new()?;
    file.write_all(bytes)?;
    Ok(file)
}

/// The dialect in a byte, a definition, a zero, a message: laid out, and decoded twice with the same decoder.
pub fn definition(data: &[u8]) {
    let Some((&choice, rest)) = data.split_first() else { return };
    let cut = rest.iter().position(|&b| b == 0).unwrap_or(rest.len());
    let (text, message) = (String::from_utf8_lossy(&rest[..cut]), rest.get(cut + 1..).unwrap_or_default());
    let layout = |dialect| Library::default().layout(dialect, "p/T", &text).ok();
    let ty = match choice % 4 {
        0 => layout(Dialect::Ros1).map(MessageType::Ros1),
        1 => layout(Dialect::Ros2).map(MessageType::Cdr),
        2 => layout(Dialect::Idl).map(MessageType::Cdr),
        _ => Some(MessageType::Json(layout(Dialect::Ros2).map(|l| l.schema().clone()))),
    };
    let Some(ty) = ty else { return };
    let Ok(mut decoder) = Decoder::new(&ty, &paths(ty.schema().map(|s| &**s)), 1 << 12) else { return };
    let mut values = decoder.slots();
    if decoder.decode(message, &mut values).is_ok() {
        let once = format!("{values:?}");
        decoder.decode(message, &mut values).expect("what could be decoded can be decoded again");
        assert_eq!(format!("{values:?}"), once, "a decoder remembers");
    }
}

/// The whole message, and what is in it.
fn paths(schema: Option<&Schema>) -> Vec<Path> {
    let mut all = vec![Path::new([])];
    match schema {
        Some(schema) => inside(schema, &[], &mut all),
        None => all.extend(["x", "a.b", "a[0].b", "header.stamp.secs"].map(|p| p.parse().expect("a path"))),
    }
    all
}

fn inside(schema: &Schema, before: &[Part], all: &mut Vec<Path>) {
    for field in &schema.fields {
        if all.len() >= FIELDS || before.len() > 4 {
            return;
        }
        let mut path = before.to_vec();
        path.push(Part::Name(field.name.clone()));
        all.push(Path::new(path.clone()));
        let mut ty = &field.ty;
        while let Type::Array(of) = ty {
            path.push(Part::Index(1));
            all.push(Path::new(path.clone()));
            ty = of;
        }
        if let Type::Message(of) = ty {
            inside(of, &path, all);
        }
    }
}
