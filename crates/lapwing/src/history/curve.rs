//! A curve in bounded memory: where there are more points than places, neighbours share one, which keeps the first, the last, the least and
//! the greatest of them. A line through these looks like the line through all.

use lapwing_stream::Time;

use super::exact::Exact;

/// One in so many of the places of a curve is the number of points that are kept on each side of a failure.
const AROUND: usize = 10;

/// The values of a number over time. Times never go back.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    buckets: Vec<Bucket>,
    most: usize,
    /// A bucket is this power of two of nanoseconds wide.
    shift: u32,
    exact: Exact,
}

/// What is kept of the points in a stretch of time.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    first: (Time, f64),
    last: (Time, f64),
    least: (Time, f64),
    greatest: (Time, f64),
    is_thinned: bool,
    /// When there ceased to be a value, before the next bucket.
    ends: Option<Time>,
}

impl Curve {
    /// Keeps at most so many buckets.
    pub fn new(most: usize) -> Curve {
        Curve { buckets: Vec::new(), most: most.max(2), shift: 0, exact: Exact::new(most / AROUND) }
    }

    /// Another point. What is no number is a gap.
    pub fn push(&mut self, time: Time, value: f64) {
        if !value.is_finite() {
            let last = self.buckets.last_mut();
            last.into_iter().for_each(|bucket| bucket.ends = bucket.ends.or(Some(time)));
            return;
        }
        self.exact.push((time, value));
        let start = self.start().unwrap_or(time);
        let shift = self.shift;
        match self.buckets.last_mut().filter(|b| place(start, b.first.0, shift) == place(start, time, shift)) {
            Some(bucket) => bucket.join(&Bucket::of(time, value)),
            None => self.buckets.push(Bucket::of(time, value)),
        }
        while self.buckets.len() > self.most {
            self.shift += 1;
            self.halve(start);
        }
    }

    fn start(&self) -> Option<Time> {
        self.buckets.first().map(|b| b.first.0)
    }

    /// Joins the buckets that share a place now that places are twice as wide.
    fn halve(&mut self, start: Time) {
        let shift = self.shift;
        self.buckets.dedup_by(|next, kept| {
            let is_shared = place(start, kept.first.0, shift) == place(start, next.first.0, shift);
            if is_shared {
                kept.join(next);
            }
            is_shared
        });
    }

    /// Something fails now: the points around are kept as they are.
    pub fn keep(&mut self) {
        self.exact.keep();
    }

    /// The points that are kept, NaN where a gap begins, and whether some are not.
    pub fn points(&self) -> (Vec<(Time, f64)>, bool) {
        let gap = |bucket: &Bucket| bucket.ends.map(|time| (time, f64::NAN));
        let mut points: Vec<(Time, f64)> =
            self.buckets.iter().flat_map(|b| b.points().into_iter().chain(gap(b))).collect();
        let is_thinned = self.buckets.iter().any(|b| b.is_thinned);
        if is_thinned {
            points.extend(self.exact.points());
            // Stable: at one moment the order is that in which they came.
            points.sort_by_key(|(time, _)| *time);
            points.dedup();
        }
        (points, is_thinned)
    }
}

/// The number of the bucket that a time belongs to. From 64 on there is one for all.
fn place(start: Time, time: Time, shift: u32) -> u64 {
    (time.0.wrapping_sub(start.0) as u64).checked_shr(shift).unwrap_or(0)
}

impl Bucket {
    fn of(time: Time, value: f64) -> Bucket {
        let point = (time, value);
        Bucket { first: point, last: point, least: point, greatest: point, is_thinned: false, ends: None }
    }

    /// Takes in what comes later.
    fn join(&mut self, later: &Bucket) {
        let before = self.points().len() + later.points().len();
        self.last = later.last;
        self.ends = later.ends;
        if later.least.1 < self.least.1 {
            self.least = later.least;
        }
        if later.greatest.1 > self.greatest.1 {
            self.greatest = later.greatest;
        }
        // Of one moment nothing more can be drawn.
        self.is_thinned |= later.is_thinned || (self.first.0 < self.last.0 && self.points().len() < before);
    }

    /// Its points in the order of time, each once.
    fn points(&self) -> Vec<(Time, f64)> {
        let mut inner = [self.least, self.greatest];
        inner.sort_by_key(|(time, _)| *time);
        let mut points = vec![self.first, inner[0], inner[1], self.last];
        points.dedup();
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_are_all_kept() {
        let mut curve = Curve::new(4);
        let points: Vec<(Time, f64)> = (0..4).map(|k| (Time(k * 10), k as f64)).collect();
        points.iter().for_each(|(t, x)| curve.push(*t, *x));
        assert_eq!(curve.points(), (points, false));
    }

    #[test]
    fn what_is_no_number_is_a_gap() {
        let mut curve = Curve::new(9);
        for (t, x) in [(0, f64::NAN), (1, 1.0), (2, f64::NAN), (3, f64::INFINITY), (4, 4.0)] {
            curve.push(Time(t), x);
        }
        let (points, _) = curve.points();
        let shown: Vec<String> = points.iter().map(|(t, x)| format!("{}:{x}", t.0)).collect();
        assert_eq!(shown, ["1:1", "2:NaN", "4:4"]);
    }

    #[test]
    fn of_many_points_the_extremes_are_kept_where_they_were() {
        let mut curve = Curve::new(100);
        let value = |k: i64| {
            if k == 77_777 {
                1000.0
            } else if k == 5 {
                -1000.0
            } else {
                (k % 10) as f64
            }
        };
        (0..100_000).for_each(|k| curve.push(Time(k * 1_000_000), value(k)));
        let (points, is_thinned) = curve.points();
        assert!(is_thinned && points.len() <= 400, "{} points", points.len());
        assert!(points.is_sorted_by_key(|(time, _)| *time));
        assert!(points.contains(&(Time(77_777_000_000), 1000.0)) && points.contains(&(Time(5_000_000), -1000.0)));
        assert_eq!((points[0].0, points.last().map(|p| p.0)), (Time(0), Some(Time(99_999_000_000))));
        // Each stretch of time keeps its own extremes, so the small waves are still there.
        assert!(points.iter().filter(|(_, x)| *x == 9.0).count() >= 40);
    }

    #[test]
    fn around_a_failure_nothing_is_lost() {
        let mut curve = Curve::new(100);
        for k in 0..100_000_i64 {
            if k == 50_000 {
                curve.keep();
            }
            curve.push(Time(k), (k % 7) as f64);
        }
        let (points, _) = curve.points();
        assert!((49_990..50_010).all(|k| points.contains(&(Time(k), (k % 7) as f64))));
        assert!(points.is_sorted_by_key(|(time, _)| *time));
    }

    #[test]
    fn times_at_both_ends_of_the_world_have_a_place() {
        let mut curve = Curve::new(2);
        [i64::MIN, -1, 0, i64::MAX].iter().for_each(|t| curve.push(Time(*t), *t as f64));
        assert!(curve.points().0.len() >= 2);
    }
}
