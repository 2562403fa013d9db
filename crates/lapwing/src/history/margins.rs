//! The margins of properties over time.

use std::collections::BTreeMap;

use lapwing_react::history::{Shape, Track};
use lapwing_stream::{Time, Value};

use super::curve::Curve;
use crate::instance::Instance;

/// More instances of properties than this have no curve each.
const INSTANCES: usize = 1000;

/// The margins of all properties over time. Those that are known at once come before those that are known at the end, which begin again
/// from the first position: they are two curves, and what counts is the lesser of them.
#[derive(Debug)]
pub(super) struct Margins {
    curves: BTreeMap<Instance, Passes>,
    most: usize,
}

/// The curves of one property, one for each time that its positions are told in their order.
#[derive(Debug, Default)]
struct Passes {
    all: Vec<Kept>,
    /// Which of them is being told.
    now: usize,
}

#[derive(Debug)]
struct Kept {
    curve: Curve,
    last: Time,
}

impl Margins {
    /// Keeps at most so many buckets of each.
    pub fn new(most: usize) -> Margins {
        Margins { curves: BTreeMap::new(), most }
    }

    /// The obligations that begin at this time have this margin.
    pub fn note(&mut self, property: usize, instance: &[Option<Value>], at: Time, margin: f64) {
        let key = Instance::running(property, instance);
        if self.curves.len() >= INSTANCES && !self.curves.contains_key(&key) {
            return;
        }
        let Passes { all, now } = self.curves.entry(key).or_default();
        *now += usize::from(all.get(*now).is_some_and(|kept| at < kept.last));
        if *now == all.len() {
            all.push(Kept { curve: Curve::new(self.most), last: at });
        }
        all[*now].push(at, margin);
    }

    /// An obligation of the property fails now.
    pub fn keep(&mut self, property: usize, instance: &[Option<Value>]) {
        let curves = self.curves.get_mut(&Instance::running(property, instance));
        curves.into_iter().flat_map(|passes| &mut passes.all).for_each(|kept| kept.curve.keep());
    }

    /// Time jumped: nothing from before counts any more.
    pub fn jump(&mut self, at: Time) {
        for Passes { all, now } in self.curves.values_mut() {
            all.iter_mut().for_each(|kept| kept.push(at, f64::NAN));
            *now = 0;
        }
    }

    /// The margin of a property, or of an instance of it; `None` where there is nothing to draw.
    pub fn of(&self, property: usize, instance: &[Value]) -> Option<Track> {
        let curves = self.curves.get(&Instance::of(property, instance))?;
        let all: Vec<_> = curves.all.iter().map(|kept| kept.curve.points()).collect();
        let is_thinned = all.iter().any(|(_, is_thinned)| *is_thinned);
        let points = all.into_iter().map(|(points, _)| points).reduce(|a, b| lesser(&a, &b))?;
        (!points.is_empty()).then(|| Track {
            name: "margin".to_owned(),
            unit: None,
            shape: Shape::Curve(points),
            is_thinned,
        })
    }
}

impl Kept {
    fn push(&mut self, at: Time, margin: f64) {
        self.last = at;
        self.curve.push(at, margin);
    }
}

/// The lesser of two curves, each of which keeps its value from a point to the next.
fn lesser(a: &[(Time, f64)], b: &[(Time, f64)]) -> Vec<(Time, f64)> {
    let mut times: Vec<Time> = a.iter().chain(b).map(|(time, _)| *time).collect();
    times.sort();
    times.dedup();
    let held = |curve: &[(Time, f64)], time: Time| {
        let after = curve.partition_point(|(t, _)| *t <= time);
        after.checked_sub(1).map_or(f64::NAN, |i| curve[i].1)
    };
    times.into_iter().map(|time| (time, held(a, time).min(held(b, time)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_late_lowers_what_was_known_at_once() {
        let mut margins = Margins::new(100);
        for (t, margin) in [(0, 3.0), (1, 2.0), (2, 1.0), (0, 5.0), (1, 0.5), (2, 4.0)] {
            margins.note(7, &[], Time(t), margin);
        }
        let track = margins.of(7, &[]).unwrap();
        assert_eq!(track.shape, Shape::Curve(vec![(Time(0), 3.0), (Time(1), 0.5), (Time(2), 1.0)]));
        assert_eq!(margins.of(8, &[]), None);
    }

    #[test]
    fn booleans_alone_have_nothing_to_draw() {
        let mut margins = Margins::new(100);
        margins.note(0, &[], Time(0), f64::INFINITY);
        assert_eq!(margins.of(0, &[]), None);
    }
}
