//! What each format gives, from files made here.

mod make;

use lapwing_record::{Cells, Format, Item, Options, Recording, TimeSource, Wanted, open};
use lapwing_stream::{Duration, Type, Value};

fn recording(text: &[u8], options: Options) -> (tempfile::TempDir, Recording) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x");
    std::fs::write(&path, text).unwrap();
    let recording = open(&path, options).unwrap();
    (dir, recording)
}

/// One line per item, and the losses.
fn shown(recording: Recording, wanted: &[Wanted]) -> (Vec<String>, Vec<String>) {
    let mut reader = recording.read(wanted);
    let mut lines = Vec::new();
    let cells = |cells: Cells<'_>| cells.iter().map(|(n, v)| format!(" {n}={}", short(v))).collect::<String>();
    while let Some(item) = reader.next() {
        lines.push(match item.unwrap() {
            Item::Message { time, wanted, topic, values } => {
                let values: String = values.iter().map(|v| format!(" {}", short(v))).collect();
                format!("{} {topic} {}{values}", time.0, wanted.map_or("-".into(), |k| k.to_string()))
            }
            Item::Row { time, cells: c } => format!("{} row{}", time.0, cells(c)),
            Item::Event { time, name, fields } => format!("{} event {name}{}", time.0, cells(fields)),
        });
    }
    (lines, reader.losses().iter().map(ToString::to_string).collect())
}

fn short(value: &Value) -> String {
    match value {
        Value::Missing => "·".into(),
        Value::Bool(b) => b.to_string(),
        Value::Num(x) => x.to_string(),
        Value::Str(s) => format!("{s:?}"),
        Value::Nums(n) => format!("{n:?}"),
        Value::List(l) => format!("[{}]", l.iter().map(short).collect::<Vec<_>>().join(" ")),
        Value::Record(r) => {
            format!("{{{}}}", r.iter().map(|(n, v)| format!("{n}:{}", short(v))).collect::<Vec<_>>().join(" "))
        }
    }
}

fn want(topic: &str, fields: &[&str]) -> Wanted {
    Wanted { topic: topic.into(), fields: fields.iter().map(|f| f.parse().unwrap()).collect() }
}

#[test]
fn csv_rows() {
    let text = "\u{feff}robot.x, time ,on,name\r\n1.5,0.1,true,plain\r\n\r\n,2e-1,false,\"a, \"\"b\"\"\"\n-inf,0.3,NaN,\"1\"\n";
    let (_dir, recording) = recording(text.as_bytes(), Options::default());
    assert_eq!(recording.format(), Format::Csv);
    assert!(recording.is_schemaless() && recording.topics().is_empty());
    assert_eq!(recording.columns().iter().map(|c| &**c).collect::<Vec<_>>(), ["robot.x", "on", "name"]);
    let (rows, losses) = shown(recording, &[]);
    assert_eq!(
        rows,
        [
            "100000000 row robot.x=1.5 on=true name=\"plain\"",
            "200000000 row robot.x=· on=false name=\"a, \\\"b\\\"\"",
            "300000000 row robot.x=-inf on=NaN name=\"1\"",
        ]
    );
    assert!(losses.is_empty());
}

#[test]
fn csv_rows_may_end_in_carriage_returns_alone() {
    let text = "\u{feff}time,x\r0.1,1\r\rsoon,2\r0.3,a\r";
    let (_dir, recording) = recording(text.as_bytes(), Options::default());
    assert_eq!(recording.columns().iter().map(|c| &**c).collect::<Vec<_>>(), ["x"]);
    let (rows, losses) = shown(recording, &[]);
    assert_eq!(rows, ["100000000 row x=1", "300000000 row x=\"a\""]);
    assert!(losses[0].contains("line 4, column 1: the time `soon`") && losses.len() == 1, "{losses:?}");
}

#[test]
fn a_carriage_return_in_json_is_a_blank() {
    let (_dir, recording) = recording(b"{\"t\": 1,\r\"values\": {\"x\": 2}}\n", Options::default());
    assert_eq!(shown(recording, &[]), (vec!["1000000000 row x=2".to_owned()], vec![]));
}

#[test]
fn wrong_csv_rows_are_losses_with_their_place() {
    let text = "time_ns,x\n5,1\nsoon,2\n7\n8,1,2\n9,\"open\n10,3\n";
    let (_dir, recording) = recording(text.as_bytes(), Options::default());
    let (rows, losses) = shown(recording, &[]);
    assert_eq!(rows, ["5 row x=1", "10 row x=3"]);
    let ends: Vec<&str> = losses.iter().map(|l| l.split_once("/x, ").unwrap().1).collect();
    assert_eq!(
        ends,
        [
            "line 3, column 1: the time `soon` is no decimal number: it is lost",
            "line 4: the row has 1 cells where the header has 2: it is lost",
            "line 5: the row has more cells where the header has 2: it is lost",
            "line 6, column 3: a quote is not closed in its line: it is lost",
        ]
    );
}

