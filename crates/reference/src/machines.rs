//! State diagrams (language reference, *Events and state diagrams*).

use crate::course::{Course, Needs};
use crate::obligations::{Episode, Tally};
use crate::piece::Piece;
use lapwing_check::checked::{EventSource, Expr, Kind, Machine, Spec};
use lapwing_stream::Time;

/// What a machine did in a piece.
#[derive(Default)]
pub(crate) struct MachineLog {
    initial: usize,
    /// Its moves, in order.
    moves: Vec<Move>,
    /// The positions at which it sampled, each with the number of samples seen by then.
    pub(crate) sampled: Vec<(i64, usize)>,
    /// Since when nobody knows where it stands, for it met with a value of a wrong kind.
    lost: Option<((Time, usize), String)>,
}

/// A move from one state to another; `None` is `undefined`.
struct Move {
    key: (Time, usize),
    from: Option<usize>,
    to: Option<usize>,
}

impl MachineLog {
    /// The state after what happened up to this instant.
    pub(crate) fn state_at(&self, key: (Time, usize)) -> Option<usize> {
        self.moves.iter().rev().find(|m| m.key <= key).map_or(Some(self.initial), |m| m.to)
    }

    /// Why nobody knows where it stands at this instant.
    pub(crate) fn is_lost_at(&self, key: (Time, usize)) -> Option<&str> {
        self.lost.as_ref().filter(|(since, _)| *since <= key).map(|(_, what)| what.as_str())
    }

    /// The events `left` and `entered` of this instant.
    pub(crate) fn moved_at(&self, key: (Time, usize), machine: usize, spec: &Spec) -> Vec<usize> {
        let moves: Vec<&Move> = self.moves.iter().filter(|m| m.key == key).collect();
        let occurs = |source: &EventSource| match source {
            EventSource::Left { machine: m, state } => {
                *m == machine && moves.iter().any(|step| step.from == Some(*state))
            }
            EventSource::Entered { machine: m, state } => {
                *m == machine && moves.iter().any(|step| step.to == Some(*state))
            }
            _ => false,
        };
        (0..spec.events.len()).filter(|&e| occurs(&spec.events[e].source)).collect()
    }
}

/// The expressions of a machine.
pub(crate) fn exprs(machine: &Machine) -> Vec<&Expr> {
    let states = machine.states.iter().filter_map(|s| s.when.as_ref());
    let edges = machine.edges.iter().filter_map(|e| e.when.as_ref());
    machine.sample.iter().chain(states).chain(edges).collect()
}

/// The events that a machine names outside its expressions.
fn named_events(machine: &Machine) -> Vec<usize> {
    let states = machine.states.iter().filter_map(|s| s.on);
    states.chain(machine.edges.iter().filter_map(|e| e.on)).collect()
}

/// The machines that something reads, by their state or by their events, and those that these read.
pub(crate) fn read_by(spec: &Spec, of: &[&Expr], machines: &[usize], alphabet: &[usize]) -> Vec<usize> {
    read_before(spec.machines.len(), spec, of, machines, alphabet)
}

/// The same among the machines before number `limit`: each reads only those before it, and itself.
fn read_before(limit: usize, spec: &Spec, of: &[&Expr], machines: &[usize], alphabet: &[usize]) -> Vec<usize> {
    let mut events = alphabet.to_vec();
    let mut read = machines.to_vec();
    for e in of {
        names(e, &mut events, &mut read);
    }
    read.extend(events.iter().filter_map(|&event| match spec.events[event].source {
        EventSource::Entered { machine, .. } | EventSource::Left { machine, .. } => Some(machine),
        _ => None,
    }));
    read.retain(|&m| m < limit);
    let mut all = read.clone();
    for machine in read {
        let earlier = &spec.machines[machine];
        all.extend(read_before(machine, spec, &exprs(earlier), &[], &named_events(earlier)));
    }
    all.sort_unstable();
    all.dedup();
    all
}

fn names(e: &Expr, events: &mut Vec<usize>, machines: &mut Vec<usize>) {
    match &e.kind {
        Kind::Event(event) | Kind::EventField { event, .. } => events.push(*event),
        Kind::InState { machine, .. } => machines.push(*machine),
        _ => {}
    }
    for child in e.children() {
        names(child, events, machines);
    }
}

/// What became of a machine's own property in a piece.
pub(crate) struct Run {
    pub(crate) tally: Tally,
    pub(crate) starts: bool,
    pub(crate) positions: usize,
    pub(crate) fault: Option<String>,
    /// Whether a longest stay ends exactly with the trace and the state was not left.
    pub(crate) unmet: bool,
}

/// What decides on the instants and the start of a machine.
pub(crate) fn needs(spec: &Spec, machine: usize) -> Needs<'_> {
    let described = &spec.machines[machine];
    Needs {
        exprs: exprs(described),
        reads: &described.reads,
        machines: read_before(machine, spec, &exprs(described), &[], &named_events(described)),
        alphabet: described.alphabet.as_deref(),
        slices: Vec::new(),
    }
}

