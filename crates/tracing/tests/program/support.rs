//! Processes of their own, a clock that counts, and the comparison with `lapwing check`.

use std::io::Write;
use std::process::Command;
use std::sync::atomic::{AtomicI64, Ordering};

use lapwing::{Options, Session};
use lapwing_react::{Format, Property, Style, render};
use lapwing_tracing::{Builder, Clock, Monitor, Report, Spec, Time};

/// A test that runs in a process of its own: a subscriber for the whole program can be set only once in each.
macro_rules! alone {
    ($(fn $name:ident() $body:block)*) => {$(
        #[test]
        fn $name() {
            crate::support::in_a_process(concat!(module_path!(), "::", stringify!($name)), || $body);
        }
    )*};
}
pub(crate) use alone;

const MARK: &str = "LAPWING_TEST_ALONE";

pub fn in_a_process(path: &str, test: impl FnOnce()) {
    let name = path.split_once("::").map_or(path, |(_, name)| name);
    if std::env::var(MARK).as_deref() == Ok(name) {
        return test();
    }
    let program = std::env::current_exe().expect("the test has a path");
    let mut child = Command::new(program);
    let output = child.args([name, "--exact", "--nocapture"]).env(MARK, name).output().expect("a process");
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

/// Shows 0 s, then 1 s, then 2 s: each arrival has the second of its number.
#[derive(Default)]
pub struct Counting(AtomicI64);

impl Clock for Counting {
    fn now(&self) -> Time {
        Time(self.0.fetch_add(1, Ordering::SeqCst) * 1_000_000_000)
    }
}

pub fn spec(text: &str) -> Spec {
    Spec::parse("robot.rv", text, &|_| None).expect("a specification without errors")
}

/// A monitor in the making whose clock counts.
pub fn counting(text: &str) -> Builder {
    Monitor::builder(spec(text)).clock(Counting::default())
}

/// The whole program watched by a specification.
pub fn watched(text: &str) -> Monitor {
    counting(text).install().expect("a monitor")
}

/// What is said of a property, or an instance of it.
pub fn said<'r>(report: &'r Report, name: &str) -> &'r Property {
    report.properties.iter().find(|p| p.name == name).expect("the property is in the report")
}

pub fn verdict(report: &Report, name: &str) -> &'static str {
    said(report, name).verdict.word()
}

pub fn cause<'r>(report: &'r Report, name: &str) -> &'r str {
    said(report, name).cause.as_deref().unwrap_or("")
}

/// The report says what `lapwing check` says of these lines, where the events of call sites are events by their names.
pub fn same_as_checked(report: &Report, text: &str, lines: &str) {
    assert_eq!(properties(report), properties(&checked(&by_name(text), lines)));
}

/// What `lapwing check` says of these lines.
pub fn checked(text: &str, lines: &str) -> Report {
    let mut file = tempfile::Builder::new().suffix(".ndjson").tempfile().expect("a file");
    file.write_all(lines.as_bytes()).expect("the lines are written");
    let specs = [spec(text)];
    Session::open(&specs, file.path(), &Options::default()).expect("a recording").run(&mut ())
}

/// `event play = call Kicker::play` as `event play`: what is recorded has happened already.
fn by_name(text: &str) -> String {
    let plain = |line: &str| match line.split_once(" = ") {
        Some((event, _)) if line.starts_with("event ") => event.to_owned(),
        _ => line.to_owned(),
    };
    text.lines().map(|line| plain(line) + "\n").collect()
}

/// What is said of the properties, as JSON.
pub fn properties(report: &Report) -> String {
    let json = render(report, Format::Json, Style::Plain);
    let (_, properties) = json.split_once("\"properties\":").expect("properties");
    properties.split_once(",\"warnings\":").expect("warnings").0.to_owned()
}