#[test]
fn a_time_under_another_name_or_in_another_unit_is_told() {
    let said = |text: &str| {
        let (_dir, recording) = recording(text.as_bytes(), Options::default());
        shown(recording, &[]).1[0].split_once("line ").unwrap().1.to_owned()
    };
    let name = "Name it \"t\" if it is in seconds, \"t_ns\" if in nanoseconds";
    for key in ["time", "time_ns", "timestamp", "stamp", "ts"] {
        let line = format!("{{\"{key}\": 0, \"topic\": \"/odom\", \"speed\": 1}}\n");
        assert_eq!(
            said(&line),
            format!("1: the line is lost: the object has no time: is its \"{key}\" the time? {name}")
        );
    }
    let without = "1: the line is lost: the object has no time: write \"t\" in seconds or \"t_ns\"";
    assert_eq!(said("{\"speed\": 1, \"msg\": {\"time\": 1}}\n"), without);
    assert!(said("{\"t\": 0, \"topic\": \"/odom\", \"speed\": 1}\n").contains("\"topic\" but no \"msg\""));
    let lost = "is too large for seconds (name it `time_ns` if it is in nanoseconds): it is lost";
    assert_eq!(said("time,x\n1700000000000000000,1\n"), format!("2, column 1: the time `1700000000000000000` {lost}"));
    assert!(
        said("{\"t\": 1700000000000000000, \"values\": {}}\n").ends_with("name it `t_ns` if it is in nanoseconds)")
    );
    assert!(said("{\"t\": 1700000000000, \"values\": {}}\n").contains("seems to be in milliseconds"));
}

