//! Scenario files: what is wrong with one is said with its place, and with what was probably meant.

use lapwing_sim::scenario::BUNDLED;
use lapwing_sim::{Options, Scenario, Simulation};

/// A robot that stands still, and what else the file says.
fn with(more: &str) -> String {
    format!("about = 'A test.'\n{more}\n[[robot]]\nname = 'r'\nat = [0, 0]\ndrive.rest = {{}}\n")
}

fn error(text: &str) -> String {
    match Scenario::parse("test.toml", text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn what_is_wrong_is_shown_at_its_place() {
    assert_eq!(
        error(&with("duratoin = 5")),
        "\
test.toml:2:1: unknown field `duratoin`, expected one of `about`, `duration`, `faults`, `world`, `robot`, `drone`
  |
2 | duratoin = 5
  | ^^^^^^^^
  help: did you mean `duration`?"
    );
    assert_eq!(
        error(&with("faults = ['frozen-scn']")),
        "\
test.toml:2:10: there is no fault called `frozen-scn`; did you mean `frozen-scan`?
  |
2 | faults = ['frozen-scn']
  |          ^^^^^^^^^^^^^^"
    );
}

#[test]
fn every_kind_of_mistake_is_answered() {
    let robot = |drive: &str| {
        format!(
            "about = ''\n[[robot]]\nname = 'r'\nat = [0, 0]\ndrive = {drive}\n[[robot]]\nname = 's'\nat = [1, 0]\ndrive.rest = {{}}\n"
        )
    };
    for (text, parts) in [
        ("about = 'Nothing.'".to_owned(), vec!["there is no robot", "[[robot]]"]),
        ("about = ".to_owned(), vec!["test.toml:1:"]),
        (with("duration = 0"), vec!["`duration` must be greater than 0"]),
        (with("duration = { between = [1, 1e5] }"), vec!["`duration`"]),
        (with("duration = { between = [3, 2] }"), vec!["the lower limit comes first", "2:"]),
        (with("faults = ['nobody:frozen-scan']"), vec!["no robot called `nobody`", "there are: r", "2:11"]),
        (with("faults = ['frozen-scan@x']"), vec!["`x` is no time"]),
        (with("world.room = [0, 5]"), vec!["0 is too small", "test.toml:2:"]),
        (with("world.room = [5, 1e300]"), vec!["at most 1000000"]),
        (with("world.scatter = { count = 1e4, within = [1, 1], radius = 1, clear = 1 }"), vec!["at most 1000"]),
        (with("world.sign = [{ name = 'r', at = [1, 1] }]"), vec!["two things called `r`"]),
        (with("world.sign = [{ name = 'a b', at = [1, 1] }]"), vec!["letters, digits and `_`"]),
        (
            robot("{ folow = { whom = 's', gap = 1, speed = 1 } }"),
            vec!["unknown variant `folow`", "did you mean `follow`?"],
        ),
        (robot("{ follow = { whom = 't', gap = 1, speed = 1 } }"), vec!["no robot called `t`"]),
        (robot("{ follow = { whom = 'r', gap = 1, speed = 1 } }"), vec!["cannot follow itself"]),
        (robot("{ road = { sped = 1 } }"), vec!["unknown field `sped`", "did you mean `speed`?"]),
        (robot("{ road = { speed = -1 } }"), vec!["-1 is negative", "test.toml:5:"]),
        (robot("{ road = {} }"), vec!["missing field `speed`"]),
        (robot("{ waypoints = { points = [[1]], speed = 1 } }"), vec!["test.toml:5"]),
        (robot("{ waypoints = { points = [], speed = 'fast' } }"), vec!["expected a number"]),
    ] {
        let error = error(&text);
        for part in parts {
            assert!(error.contains(part), "{text}\n\n{error}\n\nlacks: {part}");
        }
    }
}

#[test]
fn a_fault_on_the_command_line_must_be_meant_for_a_robot_that_is_there() {
    let scenario = Scenario::bundled("fleet").unwrap().unwrap();
    assert!(scenario.accepts(&"robot2:frozen-scan".parse().unwrap()).is_ok());
    let error = scenario.accepts(&"robt2:frozen-scan".parse().unwrap()).unwrap_err().to_string();
    assert_eq!(error, "fleet: there is no robot called `robt2`\n  help: did you mean `robot2`?");
}

#[test]
fn numbers_are_drawn_anew_for_every_seed() {
    let text = with("duration = { between = [1, 3] }");
    let scenario = Scenario::parse("test.toml", &text).unwrap();
    let steps = |seed| Simulation::new(&scenario, &Options { seed, ..Options::default() }).progress().1;
    let all: Vec<u64> = (0..20).map(steps).collect();
    assert!(all.iter().all(|n| (200..=600).contains(n)) && all.iter().any(|n| *n != all[0]), "{all:?}");
    assert_eq!(all, (0..20).map(steps).collect::<Vec<_>>());
}

#[test]
fn the_scenarios_that_come_with_it_are_right_and_say_what_they_are() {
    assert!(BUNDLED.len() >= 12);
    for (name, text) in BUNDLED {
        let scenario = Scenario::parse(name, text).unwrap_or_else(|e| panic!("{e}"));
        assert!(scenario.file().about.ends_with('.'), "{name}");
        assert!(scenario.file().duration.greatest() <= 60.0, "{name}");
    }
}

#[test]
fn damaged_scenarios_are_refused_or_run() {
    let mut state = 1_u64;
    let mut below = |count: usize| {
        // Knuth's multiplier; the low bits of such a generator are poor.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count.max(1)
    };
    let (mut refused, mut run) = (0, 0);
    for round in 0..1500 {
        let mut text: Vec<char> = BUNDLED[round % BUNDLED.len()].1.chars().collect();
        for _ in 0..1 + below(3) {
            let at = below(text.len());
            match below(4) {
                0 => drop(text.remove(at)),
                1 => text.insert(at, ['9', '-', '.', '[', '}', '"', '\n', 'e'][below(8)]),
                2 => text[at] = ['0', '7', '-', '.', ',', ']', 'x', '='][below(8)],
                _ => text.truncate(at.max(8)),
            }
        }
        let text: String = text.into_iter().collect();
        match Scenario::parse("damaged.toml", &text) {
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
            Ok(scenario) => {
                let options = Options { seed: 1, duration: Some(0.1), ..Options::default() };
                let mut simulation = Simulation::new(&scenario, &options);
                while simulation.advance().is_some() {
                    assert!(simulation.payload().len() > 4);
                }
                run += 1;
            }
        }
    }
    assert!(refused > 100 && run > 100, "{refused} refused, {run} run");
}
