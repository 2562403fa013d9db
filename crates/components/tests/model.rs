//! Monitors in BIP models: what they report in a run of the model is what the specification says of the same run.

mod common;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use common::model;
use lapwing::{Options, Session, Spec};
use lapwing_bip::{Detail, Log, Pace, Simulated, Sink, standard};
use lapwing_components::model::{with_monitors, with_requests};
use lapwing_components::{Signals, Types, request};
use lapwing_diag::{SourceMap, Style};
use lapwing_genom::Model;
use lapwing_genom::automata::{Settings, System, build};
use lapwing_genom::emit::{Input, bip};

/// A laser that sometimes rests, and somebody who drives.
const COMPONENTS: &str = "
component Laser {
  ids { double v; };
  port out double Scan;
  task t { period 40 ms; };
  activity Acquire() {
    task t;
    codel<start> A1() yield main wcet 1 ms;
    codel<main> A2(port out Scan) yield pause::main, pause::idle wcet 10 ms;
    codel<idle> A3() yield pause::main wcet 1 ms;
    codel<stop> A4() yield ether wcet 1 ms;
    interrupts Acquire;
  };
};
component Nav {
  task plan { period 50 ms; };
  activity Goto() {
    task plan;
    codel<start> N1() yield main wcet 1 ms;
    codel<main> N2() yield pause::main wcet 10 ms;
    codel<stop> N3() yield ether wcet 1 ms;
    interrupts Goto;
  };
  function Stop() { interrupts Goto; };
};
";

const REQUESTS: &str =
    "@0s Laser.Acquire()\n@300ms Nav.Goto()\n@900ms Nav.Stop()\n@1s Nav.Goto()\n@1500ms Nav.Goto()\n@2s Nav.Goto()\n";

const SPEC: &str = "use std.robot
event scan = write Laser.Scan
event asked = request Nav.Goto
event begun = start Nav.Goto
Scan_Fail: keeps_coming(scan, running Nav.Goto, 60 ms)
fresh: age(Laser.Scan) <= 75 ms
quiet: whenever scan, not running Nav.Goto
starts: whenever asked, eventually within 49 ms begun
always_fast: whenever asked, eventually within 1 s begun
event ended = end Nav.Goto
event stopped = report Nav.Stop
event stopping = request Nav.Stop
recent: whenever scan, once within 170 ms begun
recently: whenever ended, once within [0 s, 200 ms) begun
rested: whenever begun, historically within 300 ms not ended
since_begun: whenever scan and running Nav.Goto, running Nav.Goto since within 250 ms begun
long_ago: whenever stopped, held for 600 ms not begun
scans_since: whenever ended, not stopping since within 500 ms begun
steady: whenever scan, held for 250 ms running Nav.Goto
told: whenever stopping, eventually within 1 ms stopped
later: whenever asked, eventually within [40 ms, 90 ms] scan
much_later: whenever scan, eventually within [100 ms, 130 ms] begun
spaced: whenever scan, always within [1 ms, 39 ms] not scan
rests: whenever ended, always within [1 ms, 700 ms] not begun
clear: whenever begun, always within 45 ms not scan
earlier: whenever scan, once within [30 ms, 85 ms] scan
between: whenever scan, running Nav.Goto since within [90 ms, 200 ms] begun
never_then: whenever begun, historically within (100 ms, 400 ms) not ended
on violation of Scan_Fail { request Nav.Stop }
";

/// Properties that fail when they are reported: at a position, or where an age is over. What does not come in time fails at the end of its bound, one
/// nanosecond before.
const AT_ONCE: [&str; 15] = [
    "fresh",
    "quiet",
    "recent",
    "recently",
    "rested",
    "since_begun",
    "long_ago",
    "scans_since",
    "steady",
    "spaced",
    "rests",
    "clear",
    "earlier",
    "between",
    "never_then",
];

fn spec(text: &str) -> Spec {
    Spec::parse("t.rv", text, &|_| None).unwrap()
}

fn signals(model: &Arc<Model>) -> Signals {
    Signals::new(model, &Types::new(model).unwrap())
}

fn system(model: &Model) -> System {
    build(model, Settings::default()).unwrap()
}

/// The model as text.
fn text(model: &Arc<Model>, sources: &SourceMap, spec: &Spec) -> String {
    let system = system(model);
    let requests = request::file(model, &Types::new(model).unwrap(), REQUESTS).unwrap();
    let package = with_requests(bip(Input { system: &system, sources }), &system, model, &requests);
    let package = with_monitors(package, &system, model, spec, &signals(model), Style::Plain).unwrap();
    lapwing_bip::print(&package)
}

