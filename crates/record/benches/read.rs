//! How fast recordings are read, against the `mcap` crate's bare reading of the same file in the same run.
//!
//! `cargo bench -p lapwing-record` prints ratios; absolute figures are those of the machine. A word after `--` chooses workloads by name.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::Path;
use std::time::Instant;

use lapwing_record::{Item, Options, Reader, TimeSource, Wanted, open};
use lapwing_stream::Name;
use mcap::Compression;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader};

/// Runs per figure; the fastest counts.
const RUNS: usize = 5;

const ODOMETRY: &str = "std_msgs/Header header\nstring child_frame_id\nfloat64[7] pose\nfloat64[36] pose_covariance\nfloat64[6] twist\n\
                        float64[36] twist_covariance\n===\nMSG: std_msgs/Header\nint32 sec\nuint32 nanosec\nstring frame_id\n";
const SCAN: &str = "std_msgs/Header header\nfloat32[7] about\nfloat32[] ranges\nfloat32[] intensities\n===\nMSG: std_msgs/Header\nint32 sec\n\
                    uint32 nanosec\nstring frame_id\n";
const TWIST: &str = "float64[6] v\n";
const CLOUD: &str =
    "std_msgs/Header header\nuint8[] data\n===\nMSG: std_msgs/Header\nint32 sec\nuint32 nanosec\nstring frame_id\n";

/// The header of a CDR message: its encoding, a stamp, and a frame.
fn header(k: u32) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend([k.to_le_bytes(), [0; 4], 5u32.to_le_bytes()].concat());
    bytes.extend(b"odom\0");
    bytes
}

fn align(bytes: &mut Vec<u8>, to: usize) {
    bytes.resize((bytes.len() - 4).next_multiple_of(to) + 4, 0);
}

fn odometry(k: u32) -> Vec<u8> {
    let mut bytes = header(k);
    align(&mut bytes, 4);
    bytes.extend(10u32.to_le_bytes());
    bytes.extend(b"base_link\0");
    align(&mut bytes, 8);
    (0..85).for_each(|j| bytes.extend(f64::from(j + k % 1000).to_le_bytes()));
    bytes
}

fn scan(k: u32) -> Vec<u8> {
    let mut bytes = header(k);
    align(&mut bytes, 4);
    bytes.extend([0; 28]);
    for _ in 0..2 {
        bytes.extend(360u32.to_le_bytes());
        (0..360).for_each(|j| bytes.extend(((j * k % 91) as f32).to_le_bytes()));
    }
    bytes
}

fn twist(k: u32) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    (0..6).for_each(|j| bytes.extend(f64::from(j + k).to_le_bytes()));
    bytes
}

fn cloud(k: u32, size: usize) -> Vec<u8> {
    let mut bytes = header(k);
    align(&mut bytes, 4);
    bytes.extend((size as u32).to_le_bytes());
    let mut state = u64::from(k) + 1;
    bytes.extend((0..size).map(|j| {
        if j % 4 == 0 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        }
        (state >> 40) as u8
    }));
    bytes
}

/// Seconds of a robot: three topics at 50 Hz and a point cloud at 10 Hz.
fn write(path: &Path, compression: Option<Compression>, seconds: u32, cloud_size: usize) {
    let mut writer =
        mcap::WriteOptions::new().compression(compression).create(BufWriter::new(File::create(path).unwrap())).unwrap();
    let mut channel = |topic: &str, text: &str| {
        let schema = writer.add_schema(&format!("w{topic}"), "ros2msg", text.as_bytes()).unwrap();
        writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap()
    };
    let [odom, cmd, laser, points] =
        [("/odom", ODOMETRY), ("/cmd_vel", TWIST), ("/scan", SCAN), ("/points", CLOUD)].map(|(t, d)| channel(t, d));
    for k in 0..seconds * 50 {
        let mut put = |channel_id, data: &[u8]| {
            let time = u64::from(k) * 20_000_000;
            let header = mcap::records::MessageHeader { channel_id, sequence: k, log_time: time, publish_time: time };
            writer.write_to_known_channel(&header, data).unwrap();
        };
        put(odom, &odometry(k));
        put(cmd, &twist(k));
        put(laser, &scan(k));
        if cloud_size > 0 && k % 5 == 0 {
            put(points, &cloud(k, cloud_size));
        }
    }
    writer.finish().unwrap();
}

/// The fastest of some runs, in seconds.
fn best(mut run: impl FnMut() -> u64) -> (f64, u64) {
    let mut result = 0;
    let times = (0..RUNS).map(|_| {
        let start = Instant::now();
        result = run();
        start.elapsed().as_secs_f64()
    });
    (times.fold(f64::INFINITY, f64::min), result)
}

