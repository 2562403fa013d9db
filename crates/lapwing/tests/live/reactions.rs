//! What a run does to the robot: reactions and guards, and how they are limited.

use lapwing::live::{ClockChoice, Ended, LiveOptions, Reach};
use lapwing_ros::connector::Cause;

use crate::script::{Over, Script, at, try_watch, watch_as, watch_followed};

fn wall() -> LiveOptions {
    LiveOptions { clock: ClockChoice::Wall, ..LiveOptions::default() }
}

fn watch(spec: &str, script: Script) -> Over {
    watch_as(spec, script, wall())
}

/// The numbers that were published, and when.
fn numbers(over: &Over, topic: &str) -> Vec<(f64, f64)> {
    let of_topic = over.asked.published.iter().filter(|(_, to, _)| to == topic);
    of_topic.map(|(at, _, bytes)| (*at, f64::from_le_bytes(bytes.as_slice().try_into().unwrap()))).collect()
}

const BRAKES: &str = "\
decl speed /odom Float64.data
calm: never speed > 2
on violation of calm {
    publish /brake std_msgs/Float64 { data: 0.5 }
}
";

#[test]
fn a_violation_publishes_what_was_encoded_before() {
    let script =
        Script::of(5.0).offers(0.1, 1, "/odom").says(0.5, 1, 1.0).says(1.5, 1, 3.0).says(1.6, 1, 3.0).says(2.5, 1, 1.0);
    let over = watch(BRAKES, script.says(3.5, 1, 4.0));
    // Once an episode, at the message that began it.
    assert_eq!(numbers(&over, "/brake"), [(1.5, 0.5), (3.5, 0.5)]);
    assert_eq!(over.figures.reacted.count(), 2);
    // What is only written to is not listened to.
    assert_eq!(over.asked.subscribed, ["/odom"]);
    over.agrees();
}

#[test]
fn a_reaction_is_limited_where_it_says_so() {
    let spec = BRAKES.replace("of calm {", "of calm at most every 3 s {");
    let script = [1.0, 2.0, 3.0, 4.5, 6.0]
        .iter()
        .fold(Script::of(8.0).offers(0.1, 1, "/odom"), |script, at| script.says(*at, 1, 3.0).says(at + 0.1, 1, 1.0));
    let over = watch(&spec, script);
    let times: Vec<f64> = numbers(&over, "/brake").into_iter().map(|(at, _)| at).collect();
    assert_eq!(times, [1.0, 4.5]);
}

#[test]
fn a_service_is_called_and_its_answer_told() {
    let spec = BRAKES.replace("publish /brake std_msgs/Float64 { data: 0.5 }", "call /halt std_srvs/Trigger {}");
    let over = watch(&spec, Script::of(3.0).offers(0.1, 1, "/odom").says(1.0, 1, 3.0));
    assert_eq!(over.asked.called, [("/halt".to_owned(), Vec::new())]);
    let told = over.told.notes.join("\n");
    assert!(told.contains("/halt answered { success: true, message: \"ok\" }"), "{told}");
}

#[test]
fn stop_ends_the_run() {
    let spec = BRAKES.replace("publish /brake std_msgs/Float64 { data: 0.5 }", "stop");
    let script = Script::of(60.0).offers(0.1, 1, "/odom").says(1.0, 1, 3.0).says(1.5, 1, 1.0);
    let over = watch(&spec, script);
    assert_eq!(over.outcome.ended, Ended::ByReaction);
    over.agrees();
}

#[test]
fn reset_starts_the_monitor_afresh_and_the_recording_knows() {
    let spec = "\
decl speed /odom Float64.data
calm: after speed > 2, never speed < 1
on violation of calm {
    reset
}
";
    let script = [(1.0, 3.0), (2.0, 0.5), (3.0, 0.5), (4.0, 3.0), (5.0, 0.5)]
        .iter()
        .fold(Script::of(6.0).offers(0.1, 1, "/odom"), |script, (at, speed)| script.says(*at, 1, *speed));
    let over = watch(spec, script);
    // What is slow at 3 s comes before anything was fast in the eyes of a monitor that started afresh.
    let property = &over.outcome.report.properties[0];
    let failed: Vec<f64> = property.violations.iter().map(|v| (v.failed.0 - at(0.0).0) as f64 / 1e9).collect();
    assert_eq!(failed, [2.0, 5.0]);
    over.agrees();
}

#[test]
fn what_cannot_be_done_is_an_error_before_anything_is_watched() {
    let spec = BRAKES.replace("std_msgs/Float64 { data: 0.5 }", "demo_msgs/Brake { force: 0.5 }");
    let Err(why) = try_watch(&spec, Script::of(3.0), wall()) else { panic!("it began") };
    assert!(why.contains("publish /brake demo_msgs/Brake") && why.contains("nobody knows demo_msgs/Brake"), "{why}");

    let reach = Reach { allowed: Some(vec!["/other".to_owned()]), ..Reach::default() };
    let Err(why) = try_watch(BRAKES, Script::of(3.0), LiveOptions { reach, ..wall() }) else { panic!("it began") };
    assert!(why.contains("publishes /brake on violation of calm"), "{why}");
    let reach = Reach { allowed: Some(vec!["brake".to_owned()]), ..Reach::default() };
    assert!(try_watch(BRAKES, Script::of(3.0), LiveOptions { reach, ..wall() }).is_ok());
}

