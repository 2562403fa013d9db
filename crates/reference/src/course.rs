//! What one property or machine sees of a piece: its own instants, its position 0, and the value of every expression without
//! future operators at each position (language reference, *Traces, instants, values*, *Expressions* and the past operators of
//! *Temporal operators*).

use crate::future::View;
use crate::instants;
use crate::machines::MachineLog;
use crate::piece::{Instant, Occurrence, Piece};
use crate::truth::Truth;
use crate::values::{self, Computed};
use lapwing_check::checked::{self, Bound, Connective, EventSource, Expr, Kind, ReadOf, Window};
use lapwing_stream::{Duration, Time, Type, Value};
use std::cell::RefCell;
use std::collections::HashMap;

/// The course of a piece for one property, instance of a property, or machine.
pub(crate) struct Course<'a> {
    pub(crate) piece: &'a Piece<'a>,
    /// Its own instants, those before its start included.
    pub(crate) instants: Vec<Instant>,
    /// The events that occur at each.
    occurred: Vec<Vec<Occurrence>>,
    /// Those of which nobody can tell whether they occur, and why.
    unclear: Vec<Vec<(usize, String)>>,
    /// The instant that is position 0; `None` where it never starts.
    start: Option<usize>,
    /// The values of the slices around it.
    params: Vec<Value>,
    /// What the machines have done.
    logs: &'a [MachineLog],
    /// For a machine: what it has done so far itself.
    pub(crate) own: RefCell<MachineLog>,
    /// Where a value of a wrong kind was met with first.
    fault: RefCell<Option<Fault>>,
    /// Values already computed, by expression and position.
    known: RefCell<HashMap<(*const Expr, i64), Value>>,
    /// Truth values already found, by formula, position and what is seen.
    pub(crate) found: RefCell<HashMap<(*const Expr, usize, View), Truth>>,
}

/// Where what is said comes to rest on a value of a wrong kind.
#[derive(Clone, Debug)]
pub(crate) struct Fault {
    /// The first position that is spoilt.
    pub(crate) position: usize,
    /// Where that is none yet: when it would have been. What is due then is not decided any more.
    pub(crate) before: Option<Time>,
    /// What is wrong.
    pub(crate) what: String,
}

/// What decides on the instants and the start of a property or a machine.
pub(crate) struct Needs<'a> {
    /// All its expressions.
    pub(crate) exprs: Vec<&'a Expr>,
    /// What must be defined.
    pub(crate) reads: &'a [checked::Read],
    /// The machines that it reads by their state.
    pub(crate) machines: Vec<usize>,
    /// The events that make its positions, where it is over events alone.
    pub(crate) alphabet: Option<&'a [usize]>,
    /// The slices around it, each with its value.
    pub(crate) slices: Vec<(&'a checked::Slice, Value)>,
}

