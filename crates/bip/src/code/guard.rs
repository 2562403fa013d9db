//! Guards: conditions on data and clocks, which come to a window of moments.

use super::memory::FINE;
use super::{Address, Bool, Clock, Cmp, Context, Eval, Float, Int, Slot};
use crate::time::Window;

/// A condition on data and clocks.
///
/// There is no disjunction of two conditions on clocks: what a guard comes to is one window.
#[derive(Clone, Debug)]
pub(crate) enum Guard {
    /// Always, or never.
    Data(Bool),
    /// `x <= 5`
    Clock { clock: Slot, cmp: Cmp, bound: Bound },
    /// All of them.
    And(Vec<Guard>),
    /// Always where the condition holds, else the guard.
    Or(Bool, Box<Guard>),
}

/// What a clock is compared with or set to.
#[derive(Clone, Debug)]
pub(crate) enum Bound {
    /// In 10⁻⁹ ns, exactly.
    Exact(i128),
    /// A number of units of so many nanoseconds.
    Int(Int, i64),
    /// The same of a double, which is rounded to the nearest nanosecond.
    Float(Float, i64),
}

impl Bound {
    /// In 10⁻⁹ ns.
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<i128> {
        Ok(match self {
            Bound::Exact(value) => *value,
            // Two numbers of 64 bits have a product of 127; what is beyond that is beyond all time.
            Bound::Int(value, unit) => (i128::from(value.eval(at, cx)?) * i128::from(*unit)).saturating_mul(FINE),
            Bound::Float(value, unit) => rounded(value.eval(at, cx)? * *unit as f64),
        })
    }
}

/// Whole nanoseconds nearest to a double, in 10⁻⁹ ns.
fn rounded(nanoseconds: f64) -> i128 {
    // The cast saturates, and a double that is no number comes to 0.
    i128::from(nanoseconds.round() as i64) * FINE
}

impl Guard {
    /// Whether it fails whatever the clocks show.
    pub fn fails<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<bool> {
        match self {
            Guard::Data(condition) => Ok(!condition.eval(at, cx)?),
            Guard::And(parts) => {
                for part in parts {
                    if part.fails(at, cx)? {
                        return Ok(true);
                    }
                }
                Ok(false)
            }
            Guard::Clock { .. } | Guard::Or(..) => Ok(false),
        }
    }

    /// When it holds, as of now.
    pub fn window<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<Window> {
        let whole = |holds| if holds { Window::ALL } else { Window::NONE };
        match self {
            Guard::Data(condition) => condition.eval(at, cx).map(whole),
            Guard::Clock { clock, cmp, bound } => {
                let bound = bound.eval(at, cx)?;
                let clock = cx.memory.clocks.get(at.clock(*clock)).copied().unwrap_or_default();
                Ok(clock.window(*cmp, bound))
            }
            Guard::And(parts) => {
                let mut window = Window::ALL;
                for part in parts {
                    window = window.and(part.window(at, cx)?);
                    if window.is_empty() {
                        return Ok(Window::NONE);
                    }
                }
                Ok(window)
            }
            Guard::Or(condition, other) => match condition.eval(at, cx)? {
                true => Ok(Window::ALL),
                false => other.window(at, cx),
            },
        }
    }
}

impl Clock {
    /// When the clock compares so, if nobody sets it.
    fn window(&self, cmp: Cmp, bound: i128) -> Window {
        let ahead = bound.saturating_sub(self.shown);
        let rate = i128::from(self.rate);
        if rate == 0 {
            return if cmp.holds(&self.shown, &bound) { Window::ALL } else { Window::NONE };
        }
        // PERF: nearly all clocks go at the rate of time, and nearly all bounds are whole nanoseconds: a division of 64 bits then.
        let (whole, is_exact) = match (i64::try_from(ahead), rate == FINE) {
            (Ok(ahead), true) => (i128::from(ahead.div_euclid(FINE as i64)), ahead.rem_euclid(FINE as i64) == 0),
            _ => (ahead.div_euclid(rate), ahead.rem_euclid(rate) == 0),
        };
        // The last moment at which the clock shows at most the bound; `is_exact` where it shows just that.
        let floor = clamp(i128::from(self.since).saturating_add(whole));
        let after = floor.saturating_add(1);
        let until = |last, open_right| Window { last, open_right, ..Window::ALL };
        let from = |first, open_left| Window { first, open_left, ..Window::ALL };
        match cmp {
            Cmp::LessEqual => until(floor, false),
            Cmp::Less if is_exact => until(floor.saturating_sub(1), true),
            Cmp::Less => until(floor, false),
            Cmp::Greater => from(after, is_exact),
            Cmp::GreaterEqual if is_exact => from(floor, false),
            Cmp::GreaterEqual => from(after, false),
            Cmp::Equal if is_exact => Window { first: floor, last: floor, ..Window::ALL },
            Cmp::Equal => Window::NONE,
            // The checker lets none come here: it is two windows.
            Cmp::NotEqual => Window::ALL,
        }
    }
}

