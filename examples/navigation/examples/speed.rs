//! How fast the case study goes: `cargo run --release -p navigation --example speed [logical] [bip] [real]`.
//!
//! From the specification to the first thing that happens; logical time without codels; and what the engine takes of a processor in real time, beside
//! a loop by hand that sleeps from period to period and calls the same codels. Codels do next to nothing, so that what is left is the engine's.

#[path = "../../../crates/components/examples/support/hand.rs"]
mod hand;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration as Span, Instant};

use hand::{Task, Work, used};
use lapwing_components::{Answer, Call, Codels, Figures, Run, Setup, request};
use lapwing_genom::automata::{Settings, build};
use lapwing_genom::emit::{Input, bip};
use lapwing_genom::model::{Codel, CodelId, Component, Direction, Model, Object, Role, TaskId};
use lapwing_genom::{Disk, Options, load};
use lapwing_stream::Duration;

/// How long the machine's clock is watched, in seconds.
const REAL: i64 = 10;
/// How long logical time is, in seconds.
const LOGICAL: i64 = 600;

fn main() -> Result<(), String> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |part: &str| wanted.is_empty() || wanted.iter().any(|w| w == part);
    let begin = Instant::now();
    let model = read()?;
    println!("read in {:.1} ms", ms(begin));
    if is_wanted("logical") {
        logical(&model)?;
    }
    if is_wanted("bip") {
        as_bip(&model)?;
    }
    if is_wanted("real") {
        real(&model)?;
    }
    Ok(())
}

fn logical(model: &Arc<Model>) -> Result<(), String> {
    let begin = Instant::now();
    let mut run = start(model, LOGICAL, false, Codels::new())?;
    run.advance();
    println!("from the model to the first request: {:.1} ms", ms(begin));
    let begin = Instant::now();
    while run.advance().is_some() {}
    let took = begin.elapsed().as_secs_f64();
    let figures = run.figures();
    let moves = figures.moves as f64;
    println!(
        "logical time without codels: {LOGICAL} s in {took:.3} s, {:.0} times as fast; {} codels, {moves} moves, {:.0} ns each",
        LOGICAL as f64 / took,
        figures.calls,
        took * 1e9 / moves
    );
    Ok(())
}

fn real(model: &Arc<Model>) -> Result<(), String> {
    let works = works(model);
    let before = used();
    let run = start(model, REAL, true, idle(model, &works))?;
    let (run, meter) = run.carry_out(hand::Meter::default());
    let core = (meter.used - before) / REAL as f64;
    let figures = run.figures();
    let rate = figures.calls as f64 / REAL as f64;
    let late: u64 = figures.late.values().map(|c| c.times).sum();
    let worst = figures.late.values().map(|c| c.worst.nanos()).max().unwrap_or(0) as f64 / 1e6;
    println!(
        "real time: {:.2} % of a core for {rate:.0} codels a second, {:.1} us each; {} missed, {late} late, {worst:.1} ms at worst",
        100.0 * core,
        1e6 * core / rate,
        figures.all_missed()
    );
    let by_hand = hand::run(tasks(model, figures, &works), REAL);
    println!(
        "by hand: {:.2} % of a core for {:.0} codels a second, {:.1} us each; {} missed; the engine takes {:.1} times as much",
        100.0 * by_hand.core,
        by_hand.calls,
        1e6 * by_hand.core / by_hand.calls,
        by_hand.missed,
        (core / rate) / (by_hand.core / by_hand.calls)
    );
    Ok(())
}

fn ms(since: Instant) -> f64 {
    1e3 * since.elapsed().as_secs_f64()
}

fn read() -> Result<Arc<Model>, String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("robot_navigation.gen");
    let loaded = load(&Disk, &[file], &Options::default()).map_err(|(path, e)| format!("{}: {e}", path.display()))?;
    Ok(Arc::new(loaded.model))
}

fn start(model: &Arc<Model>, seconds: i64, is_real: bool, codels: Codels) -> Result<Run, String> {
    let duration = Some(Duration::from_nanos(seconds * 1_000_000_000));
    let mut run =
        Run::new(model.clone(), Setup { is_real, duration, ..Setup::default() }, codels).map_err(|e| e.to_string())?;
    let requests =
        request::file(model, run.types(), include_str!("../mission.txt")).map_err(|_| "the mission is wrong")?;
    requests.into_iter().for_each(|(time, request)| run.schedule(time, request));
    Ok(run)
}