impl<'a> Course<'a> {
    pub(crate) fn new(piece: &'a Piece<'a>, logs: &'a [MachineLog], needs: &Needs<'a>) -> Course<'a> {
        let params: Vec<Value> = needs.slices.iter().map(|(_, v)| v.clone()).collect();
        let mut instants = instants::of(piece, needs);
        let occurrences = |i: &Instant| occurring(piece, logs, &needs.slices, i);
        let mut occurred: Vec<Vec<Occurrence>> = instants.iter().map(occurrences).collect();
        let mut unclear: Vec<Vec<(usize, String)>> = instants.iter().map(|i| unclear_at(piece, logs, i)).collect();
        let mut fault = None;
        if let Some(alphabet) = needs.alphabet {
            let steps = |o: &Vec<Occurrence>| o.iter().any(|o| alphabet.contains(&o.event));
            // What may have been a position spoils all that was to be decided from there on.
            let spoils = |u: &Vec<(usize, String)>| u.iter().find(|(event, _)| alphabet.contains(event)).cloned();
            fault = unclear.iter().enumerate().find_map(|(i, u)| Some((i, spoils(u)?.1))).map(|(i, what)| Fault {
                position: occurred[..i].iter().filter(|o| steps(o)).count(),
                before: Some(instants[i].time),
                what,
            });
            let mut keep = occurred.iter().map(steps);
            unclear.retain(|_| keep.next().unwrap_or(false));
            let mut keep = occurred.iter().map(steps);
            instants.retain(|_| keep.next().unwrap_or(false));
            occurred.retain(steps);
        }
        let start = match needs.alphabet {
            Some(_) => Some(0),
            None => (0..instants.len()).find(|&i| needs.reads.iter().all(|read| defined(piece, &instants, i, read))),
        };
        Course {
            piece,
            instants,
            occurred,
            unclear,
            start,
            params,
            logs,
            own: RefCell::default(),
            fault: RefCell::new(fault),
            known: RefCell::default(),
            found: RefCell::default(),
        }
    }

    /// A single instant with a single event: where an event's own condition is tested.
    pub(crate) fn alone(piece: &'a Piece<'a>, instant: Instant, occurrence: Occurrence) -> Course<'a> {
        Course {
            piece,
            instants: vec![instant],
            occurred: vec![vec![occurrence]],
            unclear: vec![Vec::new()],
            start: Some(0),
            params: Vec::new(),
            logs: &[],
            own: RefCell::default(),
            fault: RefCell::default(),
            known: RefCell::default(),
            found: RefCell::default(),
        }
    }

    /// No instant at all: where constants are computed.
    pub(crate) fn constants(piece: &'a Piece<'a>, params: Vec<Value>) -> Course<'a> {
        let nowhere = Instant { time: Time(0), from: 0, upto: 0 };
        let nothing = Occurrence { event: usize::MAX, values: Vec::new() };
        Course { params, ..Course::alone(piece, nowhere, nothing) }
    }

    /// Whether it ever starts: something over events alone does so with the trace.
    pub(crate) fn starts(&self) -> bool {
        self.start.is_some()
    }

    /// The number of positions.
    pub(crate) fn len(&self) -> usize {
        self.start.map_or(0, |start| self.instants.len() - start)
    }

    /// The stamp of a position.
    pub(crate) fn time(&self, k: usize) -> Time {
        self.instants[self.start.unwrap_or(0) + k].time
    }

    /// What is wrong with the first value of a wrong kind.
    pub(crate) fn fault(&self) -> Option<String> {
        self.fault.borrow().as_ref().map(|fault| fault.what.clone())
    }

    /// Where a value of a wrong kind was met with first: what is not decided before it is not judged.
    pub(crate) fn spoilt(&self) -> Option<Fault> {
        self.fault.borrow().clone()
    }

    /// Whether a formula without future operators holds at position `k`. Before position 0 only lookback gets.
    pub(crate) fn holds(&self, e: &Expr, k: i64) -> bool {
        self.condition(e, k, &[])
    }

    /// The value of an expression at position `k`.
    pub(crate) fn value(&self, e: &Expr, k: i64) -> Value {
        self.eval(e, k, &[])
    }

    /// The instant of position `k`; of one before position 0 where there is one.
    pub(crate) fn instant(&self, k: i64) -> Option<&Instant> {
        self.instants.get(self.index(k)?)
    }

    fn index(&self, k: i64) -> Option<usize> {
        usize::try_from(self.start? as i64 + k).ok()
    }

    /// Whether an event occurs at position `k`.
    pub(crate) fn occurs(&self, event: usize, k: i64) -> bool {
        self.occurrence(event, k).is_some()
    }

    /// The value at position 0 of a course that has none: no event occurs, there is no past, and the trace is over.
    pub(crate) fn without_position(&self, f: &Expr) -> Truth {
        if f.has_future() { self.truth(f, 0, self.whole()) } else { Truth::True }
    }

    /// Computes every expression at every position, so that no value of a wrong kind goes unseen.
    pub(crate) fn compute_everything(&self, e: &Expr) {
        if !e.has_future() {
            (0..self.len()).for_each(|k| drop(self.value(e, k as i64)));
        }
        // The body of `any` and `all` is computed with its elements.
        if !matches!(e.kind, Kind::Quantified { .. }) {
            e.children().into_iter().for_each(|child| self.compute_everything(child));
        }
    }

    fn occurrence(&self, event: usize, k: i64) -> Option<&Occurrence> {
        let unclear = self.index(k).and_then(|i| self.unclear.get(i)?.iter().find(|(e, _)| *e == event));
        if let Some((_, what)) = unclear {
            self.remember(what.clone(), k);
        }
        // Of several the last one's fields are seen.
        self.occurred.get(self.index(k)?)?.iter().rev().find(|o| o.event == event)
    }

    fn eval(&self, e: &Expr, k: i64, vars: &[Value]) -> Value {
        let key = (std::ptr::from_ref(e), k);
        if vars.is_empty()
            && let Some(value) = self.known.borrow().get(&key)
        {
            return value.clone();
        }
        let value = self.compute(e, k, vars);
        if vars.is_empty() {
            self.known.borrow_mut().insert(key, value.clone());
        }
        value
    }

    /// The table of expressions and past operators. Both sides are always computed, so that a fault on either is seen.
    fn compute(&self, e: &Expr, k: i64, vars: &[Value]) -> Value {
        let eval = |e: &Expr| self.eval(e, k, vars);
        let holds = |e: &Expr| self.condition(e, k, vars);
        match &e.kind {
            Kind::Num(x) => Value::Num(*x),
            Kind::Bool(b) => Value::Bool(*b),
            Kind::Str(s) => Value::Str(s.clone()),
            Kind::Input(input) => self.input(*input, k),
            Kind::Event(event) => Value::Bool(self.occurrence(*event, k).is_some()),
            Kind::EventField { event, field } => {
                self.occurrence(*event, k).and_then(|o| o.values.get(*field)).cloned().unwrap_or_default()
            }
            Kind::InState { machine, state } => Value::Bool(self.state_of(*machine, k) == *state),
            Kind::Updated(inputs) => Value::Bool(self.updated(inputs, k)),
            Kind::Param(slice) => self.params.get(*slice).cloned().unwrap_or_default(),
            Kind::Var(n) => vars.iter().rev().nth(*n).cloned().unwrap_or_default(),
            Kind::Field(record, name) => eval(record).field(name).cloned().unwrap_or_default(),
            Kind::Index(array, at) => self.or_fault(values::index(&eval(array), *at, is_number(e)), e, k),
            Kind::Truth(inner) => self.or_fault(values::truth(&eval(inner)).map(Value::Bool), e, k),
            Kind::Neg(inner) => {
                self.or_fault(values::arithmetic(checked::Arith::Sub, &Value::Num(-0.0), &eval(inner)), e, k)
            }
            Kind::Arith(op, left, right) => self.or_fault(values::arithmetic(*op, &eval(left), &eval(right)), e, k),
            Kind::Compare { op, margin, left, right } => {
                let margin = margin.as_ref().map_or(Value::Num(0.0), |m| eval(m));
                self.or_fault(values::compare(*op, &margin, &eval(left), &eval(right)).map(Value::Bool), e, k)
            }
            Kind::Not(inner) => Value::Bool(!holds(inner)),
            Kind::Connective(op, left, right) => Value::Bool(connect(*op, holds(left), holds(right))),
            Kind::Call(func, args) => {
                let args: Vec<Value> = args.iter().map(eval).collect();
                self.or_fault(values::call(*func, &args, is_number(e)), e, k)
            }
            Kind::Quantified { all, array, body } => self.quantified(*all, &eval(array), body, k, vars),
            Kind::Lookback(inner, depth) => self.eval(inner, k - *depth as i64, vars),
            Kind::Delta(inner) => self.delta(inner, k, vars),
            Kind::Rate(inner) => self.rate(inner, k, vars),
            Kind::Window(window, inner, d) => self.window(*window, inner, *d, k, vars),
            Kind::Age(topic) => self.age(*topic, k),
            Kind::Frequency(topic, d) => self.frequency(*topic, *d, k),
            Kind::Fresh(topic) => Value::Bool(self.fresh(*topic, k)),
            Kind::Previously(inner) => Value::Bool(self.previously(inner, k, vars)),
            Kind::Becomes(inner) => Value::Bool(self.becomes(inner, k, vars)),
            Kind::Once(bound, inner) => Value::Bool(self.once(bound, inner, k, vars)),
            Kind::Historically(bound, inner) => Value::Bool(self.historically(bound, inner, k, vars)),
            Kind::Since(bound, left, right) => Value::Bool(self.since(bound, left, right, k, vars)),
            Kind::Held(d, inner) => Value::Bool(self.held(*d, inner, k, vars)),
            Kind::Always(..) | Kind::Eventually(..) | Kind::Next(_) | Kind::Until(..) => self.no_state(),
            Kind::Scope(..) | Kind::AfterUntil(..) => self.no_state(),
        }
    }

    /// The checker lets no future operator below an expression or a past operator.
    fn no_state(&self) -> Value {
        self.remember("a future operator stands inside an expression".into(), 0);
        Value::Missing
    }

    fn condition(&self, e: &Expr, k: i64, vars: &[Value]) -> bool {
        values::condition(&self.eval(e, k, vars)).unwrap_or_else(|fault| {
            self.remember(fault.0, k);
            false
        })
    }

    /// What cannot be computed counts as NaN or false, and is remembered.
    fn or_fault(&self, computed: Computed<Value>, e: &Expr, k: i64) -> Value {
        computed.unwrap_or_else(|fault| {
            self.remember(fault.0, k);
            if e.ty == Type::Bool { Value::Bool(false) } else { Value::Num(f64::NAN) }
        })
    }

    /// Remembers a fault, unless there is one at an earlier position.
    fn remember(&self, fault: String, k: i64) {
        let Ok(position) = usize::try_from(k) else { return };
        let mut first = self.fault.borrow_mut();
        if first.as_ref().is_none_or(|known| position < known.position) {
            *first = Some(Fault { position, before: None, what: fault });
        }
    }

    // What is read.

    /// The latest value; before the piece began, the default.
    fn input(&self, input: usize, k: i64) -> Value {
        let upto = self.instant(k).map_or(0, |i| i.upto);
        self.piece.latest[upto].get(input).cloned().flatten().unwrap_or_default()
    }

    fn state_of(&self, machine: usize, k: i64) -> Option<usize> {
        let own = self.own.borrow();
        let log = self.logs.get(machine).unwrap_or(&own);
        match self.instant(k) {
            Some(instant) => {
                if let Some(what) = log.is_lost_at(instant.key()) {
                    self.remember(what.to_owned(), k);
                }
                log.state_at(instant.key())
            }
            None => Some(self.piece.spec.machines[machine].initial),
        }
    }

    /// Whether one of the inputs got a value since the machine's last sample before position `k`.
    fn updated(&self, inputs: &[usize], k: i64) -> bool {
        let Some(upto) = self.instant(k).map(|i| i.upto) else { return false };
        let from = self.own.borrow().sampled.iter().rev().find(|(at, _)| *at < k).map_or(0, |(_, upto)| *upto);
        self.piece.updated[from..upto.max(from)].iter().flatten().any(|n| inputs.contains(n))
    }

    /// The seconds since the topic's last message.
    fn age(&self, topic: usize, k: i64) -> Value {
        let Some(instant) = self.instant(k) else { return Value::Missing };
        match self.piece.messages(topic, instant.upto).last() {
            Some(message) => Value::Num(instant.time.since(*message).seconds()),
            None => Value::Missing,
        }
    }

    /// The number of messages in `(t - d, t]` over the seconds of `d`.
    fn frequency(&self, topic: usize, d: Duration, k: i64) -> Value {
        let Some(instant) = self.instant(k) else { return Value::Missing };
        let messages = self.piece.messages(topic, instant.upto);
        let recent = messages.iter().filter(|m| instant.time.since(**m) < d).count();
        Value::Num(recent as f64 / d.seconds())
    }

    /// Whether a message of the topic arrived since the instant before.
    fn fresh(&self, topic: usize, k: i64) -> bool {
        let count = |upto| self.piece.messages(topic, upto).len();
        self.instant(k).is_some_and(|i| count(i.upto) > count(i.from))
    }

    fn quantified(&self, all: bool, array: &Value, body: &Expr, k: i64, vars: &[Value]) -> Value {
        let elements = match values::elements(array) {
            Ok(Some(elements)) => elements,
            Ok(None) => return Value::Missing,
            Err(fault) => {
                self.remember(fault.0, k);
                return Value::Bool(false);
            }
        };
        let mut results = Vec::new();
        for element in elements {
            if !matches!(element, Value::Num(x) if x.is_nan()) {
                let mut inner = vars.to_vec();
                inner.push(element);
                results.push(self.condition(body, k, &inner));
            }
        }
        Value::Bool(if all { results.iter().all(|&r| r) } else { results.iter().any(|&r| r) })
    }

    // Looking back. Below, position 0 is where the past begins, but `@` may look before it.

    /// `e − @{e, -1}`
    fn delta(&self, e: &Expr, k: i64, vars: &[Value]) -> Value {
        let (now, before) = (self.eval(e, k, vars), self.eval(e, k - 1, vars));
        self.or_fault(values::arithmetic(checked::Arith::Sub, &now, &before), e, k)
    }

    /// `delta(e)` over the seconds since the instant before, NaN where these are 0.
    fn rate(&self, e: &Expr, k: i64, vars: &[Value]) -> Value {
        let delta = self.delta(e, k, vars);
        let seconds = match (self.instant(k), self.instant(k - 1)) {
            (Some(now), Some(before)) => now.time.since(before.time).seconds(),
            _ => f64::NAN,
        };
        let seconds = if seconds == 0.0 { f64::NAN } else { seconds };
        self.or_fault(values::arithmetic(checked::Arith::Div, &delta, &Value::Num(seconds)), e, k)
    }

    /// The positions of `[0, k]`, oldest first; none where `k` is before position 0.
    fn past(&self, k: i64) -> impl DoubleEndedIterator<Item = i64> {
        0..k + 1
    }

    /// The time from position `j` to position `k`.
    pub(crate) fn distance(&self, j: i64, k: i64) -> Duration {
        match (self.instant(j), self.instant(k)) {
            (Some(earlier), Some(later)) => later.time.since(earlier.time),
            _ => Duration::ZERO,
        }
    }

    /// `min_over`, `max_over`, `mean_over`, `count`: over the positions in `[t − d, t]`, NaN skipped, over none NaN.
    fn window(&self, window: Window, e: &Expr, d: Duration, k: i64, vars: &[Value]) -> Value {
        let positions: Vec<i64> = self.past(k).filter(|&j| self.distance(j, k) <= d).collect();
        if window == Window::Count {
            return Value::Num(positions.iter().filter(|&&j| self.condition(e, j, vars)).count() as f64);
        }
        let mut entries = Vec::new();
        for j in positions {
            match values::number(&self.eval(e, j, vars)) {
                Ok(Some(x)) if !x.is_nan() => entries.push(x),
                Ok(_) => {}
                Err(fault) => self.remember(fault.0, j),
            }
        }
        Value::Num(match window {
            Window::Min => values::fold(&entries, f64::min),
            Window::Max => values::fold(&entries, f64::max),
            Window::Mean => entries.iter().fold(0.0, |sum, x| sum + x) / entries.len() as f64,
            Window::Count => f64::NAN,
        })
    }

    /// `k > 0` and φ holds at `k-1`.
    fn previously(&self, e: &Expr, k: i64, vars: &[Value]) -> bool {
        k > 0 && self.condition(e, k - 1, vars)
    }

    /// φ and not previously φ.
    fn becomes(&self, e: &Expr, k: i64, vars: &[Value]) -> bool {
        k >= 0 && self.condition(e, k, vars) && !self.previously(e, k, vars)
    }

    /// φ holds at some position of `[0, k]` within the bound.
    fn once(&self, bound: &Bound, e: &Expr, k: i64, vars: &[Value]) -> bool {
        self.past(k).any(|j| bound.contains(self.distance(j, k)) && self.condition(e, j, vars))
    }

    /// φ holds at every position of `[0, k]` within the bound.
    fn historically(&self, bound: &Bound, e: &Expr, k: i64, vars: &[Value]) -> bool {
        self.past(k).all(|j| !bound.contains(self.distance(j, k)) || self.condition(e, j, vars))
    }

    /// ψ holds at some `j ≤ k` within the bound and φ at all of `(j, k]`.
    fn since(&self, bound: &Bound, left: &Expr, right: &Expr, k: i64, vars: &[Value]) -> bool {
        self.past(k).any(|j| {
            bound.contains(self.distance(j, k))
                && self.condition(right, j, vars)
                && (j + 1..=k).all(|i| self.condition(left, i, vars))
        })
    }

    /// φ holds at every position in `[t_k − d, t_k]` and at the last position at or before `t_k − d`, and the property has been
    /// running at least `d`.
    fn held(&self, d: Duration, e: &Expr, k: i64, vars: &[Value]) -> bool {
        let running = k >= 0 && self.distance(0, k) >= d;
        let last_before = self.past(k).rev().find(|&j| self.distance(j, k) >= d);
        let inside = self.past(k).filter(|&j| self.distance(j, k) <= d);
        running && last_before.into_iter().chain(inside).all(|j| self.condition(e, j, vars))
    }
}