#[test]
fn what_is_no_time_is_shown() {
    let long = format!(r#""{}""#, "a".repeat(100));
    let no_times = [r#""1""#, "null", "[1, 2]", "1.2.3", "soon", "", &long];
    let lines: String = no_times.iter().map(|time| format!("{{\"t\":{time},\"values\":{{\"x\":1}}}}\n")).collect();
    let text = format!("{{\"t\":0,\"values\":{{\"x\":1}}}}\n{lines}");
    let (_dir, recording) = recording(text.as_bytes(), Options::default());
    let (rows, losses) = shown(recording, &[]);
    assert_eq!(rows, ["0 row x=1"]);
    let said: Vec<&str> = losses.iter().map(|l| l.split_once(", line ").unwrap().1).collect();
    let cut = format!("8: the line is lost: the time `\"{}…` is no decimal number", "a".repeat(39));
    assert_eq!(
        said,
        [
            "2: the line is lost: the time `\"1\"` is no decimal number",
            "3: the line is lost: the time `null` is no decimal number",
            "4: the line is lost: the time `[1, 2]` is no decimal number",
            "5: the line is lost: the time `1.2.3` is no decimal number",
            "6: the line is lost: no JSON at byte 6 of it: a value was expected",
            "7: the line is lost: no JSON at byte 6 of it: a value was expected",
            &cut,
        ]
    );
}

#[test]
fn ndjson_lines_of_every_kind() {
    let text = r#"
{"t":1.000000001,"values":{"x":1.5,"on":true,"s":"a","none":null}}
{"t_ns":1500000000,"event":"kick","robot":"r1","force":2}
{"topic":"/odom","type":"nav_msgs/msg/Odometry","msg":{"pose":{"pose":{"position":{"x":3}}}},"t":2}
{"t":3,"topic":"/free","msg":{"a":[{"b":1},{"b":2}],"secs":4}}
{"t":4,"topic":"/other","msg":1}
{"t":5,"values":{"x":2}}
not json
{"values":{"x":2}}
{"t":6}
"#;
    let (_dir, recording) = recording(text.as_bytes(), Options::default());
    assert_eq!(recording.format(), Format::Ndjson);
    let topics: Vec<_> =
        recording.topics().iter().map(|t| (t.name.as_str(), t.type_name.as_str(), t.schema.is_ok())).collect();
    assert_eq!(topics, [("/odom", "nav_msgs/Odometry", true), ("/free", "", false), ("/other", "", false)]);
    let wanted = [want("odom", &["pose.pose.position.x", "child_frame_id"]), want("/free", &["a", "a[1].b", "sec"])];
    let (items, losses) = shown(recording, &wanted);
    assert_eq!(
        items,
        [
            "1000000001 row x=1.5 on=true s=\"a\" none=·",
            "1500000000 event kick robot=\"r1\" force=2",
            "2000000000 /odom 0 3 ·",
            "3000000000 /free 1 [{b:1} {b:2}] 2 4",
            "4000000000 /other -",
            "5000000000 row x=2",
        ]
    );
    assert_eq!(losses.len(), 3);
    assert!(losses[0].contains("line 8") && losses[1].contains("\"t\"") && losses[2].contains("neither"), "{losses:?}");
}

#[test]
fn unwanted_topics_give_their_times() {
    let (_dir, recording) = recording(&make::mcap(Some(mcap::Compression::Lz4), true), Options::default());
    assert_eq!(recording.format(), Format::Mcap);
    let topic = &recording.topics()[1];
    assert_eq!(
        (topic.name.as_str(), topic.type_name.as_str(), topic.messages),
        ("/b", "p/T", Some(make::COUNT as u64))
    );
    assert_eq!(topic.schema.as_ref().unwrap().field("x").unwrap().ty, Type::Num { float: true });
    let (items, losses) = shown(recording, &[want("/a", &["x", "ranges[1]"])]);
    assert_eq!(items[..4], ["0 /a 0 0 ·", "1 /b -", "1000 /a 0 0.5 ·", "1001 /b -"]);
    assert_eq!(items[6], "3000 /a 0 1.5 1");
    assert!(losses.is_empty());
}

#[test]
fn a_field_that_the_type_lacks_is_a_loss_of_the_topic() {
    let (_dir, recording) = recording(&make::mcap(None, false), Options::default());
    let (items, losses) = shown(recording, &[want("/a", &["y"]), want("/b", &["name", "x"])]);
    assert_eq!(items[..2], ["0 /a -", "1 /b 1 \"n0\" 0"]);
    assert_eq!(losses.len(), 1);
    assert!(
        losses[0].contains("p/T has no field `y`; it has x, name, ranges") && losses[0].ends_with("(topic /a)"),
        "{losses:?}"
    );
}

/// Lines with a header stamp each, logged at 10, 11, 12… seconds.
fn stamped(stamps: &[i64]) -> Vec<u8> {
    let line = |(k, stamp): (usize, &i64)| {
        format!(
            "{{\"t\":{},\"topic\":\"/a\",\"msg\":{{\"k\":{k},\"header\":{{\"stamp\":{{\"sec\":{stamp},\"nanosec\":0}}}}}}}}\n",
            10 + k
        )
    };
    stamps.iter().enumerate().map(line).collect::<String>().into_bytes()
}

fn in_order(stamps: &[i64], window: i64) -> Vec<(i64, f64)> {
    let options = Options {
        time: TimeSource::Header,
        reorder: Duration::from_nanos(window * 1_000_000_000),
        ..Options::default()
    };
    let (_dir, recording) = recording(&stamped(stamps), options);
    let mut reader = recording.read(&[want("/a", &["k"])]);
    let mut got = Vec::new();
    while let Some(item) = reader.next() {
        let Item::Message { time, values: [Value::Num(k)], .. } = item.unwrap() else { panic!() };
        got.push((time.0 / 1_000_000_000, *k));
    }
    got
}

#[test]
fn header_time_sorts_within_the_window_and_passes_jumps_on() {
    assert_eq!(in_order(&[5, 4, 6, 3, 9], 3), [(3, 3.0), (4, 1.0), (5, 0.0), (6, 2.0), (9, 4.0)]);
    assert_eq!(in_order(&[50, 49, 7, 8], 3), [(49, 1.0), (50, 0.0), (7, 2.0), (8, 3.0)]);
    assert_eq!(in_order(&[9, 0, 11], 3), [(9, 0.0), (11, 1.0), (11, 2.0)], "a zero stamp counts at its log time");
}

#[test]
fn log_time_keeps_the_order_of_the_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.db3");
    make::db3(&path);
    let db = rusqlite::Connection::open(&path).unwrap();
    db.execute("UPDATE messages SET timestamp = 3 WHERE id = 5", []).unwrap();
    drop(db);
    let outcome = make::read(&path, Options::default()).unwrap();
    assert_eq!(outcome.messages.iter().map(|m| m.0).take(6).collect::<Vec<_>>(), [0, 1000, 2000, 3000, 3, 5000]);
}

#[test]
fn standard_input_is_read_as_it_grows() {
    use std::io::{BufRead, BufReader, Write};
    use std::process::{Command, Stdio};

    // This test runs itself with standard input as a pipe: the inner run prints each item when it comes.
    if std::env::args().any(|a| a == "--nocapture") && std::env::var_os("LAPWING_INNER").is_some() {
        let mut reader = open(std::path::Path::new("-"), Options::default()).unwrap().read(&[]);
        while let Some(item) = reader.next() {
            println!("\ngot {}", item.unwrap().time().0);
        }
        return;
    }
    let mut inner = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "standard_input_is_read_as_it_grows", "--nocapture"])
        .env("LAPWING_INNER", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut to = inner.stdin.take().unwrap();
    let mut from = BufReader::new(inner.stdout.take().unwrap()).lines();
    for k in 1..4 {
        writeln!(to, "{{\"t_ns\":{k},\"values\":{{\"x\":1}}}}").unwrap();
        to.flush().unwrap();
        let answer = from.find(|line| line.as_ref().unwrap().starts_with("got")).unwrap().unwrap();
        assert_eq!(answer, format!("got {k}"));
    }
    drop(to);
    assert!(inner.wait().unwrap().success());
}
