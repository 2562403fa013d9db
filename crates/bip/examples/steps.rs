//! `cargo run --release -p lapwing-bip --example steps [TASKS] [ACTIVITIES]`: how long a large model takes from its text to its first
//! state, and how long a step takes.

#[path = "../tests/support/large.rs"]
mod large;

use lapwing_bip::{Engine, FileId, Host, Rules, Schedule, Scheduler, Standing, Value, check, parse};
use std::sync::Arc;
use std::time::Instant;

/// No functions.
struct Nobody;

impl Host for Nobody {
    fn call(&mut self, _: u32, _: &mut [Value], _: Option<u32>) -> Result<Value, String> {
        Ok(Value::Unset)
    }
}

fn main() {
    let argument = |n: usize, default: usize| std::env::args().nth(n).and_then(|a| a.parse().ok()).unwrap_or(default);
    let text = large::text(argument(1, 20), argument(2, 5));
    let start = Instant::now();
    let parsed = parse(FileId(0), &text);
    let parsed_in = start.elapsed();
    let checked = check(&parsed.package, &[]);
    let model = match checked.model(None) {
        Ok(model) => Arc::new(model),
        Err(faults) => return faults.iter().for_each(|f| eprintln!("{}", f.message)),
    };
    let made_in = start.elapsed();
    let (atoms, interactions) = (model.atoms().len(), model.interactions());
    println!(
        "{} lines, {atoms} atoms, {interactions} interactions: parsed in {parsed_in:?}, a model in {made_in:?}",
        text.lines().count()
    );
    for asap in [true, false] {
        let Ok(mut engine) = Engine::new(Arc::clone(&model), Nobody, Rules::default()) else { return };
        let mut scheduler = Scheduler::new(Schedule { asap, first_enabled: false }, 1);
        let (start, mut steps) = (Instant::now(), 0_u32);
        while steps < 1_000_000 && engine.look() == Ok(Standing::Open) {
            let Some((id, at)) = scheduler.choose(&engine) else { break };
            if engine.make(id, at).is_err() || engine.settle(engine.now(), 0).is_err() {
                break;
            }
            steps += 1;
        }
        let took = start.elapsed();
        let ratio = engine.now().0 as f64 / took.as_nanos() as f64;
        println!(
            "asap {asap}: {steps} steps, {} ns each, up to {}: {ratio:.1} times real time",
            took.as_nanos() / u128::from(steps.max(1)),
            engine.now()
        );
    }
}
