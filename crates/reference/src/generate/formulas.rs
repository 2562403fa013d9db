//! Specifications at random.

use super::rng::Rng;
use super::samples;
use super::term::{Sort, Term};
use super::{Case, Raw, Statement};
use lapwing_check::{TraceShape, TraceTopic};
use lapwing_stream::{Field, Schema, Time, Type};
use std::sync::Arc;

use Sort::{Formula, Ltl, Number, State};

/// A case at random, the same for the same seed; `size` is about the number of samples.
///
/// The vocabulary is always the same: columns `a b c x y`, topics `/m /f /scan /mode`, events `kick drop tick hit`, a machine `mach`.
pub fn generate(seed: u64, size: usize) -> Case {
    let mut rng = Rng::new(seed);
    // The first numbers of neighbouring seeds look alike.
    for _ in 0..3 {
        rng.below(2);
    }
    let rate = rng.percent(15);
    let machine = rng.percent(30);
    let mut statements = settings(&mut rng, rate);
    statements.extend(declarations(&mut rng));
    if machine {
        statements.push(machine_text(&mut rng));
    }

    let count = 1 + rng.below(3);
    let mut properties = Vec::new();
    let mut events_often = false;
    for n in 0..count {
        let alone = rng.percent(25);
        events_often |= alone;
        properties.push(property(&mut rng, n, alone, machine));
    }

    // Where little happens the engine passes over much: such traces are longer.
    let is_calm = rng.percent(30);
    let length = 1 + rng.below(size.max(1) * if is_calm { 2 } else { 1 });
    let stamps = samples::stamps(&mut rng, length);
    let mut trace: Vec<(Time, Raw)> = Vec::new();
    for (n, stamp) in stamps.into_iter().enumerate() {
        // Most traces begin with a value of everything, so that most properties start.
        let raw = match n {
            0 if rng.percent(85) => samples::row(&mut rng, true),
            1 if rng.percent(70) => samples::message_m(&mut rng),
            2 if rng.percent(70) => samples::message_f(&mut rng),
            3 | 4 if rng.percent(40) => samples::message_more(&mut rng),
            _ if is_calm && rng.percent(80) => samples::repeated(&mut rng, &trace),
            _ => samples::arrival(&mut rng, events_often),
        };
        trace.push((stamp, raw));
    }
    let broke_off = rng.percent(5).then(|| "the file ends early".to_string());
    Case { statements, properties, samples: trace, broke_off, shape: shape() }
}

fn shape() -> TraceShape {
    let number = || Type::Num { float: true };
    let topic = |topic: &str, name: &str, field: &str, ty: Type| {
        let fields = vec![Field { name: field.into(), ty }];
        let schema = Some(Arc::new(Schema { name: name.into(), fields, constants: vec![] }));
        TraceTopic { name: topic.into(), type_name: name.into(), schema }
    };
    TraceShape {
        topics: vec![
            topic("/m", "std_msgs/Float64", "data", number()),
            topic("/f", "std_msgs/Bool", "data", Type::Bool),
            topic("/scan", "sensor_msgs/LaserScan", "ranges", Type::Array(Box::new(number()))),
            topic("/mode", "std_msgs/String", "data", Type::Str),
        ],
        columns: ["a", "b", "c", "x", "y"].map(String::from).to_vec(),
        schemaless: true,
        columns_open: false,
        events: ["kick", "drop", "tick"].map(String::from).to_vec(),
        ..TraceShape::default()
    }
}

fn settings(rng: &mut Rng, rate: bool) -> Vec<String> {
    let mut all = Vec::new();
    if rate {
        all.push(format!("__rate__ = {}", rng.pick(&[1, 2, 3, 5, 10])));
    } else if rng.percent(10) {
        all.push("clock events".into());
    }
    if rng.percent(10) {
        all.push(format!("__timeout__ = {}", rng.pick(&["0.5", "1", "2"])));
    }
    if rng.percent(10) {
        all.push(format!("__margin__ = {}", rng.pick(&["0.5", "1"])));
    }
    all
}

