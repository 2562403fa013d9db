//! Distributions as five numbers each, and tables of them.

use std::fmt::Write as _;

use super::{Place, Times, Way};

/// What a box plot shows of a distribution, in nanoseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Box {
    /// How many there are.
    pub count: usize,
    /// The quartiles.
    pub quartiles: [f64; 3],
    /// How far the whiskers reach: to what is farthest of what lies no farther from the box than one and a half times its length (Tukey).
    pub whiskers: [f64; 2],
    /// What lies beyond.
    pub outliers: Vec<f64>,
}

impl Box {
    /// The box of a distribution, where it has anything in it.
    pub fn of(times: &[u64]) -> Option<Box> {
        let mut sorted: Vec<f64> = times.iter().map(|&time| time as f64).collect();
        sorted.sort_by(f64::total_cmp);
        let quartiles = [0.25, 0.5, 0.75].map(|share| quantile(&sorted, share));
        let reach = 1.5 * (quartiles[2] - quartiles[0]);
        let is_near = |time: &f64| (quartiles[0] - reach..=quartiles[2] + reach).contains(time);
        let near = || sorted.iter().copied().filter(is_near);
        let whiskers = [near().next()?, near().next_back()?];
        let outliers = sorted.iter().copied().filter(|time| !is_near(time)).collect();
        Some(Box { count: sorted.len(), quartiles, whiskers, outliers })
    }

    /// Half of them take no longer.
    pub fn median(&self) -> f64 {
        self.quartiles[1]
    }

    /// The longest.
    pub fn longest(&self) -> f64 {
        self.outliers.last().map_or(self.whiskers[1], |outlier| outlier.max(self.whiskers[1]))
    }
}

/// Between two of them in proportion.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * sorted.len().saturating_sub(1) as f64;
    let nth = |n: f64| sorted.get(n as usize).copied().unwrap_or(f64::NAN);
    let (below, above) = (nth(at.floor()), nth(at.ceil()));
    below + (above - below) * at.fract()
}

/// A table for each place: each way with its quartiles, and what it adds to the first way, the program that nobody listens to.
pub fn tables(measured: &[(Way, Times)]) -> String {
    let mut text = String::new();
    for place in Place::ALL {
        let boxes: Vec<(&Way, Box)> = of_place(measured, place).collect();
        let Some((_, base)) = boxes.first() else { continue };
        let (name, figure) = place.name();
        // Writing to a text does not fail.
        let _ = writeln!(text, "**{name}** (figure {figure}, {} calls each)\n", base.count);
        let _ = writeln!(text, "| | Q1 | median | Q3 | longest | ratio | more |");
        let _ = writeln!(text, "| --- | ---: | ---: | ---: | ---: | ---: | ---: |");
        for (way, of) in &boxes {
            let [low, median, high] = of.quartiles.map(shown);
            let longest = shown(of.longest());
            let ratio = of.median() / base.median();
            let more = shown(of.median() - base.median());
            let _ = writeln!(text, "| {} | {low} | {median} | {high} | {longest} | {ratio:.2} | {more} |", way.name());
        }
        text.push('\n');
    }
    text
}

/// The boxes of a place, by way.
pub(super) fn of_place(measured: &[(Way, Times)], place: Place) -> impl Iterator<Item = (&Way, Box)> {
    measured.iter().filter_map(move |(way, times)| Some((way, Box::of(times.get(&place)?)?)))
}

/// Nanoseconds in three digits or so.
pub(super) fn shown(nanos: f64) -> String {
    match nanos.abs() {
        ..1e4 => format!("{nanos:.0} ns"),
        ..1e5 => format!("{:.1} µs", nanos / 1e3),
        ..1e7 => format!("{:.0} µs", nanos / 1e3),
        _ => format!("{:.0} ms", nanos / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_those_of_tukey() {
        let of = Box::of(&[7, 1, 3, 5, 9, 100]).unwrap();
        assert_eq!((of.count, of.quartiles, of.whiskers), (6, [3.5, 6.0, 8.5], [1.0, 9.0]));
        assert_eq!((of.outliers.as_slice(), of.longest()), ([100.0].as_slice(), 100.0));
        assert_eq!(Box::of(&[]), None);
        assert_eq!(Box::of(&[4]).unwrap().whiskers, [4.0, 4.0]);
    }

    #[test]
    fn times_are_told_in_units_that_fit() {
        assert_eq!([57.4, 12_345.0, 234_567.0, 2.5e7].map(shown), ["57 ns", "12.3 µs", "235 µs", "25 ms"]);
    }
}