/// The model in BIP: how long from the specification to one that is ready to run.
fn as_bip(model: &Arc<Model>) -> Result<(), String> {
    let begin = Instant::now();
    let loaded =
        load(&Disk, &[Path::new(env!("CARGO_MANIFEST_DIR")).join("robot_navigation.gen")], &Options::default())
            .map_err(|(_, e)| e.to_string())?;
    let system = build(model, Settings::default()).map_err(|e| e.to_string())?;
    let text = lapwing_bip::print(&bip(Input { system: &system, sources: &loaded.sources }));
    let written = ms(begin);
    let parsed = lapwing_bip::parse(lapwing_bip::FileId(0), &text);
    let checked = lapwing_bip::check(&parsed.package, &[]);
    let _running =
        checked.model(None).map_err(|faults| faults.iter().map(|f| f.message.clone()).collect::<String>())?;
    println!(
        "as BIP: {} lines written in {written:.1} ms, and read, checked and ready to run in {:.1} ms more",
        text.lines().count(),
        ms(begin) - written
    );
    Ok(())
}

/// What each codel does besides what it is called for.
type Works = BTreeMap<(usize, usize), Work>;

fn works(model: &Model) -> Works {
    let each =
        model.components.iter().enumerate().flat_map(|(c, component)| (0..component.codels.len()).map(move |n| (c, n)));
    let count = Arc::new(AtomicU64::new(0));
    let work = |at| {
        let count = count.clone();
        let work: Work = Arc::new(move || _ = count.fetch_add(1, Ordering::Relaxed));
        (at, work)
    };
    each.map(work).collect()
}

/// Codels that do their work, write what they may and go on.
fn idle(model: &Model, works: &Works) -> Codels {
    let mut all = Codels::new();
    for (number, component) in model.components.iter().enumerate() {
        for (place, codel) in component.codels.iter().enumerate().filter(|(_, c)| c.role != Role::Attribute) {
            let (event, ports) = (goes_on(codel), written(component, codel));
            let Some(work) = works.get(&(number, place)).cloned() else { continue };
            let does = move |call: &mut Call| {
                work();
                ports.iter().try_for_each(|port| call.write(port))?;
                Ok(event.clone())
            };
            all.add(&component.name, &codel.function, Arc::new(does));
        }
    }
    all
}

/// The same by hand: each task calls in every turn what the run has called in most turns of the task.
fn tasks(model: &Model, figures: &Figures, works: &Works) -> Vec<Task> {
    let mut all = Vec::new();
    for (number, component) in model.components.iter().enumerate() {
        for (id, task) in component.tasks.iter().enumerate() {
            let Some(period) = task.period_ns else { continue };
            let turns = figures.turns.get(&(number, TaskId(id))).copied().unwrap_or(0);
            let is_called = |(place, codel): &(usize, &Codel)| {
                let times = figures.took.get(&(number, CodelId(*place))).map_or(0, |count| count.times);
                component.task_of(codel) == Some(TaskId(id)) && times * 2 > turns
            };
            let called = component.codels.iter().enumerate().filter(is_called);
            let calls = called.filter_map(|(place, _)| works.get(&(number, place)).cloned()).collect();
            all.push(Task { period: Span::from_nanos(period), calls });
        }
    }
    all
}

fn goes_on(codel: &Codel) -> Answer {
    let events: Vec<String> = codel.yields().iter().map(|t| t.text()).collect();
    match events.iter().find(|e| *e != "ether").or(events.first()) {
        Some(event) => Answer::event(event),
        None => Answer::Ok,
    }
}

/// The ports that a codel may write.
fn written(component: &Component, codel: &Codel) -> Vec<String> {
    let is_port = |object: &Object| match object {
        Object::Port(port) => component.ports.get(port.0).is_some_and(|p| p.is_out && !p.multiple),
        _ => false,
    };
    let written = codel.parameters.iter().filter(|p| p.direction != Direction::In && is_port(&p.object));
    written.map(|p| p.name.clone()).collect()
}
