//! Files that are cut off, damaged or made to do harm: never a panic, never much memory, never a silent loss.

mod make;

use std::path::Path;

use lapwing_record::{Limits, OpenError, Options};
use make::{COUNT, Outcome, read};

/// Whether all messages of the topic `/a` came out unharmed.
fn complete(outcome: &Outcome) -> bool {
    let mut got = outcome.messages.iter().filter(|(_, topic, _)| topic == "/a");
    (0..COUNT).all(|k| {
        got.next()
            .is_some_and(|(time, _, values)| *time == 1000 * k as i64 && *values == Some(make::values(k).to_vec()))
    })
}

/// Reads a file cut off at every byte.
fn cut_everywhere(bytes: &[u8], name: &str) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    let mut most = 0;
    for end in 0..bytes.len() {
        std::fs::write(&path, &bytes[..end]).unwrap();
        let Ok(outcome) = read(&path, Options::default()) else { continue };
        assert!(
            !outcome.losses.is_empty() || complete(&outcome),
            "{name}: cut off at byte {end}, messages are lost without a word"
        );
        // Whatever stood before the cut comes before the loss, so that nothing seems to be lost between messages.
        let last = outcome.messages.last().map(|(time, ..)| *time);
        let cut = outcome.losses.iter().find(|loss| loss.what.contains("was cut off here"));
        assert!(
            cut.is_none_or(|loss| loss.after.map(|t| t.0) == last),
            "{name}: cut off at byte {end}: {cut:?}, {last:?}"
        );
        let got = outcome.messages.len();
        assert!(got >= most, "{name}: cut off at byte {end}, {got} messages are found where {most} were before");
        most = got;
    }
    std::fs::write(&path, bytes).unwrap();
    let outcome = read(&path, Options::default()).unwrap();
    assert!(complete(&outcome) && outcome.losses.is_empty(), "{name}: {:?}", outcome.losses);
    assert!(most + 2 >= outcome.messages.len(), "{name}: at most {most} messages");
}

#[test]
fn an_mcap_file_may_end_anywhere() {
    cut_everywhere(&make::mcap(None, true), "a.mcap");
    cut_everywhere(&make::mcap(None, false), "a.mcap");
    cut_everywhere(&make::mcap(Some(mcap::Compression::Zstd), true), "a.mcap");
    cut_everywhere(&make::mcap(Some(mcap::Compression::Lz4), true), "a.mcap");
}

#[test]
fn a_bag_may_end_anywhere() {
    cut_everywhere(&make::bag(true), "a.bag");
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("open.bag");
    std::fs::write(&path, make::bag(false)).unwrap();
    let outcome = read(&path, Options::default()).unwrap();
    assert!(complete(&outcome));
    assert!(outcome.losses[0].what.contains("never closed"), "{:?}", outcome.losses);
}

#[test]
fn a_database_may_end_anywhere() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.db3");
    make::db3(&path);
    let bytes = std::fs::read(&path).unwrap();
    for end in 0..bytes.len() {
        std::fs::write(&path, &bytes[..end]).unwrap();
        if let Ok(outcome) = read(&path, Options::default()) {
            assert!(
                !outcome.losses.is_empty() || complete(&outcome),
                "cut off at byte {end}, messages are lost without a word"
            );
        }
    }
    std::fs::write(&path, &bytes).unwrap();
    let outcome = read(&path, Options::default()).unwrap();
    assert!(complete(&outcome) && outcome.losses.is_empty());
}

#[test]
fn of_a_database_without_its_end_the_rest_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.db3");
    make::long_db3(&path, 2000);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let outcome = read(&path, Options::default()).unwrap();
    let got = outcome.messages.len();
    assert!((500..1500).contains(&got), "{got} messages: {:?}", outcome.losses);
    let last = outcome.messages.last().map(|(time, ..)| *time);
    assert_eq!(last, Some(1000 * (got as i64 - 1)), "those before the cut come in their order");
    let [broken, cut] = &outcome.losses[..] else { panic!("{:?}", outcome.losses) };
    assert!(broken.what.contains("cannot be read") && broken.what.contains(".recover"), "{broken}");
    assert!(cut.what.contains("was cut off here"), "{cut}");
    assert!(outcome.losses.iter().all(|loss| loss.after.map(|t| t.0) == last), "{:?}", outcome.losses);
    // So little is left that not even the tables are known.
    std::fs::write(&path, &bytes[..600]).unwrap();
    let error = read(&path, Options::default()).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("`sqlite3 ") && error.contains("a.db3 .recover"), "{error}");
    assert!(error.contains(&format!("only 600 of its {} bytes", bytes.len())), "{error}");
}

/// A small generator of numbers: the same ones on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }
}

