//! Deadlines in silence, timeouts, simulated time, headers.

use lapwing::Options;
use lapwing::TimeSource;
use lapwing::live::{ClockChoice, Ended, LiveOptions};
use lapwing_stream::Verdict;

use crate::script::{Script, at, watch, watch_as};

const ANSWERED: &str = "\
decl asked /asked Float64.data
decl done /done Float64.data
answered: whenever becomes asked > 0, eventually within 1 s done > 0
";

fn wall() -> LiveOptions {
    LiveOptions { clock: ClockChoice::Wall, ..LiveOptions::default() }
}

#[test]
fn a_deadline_fires_though_nothing_comes() {
    let script = Script::of(5.0).offers(0.1, 1, "/asked").offers(0.1, 2, "/done");
    let script = script.says(0.5, 1, 0.0).says(0.5, 2, 0.0).says(2.0, 1, 1.0);
    let over = watch_as(ANSWERED, script, wall());
    let [(when, name)] = over.told.violations.as_slice() else { panic!("{:?}", over.told.violations) };
    assert_eq!(name, "answered");
    assert!((3.0..3.01).contains(when), "told at {when}");
    let violation = &over.outcome.report.properties[0].violations[0];
    assert_eq!((violation.began, violation.failed), (at(2.0), at(3.0)));
    over.agrees();
}

#[test]
fn an_answer_with_the_stamp_of_the_deadline_is_in_time() {
    let script = Script::of(5.0).offers(0.1, 1, "/asked").offers(0.1, 2, "/done");
    let script = script.says(0.5, 1, 0.0).says(0.5, 2, 0.0).says(2.0, 1, 1.0).says(3.0, 2, 1.0);
    let over = watch_as(ANSWERED, script, wall());
    assert_eq!(over.verdict("answered").0, Verdict::Holds);
    over.agrees();
}

#[test]
fn a_run_ends_when_its_time_is_up_counted_from_its_start() {
    let spec = "__timeout__ = 2\ndecl x /x Float64.data\nnever x > 5\n";
    let over = watch_as(spec, Script::of(60.0).offers(0.1, 1, "/x").keeps_saying(1.0, 30.0, 0.5, 1, 1.0), wall());
    assert_eq!(over.outcome.ended, Ended::TimedOut);
    let end = over.outcome.report.span.unwrap().1;
    assert!(at(2.0) <= end && end <= at(2.06), "{end}");
    over.agrees();
}

#[test]
fn it_stops_at_the_first_violation_where_asked() {
    let checking = Options { until_first_violation: true, ..Options::default() };
    let script = Script::of(60.0).offers(0.1, 1, "/x").keeps_saying(1.0, 30.0, 0.5, 1, 9.0);
    let over = watch_as("decl x /x Float64.data\nnever x > 5\n", script, LiveOptions { checking, ..wall() });
    assert_eq!(over.outcome.ended, Ended::AtViolation);
    assert_eq!(over.outcome.report.properties[0].obligations.failed, 1);
    assert_eq!(over.outcome.report.gaps, ["stopped at the first violation, as asked"]);
    over.agrees();
}

#[test]
fn simulated_time_stamps_where_somebody_publishes_it() {
    let script = Script::of(20.0).offers_clock().offers(0.1, 1, "/asked").offers(0.1, 2, "/done");
    // Before the first /clock nothing has a stamp: the value is there all the same, from then on.
    let script = script.says(0.2, 2, 0.0).says(0.3, 1, 0.0).keeps_ticking(0.5, 10.0, 100.0).says(2.05, 1, 1.0);
    let over = watch(ANSWERED, script);
    let violation = &over.outcome.report.properties[0].violations[0];
    assert_eq!((violation.began.seconds(), violation.failed.seconds()), (101.5, 102.5));
    assert!((3.05..3.2).contains(&over.told.violations[0].0), "{:?}", over.told.violations);
    over.agrees();
}

#[test]
fn simulated_time_that_jumps_back_starts_every_monitor_anew() {
    let script = Script::of(20.0).offers_clock().offers(0.1, 1, "/asked").offers(0.1, 2, "/done");
    let script = script.keeps_ticking(0.5, 3.0, 100.0).says(1.0, 1, 0.0).says(1.0, 2, 0.0).says(2.95, 1, 1.0);
    let script = script.keeps_ticking(3.1, 9.0, 0.0).says(4.0, 1, 0.0).says(4.0, 2, 0.0);
    let over = watch(ANSWERED, script);
    let (verdict, _) = over.verdict("answered");
    assert_eq!(verdict, Verdict::Holds);
    assert!(over.told.warnings.iter().any(|(_, w)| w.starts_with("time jumped back")), "{:?}", over.told.warnings);
    over.agrees();
}