#[test]
fn a_dry_run_only_says_what_it_would_do() {
    let reach = Reach { dry: true, ..Reach::default() };
    let script = Script::of(3.0).offers(0.1, 1, "/odom").says(1.0, 1, 3.0);
    let over = watch_as(BRAKES, script, LiveOptions { reach, ..wall() });
    assert!(over.asked.published.is_empty() && over.asked.advertised.is_empty());
    assert!(over.told.notes.iter().any(|n| n.starts_with("would publish /brake")), "{:?}", over.told.notes);
}

#[test]
fn what_will_not_be_done_is_said_at_the_start() {
    let spec =
        BRAKES.replace("publish /brake std_msgs/Float64 { data: 0.5 }", "run find_ball\n    request Safety.Stop");
    let over = watch(&spec, Script::of(3.0).offers(0.1, 1, "/odom").says(1.0, 1, 1.0));
    let told = over.told.notes.join("\n");
    assert!(told.contains("no host program") && told.contains("a ROS graph has no activities"), "{told}");
}

const GUARDED: &str = "\
decl wanted /cmd_raw Float64.data
decl battery /battery Float64.data
safe: never wanted > 2 or battery < 1
guard /cmd from /cmd_raw by safe else drop
";

/// Commands at 10 Hz and a battery.
fn driving() -> Script {
    Script::of(9.0).offers(0.1, 1, "/cmd_raw").offers(0.1, 2, "/battery")
}

#[test]
fn a_guard_lets_messages_pass_while_its_property_stands() {
    let script = driving().says(0.5, 2, 5.0).says(1.0, 1, 1.0).says(2.0, 1, 3.0).says(3.0, 1, 1.5).says(3.5, 2, 0.5);
    let over = watch(GUARDED, script.says(4.0, 1, 1.0).says(5.0, 2, 5.0).says(6.0, 1, 1.0));
    assert_eq!(numbers(&over, "/cmd"), [(1.0, 1.0), (3.0, 1.5), (6.0, 1.0)]);
    assert_eq!(over.figures.guarded.count(), 3);
    over.agrees();
}

#[test]
fn what_cannot_be_judged_does_not_pass_unless_the_guard_fails_open() {
    let script = driving().says(0.5, 1, 1.0).says(1.0, 2, 5.0).says(1.5, 1, 1.0);
    let script = script.blinds(2.0, "/battery", Cause::NoPublisher).says(2.5, 1, 1.0);
    let script = script.clears(3.0, "/battery", Cause::NoPublisher).says(3.5, 1, 1.0).says_bytes(4.0, 1, &[7]);
    let times = |over: &Over| numbers(over, "/cmd").into_iter().map(|(at, _)| at).collect::<Vec<_>>();
    let over = watch(GUARDED, script.clone());
    // Before the battery has spoken, while it cannot be seen, and what cannot be decoded: dropped.
    assert_eq!(times(&over), [1.5, 3.5]);
    let told = over.told.notes.join("\n");
    assert!(told.contains("does not pass to /cmd until safe can be judged"), "{told}");
    let open = GUARDED.replace("else drop", "else drop fail open");
    let over = watch(&open, script.clone());
    assert_eq!(over.asked.published.iter().map(|(at, ..)| *at).collect::<Vec<_>>(), [0.5, 1.5, 2.5, 3.5, 4.0]);
    let instead = GUARDED.replace("else drop", "else publish std_msgs/Float64 { data: 0.0 }");
    let over = watch(&instead, script);
    assert_eq!(numbers(&over, "/cmd"), [(0.5, 0.0), (1.5, 1.0), (2.5, 0.0), (3.5, 1.0), (4.0, 0.0)]);
}

#[test]
fn specifications_that_cannot_be_carried_out_end_nothing() {
    let script = Script::of(6.0).offers(0.1, 1, "/odom").says(0.5, 1, 1.0).says(4.0, 1, 3.0);
    let next = BRAKES.replace("std_msgs/Float64 {", "demo/Unheard {");
    let over = watch_followed(BRAKES, (2.0, &next), script.clone(), wall());
    assert_eq!((over.outcome.ended, over.outcome.next.is_none()), (Ended::Stopped, true));
    let told = over.told.notes.join("\n");
    assert!(
        told.contains("`publish /brake demo/Unheard` cannot be done") && told.contains("goes on as it is"),
        "{told}"
    );
    assert_eq!(numbers(&over, "/brake"), [(4.0, 0.5)]);
    over.agrees();

    let over = watch_followed(BRAKES, (2.0, &BRAKES.replace("> 2", "> 1")), script, wall());
    assert_eq!((over.outcome.ended, over.outcome.next.map(|specs| specs.len())), (Ended::Reloaded, Some(1)));
}