/// What was chosen in a run of a model, and when, in nanoseconds.
fn run(text: &str, seed: u64) -> Vec<(String, i64)> {
    let mut sources = SourceMap::default();
    let file = sources.add("t.bip", text);
    let parsed = lapwing_bip::parse(file, text);
    let said = |all: &[lapwing_diag::Diagnostic]| {
        all.iter().map(|d| lapwing_diag::render(&sources, d, Style::Plain)).collect::<String>()
    };
    assert!(parsed.diagnostics.is_empty(), "{}", said(&parsed.diagnostics));
    let checked = lapwing_bip::check(&parsed.package, &[]);
    assert!(!lapwing_diag::has_errors(&checked.diagnostics), "{}", said(&checked.diagnostics));
    let model = Arc::new(checked.model(None).unwrap());
    let sink = Rc::new(RefCell::new(Vec::new()));
    let out: Sink<'_> = sink.clone();
    let host = standard(&out, Pace::Simulated).bind(&model).unwrap();
    let options = lapwing_bip::Options { seed, limit: Some(6000), ..lapwing_bip::Options::default() };
    let ending = lapwing_bip::Run::new(options, Simulated::default(), Log::new(out, Detail::Verbose)).run(model, host);
    assert_eq!(ending, lapwing_bip::Ending::Limit);
    let log = String::from_utf8(sink.borrow().clone()).unwrap();
    log.lines().filter_map(chosen).collect()
}

/// `-> choose [0] ROOT.name: … at global time 1s20ms`
fn chosen(line: &str) -> Option<(String, i64)> {
    let (_, rest) = line.split_once("choose [")?;
    let (_, rest) = rest.split_once("] ROOT.")?;
    let (name, rest) = rest.split_once(':')?;
    let (_, time) = rest.rsplit_once("at global time ")?;
    Some((name.to_owned(), nanoseconds(time.trim())))
}

fn nanoseconds(text: &str) -> i64 {
    let (mut all, mut number, mut rest) = (0, 0_i64, text);
    while let Some(c) = rest.chars().next() {
        if let Some(digit) = c.to_digit(10) {
            number = number * 10 + i64::from(digit);
            rest = &rest[1..];
            continue;
        }
        let (unit, scale) =
            [("min", 60_000_000_000), ("ms", 1_000_000), ("us", 1_000), ("ns", 1), ("s", 1_000_000_000)]
                .into_iter()
                .find(|(unit, _)| rest.starts_with(unit))
                .unwrap();
        (all, number, rest) = (all + number * scale, 0, &rest[unit.len()..]);
    }
    all
}

/// The run as a recording: what a run of the components would have told.
fn recording(chosen: &[(String, i64)]) -> String {
    let mut lines = String::new();
    let mut say = |t: i64, topic: &str, msg: &str| {
        lines += &format!("{{\"t_ns\":{t},\"topic\":\"{topic}\",\"type\":\"t\",\"msg\":{msg}}}\n");
    };
    say(0, "/lapwing/components", "{}");
    say(0, "/Nav/Goto/running", "{\"data\":false}");
    let mut running = 0;
    for (name, t) in chosen {
        let is = |automaton: &str, rest: &str| name.starts_with(automaton) && name.contains(rest);
        if is("Laser_Acquire", "_main_to_") {
            say(*t, "/Laser/Scan", "{\"data\":0}");
        } else if is("Nav_Goto", "_ether_to_") && !name.ends_with("ether_to_ether") {
            running += 1;
            if running == 1 {
                say(*t, "/Nav/Goto/running", "{\"data\":true}");
            }
            say(*t, "/Nav/Goto/start", "{}");
        } else if is("Nav_Goto", "_to_ether") {
            running -= 1;
            if running == 0 {
                say(*t, "/Nav/Goto/running", "{\"data\":false}");
            }
            say(*t, "/Nav/Goto/end", "{}");
        } else if name == "Nav_control_request_Goto" {
            say(*t, "/Nav/Goto/request", "{}");
        } else if name == "Nav_control_request_Stop" || name == "Scan_Fail_debt_1_request" {
            say(*t, "/Nav/Stop/request", "{}");
        } else if name == "Nav_control_Stop_done" {
            say(*t, "/Nav/Stop/report", "{}");
        }
    }
    say(chosen.last().map_or(0, |(_, t)| *t), "/lapwing/components", "{}");
    lines
}