fn is_number(e: &Expr) -> bool {
    matches!(e.ty, Type::Num { .. })
}

fn connect(op: Connective, left: bool, right: bool) -> bool {
    match op {
        Connective::And => left && right,
        Connective::Or => left || right,
        Connective::Implies => !left || right,
        Connective::Iff => left == right,
    }
}

/// Whether what is read is defined as far back as it is looked at.
fn defined(piece: &Piece<'_>, instants: &[Instant], at: usize, read: &checked::Read) -> bool {
    let Some(instant) = at.checked_sub(read.depth).and_then(|i| instants.get(i)) else { return false };
    match read.what {
        ReadOf::Input(input) => piece.latest[instant.upto].get(input).is_some_and(Option::is_some),
        ReadOf::Topic(topic) => !piece.messages(topic, instant.upto).is_empty(),
    }
}

/// The events of an instant. In a slice, one whose field has another value does not occur.
fn occurring(
    piece: &Piece<'_>,
    logs: &[MachineLog],
    slices: &[(&checked::Slice, Value)],
    instant: &Instant,
) -> Vec<Occurrence> {
    let arrived = piece.occurrences[instant.from..instant.upto].iter().flatten();
    let mut all: Vec<Occurrence> = arrived.filter(|o| in_slices(o, slices)).cloned().collect();
    for (machine, log) in logs.iter().enumerate() {
        let moved = log.moved_at(instant.key(), machine, piece.spec);
        all.extend(moved.into_iter().map(|event| Occurrence { event, values: Vec::new() }));
    }
    all
}