/// A moment that is none of the two infinities.
fn clamp(at: i128) -> i64 {
    at.clamp(i128::from(i64::MIN + 2), i128::from(i64::MAX - 2)) as i64
}

#[cfg(test)]
mod tests {
    use super::super::{Base, Memory};
    use super::*;
    use crate::ast::TimeUnit;
    use crate::host::Host;
    use crate::value::Value;

    fn window(clock: Clock, cmp: Cmp, bound: i128) -> String {
        clock.window(cmp, bound).to_string()
    }

    #[test]
    fn a_clock_that_goes_as_time_does() {
        let clock = Clock { since: 10, ..Clock::default() };
        let five = 5 * FINE;
        assert_eq!(window(clock, Cmp::LessEqual, five), "[ -INFTY, 15ns ]");
        assert_eq!(window(clock, Cmp::Less, five), "[ -INFTY, 15ns [");
        assert_eq!(window(clock, Cmp::Greater, five), "] 15ns, +INFTY ]");
        assert_eq!(window(clock, Cmp::GreaterEqual, five), "[ 15ns, +INFTY ]");
        assert_eq!(window(clock, Cmp::Equal, five), "[ 15ns, 15ns ]");
    }

    #[test]
    fn bounds_between_two_nanoseconds() {
        let clock = Clock::default();
        let half = FINE / 2;
        assert_eq!(window(clock, Cmp::LessEqual, FINE + half), "[ -INFTY, 1ns ]");
        assert_eq!(window(clock, Cmp::Less, FINE + half), "[ -INFTY, 1ns ]");
        assert_eq!(window(clock, Cmp::GreaterEqual, FINE + half), "[ 2ns, +INFTY ]");
        assert!(clock.window(Cmp::Equal, FINE + half).is_empty());
    }

    #[test]
    fn clocks_that_go_faster_slower_and_not_at_all() {
        let double = Clock { rate: 2 * FINE as i64, ..Clock::default() };
        assert_eq!(window(double, Cmp::Equal, 10 * FINE), "[ 5ns, 5ns ]");
        assert_eq!(window(double, Cmp::GreaterEqual, 5 * FINE), "[ 3ns, +INFTY ]");
        let half = Clock { rate: FINE as i64 / 2, ..Clock::default() };
        assert_eq!(window(half, Cmp::LessEqual, 10 * FINE), "[ -INFTY, 20ns ]");
        let stopped = Clock { rate: 0, shown: 3 * FINE, ..Clock::default() };
        assert!(stopped.window(Cmp::Less, 3 * FINE).is_empty());
        assert_eq!(stopped.window(Cmp::LessEqual, 3 * FINE), Window::ALL);
    }

    #[test]
    fn a_change_of_rate_keeps_what_the_clock_shows() {
        let mut clock = Clock::default();
        clock.set_rate(3, FINE as i64 / 2);
        clock.set_rate(4, 2 * FINE as i64);
        assert_eq!(clock.at(4), 3 * FINE + FINE / 2);
        assert_eq!(window(clock, Cmp::GreaterEqual, 5 * FINE), "[ 5ns, +INFTY ]");
    }

    #[test]
    fn bounds_beyond_all_time() {
        let clock = Clock::default();
        let far = i128::from(i64::MAX) * 1_000_000_000 * FINE;
        assert!(clock.window(Cmp::LessEqual, far).holds(i64::MAX - 2));
        assert!(clock.window(Cmp::GreaterEqual, far).first >= i64::MAX - 2);
    }

    struct Nobody;

    impl Host for Nobody {
        fn call(&mut self, _: u32, _: &mut [Value], _: Option<u32>) -> Result<Value, String> {
            Err("nobody is there".to_owned())
        }
    }

    #[test]
    fn bounds_that_no_number_holds() {
        let (mut memory, mut host) = (Memory::default(), Nobody);
        let mut cx = Context { memory: &mut memory, host: &mut host, atom: None, now: 0 };
        let mut days =
            |number| Bound::Int(Int::Const(number), TimeUnit::Day.nanoseconds()).eval(Base::default(), &mut cx);
        assert_eq!(days(2), Ok(2 * 86_400_000_000_000 * FINE));
        let (far, past) = (days(i64::MAX).unwrap(), days(i64::MIN).unwrap());
        let clock = Clock::default();
        assert!(clock.window(Cmp::LessEqual, far).holds(i64::MAX - 2));
        assert!(clock.window(Cmp::GreaterEqual, past).holds(0));
        assert!(!clock.window(Cmp::GreaterEqual, far).holds(0) && !clock.window(Cmp::LessEqual, past).holds(0));
    }
}