#[test]
fn a_run_of_the_model_and_the_specification_agree_on_every_violation() {
    let (model, sources) = model(COMPONENTS);
    let spec = spec(SPEC);
    let text = text(&model, &sources, &spec);
    let folder = tempfile::tempdir().unwrap();
    let mut all = BTreeMap::new();
    for seed in 1..=6 {
        let chosen = run(&text, seed);
        // At the last moment what has happened may not have been reported yet.
        let end = chosen.last().map_or(0, |(_, t)| *t);
        let file = folder.path().join("run.ndjson");
        std::fs::write(&file, recording(&chosen)).unwrap();
        let specs = [spec.clone()];
        let report = Session::open(&specs, &file, &Options::default()).unwrap().run(&mut ());
        for property in &report.properties {
            let said: Vec<i64> = property.violations.iter().map(|v| v.failed.0).filter(|t| *t < end).collect();
            let reported: Vec<i64> =
                chosen.iter().filter(|(name, _)| *name == property.name).map(|(_, t)| *t).collect();
            let late = i64::from(!AT_ONCE.contains(&property.name.as_str()));
            let reported: Vec<i64> = reported.into_iter().map(|t| t - late).filter(|t| *t < end).collect();
            assert_eq!(reported, said, "{} with seed {seed}", property.name);
            *all.entry(property.name.clone()).or_insert(0) += said.len();
        }
        let stops = chosen.iter().filter(|(name, _)| name == "Scan_Fail_debt_1_request").count();
        let fails = chosen.iter().filter(|(name, _)| name == "Scan_Fail").count();
        assert_eq!(stops, fails, "a reaction was missed with seed {seed}");
    }
    assert!(all.values().sum::<usize>() > 100, "{all:?} are too few violations to compare");
    let silent: Vec<&String> = all.iter().filter(|(_, count)| **count == 0).map(|(name, _)| name).collect();
    // What holds in every run compares nothing but that.
    assert_eq!(silent, ["always_fast", "told"], "{all:?}");
}

#[test]
fn a_monitor_hinders_nothing() {
    let (model, sources) = model(COMPONENTS);
    let silent = spec(&SPEC.replace("on violation of Scan_Fail { request Nav.Stop }", ""));
    let bare = spec("event scan = write Laser.Scan\nunwatched: whenever scan, true\n");
    // The same lots are drawn for what both have; what is only watched comes between.
    let without: Vec<(String, i64)> = run(&text(&model, &sources, &bare), 5);
    let with: Vec<(String, i64)> = run(&text(&model, &sources, &silent), 5);
    let scans = |all: &[(String, i64)]| {
        all.iter().filter(|(n, _)| n.starts_with("Laser_t_timer")).map(|(_, t)| *t).collect::<Vec<_>>()
    };
    let (one, two) = (scans(&without), scans(&with));
    let both = one.len().min(two.len());
    assert!(both > 20 && one[..both] == two[..both], "{one:?}\n{two:?}");
}

/// A monitor that has no place for a request says so, and nothing more: that would be judged of some requests and not of others.
#[test]
fn a_monitor_with_more_requests_open_than_places_gives_up() {
    let (model, sources) = model(COMPONENTS);
    let spec = spec(
        "event scan = write Laser.Scan\nevent begun = start Nav.Goto\nfar: whenever scan, eventually within [500 ms, 2 s] begun\n",
    );
    let chosen = run(&text(&model, &sources, &spec), 1);
    let times = |wanted: &str| chosen.iter().filter(|(name, _)| name == wanted).count();
    assert_eq!((times("far_lost"), times("far"), times("far_again")), (1, 0, 0));
}

#[test]
fn what_the_model_does_not_have_is_told_with_its_place() {
    let (model, sources) = model(COMPONENTS);
    let system = system(&model);
    for (text, words) in [
        ("never Laser.Scan.data > 3\n", "values: codels make them"),
        ("event s = start Nav.Goto\nwhenever s, age(Laser.Scan) <= 1 s\n", "`once within d` of what is written"),
        ("event done = report Nav.Goto\nnever done\n", "reports of activities"),
        ("event s = write Laser.Scan\nwhenever s, once within [2 s, 2001 ms] running Nav.Goto\n", "so narrow a bound"),
        ("event s = write Laser.Scam\nnever s\n", "/Laser/Scam"),
    ] {
        let spec = spec(text);
        let package = bip(Input { system: &system, sources: &sources });
        let wrong = with_monitors(package, &system, &model, &spec, &signals(&model), Style::Plain).unwrap_err();
        assert!(wrong.0.contains(words) && wrong.0.contains("t.rv:"), "{}", wrong.0);
    }
}
