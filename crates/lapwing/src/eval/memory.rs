//! Operators over the past, from the positions that are kept.
//!
//! Each is its definition, read backwards from the moment in question. Where that leads to what is no longer kept nothing is said.

use lapwing_check::checked::{Bound, Expr, Kind, Window};
use lapwing_engine::{numeric, program};
use lapwing_stream::{Duration, Value};

use super::{number, truth, waits_for_event};
use crate::trail::Point;

/// The value of an operator over the past.
pub(super) fn value(e: &Expr, at: &Point<'_>, vars: &[Value]) -> Option<Value> {
    at.spend()?;
    let past = Past { vars };
    let held = match &e.kind {
        Kind::Previously(of) => past.previously(of, at),
        Kind::Becomes(of) => past.becomes(of, at),
        Kind::Once(bound, of) => past.once(bound, of, at, true),
        Kind::Historically(bound, of) => past.once(bound, of, at, false).map(|b| !b),
        Kind::Since(bound, left, right) => past.since(bound, left, right, at),
        Kind::Held(d, of) => past.held(*d, of, at),
        Kind::Lookback(of, depth) => return super::value(of, &at.before(*depth)?, vars),
        Kind::Delta(of) => return past.delta(of, at).map(|(difference, _)| Value::Num(difference)),
        Kind::Rate(of) => {
            let (difference, time) = past.delta(of, at)?;
            return Some(Value::Num(if time.nanos() == 0 { f64::NAN } else { difference / time.seconds() }));
        }
        Kind::Window(Window::Count, of, d) => return past.count(of, *d, at).map(Value::Num),
        Kind::Window(window, of, d) => return past.window(*window, of, *d, at).map(Value::Num),
        _ => None,
    };
    held.map(Value::Bool)
}

/// Operators over the past, inside quantifiers with those variables.
struct Past<'v> {
    vars: &'v [Value],
}

impl Past<'_> {
    fn holds(&self, e: &Expr, at: &Point<'_>) -> Option<bool> {
        at.spend()?;
        truth(&super::value(e, at, self.vars)?)
    }

    fn previously(&self, of: &Expr, at: &Point<'_>) -> Option<bool> {
        let (mut positions, is_whole) = at.back();
        match positions.nth(1) {
            Some(before) => self.holds(of, &before),
            None => is_whole.then_some(false),
        }
    }

    fn becomes(&self, of: &Expr, at: &Point<'_>) -> Option<bool> {
        let here = at.before(0)?;
        Some(self.holds(of, &here)? && !self.previously(of, at)?)
    }

    /// Whether the operand is `wanted` at a position that the bound lets be looked at.
    fn once(&self, bound: &Bound, of: &Expr, at: &Point<'_>, wanted: bool) -> Option<bool> {
        let (positions, is_whole) = at.back();
        let mut is_known = is_whole;
        for position in positions {
            let distance = at.time.since(position.time);
            if bound.hi.is_some_and(|hi| distance > hi) {
                is_known = true;
                break;
            }
            if bound.contains(distance) {
                match self.holds(of, &position) {
                    Some(b) if b == wanted => return Some(true),
                    Some(_) => {}
                    None => return None,
                }
            }
        }
        is_known.then_some(false)
    }

    fn since(&self, bound: &Bound, left: &Expr, right: &Expr, at: &Point<'_>) -> Option<bool> {
        let (positions, is_whole) = at.back();
        for position in positions {
            let distance = at.time.since(position.time);
            if bound.hi.is_some_and(|hi| distance > hi) {
                return Some(false);
            }
            if bound.contains(distance) && self.holds(right, &position)? {
                return Some(true);
            }
            if !self.holds(left, &position)? {
                return Some(false);
            }
        }
        is_whole.then_some(false)
    }

    fn held(&self, d: Duration, of: &Expr, at: &Point<'_>) -> Option<bool> {
        let (positions, is_whole) = at.back();
        for position in positions {
            if !self.holds(of, &position)? {
                return Some(false);
            }
            if at.time.since(position.time) >= d {
                return Some(true);
            }
        }
        // It has not been running for so long.
        is_whole.then_some(false)
    }

    /// What was added since the instant before, and how long ago that was.
    fn delta(&self, of: &Expr, at: &Point<'_>) -> Option<(f64, Duration)> {
        let (here, before) = (at.before(0)?, at.before(1)?);
        let difference = number(of, &here, self.vars)? - number(of, &before, self.vars)?;
        Some((difference, here.time.since(before.time)))
    }

    /// The positions of a closed window, the latest first; `None` where some of it is no longer kept.
    fn within<'t>(d: Duration, at: &Point<'t>) -> Option<Vec<Point<'t>>> {
        let (positions, mut is_whole) = at.back();
        let mut inside = Vec::new();
        for position in positions {
            if at.time.since(position.time) > d {
                is_whole = true;
                break;
            }
            at.spend()?;
            inside.push(position);
        }
        is_whole.then_some(inside)
    }

    fn count(&self, of: &Expr, d: Duration, at: &Point<'_>) -> Option<f64> {
        let mut count = 0.0;
        for position in Past::within(d, at)? {
            count += f64::from(u8::from(self.holds(of, &position)?));
        }
        Some(count)
    }

    fn window(&self, window: Window, of: &Expr, d: Duration, at: &Point<'_>) -> Option<f64> {
        let mut numbers = Vec::new();
        for position in Past::within(d, at)? {
            match number(of, &position, self.vars) {
                Some(x) if x.is_nan() => {}
                Some(x) => numbers.push(x),
                None if waits_for_event(of, &position) => {}
                None => return None,
            }
        }
        Some(match window {
            _ if numbers.is_empty() => f64::NAN,
            Window::Min => numeric(program::Func::Min, &numbers),
            Window::Max => numeric(program::Func::Max, &numbers),
            _ => numbers.iter().rev().fold(0.0, |sum, x| sum + x) / numbers.len() as f64,
        })
    }
}
