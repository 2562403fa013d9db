//! Robustness: how far a property was from changing its verdict (language reference, *Grammar*: margin).
//!
//! A comparison counts with its signed distance to changing, anything else that is true or false with ±∞; `and` and `always` take
//! the least, `or` and `eventually` the greatest, `not` the negative. NaN is skipped: `None` below means that there is nothing to
//! count. The trace is taken as it is, as if it were all.

use crate::course::Course;
use crate::future::{End, View};
use crate::obligations::{self, Duty, Obligation};
use crate::truth::Truth;
use lapwing_check::checked::{Bound, Compare, Connective, Expr, Kind, Scope};
use lapwing_stream::Value;

/// A robustness, or nothing to count.
type Margin = Option<f64>;

/// The worst robustness of an obligation; none where operands of different dimensions are compared.
pub(crate) fn of(course: &Course<'_>, formula: &Expr) -> Option<f64> {
    let mut dims = Vec::new();
    dimensions(formula, &mut dims);
    dims.sort_unstable();
    dims.dedup();
    if dims.len() > 1 {
        return None;
    }
    least(obligations::of(course, formula).iter().map(|o| course.margin_of(o)))
}

/// The known dimensions of all comparisons.
fn dimensions(e: &Expr, found: &mut Vec<[i8; 3]>) {
    if let Kind::Compare { left, .. } = &e.kind
        && is_of_numbers(left)
    {
        found.extend(e.dim.0);
    }
    e.children().into_iter().for_each(|child| dimensions(child, found));
}

fn is_of_numbers(e: &Expr) -> bool {
    !matches!(e.ty, lapwing_stream::Type::Bool | lapwing_stream::Type::Str)
}

fn least(margins: impl Iterator<Item = Margin>) -> Margin {
    margins.flatten().reduce(f64::min)
}

fn greatest(margins: impl Iterator<Item = Margin>) -> Margin {
    margins.flatten().reduce(f64::max)
}

fn both(a: Margin, b: Margin) -> Margin {
    least([a, b].into_iter())
}

fn either(a: Margin, b: Margin) -> Margin {
    greatest([a, b].into_iter())
}

fn opposite(a: Margin) -> Margin {
    // Zero stays what it is, without a sign.
    a.map(|x| 0.0 - x)
}

fn implies(a: Margin, b: Margin) -> Margin {
    either(opposite(a), b)
}

/// What is true by itself has nothing to lose.
const CERTAIN: Margin = Some(f64::INFINITY);
const IMPOSSIBLE: Margin = Some(f64::NEG_INFINITY);

fn certain(b: bool) -> Margin {
    if b { CERTAIN } else { IMPOSSIBLE }
}

