//! The quick ways through rows and lines give what the general ones give: the same values to the bit, the same losses.

use std::io::{self, Cursor, Read};
use std::path::Path;

use lapwing_stream::{Name, Value};

use super::csv::Csv;
use super::lines::Lines;
use super::ndjson::Ndjson;
use super::{Head, Source};
use crate::definition::Library;
use crate::error::Losses;
use crate::options::Limits;

/// Gives one byte at a time, as a slow pipe does: no row is ever there as a whole when it is looked for, so that none goes the quick way.
struct Drip(Cursor<Vec<u8>>);

impl Read for Drip {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let one = into.len().min(1);
        self.0.read(&mut into[..one])
    }
}

/// A small generator of numbers: the same ones on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }

    fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }

    /// A number as programs write it, or a text that looks like one.
    fn number(&mut self) -> String {
        let mut text = format!("{}", self.0 >> self.below(64));
        if self.below(2) == 0 {
            text.insert(self.below(text.len() + 1), '.');
        }
        let before = self.pick(&["", "", "", "-", "+", "--", "00"]);
        let after = self.pick(&["", "", "", "", "", "e-5", "E3", ".", "x", "e", "-"]);
        format!("{before}{text}{after}")
    }
}

/// A value to the bit.
fn shown(value: &Value) -> String {
    match value {
        Value::Num(x) => format!("{x} {:x}", x.to_bits()),
        other => format!("{other:?}"),
    }
}

/// All that comes out, one line each, and then what was lost.
fn read(source: &mut dyn Source, signals: &[&str]) -> Vec<String> {
    let mut losses = Losses::new(10_000);
    let mut all = Vec::new();
    source.choose(&signals.iter().map(|s| Name::from(*s)).collect::<Vec<_>>());
    while let Some((time, head)) = source.advance(&mut losses).unwrap() {
        let cells: String = source.cells().iter().map(|(name, value)| format!(" {name}={}", shown(value))).collect();
        all.push(match head {
            Head::Message(channel) => {
                let topic = source.channels()[channel].topic.clone();
                format!("{} {topic} {}", time.0, String::from_utf8_lossy(source.payload().unwrap()))
            }
            Head::Row => format!("{} row{cells}", time.0),
            Head::Event => format!("{} {}{cells}", time.0, source.event()),
        });
    }
    all.extend(losses.list().iter().map(ToString::to_string));
    all
}

fn lines(from: Box<dyn Read + Send>) -> Lines {
    Lines::new(from, Path::new("x"), 0, 1 << 20)
}

/// Reads a text in both ways; gives what came out, and how many rows it were.
fn both<S: Source>(text: &str, signals: &[&str], open: impl Fn(Lines) -> S) -> Vec<String> {
    let at_once = read(&mut open(lines(Box::new(Cursor::new(text.as_bytes().to_vec())))), signals);
    let slowly = read(&mut open(lines(Box::new(Drip(Cursor::new(text.as_bytes().to_vec()))))), signals);
    for (quick, general) in at_once.iter().zip(&slowly) {
        assert_eq!(quick, general, "in\n{text}");
    }
    assert_eq!(at_once.len(), slowly.len(), "in\n{text}");
    at_once
}

const CELLS: &[&str] = &[
    "",
    "",
    "true",
    "false",
    "0",
    "1",
    "-0",
    "nan",
    "inf",
    "-Infinity",
    "truex",
    "tru",
    "True",
    "NaN",
    " 1.5",
    "2 ",
    " true ",
    "a text",
    "\"quoted\"",
    "\"a, \"\"b\"\"\"",
    "\"open",
    "a\"b",
    "\"\"",
    "\"1\"",
    " \"x\"",
    "é",
    "1e5",
    "1.2e-05",
    "12:30:45",
    "0x10",
    "-",
    ".",
    ".5",
    "5.",
    "1\r",
    "\t7",
    "9007199254740993",
    "123456789012345678901234567890",
];
const TIMES: &[&str] =
    &["1", "2.5", "1727000000.123456789", "\"3\"", " 4", "5 ", "1e3", "", "soon", "-7.25", "0.0000000015"];

