//! The simulator's robots and the specifications of `examples/turtlebot`: healthy ones are clean, faulty ones are caught, and the pages say so.

use std::fs;
use std::path::{Path, PathBuf};

use lapwing_sim::{Options, Scenario, Simulation};
use xtask::{generated, robots};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The page must have that part; with `BLESS` it gets it.
fn holds(page: &str, name: &str, part: &str) {
    generated::part_holds(&root().join(page), name, part, "robots").unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn healthy_robots_are_clean_and_faulty_ones_are_caught() {
    let runs = robots::runs(&root().join("examples/turtlebot")).unwrap_or_else(|e| panic!("{e}"));
    let wrong = robots::surprises(&runs);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let bugs = robots::bugs(&runs, |_| true);
    assert!(bugs.len() >= 18, "only {} bugs are caught: {bugs:?}", bugs.len());
    let by_patterns = robots::bugs(&runs, |property| robots::pattern(property).is_some());
    assert!(by_patterns.len() >= 12, "only {} bugs are caught by patterns: {by_patterns:?}", by_patterns.len());
    holds("examples/turtlebot/README.md", "table", &robots::table(&runs));
}

#[test]
fn the_scenario_of_the_page_is_one() {
    let page = fs::read_to_string(root().join("docs/simulator.md")).expect("the page can be read");
    let fences: Vec<&str> = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let [scenario, drone] = fences.as_slice() else { panic!("{} scenarios", fences.len()) };
    let whole = format!("{scenario}\n{drone}");
    let scenario = Scenario::parse("docs/simulator.md", &whole).unwrap_or_else(|e| panic!("{e}"));
    let mut run = Simulation::new(&scenario, &Options { seed: 1, ..Options::default() });
    assert!(std::iter::from_fn(|| run.advance()).count() > 1000);
}

#[test]
fn the_list_of_faults_is_up_to_date() {
    holds("docs/simulator.md", "faults", &robots::faults());
}
