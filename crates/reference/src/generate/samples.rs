//! Traces at random, by name.

use super::rng::Rng;
use lapwing_stream::{Time, Value};

/// Something that arrives.
#[derive(Clone, Debug, PartialEq)]
pub enum Raw {
    /// Cells by column.
    Row(Vec<(String, Value)>),
    /// A message of a topic.
    Message(String, Value),
    /// An event with its fields.
    Event(String, Value),
    /// Something that nobody reads.
    Other,
}

const MS: i64 = 1_000_000;

/// The stamps of a trace: multiples of 100 ms, often the same one, seldom a nanosecond beside it, and now and then a jump back.
pub(crate) fn stamps(rng: &mut Rng, count: usize) -> Vec<Time> {
    let jumps = rng.percent(10);
    let base = if rng.percent(20) { 1_700_000_000_000_000_000 } else { 0 };
    let mut at = base;
    let mut stamps: Vec<Time> = Vec::new();
    for _ in 0..count {
        at += 100 * MS * *rng.pick(&[0, 0, 1, 1, 1, 1, 2, 2, 3, 5]);
        if jumps && rng.percent(8) {
            at = base + 100 * MS * rng.below(4) as i64;
        }
        let beside = if rng.percent(8) { *rng.pick(&[-1, 1]) } else { 0 };
        let last = stamps.last().map_or(i64::MIN, |t| t.0);
        // A nanosecond early must not make a jump of its own.
        let stamp = if beside < 0 && at + beside < last { at } else { at + beside };
        stamps.push(Time(if stamp + 1 == last { last } else { stamp }));
    }
    stamps
}

/// One thing that arrives: rows more often than the rest.
pub(crate) fn arrival(rng: &mut Rng, events_often: bool) -> Raw {
    let roll = rng.below(100);
    let rows = if events_often { 25 } else { 55 };
    match roll {
        _ if roll < rows => row(rng, false),
        _ if roll < rows + 8 => message_m(rng),
        _ if roll < rows + 14 => message_f(rng),
        _ if roll < rows + 18 => message_more(rng),
        92.. => Raw::Other,
        _ => event(rng),
    }
}

pub(crate) fn message_m(rng: &mut Rng) -> Raw {
    Raw::Message("/m".into(), record(vec![("data", number(rng))]))
}

pub(crate) fn message_f(rng: &mut Rng) -> Raw {
    Raw::Message("/f".into(), record(vec![("data", Value::Bool(rng.percent(60)))]))
}

/// A scan of up to three ranges, or a mode.
pub(crate) fn message_more(rng: &mut Rng) -> Raw {
    if rng.percent(50) {
        let ranges = (0..rng.below(4)).map(|_| if let Value::Num(x) = number(rng) { x } else { 0.0 }).collect();
        Raw::Message("/scan".into(), record(vec![("ranges", Value::Nums(ranges))]))
    } else {
        Raw::Message("/mode".into(), record(vec![("data", Value::from(*rng.pick(&["auto", "hand", ""])))]))
    }
}

/// A row; a full one has every cell.
pub(crate) fn row(rng: &mut Rng, full: bool) -> Raw {
    let mut cells = Vec::new();
    for name in ["a", "b", "c", "x", "y"] {
        if full || rng.percent(70) {
            let value = match name {
                "a" | "b" => Value::Bool(rng.percent(50)),
                // A column that numbers and booleans share.
                "c" => rng.pick(&[Value::Bool(true), Value::Bool(false), Value::Num(0.0), Value::Num(2.0)]).clone(),
                _ => number(rng),
            };
            cells.push((name.to_string(), value));
        }
    }
    Raw::Row(cells)
}

/// The latest row once more, now and then with one cell as it is in another.
pub(crate) fn repeated(rng: &mut Rng, trace: &[(Time, Raw)]) -> Raw {
    let cells =
        trace.iter().rev().find_map(|(_, raw)| if let Raw::Row(cells) = raw { Some(cells.clone()) } else { None });
    let (Some(mut cells), Raw::Row(mut other)) = (cells, row(rng, true)) else { return row(rng, true) };
    if rng.percent(20) {
        let new = other.swap_remove(rng.below(other.len()));
        match cells.iter_mut().find(|(name, _)| *name == new.0) {
            Some(old) => *old = new,
            None => cells.push(new),
        }
    }
    Raw::Row(cells)
}

fn event(rng: &mut Rng) -> Raw {
    match rng.below(5) {
        0 | 1 => {
            let robot = rng.pick(&[Value::from("r1"), Value::from("r2"), Value::Num(3.0)]).clone();
            Raw::Event("kick".into(), record(vec![("power", number(rng)), ("robot", robot)]))
        }
        2 => {
            let robot =
                if rng.percent(90) { rng.pick(&["r1", "r2"]).to_string().as_str().into() } else { Value::Missing };
            Raw::Event("drop".into(), record(vec![("robot", robot)]))
        }
        _ => Raw::Event("tick".into(), record(vec![])),
    }
}

fn number(rng: &mut Rng) -> Value {
    match rng.below(100) {
        0..4 => Value::Num(f64::NAN),
        4 => Value::Num(f64::INFINITY),
        _ => Value::Num(*rng.pick(&[-1.0, 0.0, 0.5, 1.0, 1.0, 2.0, 3.0])),
    }
}

fn record(fields: Vec<(&str, Value)>) -> Value {
    Value::Record(fields.into_iter().map(|(name, value)| (name.into(), value)).collect())
}
