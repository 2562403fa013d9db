//! Never silent: what cannot be seen is told within a second, and a verdict that rests on it is none.

use lapwing::live::{ClockChoice, LiveOptions};
use lapwing_ros::connector::Cause;
use lapwing_stream::Verdict;

use crate::script::{Over, Script, watch_as};

const SPEED: &str = "decl speed /odom Float64.data\ncalm: never speed > 2\n";

fn watch(spec: &str, script: Script) -> Over {
    watch_as(spec, script, LiveOptions { clock: ClockChoice::Wall, ..LiveOptions::default() })
}

/// A topic of good numbers from half a second on.
fn healthy(until: f64) -> Script {
    Script::of(until).offers(0.1, 1, "/odom").keeps_saying(0.5, until - 0.5, 0.1, 1, 1.0)
}

fn warned(over: &Over, word: &str) -> f64 {
    let found = over.told.warnings.iter().find(|(_, text)| text.contains(word));
    found.unwrap_or_else(|| panic!("no `{word}` in {:?}", over.told.warnings)).0
}

#[test]
fn a_topic_that_nobody_publishes_is_told_and_makes_nothing_hold() {
    let script = Script::of(5.0).blinds(1.0, "/odom", Cause::NoPublisher);
    let over = watch(SPEED, script);
    assert!(warned(&over, "/odom cannot be seen: nobody publishes it") <= 1.1);
    let (verdict, cause) = over.verdict("calm");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("/odom could not be seen from") && cause.contains("nobody publishes it"), "{cause}");
    over.agrees();
}

#[test]
fn what_was_not_there_before_the_property_began_was_not_missed() {
    let script = Script::of(9.0).blinds(1.0, "/odom", Cause::NoPublisher).offers(3.0, 1, "/odom");
    let script = script.clears(3.0, "/odom", Cause::NoPublisher).keeps_saying(3.1, 8.0, 0.1, 1, 1.0);
    let over = watch(SPEED, script);
    assert_eq!(over.verdict("calm"), (Verdict::Holds, String::new()));
    warned(&over, "/odom is published now, after 2 s");
    over.agrees();
}

#[test]
fn a_value_by_default_is_judged_from_the_start_and_so_is_blind_from_the_start() {
    let spec =
        "decl stop /stop Float64.data default 0\ndecl speed /odom Float64.data\nheeds: never stop > 0 and speed > 0\n";
    let script = healthy(9.0).blinds(1.0, "/stop", Cause::NoPublisher).offers(3.0, 2, "/stop");
    let over = watch(spec, script.clears(3.0, "/stop", Cause::NoPublisher).says(3.5, 2, 0.0));
    // Nothing was judged before /stop was there, and so nothing was missed.
    assert_eq!(over.verdict("heeds").0, Verdict::Holds);
    over.agrees();
}

#[test]
fn each_cause_leaves_doubt_with_when_and_how_long() {
    for (cause, word) in [
        (Cause::NoPublisher, "nobody publishes it"),
        (Cause::Incompatible("offers BEST_EFFORT".to_owned()), "quality of service does not fit: offers BEST_EFFORT"),
        (Cause::Undefined("no definition of demo/X".to_owned()), "no definition of demo/X"),
        (Cause::Disconnected("connection reset".to_owned()), "the connection is broken: connection reset"),
    ] {
        let script = healthy(9.0).blinds(4.0, "/odom", cause.clone()).clears(5.5, "/odom", cause);
        let over = watch(SPEED, script);
        assert!((4.0..4.1).contains(&warned(&over, word)));
        warned(&over, "again after 1.5 s");
        let (verdict, text) = over.verdict("calm");
        assert_eq!(verdict, Verdict::Inconclusive);
        assert!(text.contains("(1.5 s)") && text.contains(word), "{text}");
        over.agrees();
    }
}

#[test]
fn a_violation_that_was_seen_stands() {
    let script = healthy(9.0).says(2.05, 1, 9.0).blinds(4.0, "/odom", Cause::NoPublisher);
    let over = watch(SPEED, script);
    assert_eq!(over.verdict("calm").0, Verdict::Violated);
    over.agrees();
}

