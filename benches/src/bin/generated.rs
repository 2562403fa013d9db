//! `cargo run --release -p lapwing-benches --bin generated [steps]`: generated Rust against hand-written loops, on the workloads of the engine's bench, as
//! ratios of one run.
//!
//! Monitors are generated for every property and bound, put into one program beside the loops, and compiled by `rustc -O`; that program measures. Both
//! sides must count the same failures.

#[path = "../robot.rs"]
#[allow(dead_code)] // The other bench needs all of it.
mod robot;
#[path = "../timescales.rs"]
#[allow(dead_code)] // The other bench needs all of it.
mod timescales;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use lapwing_check::{TraceShape, check, load};
use lapwing_codegen::{Language, Options, generate};
use lapwing_diag::SourceMap;
use timescales::Property;

/// The bounds of W1, in steps.
const BOUNDS: [u32; 3] = [10, 100, 10_000];
/// How many open obligations a monitor has room for: as many as there are steps in the longest bound.
const CAPACITY: usize = 10_001;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let steps: usize = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(1_000_000);
    let folder = std::env::temp_dir().join(format!("lapwing-generated-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let measured = measure(&folder, steps);
    std::fs::remove_dir_all(&folder)?;
    measured
}

fn measure(folder: &Path, steps: usize) -> Result<(), Box<dyn std::error::Error>> {
    let (source, program) = (folder.join("bench.rs"), folder.join("bench"));
    std::fs::write(&source, text(steps))?;
    let mut rustc = Command::new("rustc");
    rustc.args(["--edition", "2024", "-C", "opt-level=3", "-C", "codegen-units=1", "-o"]).args([&program, &source]);
    if !rustc.status()?.success() {
        return Err("what was generated does not compile".into());
    }
    if Command::new(&program).status()?.success() { Ok(()) } else { Err("the two sides do not agree".into()) }
}

/// The program.
fn text(steps: usize) -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut modules, mut calls) = (String::new(), String::new());
    for property in Property::ALL {
        for bound in BOUNDS {
            let name = format!("{property:?}{bound}").to_lowercase();
            modules += &module(&name, &timescales::COLUMNS, "timescales", &[property.formula(bound)]);
            // Writing to a text cannot fail.
            let _ = writeln!(
                calls,
                "    let (p, b) = (timescales::Property::{property:?}, {bound});\n    \
                 let sat = compare(&p.satisfying(b, STEPS), |rows| p.by_hand(b, rows), {name}::run);\n    \
                 let rnd = compare(&timescales::random(STEPS), |rows| p.by_hand(b, rows), {name}::run);\n    \
                 println!(\"{{:<12}} {{:>6}}   {{sat}}   {{rnd}}\", \"{property:?}\", b);"
            );
        }
    }
    calls += "    println!(\"\\n{:<19}   {HEAD}\", \"W2\");\n    let log = robot::log(STEPS);\n";
    let mut sets: Vec<(String, String, Vec<robot::Question>)> = (0..4)
        .map(|i| (format!("{:?}", robot::FOUR[i]), format!("&robot::FOUR[{i}..{}]", i + 1), vec![robot::FOUR[i]]))
        .collect();
    sets.push(("Four".to_owned(), "&robot::FOUR".to_owned(), robot::FOUR.to_vec()));
    sets.push(("Hundred".to_owned(), "&robot::hundred()".to_owned(), robot::hundred()));
    for (number, (name, questions, all)) in sets.iter().enumerate() {
        let formulas: Vec<String> = all.iter().map(|question| question.formula()).collect();
        modules += &module(&format!("w2_{number}"), &robot::COLUMNS, "robot", &formulas);
        let _ = writeln!(
            calls,
            "    let both = compare(&log, |rows| ask({questions}, rows), w2_{number}::run);\n    \
             println!(\"{{:<19}}   {{both}}\", \"{name}\");"
        );
    }
    FRAME
        .replace("TIMESCALES", &here.join("timescales.rs").display().to_string())
        .replace("ROBOT", &here.join("robot.rs").display().to_string())
        .replace("STEPS_GIVEN", &steps.to_string())
        .replace("    CALLS", &calls)
        .replace("MODULES", &modules)
}

