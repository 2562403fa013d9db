//! State diagrams: which state the robot is in, and whether it may go there.

use lapwing_engine::program::{Edge, Machine, MachineState};

use crate::code::{Block, Expr, Helper, Ty, Unit, call, elem, field, local, since};
use crate::past::Past;
use crate::positions::enter;
use crate::scene::{Scene, updated_slots};
use crate::value::bit;

/// A machine of more states is refused: they are counted in a byte, in which one number more says that it is in none of them.
pub(crate) const MOST_STATES: usize = u8::MAX as usize;

/// Writes a machine's function. Gives the fields that say that a queue was too short.
pub(crate) fn machine(scene: &Scene<'_>, number: usize, capacity: usize, unit: &mut Unit) -> Vec<String> {
    let plan = &scene.program.machines[number];
    let prefix = format!("m{number}");
    unit.field(&format!("{prefix}_state"), Ty::U8, (plan.initial as i64).into(), "The state of a machine.");
    let since = unit.field(&format!("{prefix}_since"), Ty::I64, 0.into(), "Since when it is in it.");
    unit.field(&format!("{prefix}_overstayed"), Ty::Bool, false.into(), "Whether that was too long, and told.");
    for slot in updated_slots(&plan.at) {
        let doc = "Whether a signal got a value since the machine looked last.";
        unit.field(&format!("{prefix}_updated_{slot}"), Ty::Bool, false.into(), doc);
    }
    let mut b = Block::default();
    let walked = unit.field(&format!("{prefix}_walked"), Ty::Bool, false.into(), "Whether there was a position.");
    let last = unit.field(&format!("{prefix}_last"), Ty::I64, 0.into(), "The stamp of the latest.");
    let running = enter(scene, &plan.at, &prefix, unit, &mut b);
    let (at, overflows, name) = (&plan.at, Vec::new(), prefix.clone());
    let mut past = Past { scene, at, prefix: name, machine: Some(number), capacity, running, overflows };
    past.run(unit, &mut b);
    b.when(!past.running.clone(), Block::leave);
    b.when(!walked.clone(), |b| b.set(&since, local("now")));
    b.set(&walked, true);
    b.set(&last, local("now"));
    if let Some(sample) = plan.sample {
        b.when(!bit(sample), Block::leave);
    }
    look(scene, plan, number, &mut b);
    unit.function(&prefix, "A machine looks, and moves.", &[("now", Ty::I64)], b);
    past.overflows
}

/// It chooses a state, and goes there.
fn look(scene: &Scene<'_>, plan: &Machine, number: usize, b: &mut Block) {
    let prefix = format!("m{number}");
    let state = field(format!("{prefix}_state"));
    let from = b.bind("from", Ty::U8, state.clone());
    let to = b.var("to", Ty::U8, staying(plan, &from));
    // The last that is set counts: the first listed whose condition holds.
    for (i, s) in plan.states.iter().enumerate().rev() {
        b.when(fits(scene, plan, i, s, &from), |b| b.set(&to, i as i64));
    }
    for slot in updated_slots(&plan.at) {
        b.set(&field(format!("{prefix}_updated_{slot}")), false);
    }
    b.when(to.clone().ne(&from), |b| go(scene, plan, number, b, &from, &to));
}

fn go(scene: &Scene<'_>, plan: &Machine, number: usize, b: &mut Block, from: &Expr, to: &Expr) {
    let prefix = format!("m{number}");
    let undefined = plan.states.len() as i64;
    let (state, since_field) = (field(format!("{prefix}_state")), field(format!("{prefix}_since")));
    let now = local("now");
    if plan.property != usize::MAX {
        let drawn =
            plan.edges.iter().map(|e| from.clone().eq(e.from as i64) & to.clone().eq(e.to as i64) & is_open(scene, e));
        let drawn = drawn.fold(Expr::Bool(false), |a, b| a | b) | from.clone().eq(undefined);
        let fail =
            |b: &mut Block| b.call("fail", vec![Expr::Int(plan.property as i64), 1.into(), now.clone(), now.clone()]);
        b.branch(to.clone().eq(undefined) | !drawn, fail, |b| {
            b.when(from.clone().ne(undefined), |b| b.add(&elem("met", Expr::Int(plan.property as i64)), 1))
        });
        for (i, s) in plan.states.iter().enumerate() {
            if let Some(least) = s.at_least {
                b.when(from.clone().eq(i as i64) & since(&now, &since_field).lt(least.nanos()), fail);
            }
        }
    }
    for (i, s) in plan.states.iter().enumerate() {
        let tell = |b: &mut Block, of: &Expr, event: Option<usize>| {
            if let Some(event) = event {
                b.when(of.clone().eq(i as i64), |b| b.set(&field(scene.event_field(event)), true));
            }
        };
        tell(b, from, s.left);
        tell(b, to, s.entered);
    }
    b.set(&state, to.clone());
    b.set(&since_field, now.clone());
    b.set(&field(format!("{prefix}_overstayed")), false);
}

