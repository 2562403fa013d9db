//! What the index of an MCAP file says nobody wants is not decompressed; times, counts and order stay as they are, and an index that
//! lies is found out.

mod make;

use std::collections::BTreeMap;

use lapwing_record::{Loss, Options};
use make::{COUNT, cdr};
use mcap::Compression;
use mcap::records::ChunkIndex;

/// A message that makes its chunk worth a look into the index, and does not compress.
const LARGE: usize = 3 << 20;

/// An MCAP file: chunks of `/a` alone, chunks of `/b` alone, and one in which a large message of `/b` comes last.
fn recording(compression: Compression) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(Some(compression)).chunk_size(None);
    let mut writer = options.create(&mut file).unwrap();
    let schema = writer.add_schema("p/msg/T", "ros2msg", make::DEFINITION.as_bytes()).unwrap();
    let [a, b] = ["/a", "/b"].map(|topic| writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap());
    let mut put = |k: usize, channel_id: u16, data: &[u8], ends: bool| {
        let time = 1000 * k as u64;
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, data).unwrap();
        if ends {
            writer.flush().unwrap();
        }
    };
    (0..6).for_each(|k| put(k, a, &cdr(k), k == 5));
    (6..10).for_each(|k| put(k, b, b"not even CDR", k % 2 == 1));
    (10..13).for_each(|k| put(k, a, &cdr(k - 4), false));
    put(13, b, &noise(), true);
    (14..17).for_each(|k| put(k, a, &cdr(k - 5), k == 16));
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}

fn noise() -> Vec<u8> {
    let mut state = 1u64;
    let mut byte = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    (0..LARGE).map(|_| byte()).collect()
}

fn chunks(file: &[u8]) -> Vec<ChunkIndex> {
    mcap::Summary::read(file).unwrap().unwrap().chunk_indexes
}

/// Times and topics of all messages.
type Messages = Vec<(i64, String)>;

/// Times and topics, the values of `/a`, and the losses.
fn read(file: &[u8]) -> (Messages, Vec<Option<f64>>, Vec<Loss>) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.mcap");
    std::fs::write(&path, file).unwrap();
    let outcome = make::read(&path, Options::default()).unwrap();
    let x = |values: &Vec<lapwing_stream::Value>| match values[0] {
        lapwing_stream::Value::Num(x) => Some(x),
        _ => None,
    };
    let wanted = outcome.messages.iter().filter(|(_, topic, _)| topic == "/a");
    let values = wanted.map(|(_, _, values)| values.as_ref().and_then(x)).collect();
    (outcome.messages.into_iter().map(|(time, topic, _)| (time, topic)).collect(), values, outcome.losses)
}

fn expected() -> (Messages, Vec<Option<f64>>) {
    let is_b = |k: &i64| (6..10).contains(k) || *k == 13;
    let messages = (0..17).map(|k| (1000 * k, if is_b(&k) { "/b" } else { "/a" }.to_owned())).collect();
    (messages, (0..COUNT).map(|k| Some(k as f64 / 2.0)).collect())
}

/// Spoils bytes of the compressed data of a chunk, those from `from` on.
fn spoil(file: &mut [u8], chunk: &ChunkIndex, from: usize) {
    let end = (chunk.chunk_start_offset + chunk.chunk_length) as usize;
    file[end - chunk.compressed_size as usize + from..end].fill(0xff);
}

#[test]
fn what_nobody_wants_is_not_decompressed() {
    for compression in [Compression::Lz4, Compression::Zstd] {
        let mut file = recording(compression);
        let chunks = chunks(&file);
        assert_eq!(chunks.len(), 5);
        let (messages, values, losses) = read(&file);
        assert_eq!((messages, values), expected());
        assert!(losses.is_empty(), "{losses:?}");
        // The two chunks of `/b`, and of the mixed one what stands behind the messages of `/a`.
        spoil(&mut file, &chunks[1], 0);
        spoil(&mut file, &chunks[2], 0);
        spoil(&mut file, &chunks[3], 2 << 20);
        let (messages, values, losses) = read(&file);
        assert_eq!((messages, values), expected());
        assert!(losses.is_empty(), "{losses:?}");
        // A chunk with wanted messages is another matter.
        spoil(&mut file, &chunks[0], 0);
        let (messages, _, losses) = read(&file);
        assert_eq!(messages, expected().0[6..]);
        assert_eq!(losses.len(), 1, "{losses:?}");
    }
}

/// The place of the records of that code.
fn places(file: &[u8], code: u8) -> Vec<usize> {
    let mut at = 8;
    let mut found = Vec::new();
    while let Some(head) = file.get(at..at + 9) {
        if head[0] == code {
            found.push(at);
        }
        at += 9 + u64::from_le_bytes(head[1..].try_into().unwrap()) as usize;
    }
    found
}

const MESSAGE_INDEX: u8 = 7;
const CHUNK_INDEX: u8 = 8;

#[test]
fn an_index_that_hides_a_wanted_channel_is_found_out() {
    let mut file = recording(Compression::Zstd);
    let b = chunks(&file)[1].message_index_offsets.keys().next().unwrap().to_le_bytes();
    // The first chunk says, in both places, that its messages are of `/b`.
    let (summary, behind) = (places(&file, CHUNK_INDEX)[0] + 9 + 36, places(&file, MESSAGE_INDEX)[0] + 9);
    file[summary..summary + 2].copy_from_slice(&b);
    file[behind..behind + 2].copy_from_slice(&b);
    let (messages, _, losses) = read(&file);
    assert_eq!(messages.len(), 17);
    assert_eq!(losses.len(), 1, "{losses:?}");
    assert_eq!(losses[0].topic.as_deref(), Some("/a"));
    assert!(losses[0].what.contains("12 messages, and 6 were found"), "{losses:?}");
}

#[test]
fn an_index_that_does_not_fit_its_chunk_is_not_believed() {
    let file = recording(Compression::Lz4);
    let index = places(&file, MESSAGE_INDEX);
    // The time of a message, its offset, the channel, and the record as a whole: the chunks of `/b` are then read themselves.
    for (at, byte) in [(15, 0xff), (23, 0xff), (9, 0xee), (0, 0x7f)] {
        let mut file = file.clone();
        file[index[1] + at] = byte;
        file[index[1] + at + 1] |= if at == 23 { 0xff } else { 0 };
        let (messages, values, losses) = read(&file);
        assert_eq!((messages, values), expected(), "byte {at} of the index");
        assert!(losses.is_empty(), "{losses:?}");
    }
}