#[test]
fn simulated_time_that_leaps_forward_is_told_and_leaves_doubt() {
    let script = Script::of(20.0).offers_clock().offers(0.1, 1, "/asked").offers(0.1, 2, "/done");
    let script =
        script.keeps_ticking(0.5, 3.0, 100.0).says(1.0, 1, 0.0).says(1.0, 2, 0.0).keeps_ticking(3.1, 5.0, 500.0);
    let over = watch(ANSWERED, script);
    let (verdict, cause) = over.verdict("answered");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("the clock leapt forward: by 397.5 s"), "{cause}");
    over.agrees();
}

#[test]
fn a_clock_that_turns_up_late_is_told_and_changes_nothing() {
    let script = Script::of(5.0).offers(0.1, 1, "/x").says(0.5, 1, 1.0);
    let script = script.offers_type(3.0, 99, "/clock", "rosgraph_msgs/Clock", "time clock\n");
    let over = watch("decl x /x Float64.data\nnever x > 5\n", script);
    assert_eq!(over.verdict("line 2").0, Verdict::Holds);
    assert!(over.told.notes[0].contains("/clock"), "{:?}", over.told.notes);
}

#[test]
fn headers_may_count_and_the_recording_agrees_under_the_same_option() {
    let definition = "Header header\nfloat64 x\n================================================================================\n\
                      MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
    let stamped = |seconds: f64, x: f64| {
        let nanos = (1_000.0 + seconds) * 1e9;
        let mut bytes = 0_u32.to_le_bytes().to_vec();
        bytes.extend(((nanos / 1e9) as u32).to_le_bytes());
        bytes.extend(((nanos % 1e9) as u32).to_le_bytes());
        bytes.extend(0_u32.to_le_bytes());
        bytes.extend(x.to_le_bytes());
        bytes
    };
    let mut script = Script::of(12.0).offers_type(0.1, 1, "/s", "demo/Stamped", definition);
    // In pairs of which the later comes first.
    for k in 0..40 {
        let pair = if k % 2 == 0 { k + 1 } else { k - 1 };
        let x = if pair == 20 { 9.0 } else { 1.0 };
        script = script.says_bytes(1.0 + 0.25 * f64::from(k), 1, &stamped(0.25 * f64::from(pair), x));
    }
    let recording = lapwing_record::Options { time: TimeSource::Header, ..lapwing_record::Options::default() };
    let checking = Options { recording, ..Options::default() };
    let over = watch_as("decl x /s demo/Stamped.x\nnever x > 5\n", script, LiveOptions { checking, ..wall() });
    assert_eq!(over.outcome.report.properties[0].violations[0].failed.seconds(), 1005.0);
    over.agrees();
}

#[test]
fn a_clock_that_is_found_late_counts_where_nothing_was_judged() {
    // As where discovery takes its time: everything is found together, after the second in which a clock is waited for.
    let script = Script::of(20.0).blinds(1.0, "/asked", lapwing_ros::connector::Cause::NoPublisher);
    let script = script.offers(1.2, 1, "/asked").offers(1.2, 2, "/done");
    let script = script.clears(1.2, "/asked", lapwing_ros::connector::Cause::NoPublisher);
    let script = script.offers_type(1.25, 99, "/clock", "rosgraph_msgs/Clock", "time clock\n");
    let script = script.keeps_ticking(1.5, 10.0, 100.0).says(1.55, 1, 0.0).says(1.56, 2, 0.0).says(3.05, 1, 1.0);
    let over = watch(ANSWERED, script);
    assert!(over.told.notes.iter().any(|note| note.contains("anew, by simulated time")), "{:?}", over.told.notes);
    let violation = &over.outcome.report.properties[0].violations[0];
    assert_eq!((violation.began.seconds(), violation.failed.seconds()), (101.5, 102.5));
    assert!(over.asked.subscribed.contains(&"/clock".to_owned()));
    over.agrees();
}