impl Course<'_> {
    fn margin_of(&self, o: &Obligation<'_>) -> Margin {
        let view = View { end: o.end.map_or(End::Cut, End::At), ..self.whole() };
        let own = match o.duty {
            Duty::Formula(f) => self.margin(f, o.at, view),
            Duty::Implies(x, f) => implies(self.margin(x, o.at, view), self.margin(f, o.at, view)),
            Duty::Exists(x) => self.margin_some(&Bound::ALL, x, o.at, view),
        };
        // Under `before X` nothing can fail where X never comes.
        if o.can_fail() { own } else { CERTAIN }
    }

    /// The robustness of a formula at position `k` of a segment.
    fn margin(&self, f: &Expr, k: usize, view: View) -> Margin {
        if !f.has_future() {
            return self.margin_of_state(f, k as i64);
        }
        match &f.kind {
            Kind::Always(bound, f) => self.margin_every(bound, f, k, view),
            Kind::Eventually(bound, f) => self.margin_some(bound, f, k, view),
            Kind::Next(f) if k + 1 < view.upto() => self.margin(f, k + 1, view),
            Kind::Next(_) => IMPOSSIBLE,
            Kind::Until(bound, left, right) => self.margin_until(bound, left, right, k, view),
            Kind::Scope(Scope::After, x, f) => match self.first_true(x, k, view) {
                Some(j) => self.margin_hat(f, j, view),
                None => CERTAIN,
            },
            Kind::Scope(Scope::Until, x, f) => match self.first_true(x, k, view) {
                Some(j) => both(self.margin(x, j, view), self.margin_segment(f, k, j, view)),
                None => self.margin_some(&Bound::ALL, x, k, view),
            },
            Kind::Scope(Scope::Before, x, f) => match self.first_true(x, k, view) {
                Some(j) => self.margin_segment(f, k, j, view),
                None => CERTAIN,
            },
            Kind::Scope(Scope::While, x, f) => {
                let after = |i| (i..view.upto()).find(|&j| self.truth(x, j, view) != Truth::True);
                self.margin_segments(x, f, k, view, after, 0)
            }
            Kind::Scope(Scope::Whenever, x, f) => {
                let at = |j| implies(self.margin(x, j, view), self.margin(f, j, view));
                least(self.seen(&Bound::ALL, k, view).map(at)).or(CERTAIN)
            }
            Kind::AfterUntil(x, y, f) => self.margin_segments(x, f, k, view, |i| self.first_true(y, i, view), 1),
            Kind::Not(f) => opposite(self.margin(f, k, view)),
            Kind::Connective(op, a, b) => connect(*op, self.margin(a, k, view), self.margin(b, k, view)),
            _ => self.margin_of_state(f, k as i64),
        }
    }

    fn margin_hat(&self, f: &Expr, k: usize, view: View) -> Margin {
        if f.has_future() { self.margin(f, k, view) } else { self.margin_every(&Bound::ALL, f, k, view) }
    }

    fn margin_every(&self, bound: &Bound, f: &Expr, k: usize, view: View) -> Margin {
        least(self.seen(bound, k, view).map(|j| self.margin(f, j, view)).chain([CERTAIN]))
    }

    fn margin_some(&self, bound: &Bound, f: &Expr, k: usize, view: View) -> Margin {
        greatest(self.seen(bound, k, view).map(|j| self.margin(f, j, view)).chain([IMPOSSIBLE]))
    }

    fn margin_until(&self, bound: &Bound, left: &Expr, right: &Expr, k: usize, view: View) -> Margin {
        let (mut any, mut before) = (IMPOSSIBLE, CERTAIN);
        for j in k..view.upto() {
            if bound.contains(self.time(j).since(self.time(k))) {
                any = either(any, both(self.margin(right, j, view), before));
            }
            before = both(before, self.margin(left, j, view));
        }
        any
    }

    fn margin_segment(&self, f: &Expr, from: usize, to: usize, view: View) -> Margin {
        if from == to { CERTAIN } else { self.margin_hat(f, from, view.until(to)) }
    }

    /// The segments that X opens and `close` closes; the search goes on `skip` positions after.
    fn margin_segments(
        &self,
        x: &Expr,
        f: &Expr,
        k: usize,
        view: View,
        close: impl Fn(usize) -> Option<usize>,
        skip: usize,
    ) -> Margin {
        let mut worst = CERTAIN;
        let mut from = k;
        while let Some(i) = self.first_true(x, from, view) {
            match close(i) {
                Some(j) => {
                    worst = both(worst, self.margin_segment(f, i, j, view));
                    from = j + skip;
                }
                None => return both(worst, self.margin_hat(f, i, view)),
            }
        }
        worst
    }

    fn seen(&self, bound: &Bound, k: usize, view: View) -> impl Iterator<Item = usize> {
        (k..view.upto()).filter(move |&j| bound.contains(self.time(j).since(self.time(k))))
    }

    fn first_true(&self, x: &Expr, from: usize, view: View) -> Option<usize> {
        (from..view.upto()).find(|&j| self.truth(x, j, view) == Truth::True)
    }

    /// The robustness of a formula without future operators. As everywhere, the past begins at position 0.
    fn margin_of_state(&self, e: &Expr, k: i64) -> Margin {
        let at = |e: &Expr, j: i64| self.margin_of_state(e, j);
        let bounded = |bound: &Bound| {
            let bound = *bound;
            (0..k + 1).filter(move |&j| bound.contains(self.distance(j, k)))
        };
        match &e.kind {
            Kind::Compare { op, margin, left, right } => {
                let margin = margin.as_ref().map_or(Value::Num(0.0), |m| self.value(m, k));
                match (self.value(left, k), self.value(right, k), margin) {
                    (Value::Num(a), Value::Num(b), Value::Num(m)) => distance(*op, m, a, b),
                    _ => certain(self.holds(e, k)),
                }
            }
            Kind::Not(e) => opposite(at(e, k)),
            Kind::Connective(op, a, b) => connect(*op, at(a, k), at(b, k)),
            Kind::Lookback(e, depth) => at(e, k - *depth as i64),
            Kind::Previously(e) if k > 0 => at(e, k - 1),
            Kind::Previously(_) => IMPOSSIBLE,
            Kind::Becomes(e) if k > 0 => both(at(e, k), opposite(at(e, k - 1))),
            Kind::Becomes(e) if k == 0 => at(e, k),
            Kind::Becomes(_) => IMPOSSIBLE,
            Kind::Once(bound, e) => greatest(bounded(bound).map(|j| at(e, j)).chain([IMPOSSIBLE])),
            Kind::Historically(bound, e) => least(bounded(bound).map(|j| at(e, j)).chain([CERTAIN])),
            Kind::Since(bound, a, b) => {
                let from = |j: i64| both(at(b, j), least((j + 1..=k).map(|i| at(a, i))));
                greatest(bounded(bound).map(from).chain([IMPOSSIBLE]))
            }
            Kind::Held(d, e) if k >= 0 && self.distance(0, k) >= *d => {
                let before = (0..k + 1).rev().find(|&j| self.distance(j, k) >= *d);
                let inside = (0..k + 1).filter(|&j| self.distance(j, k) <= *d);
                least(before.into_iter().chain(inside).map(|j| at(e, j)))
            }
            Kind::Held(..) => IMPOSSIBLE,
            _ => certain(self.holds(e, k)),
        }
    }
}

fn connect(op: Connective, a: Margin, b: Margin) -> Margin {
    match op {
        Connective::And => both(a, b),
        Connective::Or => either(a, b),
        Connective::Implies => implies(a, b),
        Connective::Iff => both(implies(a, b), implies(b, a)),
    }
}

/// The signed distance of a comparison to changing; none where NaN takes part.
fn distance(op: Compare, m: f64, a: f64, b: f64) -> Margin {
    // Equal infinities are equal.
    let gap = if a == b { 0.0 } else { (a - b).abs() };
    let distance = match op {
        Compare::Lt | Compare::Le => b + m - a,
        Compare::Gt | Compare::Ge => a - b + m,
        Compare::Eq => m - gap,
        Compare::Ne => gap - m,
    };
    (!distance.is_nan()).then_some(distance)
}
