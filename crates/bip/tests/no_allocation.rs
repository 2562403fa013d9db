//! After warm-up a step needs no memory: looking, choosing, making and settling.

mod support;

use allocation_counter::measure;
use lapwing_bip::{Engine, Host, Rules, Schedule, Scheduler, Standing, Value};
use support::{large, model};

/// No functions.
struct Nobody;

impl Host for Nobody {
    fn call(&mut self, _: u32, _: &mut [Value], _: Option<u32>) -> Result<Value, String> {
        Ok(Value::Unset)
    }
}

fn steps(engine: &mut Engine<Nobody>, scheduler: &mut Scheduler, count: usize) -> usize {
    let mut made = 0;
    for _ in 0..count {
        let is_open = engine.look() == Ok(Standing::Open);
        let Some((id, at)) = scheduler.choose(engine).filter(|_| is_open) else { break };
        if engine.make(id, at).is_err() || engine.settle(engine.now(), 0).is_ok_and(|v| !v.is_empty()) {
            break;
        }
        made += 1;
    }
    made
}

#[test]
fn a_step_allocates_nothing() {
    for asap in [true, false] {
        let model = model("large", &large::text(8, 3));
        let mut engine = Engine::new(model, Nobody, Rules::default()).unwrap_or_else(|f| panic!("{f}"));
        let mut scheduler = Scheduler::new(Schedule { asap, first_enabled: false }, 3);
        assert_eq!(steps(&mut engine, &mut scheduler, 3_000), 3_000);
        let mut made = 0;
        let info = measure(|| made = steps(&mut engine, &mut scheduler, 5_000));
        assert_eq!((made, info.count_total), (5_000, 0), "asap: {asap}");
    }
}