#[test]
fn only_who_reads_a_topic_is_in_doubt_of_it() {
    let spec = format!("{SPEED}decl battery /battery Float64.data\nfull: never battery < 1\n");
    let script = healthy(9.0).offers(0.1, 2, "/battery").keeps_saying(0.5, 8.0, 0.5, 2, 5.0);
    let over = watch(&spec, script.blinds(4.0, "/battery", Cause::NoPublisher));
    assert_eq!(over.verdict("calm").0, Verdict::Holds);
    assert_eq!(over.verdict("full").0, Verdict::Inconclusive);
    over.agrees();
}

#[test]
fn lost_messages_are_counted_and_leave_doubt() {
    let over = watch(SPEED, healthy(5.0).loses(2.05, 1, 17));
    assert!((2.0..2.1).contains(&warned(&over, "17 messages of /odom were lost")));
    let (verdict, cause) = over.verdict("calm");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("messages were lost"), "{cause}");
    over.agrees();
}

#[test]
fn a_message_that_cannot_be_decoded_blinds_until_one_can() {
    let over = watch(SPEED, healthy(5.0).says_bytes(2.05, 1, &[1, 2, 3]));
    assert!((2.0..2.1).contains(&warned(&over, "a message could not be decoded")));
    assert!((2.0..2.2).contains(&warned(&over, "can be seen again")));
    assert_eq!(over.verdict("calm").0, Verdict::Inconclusive);
    over.agrees();
}

#[test]
fn a_topic_of_another_type_is_told_at_its_place() {
    let script = Script::of(5.0).offers_type(0.1, 1, "/odom", "std_msgs/String", "string data\n");
    let over = watch(SPEED, script.says_bytes(0.5, 1, &[1, 0, 0, 0, b'x']));
    let (verdict, cause) = over.verdict("calm");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("/odom is a std_msgs/String"), "{cause}");
    let warning = over.outcome.report.warnings.iter().find(|w| w.code == Some("topic-type")).unwrap();
    assert_eq!(warning.place.as_ref().map(|(_, line, _)| *line), Some(1));
    over.agrees();
}

#[test]
fn a_second_type_on_a_topic_is_told_and_leaves_doubt() {
    let script = healthy(9.0).offers_type(4.0, 2, "/odom", "std_msgs/String", "string data\n");
    let over = watch(SPEED, script.has_publishers(6.0, 2, 0));
    assert!((4.0..4.1).contains(&warned(&over, "another type: std_msgs/String")));
    let (verdict, cause) = over.verdict("calm");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("(2 s)"), "{cause}");
    over.agrees();
}

#[test]
fn a_silence_is_told_by_the_topics_own_period_as_a_warning_only() {
    let script =
        Script::of(9.0).offers(0.1, 1, "/odom").keeps_saying(0.5, 3.0, 0.1, 1, 1.0).keeps_saying(6.0, 8.9, 0.1, 1, 1.0);
    let over = watch(SPEED, script);
    assert!(
        (3.5..3.6).contains(&warned(&over, "nothing came on /odom for 500 ms: before, a message came every 100 ms"))
    );
    assert!((6.0..6.1).contains(&warned(&over, "/odom is back after 3 s of silence")));
    assert_eq!(over.verdict("calm").0, Verdict::Holds);
    over.agrees();
}

#[test]
fn a_silence_beyond_what_the_specification_allows_leaves_doubt() {
    let spec = "decl speed /odom Float64.data stale after 2 s\ncalm: never speed > 2\n";
    let script =
        Script::of(9.0).offers(0.1, 1, "/odom").keeps_saying(0.5, 3.0, 0.1, 1, 1.0).keeps_saying(6.0, 8.9, 0.1, 1, 1.0);
    let over = watch(spec, script);
    assert!((5.0..5.1).contains(&warned(&over, "longer than 2 s, its `stale after`")));
    let (verdict, cause) = over.verdict("calm");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("/odom was silent from"), "{cause}");
    over.agrees();
}

#[test]
fn events_that_no_graph_has_do_not_pass_in_silence() {
    let script = healthy(3.0);
    let over = watch(
        &format!("{SPEED}event kick\nevent play = call Kicker::play\nfair: whenever play, eventually kick\n"),
        script,
    );
    assert_eq!(over.verdict("calm").0, Verdict::Holds);
    let (verdict, cause) = over.verdict("fair");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("a ROS graph has no event"), "{cause}");
    over.agrees();
}