/// The state that it keeps where no condition holds.
fn staying(plan: &Machine, from: &Expr) -> Expr {
    let undefined = Expr::Int(plan.states.len() as i64);
    if plan.states.iter().all(|s| s.when.is_none()) {
        return from.clone();
    }
    let stays = plan.states.iter().enumerate().filter(|(_, s)| s.when.is_none() || s.on.is_some() || plan.else_stay);
    let stays = stays.map(|(i, _)| from.clone().eq(i as i64)).fold(Expr::Bool(false), |a, b| a | b);
    stays.choose(from.clone(), undefined)
}

fn fits(scene: &Scene<'_>, plan: &Machine, i: usize, state: &MachineState, from: &Expr) -> Expr {
    if state.when.is_none() && state.on.is_none() {
        let leads = |e: &&Edge| e.to == i && (e.on.is_some() || e.when.is_some());
        let led = plan.edges.iter().filter(leads).map(|e| from.clone().eq(e.from as i64) & is_open(scene, e));
        return led.fold(Expr::Bool(false), |a, b| a | b);
    }
    let when = state.when.map_or(Expr::Bool(true), bit);
    let on = state.on.map_or(Expr::Bool(true), |e| field(scene.event_field(e)));
    when & on
}

fn is_open(scene: &Scene<'_>, edge: &Edge) -> Expr {
    let on = edge.on.map_or(Expr::Bool(true), |e| field(scene.event_field(e)));
    on & edge.when.map_or(Expr::Bool(true), bit)
}

/// Whether a machine's state has a longest stay, and since when it has been over at a time.
fn overstay(plan: &Machine, number: usize, at: &Expr, is_over: impl Fn(Expr, i64) -> Expr) -> Vec<(Expr, i64)> {
    let prefix = format!("m{number}");
    let here = |i: usize| field(format!("{prefix}_state")).eq(i as i64);
    let gone = since(at, &field(format!("{prefix}_since")));
    let stays = plan.states.iter().enumerate();
    stays
        .filter_map(|(i, s)| s.at_most.map(|most| (here(i) & is_over(gone.clone(), most.nanos()), most.nanos())))
        .collect()
}

fn waits(plan: &Machine, number: usize) -> Expr {
    let prefix = format!("m{number}");
    let started = match plan.at.alphabet {
        Some(_) => field(format!("{prefix}_walked")),
        None => field(format!("{prefix}_started")),
    };
    started & !field(format!("{prefix}_overstayed"))
}

/// Time has come to `now`: stays that ended before were too long.
pub(crate) fn expire(plan: &Machine, number: usize, b: &mut Block) {
    if plan.property == usize::MAX {
        return;
    }
    let since = field(format!("m{number}_since"));
    for (is_over, most) in overstay(plan, number, &local("now"), |gone, most| gone.gt(most)) {
        b.when(waits(plan, number) & is_over, |b| {
            b.set(&field(format!("m{number}_overstayed")), true);
            let at = call(Helper::Later, vec![since.clone(), most.into()]);
            b.call("fail", vec![Expr::Int(plan.property as i64), 1.into(), at, since.clone()]);
        });
    }
}

/// A stay that may still become too long is open, and missed where it is over with the trace.
pub(crate) fn tally(plan: &Machine, number: usize, b: &mut Block, open: &Expr, missed: &Expr) {
    let all = overstay(plan, number, &field("last"), |_, _| Expr::Bool(true));
    let over = overstay(plan, number, &field("last"), |gone, most| gone.ge(most));
    for ((is_limited, _), (is_over, _)) in all.into_iter().zip(over) {
        b.when(waits(plan, number) & is_limited, |b| b.set(open, 1));
        b.when(waits(plan, number) & is_over, |b| b.set(missed, true));
    }
}