/// Runs a machine. `logs` are those of the machines before it.
pub(crate) fn run<'a>(piece: &'a Piece<'a>, machine: usize, logs: &'a [MachineLog]) -> (MachineLog, Run) {
    let course = Course::new(piece, logs, &needs(piece.spec, machine));
    let machine = &piece.spec.machines[machine];
    course.own.borrow_mut().initial = machine.initial;

    let mut tally = Tally::default();
    let mut state = Some(machine.initial);
    let mut entered = (course.len() > 0).then(|| course.time(0));
    for k in 0..course.len() {
        let now = course.time(k);
        if let Some(at) = overstayed(machine, state, entered).filter(|at| *at < now) {
            tally.fail_since(entered.unwrap_or(at), at);
            // Once a stay.
            entered = None;
        }
        let position = k as i64;
        course.own.borrow_mut().lost = lost_at(&course, machine, k);
        if course.own.borrow().lost.is_some() {
            break;
        }
        if !machine.sample.as_ref().is_none_or(|when| course.holds(when, position)) {
            continue;
        }
        let next = choose(machine, state, &course, position);
        if next != state {
            judge_move(machine, state, next, &course, position, &mut tally);
            if left_early(machine, state, entered, now) {
                tally.fail(now);
            }
            if let Some(instant) = course.instant(position) {
                course.own.borrow_mut().moves.push(Move { key: instant.key(), from: state, to: next });
            }
            state = next;
            entered = Some(now);
        }
        if let Some(instant) = course.instant(position) {
            course.own.borrow_mut().sampled.push((position, instant.upto));
        }
    }
    // What may have been a further position was none that it could have used.
    if course.own.borrow().lost.is_none() {
        course.own.borrow_mut().lost = lost_at(&course, machine, course.len());
    }
    // At the end, a stay has been too long once time has gone beyond its limit.
    let limit = overstayed(machine, state, entered).filter(|_| course.own.borrow().lost.is_none());
    match limit {
        Some(at) if at < piece.last => tally.fail_since(entered.unwrap_or(at), at),
        Some(_) => tally.open += 1,
        None => {}
    }
    let unmet = limit.is_some_and(|at| at == piece.last);
    let (starts, positions, fault) = (course.starts(), course.len(), course.fault());
    tally.episodes.sort_by_key(|e: &Episode| (e.failed, e.began));
    (course.own.into_inner(), Run { tally, starts, positions, fault, unmet })
}

/// Since when nobody knows where a machine stands, if that is so at position `k`, and why.
fn lost_at(course: &Course<'_>, machine: &Machine, k: usize) -> Option<((Time, usize), String)> {
    let position = k as i64;
    let here = course.instant(position).map(|instant| instant.key());
    if here.is_some() {
        // All that it asks is computed, so that no value of a wrong kind goes unseen.
        exprs(machine).into_iter().for_each(|e| _ = course.holds(e, position));
        named_events(machine).into_iter().for_each(|event| _ = course.occurs(event, position));
    }
    let fault = course.spoilt().filter(|fault| fault.position <= k)?;
    Some((fault.before.map(|time| (time, 0)).or(here)?, fault.what))
}

/// The current state after a sample: the first listed whose condition holds.
fn choose(machine: &Machine, state: Option<usize>, course: &Course<'_>, k: i64) -> Option<usize> {
    let chosen = (0..machine.states.len()).find(|&s| {
        let candidate = &machine.states[s];
        let conditional = candidate.when.is_some() || candidate.on.is_some();
        if !conditional {
            return led_to(machine, state, s, course, k);
        }
        let when = candidate.when.as_ref().is_none_or(|when| course.holds(when, k));
        when && candidate.on.is_none_or(|event| course.occurs(event, k))
    });
    let stays = state.is_some_and(|s| machine.states[s].when.is_none() || machine.states[s].on.is_some());
    if chosen.is_some() {
        chosen
    } else if stays || machine.else_stay {
        state
    } else {
        None
    }
}

/// Whether an edge with an event or a condition of its own leads now from the current state to one without a condition.
fn led_to(machine: &Machine, state: Option<usize>, to: usize, course: &Course<'_>, k: i64) -> bool {
    machine.edges.iter().any(|edge| {
        Some(edge.from) == state
            && edge.to == to
            && (edge.on.is_some() || edge.when.is_some())
            && edge.on.is_none_or(|event| course.occurs(event, k))
            && edge.when.as_ref().is_none_or(|when| course.holds(when, k))
    })
}

/// A move along an edge is an obligation met, any other one failed; so is the entry into `undefined`, but not the way out of it.
fn judge_move(
    machine: &Machine,
    from: Option<usize>,
    to: Option<usize>,
    course: &Course<'_>,
    k: i64,
    tally: &mut Tally,
) {
    let now = course.time(k as usize);
    match (from, to) {
        (None, _) => {}
        (Some(_), None) => tally.fail(now),
        (Some(from), Some(to)) => {
            let legal = machine.edges.iter().any(|edge| {
                edge.from == from
                    && edge.to == to
                    && edge.on.is_none_or(|event| course.occurs(event, k))
                    && edge.when.as_ref().is_none_or(|when| course.holds(when, k))
            });
            if legal {
                tally.met += 1;
            } else {
                tally.fail(now);
            }
        }
    }
}

/// The time at which a stay becomes too long.
fn overstayed(machine: &Machine, state: Option<usize>, entered: Option<Time>) -> Option<Time> {
    Some(entered? + machine.states[state?].at_most?)
}

/// Whether a state is left before its shortest stay is over.
fn left_early(machine: &Machine, state: Option<usize>, entered: Option<Time>, now: Time) -> bool {
    let shortest = state.and_then(|s| machine.states[s].at_least);
    matches!((shortest, entered), (Some(d), Some(at)) if now.since(at) < d)
}