/// The `mcap` crate's reader with nothing done to the messages but counting them.
fn bare(path: &Path) -> u64 {
    let mut file = File::open(path).unwrap();
    let mut reader = LinearReader::new();
    let mut count = 0;
    while let Some(event) = reader.next_event() {
        match event.unwrap() {
            LinearReadEvent::ReadRequest(need) => {
                let read = file.read(reader.insert(need)).unwrap();
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode: mcap::records::op::MESSAGE, .. } => count += 1,
            LinearReadEvent::Record { .. } => {}
        }
    }
    count
}

fn want(topic: &str, field: &str) -> Wanted {
    Wanted { topic: topic.into(), fields: vec![field.parse().unwrap()] }
}

fn ours(path: &Path, wanted: &[Wanted], time: TimeSource) -> u64 {
    count(open(path, Options { time, ..Options::default() }).unwrap().read(wanted))
}

fn count(mut reader: Reader) -> u64 {
    let mut count = 0;
    while let Some(item) = reader.next() {
        count += u64::from(matches!(item.unwrap(), Item::Message { .. } | Item::Row { .. }));
    }
    assert!(reader.losses().is_empty(), "{:?}", reader.losses());
    count
}

fn recordings(dir: &Path, chosen: &dyn Fn(&str) -> bool) {
    let three = [want("/odom", "pose[0]"), want("/cmd_vel", "v[0]"), want("/scan", "about[5]")];
    let arrays = [want("/odom", "pose"), want("/cmd_vel", "v"), want("/scan", "ranges")];
    for (name, compression) in [("plain", None), ("lz4", Some(Compression::Lz4)), ("zstd", Some(Compression::Zstd))] {
        for (load, seconds, cloud) in [("small messages", 1500, 0), ("with point clouds", 6, 10 << 20)] {
            let title = format!("MCAP {name}, {load}");
            if !chosen(&title) {
                continue;
            }
            let path = dir.join("w.mcap");
            write(&path, compression, seconds, cloud);
            let size = std::fs::metadata(&path).unwrap().len() as f64 / 1e6;
            let (base, count) = best(|| bare(&path));
            println!("{title}: {size:.0} MB, {count} messages; mcap crate {:.0} MB/s", size / base);
            for (what, wanted, time) in [
                ("times only", &[][..], TimeSource::Log),
                ("three fields", &three, TimeSource::Log),
                ("three fields by header", &three, TimeSource::Header),
                ("three arrays", &arrays, TimeSource::Log),
            ] {
                let (taken, found) = best(|| ours(&path, wanted, time));
                assert_eq!(found, count);
                println!(
                    "    {what:24} {:6.0} MB/s, {:4.0} % of bare, {:5.0} ns a message",
                    size / taken,
                    100.0 * base / taken,
                    taken / count as f64 * 1e9
                );
            }
        }
    }
}

fn texts(dir: &Path, chosen: &dyn Fn(&str) -> bool) {
    let rows = 1_000_000;
    let path = dir.join("w.csv");
    for (title, head, signals, row) in [
        (
            "CSV, W1",
            "time,p,q,r,s",
            ["p", "q", "r", "s"],
            (|k| format!("{k},true,false,{},true", k % 3 == 0)) as fn(u32) -> String,
        ),
        ("CSV, W2", "time,x,y,vx,vy,wz,min_laser,scan,speed", ["vx", "min_laser", "scan", "speed"], |k| {
            let x = f64::from(k % 977) / 7.0;
            format!(
                "{}.{:03},{x:.4},{:.4},{:.3},0,{:.3},{:.3},{},{:.3}",
                k / 1000,
                k % 1000,
                -x,
                x / 3.0,
                x / 9.0,
                x,
                k % 50,
                x / 2.0
            )
        }),
        ("NDJSON, W1", "", ["p", "q", "r", "s"], |k| {
            format!("{{\"t\":{k},\"values\":{{\"p\":true,\"q\":false,\"r\":{},\"s\":true}}}}", k % 3 == 0)
        }),
    ] {
        if !chosen(title) {
            continue;
        }
        let mut file = BufWriter::new(File::create(&path).unwrap());
        if !head.is_empty() {
            writeln!(file, "{head}").unwrap();
        }
        (0..rows).for_each(|k| writeln!(file, "{}", row(k)).unwrap());
        file.flush().unwrap();
        let recording = || open(&path, Options::default()).unwrap();
        for (what, signals) in
            [("all values", None), ("four signals", Some(signals)), ("times only", Some(["none"; 4]))]
        {
            let (taken, rows) = best(|| match signals {
                Some(names) => count(recording().read_signals(&[], &names.map(Name::from))),
                None => count(recording().read(&[])),
            });
            println!("{title}, {what:13} {:4.0} ns a row", taken / rows as f64 * 1e9);
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let chosen = |title: &str| words.is_empty() || words.iter().any(|w| title.contains(w.as_str()));
    let dir = tempfile::tempdir().unwrap();
    recordings(dir.path(), &chosen);
    texts(dir.path(), &chosen);
}
