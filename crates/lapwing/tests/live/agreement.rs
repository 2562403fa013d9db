//! What turns up late, and that a check of the recording says the same as the run did.

use std::path::Path;

use lapwing::live::{ClockChoice, LiveOptions};
use lapwing::{Options, Spec};
use lapwing_ros::connector::Cause;
use lapwing_stream::Verdict;

use crate::script::{Over, Script, asked_by_both, at, check, watch_as};

fn watch(spec: &str, script: Script) -> Over {
    watch_as(spec, script, LiveOptions { clock: ClockChoice::Wall, ..LiveOptions::default() })
}

#[test]
fn robots_may_come_later_and_each_is_judged() {
    let spec = "slow: for each r in topics /{r}/speed: never age(/{r}/speed) > 0.4\n";
    let script =
        Script::of(9.0).mentions(0.1, 1, "/a/speed").offers(0.2, 1, "/a/speed").keeps_saying(0.5, 8.9, 0.1, 1, 1.0);
    let script = script.mentions(4.0, 2, "/b/speed").offers(4.1, 2, "/b/speed").keeps_saying(4.2, 6.0, 0.1, 2, 1.0);
    let over = watch(spec, script);
    assert_eq!(over.names(), ["slow[a]", "slow[b]"]);
    assert_eq!(over.verdict("slow[a]").0, Verdict::Holds);
    assert_eq!(over.verdict("slow[b]").0, Verdict::Violated);
    assert!(over.asked.subscribed.contains(&"/b/speed".to_owned()), "{:?}", over.asked.subscribed);
    over.agrees();
}

#[test]
fn robots_that_were_met_in_an_earlier_run_are_subscribed_to_by_the_next() {
    let calm = "decl speed /speed Float64.data\ncalm: never speed > 2\n";
    let slow = "slow: for each r in topics /{r}/speed: never age(/{r}/speed) > 0.4\n";
    let asked = asked_by_both(calm, slow, Script::of(4.0).mentions(0.1, 1, "/a/speed").mentions(0.1, 2, "/b/speed"));
    assert_eq!(asked.subscribed, ["/speed", "/a/speed", "/b/speed"]);
}

#[test]
fn a_topic_that_comes_late_is_judged_with_what_others_said_before() {
    let spec = "decl limit /limit Float64.data\ndecl speed /odom Float64.data\nkept: never speed > limit\n";
    let script = Script::of(9.0).offers_latched(0.1, 1, "/limit").says(0.5, 1, 2.0);
    let script = script.offers(5.0, 2, "/odom").keeps_saying(5.1, 7.0, 0.1, 2, 1.0).says(7.5, 2, 3.0);
    let over = watch(spec, script);
    let property = &over.outcome.report.properties[0];
    assert_eq!((property.verdict, property.violations[0].failed), (Verdict::Violated, at(7.5)));
    over.agrees();
}

#[test]
fn a_topic_that_comes_again_with_the_right_type_is_judged_from_then_on() {
    let spec = "decl speed /odom Float64.data\ncalm: never speed > 2\n";
    let script = Script::of(9.0).offers_type(0.1, 1, "/odom", "std_msgs/String", "string data\n");
    let script = script.says_bytes(0.5, 1, &[1, 0, 0, 0, b'x']).has_publishers(3.0, 1, 0);
    let over = watch(spec, script.offers(4.0, 2, "/odom").says(4.5, 2, 1.0).says(5.0, 2, 3.0));
    assert_eq!(over.verdict("calm").0, Verdict::Violated);
    over.agrees();
}

#[test]
fn publishers_are_counted_live_and_in_the_recording() {
    let spec = "alone: never publishers(/cmd) > 1\n";
    let script = Script::of(9.0).mentions(0.1, 1, "/cmd").has_publishers(3.0, 1, 2).has_publishers(5.0, 1, 1);
    let over = watch(spec, script);
    let property = &over.outcome.report.properties[0];
    assert_eq!((property.verdict, property.violations[0].failed), (Verdict::Violated, at(3.0)));
    over.agrees();
}

#[test]
fn a_rate_a_machine_and_a_default_agree() {
    let spec = "\
__rate__ = 10
decl speed /odom Float64.data
decl stop /stop Float64.data default 0
machine drive {
    initial idle
    state idle when speed < 0.1
    state going when speed >= 0.1
    idle -> going
    going -> idle
}
calm: never speed > 2
heeds: whenever stop > 0, eventually within 1 s speed < 0.1
";
    let script =
        Script::of(9.0).offers(0.1, 1, "/odom").offers(0.2, 2, "/stop").blinds(1.5, "/stop", Cause::NoPublisher);
    let script = script.keeps_saying(0.5, 3.0, 0.07, 1, 0.0).keeps_saying(3.1, 8.0, 0.07, 1, 1.0).says(5.0, 2, 1.0);
    let over = watch(spec, script);
    assert_eq!(over.names(), ["drive", "calm", "heeds"]);
    assert_eq!(over.verdict("heeds").0, Verdict::Violated);
    over.agrees();
}

#[test]
fn a_recording_that_was_cut_off_says_so() {
    let spec = "decl speed /odom Float64.data\ncalm: never speed > 2\n";
    let script = Script::of(9.0).offers(0.1, 1, "/odom").keeps_saying(0.5, 8.0, 0.1, 1, 1.0);
    let over = watch(spec, script);
    let bytes = std::fs::read(&over.recording).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let cut = folder.path().join("cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let specs = [Spec::parse("live.rv", spec, &|_| None).unwrap()];
    let report = check(&specs, &cut, &Options::default());
    assert!(!report.gaps.is_empty(), "{report:?}");
    assert_ne!(report.standing(), lapwing::Standing::Good);
}

#[test]
fn a_recording_of_a_run_may_be_hostile() {
    use std::collections::BTreeMap;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hostile.mcap");
    write_status(
        &path,
        &[b"{", b"{}", b"[1,2]", &b"[".repeat(5000), br#"{"kind":"offered","topic":"/x","type":"T","defined":true}"#],
    );
    let specs = [Spec::parse("live.rv", "decl x /x T.data\nnever x > 2\n", &|_| None).unwrap()];
    let report = check(&specs, &path, &Options::default());
    assert_eq!(report.properties[0].verdict, Verdict::Inconclusive);
    assert!(report.gaps.iter().any(|gap| gap.contains("cannot be read")), "{:?}", report.gaps);

    fn write_status(path: &Path, texts: &[&[u8]]) {
        let mut writer = mcap::Writer::new(std::fs::File::create(path).unwrap()).unwrap();
        let channel = writer.add_channel(0, lapwing::status::TOPIC, "json", &BTreeMap::new()).unwrap();
        for (sequence, text) in texts.iter().enumerate() {
            let time = sequence as u64;
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: sequence as u32,
                log_time: time,
                publish_time: time,
            };
            writer.write_to_known_channel(&header, text).unwrap();
        }
        writer.finish().unwrap();
    }
}
