//! The models of `tests/models` give the traces that their first lines ask for: the results of the original engine's own tests, on models
//! of our own, and what the paper shows.
//!
//! `// run:` begins a run, with the words `asap`, `real-time`, `silent`, `all` (no maximal progress), `warn`, `limit=N`. What follows is about it:
//! `expect:` a line of the log, `absent:` none such, `count N:` so many, `either:` one of several groups of lines, `exit:` the code. `*` stands
//! for anything.

mod support;

use std::fs;
use std::path::Path;
use support::{Outcome, Setting, matches, run};

/// What is asked of a run.
#[derive(Debug)]
enum Demand {
    Expect(String),
    Absent(String),
    Count(usize, String),
    Either(String),
    Exit(u8),
}

fn demands(text: &str) -> Vec<(Setting, Vec<Demand>)> {
    let mut runs: Vec<(Setting, Vec<Demand>)> = Vec::new();
    for line in text.lines().map_while(|l| l.strip_prefix("//")) {
        let Some((word, rest)) = line.split_once(':') else { continue };
        let rest = rest.strip_prefix(' ').unwrap_or(rest).to_owned();
        let demand = match word.trim() {
            "run" => {
                runs.push((Setting::read(&rest), Vec::new()));
                continue;
            }
            "expect" | "expect-raw" => Demand::Expect(rest),
            "absent" => Demand::Absent(rest),
            "either" => Demand::Either(rest),
            "exit" => Demand::Exit(rest.trim().parse().expect("a code")),
            count if count.starts_with("count ") => Demand::Count(count[6..].parse().expect("a number"), rest),
            _ => continue,
        };
        runs.last_mut().expect("a run before what is asked of it").1.push(demand);
    }
    runs
}

fn fails(demand: &Demand, outcome: &Outcome) -> bool {
    let lines: Vec<&str> = outcome.lines();
    let count = |pattern: &str| lines.iter().filter(|line| matches(pattern, line)).count();
    match demand {
        Demand::Expect(pattern) => count(pattern) == 0,
        Demand::Absent(pattern) => count(pattern) > 0,
        Demand::Count(wanted, pattern) => count(pattern) != *wanted,
        Demand::Either(groups) => {
            let holds = |group: &str| group.split(" & ").all(|pattern| count(pattern.trim()) > 0);
            !groups.split(" | ").any(holds)
        }
        Demand::Exit(code) => outcome.code != *code,
    }
}

#[test]
fn models_give_the_traces_that_they_ask_for() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    let mut paths: Vec<_> = fs::read_dir(folder).expect("models").flatten().map(|e| e.path()).collect();
    paths.sort();
    assert!(paths.len() > 40, "only {} models", paths.len());
    let mut wrong = Vec::new();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).expect("a model");
        let runs = demands(&text);
        assert!(!runs.is_empty(), "{name} asks for nothing");
        for (setting, demands) in runs {
            let outcome = run(&name, &text, &setting);
            assert!(!demands.is_empty(), "{name} asks for nothing");
            let failed: Vec<&Demand> = demands.iter().filter(|d| fails(d, &outcome)).collect();
            if !failed.is_empty() {
                wrong.push(format!("{name} {setting:?}: {failed:#?}\nexit {}\n{}", outcome.code, outcome.log));
            }
        }
    }
    assert!(wrong.is_empty(), "{} runs:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_seed_gives_the_same_bytes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    for name in ["broadcast_maximal.bip", "petri_net.bip", "clock_speed.bip", "paper_monitor.bip"] {
        let text = fs::read_to_string(folder.join(name)).expect("a model");
        let with_seed = |seed: u64| run(name, &text, &Setting { seed, limit: Some(100), ..Setting::default() }).log;
        assert_eq!(with_seed(5), with_seed(5), "{name}");
        assert!((0..20).any(|seed| with_seed(seed) != with_seed(99)), "{name}: chance chooses nothing");
    }
}