/// The events of an instant of which nobody can tell whether they occur.
fn unclear_at(piece: &Piece<'_>, logs: &[MachineLog], instant: &Instant) -> Vec<(usize, String)> {
    let mut all: Vec<(usize, String)> = piece.unclear[instant.from..instant.upto].iter().flatten().cloned().collect();
    for (machine, log) in logs.iter().enumerate() {
        let Some(what) = log.is_lost_at(instant.key()) else { continue };
        let events = piece.spec.events.iter().enumerate().filter(|(_, e)| is_of_machine(&e.source, machine));
        all.extend(events.map(|(event, _)| (event, what.to_owned())));
    }
    all
}

fn is_of_machine(source: &EventSource, machine: usize) -> bool {
    matches!(source, EventSource::Entered { machine: m, .. } | EventSource::Left { machine: m, .. } if *m == machine)
}

/// Whether an event belongs to the slices of these values.
pub(crate) fn in_slices(occurrence: &Occurrence, slices: &[(&checked::Slice, Value)]) -> bool {
    slices.iter().all(|(slice, value)| {
        let field = slice.fields.iter().find(|(event, _)| *event == occurrence.event).map(|(_, field)| *field);
        match field.and_then(|f| occurrence.values.get(f)) {
            None | Some(Value::Missing) => true,
            Some(other) => other == value,
        }
    })
}
