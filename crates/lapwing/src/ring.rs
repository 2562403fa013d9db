//! The values of some signals at the latest instants.

use lapwing_stream::{Time, Value};

use crate::eval::Moment;

/// How many instants are kept.
const INSTANTS: usize = 1024;

/// The longest array that is kept.
const LONGEST: usize = 16;

/// The values of some signals at the latest instants. Once it is full it allocates no more.
#[derive(Debug)]
pub(crate) struct Ring {
    /// The signals that are kept.
    kept: Vec<usize>,
    /// For every signal, its place among the kept ones.
    places: Vec<Option<usize>>,
    times: Vec<Time>,
    /// Of one instant after the other, the values of the kept signals.
    values: Vec<Value>,
    /// Where the oldest is, once all places are taken.
    oldest: usize,
}

/// An instant of a [`Ring`].
pub(crate) struct Instant<'r> {
    ring: &'r Ring,
    at: usize,
}

impl Ring {
    /// Keeps those of so many signals for which `is_kept` holds.
    pub fn new(inputs: usize, is_kept: impl Fn(usize) -> bool) -> Ring {
        let kept: Vec<usize> = (0..inputs).filter(|i| is_kept(*i)).collect();
        let mut places = vec![None; inputs];
        kept.iter().enumerate().for_each(|(place, &input)| places[input] = Some(place));
        Ring { kept, places, times: Vec::new(), values: Vec::new(), oldest: 0 }
    }

    /// An instant is over.
    pub fn push<'v>(&mut self, time: Time, value: impl Fn(usize) -> &'v Value) {
        let width = self.kept.len();
        let at = match self.times.len() < INSTANTS {
            true => {
                self.times.push(time);
                self.values.resize_with(self.times.len() * width, Value::default);
                self.times.len() - 1
            }
            false => {
                self.times[self.oldest] = time;
                let at = self.oldest;
                self.oldest = (self.oldest + 1) % INSTANTS;
                at
            }
        };
        for (to, &input) in self.values[at * width..].iter_mut().zip(&self.kept) {
            keep(to, value(input));
        }
    }

    /// Time jumped: what was before is no history of what comes.
    pub fn clear(&mut self) {
        self.times.clear();
        self.values.clear();
        self.oldest = 0;
    }

    /// The instants, from the oldest to the latest.
    pub fn instants(&self) -> impl DoubleEndedIterator<Item = Instant<'_>> {
        let count = self.times.len();
        (0..count).map(move |n| Instant { ring: self, at: (self.oldest + n) % count })
    }
}

fn keep(to: &mut Value, from: &Value) {
    match from {
        Value::Num(_) | Value::Bool(_) | Value::Str(_) => to.clone_from(from),
        Value::Nums(xs) if xs.len() <= LONGEST => to.clone_from(from),
        _ => *to = Value::Missing,
    }
}

impl Instant<'_> {
    /// When it was.
    pub fn time(&self) -> Time {
        self.ring.times[self.at]
    }
}

impl Moment for Instant<'_> {
    fn value(&self, input: usize) -> &Value {
        let place = self.ring.places.get(input).copied().flatten();
        place.and_then(|p| self.ring.values.get(self.at * self.ring.kept.len() + p)).unwrap_or(&Value::Missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_instants_are_kept_in_order() {
        let mut ring = Ring::new(3, |input| input != 1);
        let count = INSTANTS as i64 + 10;
        for k in 0..count {
            let values = [Value::Num(k as f64), Value::Num(-1.0), Value::Bool(k % 2 == 0)];
            ring.push(Time(k), |input| &values[input]);
        }
        let times: Vec<i64> = ring.instants().map(|i| i.time().0).collect();
        assert_eq!(times, (10..count).collect::<Vec<_>>());
        let last = ring.instants().next_back().unwrap();
        let expected = [&Value::Num(count as f64 - 1.0), &Value::Missing, &Value::Bool(false), &Value::Missing];
        assert_eq!([0, 1, 2, 9].map(|input| last.value(input)), expected);
        ring.clear();
        assert_eq!(ring.instants().count(), 0);
    }

    #[test]
    fn long_arrays_are_not_kept() {
        let mut ring = Ring::new(1, |_| true);
        ring.push(Time(0), |_| const { &Value::Num(1.0) });
        let scan = Value::Nums(vec![0.0; LONGEST + 1]);
        ring.push(Time(1), |_| &scan);
        let values: Vec<Value> = ring.instants().map(|i| i.value(0).clone()).collect();
        assert_eq!(values, [Value::Num(1.0), Value::Missing]);
    }
}