#[test]
fn flipped_bytes_never_panic() {
    let dir = tempfile::tempdir().unwrap();
    let db3 = dir.path().join("made.db3");
    make::db3(&db3);
    let files = [
        make::mcap(None, true),
        make::mcap(None, false),
        make::mcap(Some(mcap::Compression::Zstd), true),
        make::mcap(Some(mcap::Compression::Lz4), true),
        make::bag(true),
        std::fs::read(&db3).unwrap(),
        b"time,x,name\n0.1,1.5,\"a,\"\"b\"\n0.2,true,\n".to_vec(),
        br#"{"t":1.5,"topic":"/a","msg":{"x":1,"name":"n\u00e9","ranges":[1,null]}}"#.to_vec(),
    ];
    let limits = Limits { chunk: 1 << 20, record: 1 << 20, ..Limits::default() };
    let mut random = Random(42);
    let path = dir.path().join("flipped");
    for bytes in files {
        for _ in 0..600 {
            let mut flipped = bytes.clone();
            for _ in 0..=random.below(4) {
                let at = random.below(flipped.len());
                flipped[at] = random.below(256) as u8;
            }
            std::fs::write(&path, &flipped).unwrap();
            let _ = read(&path, Options { limits: limits.clone(), ..Options::default() });
        }
    }
}

/// An MCAP file of one chunk.
fn with_chunk(size: u64, compression: &str, data: &[u8]) -> Vec<u8> {
    let mut chunk = [0u64.to_le_bytes(), 0u64.to_le_bytes(), size.to_le_bytes()].concat();
    chunk.extend([0; 4]);
    chunk.extend((compression.len() as u32).to_le_bytes());
    chunk.extend(compression.as_bytes());
    chunk.extend((data.len() as u64).to_le_bytes());
    chunk.extend(data);
    let mut file = b"\x89MCAP0\r\n\x06".to_vec();
    file.extend((chunk.len() as u64).to_le_bytes());
    file.extend(chunk);
    file.push(0x0f);
    file.extend(4u64.to_le_bytes());
    file.extend([0; 4]);
    file
}

fn losses(bytes: &[u8], limits: Limits) -> String {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    std::fs::write(&path, bytes).unwrap();
    let outcome = read(&path, Options { limits, ..Options::default() }).unwrap();
    outcome.losses.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_chunk_cannot_grow_beyond_its_limit() {
    let bomb = zstd::bulk::compress(&vec![0; 50_000_000], 19).unwrap();
    assert!(bomb.len() < 10_000);
    let honest = losses(&with_chunk(50_000_000, "zstd", &bomb), Limits { chunk: 1 << 20, ..Limits::default() });
    assert!(honest.contains("a.mcap, byte 8") && honest.contains("Limits::chunk"), "{honest}");
    let lying = losses(&with_chunk(1000, "zstd", &bomb), Limits::default());
    assert!(lying.contains("the messages of a chunk are lost"), "{lying}");
    let enormous = losses(&with_chunk(u64::MAX, "zstd", &bomb), Limits::default());
    assert!(enormous.contains("Limits::chunk"), "{enormous}");
    let unknown = losses(&with_chunk(10, "brotli", &bomb), Limits::default());
    assert!(unknown.contains("`brotli`"), "{unknown}");
}

#[test]
fn a_damaged_chunk_costs_only_itself() {
    let mut bytes = make::mcap(Some(mcap::Compression::Zstd), true);
    let whole = make::COUNT * 2;
    let at = bytes.windows(4).position(|w| w == b"\x28\xb5\x2f\xfd").unwrap();
    bytes[at + 20] ^= 0xff;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    std::fs::write(&path, &bytes).unwrap();
    let outcome = read(&path, Options::default()).unwrap();
    assert_eq!(outcome.losses.len(), 1, "{:?}", outcome.losses);
    assert!(outcome.messages.len() > whole / 2 && outcome.messages.len() < whole);
}

#[test]
fn a_large_plain_chunk_is_walked_through() {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().compression(None).chunk_size(Some(3 << 20)).create(&mut file).unwrap();
    let schema = writer.add_schema("p/T", "ros2msg", make::DEFINITION.as_bytes()).unwrap();
    let channels =
        ["/a", "/b"].map(|topic| writer.add_channel(schema, topic, "cdr", &std::collections::BTreeMap::new()).unwrap());
    for k in 0..COUNT {
        for (channel_id, data) in channels.into_iter().zip([make::cdr(k), make::cdr(500_000)]) {
            let time = 1000 * k as u64;
            let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, &data).unwrap();
        }
    }
    writer.finish().unwrap();
    drop(writer);
    let bytes = file.into_inner();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    let get = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read(&path, Options::default()).unwrap()
    };
    let whole = get(&bytes);
    assert!(whole.losses.is_empty(), "{:?}", whole.losses);
    assert_eq!(whole.messages.len(), 2 * COUNT);
    for cut in [bytes.len() / 3, bytes.len() / 2, bytes.len() - 1_000_000] {
        let part = get(&bytes[..cut]);
        assert!(
            part.losses.len() == 1 && part.messages[..] == whole.messages[..part.messages.len()],
            "{:?}",
            part.losses
        );
        assert!(
            part.messages.len() + 2 >= 2 * COUNT * cut / bytes.len(),
            "{} messages in {cut} bytes",
            part.messages.len()
        );
    }
    // The length of the second message of the first chunk lies: the chunk is lost from there on, and the next one is found.
    let mut damaged = bytes.clone();
    let second = bytes
        .windows(9)
        .enumerate()
        .filter(|(_, w)| w[0] == 5 && w[1..] == (data_length() as u64).to_le_bytes())
        .map(|(k, _)| k)
        .next()
        .unwrap();
    damaged[second + 5] = 1;
    let part = get(&damaged);
    assert_eq!(part.losses.len(), 1, "{:?}", part.losses);
    assert!(part.losses[0].what.contains("a chunk is damaged here"), "{:?}", part.losses);
    assert!(part.messages.len() > COUNT);
}