fn declarations(rng: &mut Rng) -> Vec<String> {
    let default = if rng.percent(30) { " default 1" } else { "" };
    let stale = if rng.percent(5) { " stale after 500 ms" } else { "" };
    vec![
        format!("decl m /m Float64.data{default}{stale}"),
        format!("decl f /f Bool.data{}", if rng.percent(30) { " default false" } else { "" }),
        "decl ranges /scan LaserScan.ranges".into(),
        format!("decl mode /mode String.data{}", if rng.percent(50) { " default \"auto\"" } else { "" }),
        "event kick".into(),
        "event drop".into(),
        "event tick".into(),
        "event hit = message /m std_msgs/Float64 when data > 0".into(),
        "high = x > 1".into(),
        "calm = always (a or c)".into(),
    ]
}

fn machine_text(rng: &mut Rng) -> String {
    let sample = ["", "    sample when updated(x)\n", "    sample when updated(a) or tick\n"];
    let bound = ["", "", " at most 300 ms", " at least 200 ms"];
    let go = ["a", "x > 0", "becomes b", "age(/m) > 0.25"];
    let edge = ["", " when b", " on tick"];
    format!(
        "machine mach {{\n{}    initial idle\n    state go when {}{}\n    state halt on {}{}\n    state idle{}\n{}    \
         idle -> go\n    go -> halt{}\n    halt -> go | idle\n}}",
        rng.pick(&sample),
        rng.pick(&go),
        rng.pick(&bound),
        rng.pick(&["tick", "kick"]),
        rng.pick(&bound),
        rng.pick(&["", " when c"]),
        rng.pick(&["", "    else stay\n"]),
        rng.pick(&edge),
    )
}

fn property(rng: &mut Rng, n: usize, alone: bool, machine: bool) -> Statement {
    let mut words = if alone { events() } else { signals() };
    if machine {
        words.conditions.extend(["entered(mach.go)", "left(mach.go)"].map(String::from));
        if !alone {
            words.conditions.extend(["mach == go", "mach != idle"].map(String::from));
        }
    }
    let each = rng.percent(if alone { 25 } else { 15 });
    let over = if alone && rng.percent(60) {
        format!(" over ({})", rng.pick(&["kick, tick", "kick", "tick, drop, hit"]))
    } else {
        String::new()
    };
    let each = if each { *rng.pick(&[" for each k of kick.robot:", " for each k of drop.robot:"]) } else { "" };
    let head = format!("property p{n}{over}:{each}");
    let depth = 1 + rng.below(4);
    let body = if rng.percent(10) {
        Term::node(Formula, "ltl(#)", vec![ltl(rng, &words, depth)])
    } else {
        formula(rng, &words, depth)
    };
    Statement { head, body }
}

/// What a formula may speak of.
struct Words {
    conditions: Vec<String>,
    numbers: Vec<String>,
    /// Whether topics may be named.
    topics: bool,
    /// Names for `ltl(…)`.
    names: Vec<String>,
}

fn signals() -> Words {
    let owned = |list: &[&str]| list.iter().map(ToString::to_string).collect();
    Words {
        conditions: owned(&["a", "b", "a", "b", "c", "f", "high", "kick", "hit", "kick.power > 1", "x > 1", "x != y"]),
        numbers: owned(&["x", "y", "m", "0", "1", "2.5"]),
        topics: true,
        names: owned(&["a", "b", "kick"]),
    }
}

fn events() -> Words {
    let owned = |list: &[&str]| list.iter().map(ToString::to_string).collect();
    Words {
        conditions: owned(&["kick", "tick", "drop", "hit", "kick", "tick", "kick.power > 1", "kick.power != 1"]),
        numbers: owned(&["kick.power", "1", "2"]),
        topics: false,
        names: owned(&["kick", "tick", "drop"]),
    }
}

