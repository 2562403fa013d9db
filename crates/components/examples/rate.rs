//! What running components costs: `cargo run --release -p lapwing-components --example rate`.
//!
//! A set of components like a drone's, tasks at 1 kHz that pass a value on through ports, beside threads that call the same codels by hand.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use lapwing_components::{Answer, Call, Codels, Run, Setup, request};
use lapwing_genom::{Files, Model, Options, load};
use lapwing_stream::Duration;

#[path = "support/hand.rs"]
mod hand;

use hand::used;

/// How long the machine's clock is watched, in seconds.
const SECONDS: i64 = 5;
/// How many components there are in a row.
const COMPONENTS: usize = 5;

struct Text(String);

impl Files for Text {
    fn read(&self, _: &std::path::Path) -> std::io::Result<Vec<u8>> {
        Ok(self.0.clone().into_bytes())
    }
}

fn text() -> String {
    let one = |n: usize| {
        let before = n.checked_sub(1).map(|b| format!("port in double P{b};")).unwrap_or_default();
        let reads = n.checked_sub(1).map(|b| format!("port in P{b}, ")).unwrap_or_default();
        format!(
            "component C{n} {{ ids {{ double v; }}; {before} port out double P{n}; task t {{ period 1 ms; }};
               activity Go() {{ task t; codel<start> Step{n}({reads}ids inout v, port out P{n}) yield pause::start wcet 100 us; }}; }};\n"
        )
    };
    (0..COMPONENTS).map(one).collect()
}

fn codels(calls: &Arc<AtomicU64>) -> Codels {
    (0..COMPONENTS).fold(Codels::new(), |all, n| {
        let calls = calls.clone();
        all.on(&format!("C{n}"), &format!("Step{n}"), move |call: &mut Call| {
            calls.fetch_add(1, Ordering::Relaxed);
            let v = call.number("v")? + 1.0;
            call.set("v", v)?;
            call.set(&format!("P{n}"), v)?;
            call.write(&format!("P{n}"))?;
            Ok(Answer::event("pause::start"))
        })
    })
}

fn start(model: &Arc<Model>, seconds: i64, is_real: bool, calls: &Arc<AtomicU64>) -> Run {
    let duration = Some(Duration::from_nanos(seconds * 1_000_000_000));
    let setup = Setup { is_real, duration, ..Setup::default() };
    let mut run = Run::new(model.clone(), setup, codels(calls)).expect("components of a fair size");
    for n in 0..COMPONENTS {
        let request = request::request(model, run.types(), &format!("C{n}.Go()")).expect("a service of the components");
        run.request(request);
    }
    run
}

fn main() {
    let loaded = load(&Text(text()), &["t.gen".into()], &Options::default()).expect("the text can be read");
    let model = Arc::new(loaded.model);
    let calls = Arc::new(AtomicU64::new(0));

    let mut run = start(&model, 60, false, &calls);
    let begin = Instant::now();
    while run.advance().is_some() {}
    let took = begin.elapsed().as_secs_f64();
    let (count, moves) = (run.figures().calls as f64, run.figures().moves as f64);
    println!(
        "logical: 60 s in {took:.3} s, {:.0} times as fast; {count} codels, {moves} moves of automata",
        60.0 / took
    );
    println!("logical: {:.0} ns for each codel, {:.0} ns for each move", took * 1e9 / count, took * 1e9 / moves);

    let before = used();
    let run = start(&model, SECONDS, true, &calls);
    let (run, meter) = run.carry_out(hand::Meter::default());
    let core = (meter.used - before) / SECONDS as f64;
    let figures = run.figures();
    let (turns, missed): (u64, u64) = (figures.turns.values().sum(), figures.all_missed());
    let late: u64 = figures.late.values().map(|c| c.times).sum();
    let worst = figures.late.values().map(|c| c.worst.nanos()).max().unwrap_or(0) as f64 / 1e6;
    let each = |core: f64, calls: f64| 1e6 * core / calls;
    let rate = figures.calls as f64 / SECONDS as f64;
    println!(
        "real time: {SECONDS} s, {turns} turns, {missed} missed, {late} late by more than 1 ms, {worst:.1} ms at worst"
    );
    println!("real time: {:.1} % of a core, {:.1} us for each codel", 100.0 * core, each(core, rate));

    let task = |_| {
        let calls = calls.clone();
        let work: hand::Work = Arc::new(move || _ = calls.fetch_add(1, Ordering::Relaxed));
        hand::Task { period: std::time::Duration::from_millis(1), calls: vec![work] }
    };
    let by_hand = hand::run((0..COMPONENTS).map(task).collect(), SECONDS);
    println!(
        "by hand: {:.1} % of a core, {:.1} us for each codel, {} missed; the engine takes {:.1} times as much",
        100.0 * by_hand.core,
        each(by_hand.core, by_hand.calls),
        by_hand.missed,
        core / by_hand.core
    );
}