/// The length of the record of a large message.
fn data_length() -> usize {
    make::cdr(500_000).len() + 22
}

/// A bag with one message of that definition and those bytes.
fn bag_of(definition: &str, message: &[u8]) -> Vec<u8> {
    let fields: &[(&str, &[u8])] = &[("topic", b"/a"), ("type", b"p/T"), ("message_definition", definition.as_bytes())];
    let about = make::record(fields, b"");
    let length = u32::from_le_bytes([about[0], about[1], about[2], about[3]]) as usize;
    let mut chunk = make::record(&[("op", &[7]), ("conn", &[0; 4])], &about[4..4 + length]);
    chunk.extend(make::record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &[0; 8])], message));
    let mut bag = b"#ROSBAG V2.0\n".to_vec();
    bag.extend(make::record(&[("op", &[3]), ("index_pos", &[0; 8])], b""));
    bag.extend(make::record(
        &[("op", &[5]), ("compression", b"none"), ("size", &(chunk.len() as u32).to_le_bytes())],
        &chunk,
    ));
    bag
}

fn loss_of(definition: &str, message: &[u8]) -> String {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.bag");
    std::fs::write(&path, bag_of(definition, message)).unwrap();
    let outcome = read(&path, Options::default()).unwrap();
    assert_eq!(outcome.losses[0].topic.as_deref(), Some("/a"));
    outcome.losses[0].what.clone()
}

#[test]
fn messages_cannot_lie_about_their_lengths() {
    let text = "string name\nfloat64 x\nfloat32[] ranges\n";
    assert!(loss_of(text, &u32::MAX.to_le_bytes()).contains("4294967295 bytes are expected at byte 4"));
    let array = "float64 x\nstring name\nfloat32[] ranges\n";
    let bytes = [&[0; 8][..], &[0; 4], &u32::MAX.to_le_bytes()].concat();
    assert!(loss_of(array, &bytes).contains("limit"), "{}", loss_of(array, &bytes));
    let nothings = "float64 x\nstring name\np/E[] ranges\n===\nMSG: p/E\n";
    assert!(loss_of(nothings, &bytes).contains("limit"));
    assert!(loss_of(array, &[0; 17]).contains("1 bytes are left over"));
}

#[test]
fn definitions_that_cannot_be_are_named() {
    let circle = loss_of("float64 x\np/A name\nfloat32[] ranges\n===\nMSG: p/A\np/T back\n", &[]);
    assert!(circle.contains("circle"), "{circle}");
    let unknown = loss_of("float64 x\nother/A name\nfloat32[] ranges\n", &[]);
    assert!(unknown.contains("other/A") && unknown.contains("--msgs"), "{unknown}");
    let without = loss_of("float64 x\nstring name\n", &[]);
    assert!(without.contains("has no field `ranges`; it has x, name"), "{without}");
}

#[test]
fn what_is_no_recording_is_told_what_was_seen() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x");
    let seen = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read(&path, Options::default()).map(|_| ()).unwrap_err().to_string()
    };
    assert!(seen(b"").contains("it is empty"));
    assert!(seen(b"\x7fELF\x02\x01").contains(r"`\x7fELF\x02\x01`"));
    assert!(seen(b"a,b\n1,2\n").contains("`time`"));
    assert!(seen(b"time;b\n1;2\n").contains("not separated by commas"));
    assert!(seen(b"Time,b\n1,2\n").contains("is its column `Time` the time? Name it `time`"));
    assert!(seen(b"time_to_goal,\"timestamp\"\n1,2\n").contains("is its column `timestamp` the time?"));
    assert!(seen(b"time,\"a\n1,2\n").contains("a quote in it is not closed"));
    assert!(seen(b"#ROSBAG V1.2\n").contains("rosbag fix"));
    let wide = |text: &str, order: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(order).collect::<Vec<u8>>();
    for text in ["\u{feff}time,b\n1,2\n", "time,b\r\n1,2\r\n", "\u{feff}{\"t\": 0}\n", "{\"t\": 0}\n"] {
        for order in [u16::to_le_bytes, u16::to_be_bytes] {
            assert!(seen(&wide(text, order)).ends_with("x: it is UTF-16 text; save it as UTF-8"), "{text}");
        }
    }
    let folder = read(Path::new(dir.path()), Options::default()).map(|_| ()).unwrap_err();
    assert!(matches!(folder, OpenError::Unrecognised { .. }));
    assert!(read(&dir.path().join("none"), Options::default()).map(|_| ()).unwrap_err().to_string().contains("none"));
}