/// Any formula.
fn formula(rng: &mut Rng, words: &Words, depth: usize) -> Term {
    if depth == 0 {
        // Now and then the named formula stands in place of a state.
        let named = words.topics && rng.percent(5);
        return if named { Term::atom(Formula, "calm") } else { state(rng, words, 1) };
    }
    let next = depth - 1;
    let two = |rng: &mut Rng, text: String| {
        let parts = vec![formula(rng, words, next), formula(rng, words, next)];
        Term::node(Formula, text, parts)
    };
    match rng.below(20) {
        0 => state(rng, words, 2),
        1 => Term::node(Formula, "(not #)", vec![formula(rng, words, next)]),
        2 | 3 => two(rng, "(# and #)".into()),
        4 => two(rng, format!("(# {} #)", ["or", "implies", "iff"][depth % 3])),
        5 => {
            let text = format!("(always{} #)", bound(rng, true));
            Term::node(Formula, text, vec![formula(rng, words, next)])
        }
        6 => Term::node(Formula, "(never #)", vec![formula(rng, words, next)]),
        7 | 8 => {
            let text = format!("(eventually{} #)", bound(rng, false));
            Term::node(Formula, text, vec![formula(rng, words, next)])
        }
        9 => Term::node(Formula, "(next #)", vec![formula(rng, words, next)]),
        10 => {
            let text = format!("(# until{} #)", bound(rng, false));
            two(rng, text)
        }
        n => {
            // The X of a scope is nearly always a state.
            let x = if rng.percent(92) { state(rng, words, 1) } else { formula(rng, words, 1) };
            let body = formula(rng, words, next);
            match n {
                11 => Term::node(Formula, "(after #, #)", vec![x, body]),
                12 => Term::node(Formula, "(until #, #)", vec![x, body]),
                13 => Term::node(Formula, "(before #, #)", vec![x, body]),
                14 | 15 => Term::node(Formula, "(while #, #)", vec![x, body]),
                16 | 17 => Term::node(Formula, "(whenever #, #)", vec![x, body]),
                _ => {
                    let y = state(rng, words, 1);
                    Term::node(Formula, "(after_until #, #, #)", vec![x, y, body])
                }
            }
        }
    }
}

/// A condition without future operators.
fn state(rng: &mut Rng, words: &Words, depth: usize) -> Term {
    if depth == 0 || rng.percent(40) {
        let word = rng.pick(&words.conditions).clone();
        return Term::atom(State, if word.contains(' ') { format!("({word})") } else { word });
    }
    let next = depth - 1;
    let one = |rng: &mut Rng, text: String| Term::node(State, text, vec![state(rng, words, next)]);
    let two =
        |rng: &mut Rng, text: String| Term::node(State, text, vec![state(rng, words, next), state(rng, words, next)]);
    match rng.below(16) {
        0 => one(rng, "(not #)".into()),
        1 => two(rng, "(# and #)".into()),
        2 => two(rng, "(# or #)".into()),
        3 => one(rng, "(previously #)".into()),
        4 => one(rng, "(becomes #)".into()),
        5 => {
            let text = format!("(once{} #)", bound(rng, false));
            one(rng, text)
        }
        6 => {
            let text = format!("(historically{} #)", bound(rng, true));
            one(rng, text)
        }
        7 => {
            let text = format!("(# since{} #)", bound(rng, false));
            two(rng, text)
        }
        8 | 9 => {
            let text = format!("(held for {} #)", duration(rng));
            one(rng, text)
        }
        10 if words.topics => Term::atom(
            State,
            match rng.below(4) {
                0 => "fresh(/m)".into(),
                1 => format!("(frequency(/m, {}) > 2)", rng.pick(&["300 ms", "1 s"])),
                2 => format!("({} > age(/m))", rng.pick(&["0.2", "0.25", "0.1 + 0.2"])),
                _ => format!(
                    "(age(/m) {} {})",
                    rng.pick(&["<", "<=", ">", ">=", "=={0.05}", "=="]),
                    rng.pick(&["0.2", "0.15", "0.3"])
                ),
            },
        ),
        11 if words.topics && rng.percent(50) => {
            let texts = [
                "(mode == \"auto\")",
                "starts_with(mode, \"a\")",
                "(min(ranges) < 1)",
                "any(ranges, v => v > 1)",
                "all(ranges, v => v >= 0.5)",
            ];
            Term::atom(State, *rng.pick(&texts))
        }
        11 => one(rng, format!("@{{#, -{}}}", 1 + depth % 2)),
        _ => {
            let op = *rng.pick(&["==", "!=", "<", "<=", ">", ">=", "=={0.5}", "!={0.5}", "<{1}", ">={0.5}"]);
            let parts = vec![number(rng, words, next), number(rng, words, next)];
            Term::node(State, format!("(# {op} #)"), parts)
        }
    }
}