#[test]
fn rows_are_read_alike_in_both_ways() {
    let mut random = Random(7);
    let mut rows = 0;
    for round in 0..400 {
        let mut text = "a,time,b,c\n".to_owned();
        for row in 0..30 {
            let count = if random.below(12) == 0 { random.below(7) } else { 4 };
            for column in 0..count {
                text.push_str(if column > 0 { "," } else { "" });
                match (column, random.below(3)) {
                    (1, 0) => text.push_str(random.pick(TIMES)),
                    (1, _) => text.push_str(&format!("{row}.{}", random.below(1000))),
                    (_, 0) => text.push_str(&random.number()),
                    _ => text.push_str(random.pick(CELLS)),
                }
            }
            text.push_str(if round % 3 == 0 { "\r\n" } else { random.pick(&["\n", "\n", "\n", "\n\n", " \n"]) });
        }
        let signals = random_signals(&mut random, &["a", "b", "c", "none", "a"]);
        let open = |lines| Csv::open(lines, &Limits::default()).unwrap();
        rows += both(&text, &signals, open).iter().filter(|line| line.contains(" row")).count();
    }
    assert!(rows > 5000, "{rows} rows");
}

/// Some of the names, some of them twice.
fn random_signals<'n>(random: &mut Random, names: &[&'n str]) -> Vec<&'n str> {
    (0..random.below(names.len() + 1)).map(|_| random.pick(names)).collect()
}

const JSON: &[&str] = &[
    "true",
    "false",
    "null",
    "0",
    "-0",
    "1.5",
    "-2e3",
    "\"text\"",
    "\"\"",
    "\"a\\nb\"",
    "\"\\u00e9\"",
    "\"\\x\"",
    "\"é,}\"",
    "[1,2]",
    "{\"x\":1}",
    "NaN",
    "-Infinity",
    "tru",
    "truee",
    "01",
    "+1",
    "1.",
    ".5",
    "",
    "\"open",
    "[1,",
    "nul",
    "9007199254740993",
    "1-2",
];
const KEYS: &[&str] = &["p", "q", "r", "s.t", "p", "\\u0070"];

/// A line of values: mostly plain, with the members in their order.
fn line(random: &mut Random) -> String {
    let is_odd = random.below(8) == 0;
    let value = |random: &mut Random| match (is_odd, random.below(4)) {
        (true, _) => random.pick(JSON).to_owned(),
        (_, 0) => random.number(),
        (_, 1) => random.pick(&["true", "false", "null", "\"word\""]).to_owned(),
        _ => format!("{}.{}", random.below(100), random.below(100)),
    };
    let keys: Vec<&str> = if is_odd { (0..4).map(|_| random.pick(KEYS)).collect() } else { vec!["p", "q", "s.t"] };
    let members: Vec<String> = keys.iter().map(|key| format!("\"{key}\":{}", value(random))).collect();
    let blank = if is_odd { random.pick(&["", " ", "\t"]) } else { "" };
    let time = if is_odd { random.pick(TIMES).to_owned() } else { format!("{}.5", random.below(100)) };
    let members = members.join(&format!(",{blank}"));
    match random.below(if is_odd { 8 } else { 1 }) {
        0 | 1 => format!("{{\"t\":{blank}{time},\"values\":{{{members}}}}}"),
        2 => format!("{{\"values\":{{{members}}},\"t_ns\":{time}}}"),
        3 => format!("{{\"t\":{time},\"topic\":\"/a\",\"msg\":{{{members}}}}}"),
        4 => format!("{{\"t\":{time},\"event\":\"kick\",{members}}}"),
        5 => format!("{{\"t\":{time},\"more\":[1],\"values\":{{{members}}}}}"),
        6 => format!("{{\"t\":{time},\"values\":{{{members}}}"),
        _ => format!(" {{\"t\":{time},\"values\":{{}}}} x"),
    }
}

#[test]
fn lines_are_read_alike_in_both_ways() {
    let mut random = Random(11);
    let mut rows = 0;
    for round in 0..400 {
        let end = if round % 3 == 0 { "\r\n" } else { "\n" };
        let text: String = (0..30).map(|_| line(&mut random) + end).collect();
        let signals = random_signals(&mut random, &["p", "q", "r", "s.t", "none"]);
        let open = |lines| Ndjson::new(lines, &Library::default(), &Limits::default());
        rows += both(&text, &signals, open).iter().filter(|line| line.contains(" row")).count();
    }
    assert!(rows > 5000, "{rows} rows");
}

#[test]
fn only_the_first_of_two_values_of_one_name_counts() {
    let text = "{\"t\":1,\"values\":{\"p\":1,\"p\":2}}\n".repeat(3);
    let open = |lines| Ndjson::new(lines, &Library::default(), &Limits::default());
    let one = format!("1000000000 row p={}", shown(&Value::Num(1.0)));
    assert_eq!(both(&text, &["p"], open), [one.clone(), one.clone(), one]);
}