#[test]
fn warnings_without_end_are_bounded() {
    let script = (0..200).fold(healthy(30.0), |script, k| script.loses(1.05 + 0.1 * f64::from(k), 1, 1));
    let over = watch(SPEED, script);
    let about = over.outcome.report.warnings.iter().filter(|w| w.message.contains("lost")).count();
    assert_eq!(about, 20);
    assert!(over.verdict("calm").1.contains("200 times"), "{}", over.verdict("calm").1);
    over.agrees();
}

#[test]
fn a_type_that_differs_is_told_when_it_is_known_though_nothing_comes() {
    let script = Script::of(3.0).offers_type(0.1, 1, "/odom", "std_msgs/String", "string data\n");
    let over = watch(SPEED, script);
    assert!(warned(&over, "/odom is a std_msgs/String in this run, not a Float64") <= 0.2);
    let (verdict, cause) = over.verdict("calm");
    assert_eq!((verdict, cause.contains("not a Float64")), (Verdict::Inconclusive, true), "{cause}");
    over.agrees();

    let over = watch(&SPEED.replace(".data", ".dta"), Script::of(3.0).offers(0.1, 1, "/odom"));
    assert!(warned(&over, "has no field `dta`; did you mean `data`?") <= 0.2);
    over.agrees();
}

#[test]
fn a_misspelt_topic_is_asked_about() {
    let script = Script::of(3.0).mentions(0.2, 1, "/odom").blinds(1.0, "/odmo", Cause::NoPublisher);
    let over = watch(&SPEED.replace("/odom", "/odmo"), script);
    assert!(warned(&over, "/odmo cannot be seen: nobody publishes it; did you mean /odom?") <= 1.1);
    let (verdict, cause) = over.verdict("calm");
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(cause.contains("no message on /odmo in this run; did you mean /odom?"), "{cause}");
    over.agrees();
}

#[test]
fn a_topic_that_is_published_for_the_first_time_is_not_published_again() {
    let script = Script::of(6.0).blinds(1.0, "/odom", Cause::NoPublisher);
    let script = script.offers(1.5, 1, "/odom").clears(1.5, "/odom", Cause::NoPublisher).says(2.0, 1, 1.0);
    let script = script.has_publishers(3.0, 1, 0).blinds(3.0, "/odom", Cause::NoPublisher);
    let over = watch(SPEED, script.has_publishers(4.0, 1, 1).clears(4.0, "/odom", Cause::NoPublisher));
    assert!(warned(&over, "/odom is published now, after 500 ms") < 2.0);
    assert!(warned(&over, "/odom is published again after 1 s") > 3.9);
    over.agrees();
}

#[test]
fn one_cause_that_is_over_does_not_hide_another() {
    let gone = || Cause::Disconnected("the master does not answer".to_owned());
    let script = Script::of(4.0).blinds(1.0, "/odom", gone()).blinds(2.0, "/odom", Cause::NoPublisher);
    let over = watch(SPEED, script.clears(2.5, "/odom", gone()));
    assert!(warned(&over, "/odom still cannot be seen: nobody publishes it (and no more, after 1.5 s: ") > 2.4);
    assert!(!over.told.warnings.iter().any(|(_, text)| text.contains("can be seen again")), "{:?}", over.told.warnings);
    over.agrees();
}

#[test]
fn times_in_a_cause_are_counted_from_the_beginning_of_the_run() {
    let over = watch(SPEED, Script::of(5.0).blinds(1.0, "/odom", Cause::NoPublisher));
    let (_, cause) = over.verdict("calm");
    assert!(cause.starts_with("/odom could not be seen from 1 s to 5"), "{cause}");
}

#[test]
fn that_no_topic_matches_is_told() {
    let spec = "slow: for each r in topics /{r}/speed: never age(/{r}/speed) > 0.4\n";
    let over = watch(spec, Script::of(4.0));
    assert!((1.0..1.1).contains(&warned(&over, "slow cannot be judged: no topic on the graph matches /{r}/speed")));
    assert_eq!(over.verdict("slow").0, Verdict::Inconclusive);
    over.agrees();

    let script = Script::of(4.0).mentions(0.1, 1, "/a/speed").offers(0.2, 1, "/a/speed");
    let over = watch(spec, script.keeps_saying(1.5, 3.9, 0.1, 1, 1.0));
    assert!(!over.told.warnings.iter().any(|(_, text)| text.contains("cannot be judged")), "{:?}", over.told.warnings);
    over.agrees();
}