fn number(rng: &mut Rng, words: &Words, depth: usize) -> Term {
    if depth == 0 || rng.percent(50) {
        return Term::atom(Number, rng.pick(&words.numbers).clone());
    }
    let next = depth - 1;
    let one = |rng: &mut Rng, text: &str| Term::node(Number, text, vec![number(rng, words, next)]);
    let two =
        |rng: &mut Rng, text: &str| Term::node(Number, text, vec![number(rng, words, next), number(rng, words, next)]);
    match rng.below(14) {
        0 => one(rng, "(- #)"),
        1 => one(rng, "abs(#)"),
        2 => two(rng, "(# + #)"),
        3 => two(rng, "(# - #)"),
        4 => two(rng, "(# * #)"),
        5 => two(rng, "(# / #)"),
        6 => two(rng, "max(#, #)"),
        7 => two(rng, "min(#, #)"),
        8 => one(rng, "@{#, -1}"),
        9 => one(rng, "delta(#)"),
        10 => one(rng, "rate(#)"),
        11 if words.topics && rng.percent(40) => {
            Term::atom(Number, *rng.pick(&["max(ranges)", "len(ranges)", "ranges[1]", "len(mode)"]))
        }
        12 if rng.percent(50) => {
            let text = *rng.pick(&["norm(#, #)", "angle_diff(#, #)", "atan2(#, #)"]);
            two(rng, text)
        }
        11 => Term::node(Number, format!("count(#, {})", duration(rng)), vec![state(rng, words, next)]),
        n => {
            let window = ["min_over", "max_over", "mean_over"][n % 3];
            let text = format!("{window}(#, {})", duration(rng));
            one(rng, &text)
        }
    }
}

/// A part of `ltl(…)`.
fn ltl(rng: &mut Rng, words: &Words, depth: usize) -> Term {
    if depth == 0 {
        return Term::atom(Ltl, rng.pick(&words.names).clone());
    }
    let next = depth - 1;
    let past = depth == 1;
    let text = match rng.below(12) {
        0 | 1 => "([] #)",
        2 => "(<> #)",
        3 => "(o #)",
        4 => "(X #)",
        5 => "(# U #)",
        6 => "(# => #)",
        7 => "(# and #)",
        8 => "(! #)",
        9 if past => "(<*> #)",
        10 if past => "([*] #)",
        11 if past => "(# S #)",
        _ => "(# or #)",
    };
    let parts = text.matches('#').map(|_| ltl(rng, words, next)).collect();
    Term::node(Ltl, text, parts)
}

fn duration(rng: &mut Rng) -> &'static str {
    const ALL: [&str; 6] = ["100 ms", "200 ms", "0.3 s", "500 ms", "150 ms", "1 s"];
    ALL[rng.below(ALL.len())]
}

/// A bound, or none. `plain` allows `for d` in place of `within d`.
fn bound(rng: &mut Rng, plain: bool) -> String {
    match rng.below(10) {
        0..4 => String::new(),
        4 if plain => format!(" for {}", duration(rng)),
        4..8 => format!(" within {}", duration(rng)),
        _ => {
            let lo = rng.below(3) * 100;
            let hi = lo + 100 * rng.below(4);
            let (left, right) = (rng.pick(&["[", "("]), *rng.pick(&["]", ")"]));
            format!(" within {left}{lo} ms, {hi} ms{right}")
                .replace(&format!("{left}0 ms"), &format!("{left}0 s"))
                .replace(", 0 ms", ", 0 s")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_always_gives_the_same_case() {
        // NaN is not equal to itself, its text is.
        assert_eq!(format!("{:?}", generate(7, 20)), format!("{:?}", generate(7, 20)));
        assert_ne!(generate(7, 20).text(), generate(8, 20).text());
    }
}