/// A generated monitor, and how it is fed.
fn module(name: &str, columns: &[&str], rows: &str, formulas: &[String]) -> String {
    let mut sources = SourceMap::default();
    let text: String = formulas.iter().enumerate().map(|(i, formula)| format!("p{i}: {formula}\n")).collect();
    let file = sources.add("bench.rv", text.clone());
    let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
    let shape = TraceShape {
        columns: columns.iter().map(|c| c.to_string()).collect(),
        schemaless: true,
        ..TraceShape::default()
    };
    let checked = check(&sources, &loaded, Some(&shape));
    assert!(!checked.has_errors(), "{text}: {:?}", checked.diagnostics);
    let options =
        Options { language: Language::Rust, name: name.to_owned(), capacity: CAPACITY, properties: Vec::new() };
    let made = generate(&checked.spec, "bench.rv", &options).unwrap_or_else(|refused| panic!("{text}: {refused:?}"));
    let mut sets = String::new();
    for member in &made.interface.members {
        let column = columns.iter().position(|column| *column == member.name).expect("it is a column");
        let has = member.has.as_ref().map(|has| format!("inputs.{has} = true; ")).unwrap_or_default();
        let _ = writeln!(sets, "        {has}inputs.{} = row[{column}];", member.name);
    }
    let code: String = made.files.iter().map(|(_, text)| text.as_str()).collect();
    format!("mod {name} {{\n{code}\n{}}}\n", RUN.replace("ROWS", rows).replace("SETS", &sets))
}

/// How many obligations fail; rows are a millisecond apart.
const RUN: &str = "
pub fn run(rows: &[super::ROWS::Row]) -> u64 {
    let mut monitor = Monitor::new();
    let mut inputs = Inputs::default();
    for (t, row) in rows.iter().enumerate() {
SETS        monitor.step(t as i64 * 1_000_000, &inputs);
    }
    monitor.end();
    (0..PROPERTIES.len()).map(|p| monitor.failures(p)).sum()
}
";

const FRAME: &str = r#"#![allow(dead_code, unused)]
#[path = "TIMESCALES"]
mod timescales;
#[path = "ROBOT"]
mod robot;

use std::hint::black_box;
use std::time::Instant;

const STEPS: usize = STEPS_GIVEN;
const ROUNDS: usize = 5;
const HEAD: &str = "    hand    made  ratio";

fn main() {
    println!("{STEPS} steps: nanoseconds a step by hand and by generated code, and their ratio\n");
    println!("{:<12} {:>6}   {HEAD}   {HEAD}", "W1: sat, rnd", "bound");
    CALLS
}

fn compare<Row>(rows: &[Row], by_hand: impl Fn(&[Row]) -> u64, made: impl Fn(&[Row]) -> u64) -> String {
    let per_step = |start: Instant| start.elapsed().as_secs_f64() * 1e9 / rows.len() as f64;
    let (mut hand, mut generated) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let bad = black_box(by_hand(black_box(rows)));
        hand = hand.min(per_step(start));
        let start = Instant::now();
        let failed = black_box(made(black_box(rows)));
        generated = generated.min(per_step(start));
        assert_eq!(bad, failed, "the loop by hand and the generated code disagree");
    }
    format!("{hand:>8.2} {generated:>7.2} {:>6.2}", generated / hand)
}

fn ask(questions: &[robot::Question], rows: &[robot::Row]) -> u64 {
    let mut hands: Vec<robot::ByHand> = questions.iter().map(|q| q.by_hand()).collect();
    for (t, row) in rows.iter().enumerate() {
        hands.iter_mut().for_each(|hand| hand.step(t as i64, row));
    }
    hands.iter().map(|hand| hand.bad).sum()
}

MODULES
"#;
