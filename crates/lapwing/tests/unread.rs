//! Messages that no property reads: their time counts, whatever else is saved on them.

use std::path::Path;

use lapwing::{Options, Report, Session, Spec, Watch};
use lapwing_react::Event;
use lapwing_record::{Library, MessageType, Messages, Recording};
use lapwing_stream::{Time, Verdict};

/// Whenever /go says so, /done does within a second.
const SPEC: &str = "decl go /go Bool.data\ndecl done /done Bool.data\nwhenever go, eventually within 1 s done\n";
const TOPICS: [&str; 3] = ["/go", "/done", "/noise"];
const MS: i64 = 1_000_000;

/// Messages of [`TOPICS`], by milliseconds: those of /go say yes, those of /done no.
struct Script {
    rest: std::vec::IntoIter<(i64, usize)>,
    topic: usize,
}

impl Messages for Script {
    fn advance(&mut self) -> Option<(Time, usize)> {
        let (at, topic) = self.rest.next()?;
        self.topic = topic;
        Some((Time(at * MS), topic))
    }

    fn payload(&mut self) -> &[u8] {
        // A boolean in CDR.
        if self.topic == 0 { &[0, 1, 0, 0, 1] } else { &[0, 1, 0, 0, 0] }
    }

    fn progress(&self) -> (u64, u64) {
        (0, 0)
    }
}

/// Counts what it is asked and told, and stops after so many questions.
#[derive(Default)]
struct Counting {
    asked: usize,
    progress: usize,
    violations: Vec<Time>,
    stop_after: Option<usize>,
}

impl Watch for Counting {
    fn event(&mut self, event: Event<'_>) {
        if let Event::Violation { violation, .. } = event {
            self.violations.push(violation.failed);
        }
    }

    fn progress(&mut self, _read: u64, _of: u64) {
        self.progress += 1;
    }

    fn goes_on(&mut self) -> bool {
        self.asked += 1;
        self.stop_after.is_none_or(|most| self.asked <= most)
    }
}

fn check(messages: Vec<(i64, usize)>, watch: &mut Counting, options: &Options) -> Report {
    let specs = [Spec::parse("unread.rv", SPEC, &|_| None).unwrap()];
    let layout = Library::default().installed("std_msgs/msg/Bool").unwrap();
    let topics = TOPICS.map(|topic| (topic.to_owned(), MessageType::Cdr(layout.clone()))).to_vec();
    let script = Box::new(Script { rest: messages.into_iter(), topic: 0 });
    let recording = Recording::of(Path::new("script"), topics, script, Default::default());
    Session::over(&specs, recording, Path::new("script"), options).run(watch)
}

/// Noise every ten milliseconds, in milliseconds from one time to another.
fn noise(from: i64, to: i64) -> impl Iterator<Item = (i64, usize)> {
    (from..=to).step_by(10).map(|at| (at, 2))
}

#[test]
fn a_deadline_passes_among_them() {
    let messages = noise(0, 100).chain([(105, 1), (107, 0)]).chain(noise(110, 9000)).collect();
    let mut watch = Counting::default();
    let report = check(messages, &mut watch, &Options::default());
    assert_eq!((report.properties[0].verdict, watch.violations), (Verdict::Violated, vec![Time(1107 * MS)]));
    assert_eq!(report.span, Some((Time(0), Time(9000 * MS))), "the first and the last are noise");
}

#[test]
fn they_do_not_go_on_after_the_first_violation() {
    let messages = [(5, 1), (7, 0)].into_iter().chain(noise(10, 9000)).collect();
    let options = Options { until_first_violation: true, ..Options::default() };
    let report = check(messages, &mut Counting::default(), &options);
    let (_, end) = report.span.unwrap();
    assert!((1007 * MS..=1020 * MS).contains(&end.0), "{end}");
}

#[test]
fn without_them_it_is_open_what_comes() {
    let report = check(vec![(5, 1), (7, 0), (907, 2)], &mut Counting::default(), &Options::default());
    assert_eq!(report.properties[0].verdict, Verdict::Holds);
}

#[test]
fn time_that_jumps_back_among_them_is_told() {
    let messages = noise(0, 5000).chain([(5005, 1)]).chain(noise(5010, 6000)).chain(noise(100, 200)).collect();
    let report = check(messages, &mut Counting::default(), &Options::default());
    assert!(
        report.warnings.iter().any(|w| w.message.contains("time jumped back from 6 s to 0.1 s")),
        "{:?}",
        report.warnings
    );
}

#[test]
fn whoever_looks_on_is_asked_and_told_all_the_same() {
    let mut watch = Counting::default();
    check(noise(0, 100_000).collect(), &mut watch, &Options::default());
    assert!(watch.asked >= 10_000, "{}", watch.asked);
    assert!((30..=50).contains(&watch.progress), "{} of 10,001 items", watch.progress);
    let mut watch = Counting { stop_after: Some(500), ..Counting::default() };
    let report = check(noise(0, 100_000).collect(), &mut watch, &Options::default());
    let (_, end) = report.span.unwrap();
    assert!(end.0 < 6000 * MS, "it stops soon: {end}");
    assert!(report.gaps.iter().any(|gap| gap.contains("interrupted")), "{:?}", report.gaps);
}
