//! How often properties fired on many recordings, and by how much they missed.

mod json;
mod text;

use lapwing_stream::Verdict;

use crate::report::Report;

pub use json::json;
pub use text::text;

/// So many bars has a histogram of margins.
const BARS: usize = 8;

/// What is known of a recording beforehand.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Mark {
    /// The robot did what it should: an alarm is a false one.
    Good,
    /// Something went wrong: it should be caught.
    Bad,
    /// Nothing.
    #[default]
    Unmarked,
}

/// How properties did on many recordings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backtest {
    /// The specifications.
    pub specs: Vec<String>,
    /// The recordings, in their order.
    pub runs: Vec<Run>,
    /// The properties, in the order of the text.
    pub properties: Vec<Record>,
    /// What became of the search for a value, where there was one.
    pub tuned: Option<Tuned>,
}

/// A recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// Its name.
    pub trace: String,
    /// What is known of it.
    pub mark: Mark,
    /// How many alarms all properties gave.
    pub alarms: usize,
    /// Why not all of it was looked at, where that is so.
    pub gaps: Vec<String>,
}

/// How one property did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Its name.
    pub name: String,
    /// Its file.
    pub file: String,
    /// Its line, from 1.
    pub line: usize,
    /// The recordings in which it failed, by number.
    pub fired_in: Vec<usize>,
    /// Episodes of failures; one for what was due and did not come.
    pub alarms: usize,
    /// The recordings in which it could not be judged, by number.
    pub open_in: Vec<usize>,
    /// The recordings in which something put it to the test, by number.
    pub tested_in: Vec<usize>,
    /// Its margins, each with the number of the recording.
    pub margins: Vec<(usize, f64)>,
}

/// What became of the search for a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuned {
    /// The name that was tuned.
    pub name: String,
    /// Its unit as written, where it has one.
    pub unit: Option<String>,
    /// The value in the specification.
    pub current: Tried,
    /// The smallest value that fits, and the largest: `None` where none does.
    pub fits: Option<(Tried, Tried)>,
    /// The range that was searched.
    pub searched: (f64, f64),
    /// What every value of the first round did.
    pub tried: Vec<Tried>,
    /// The properties that depend on it.
    pub properties: Vec<String>,
    /// How many recordings are marked good, and how many bad.
    pub marked: (usize, usize),
}

/// What a value did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tried {
    /// The value.
    pub value: f64,
    /// How many good recordings gave an alarm.
    pub false_alarms: usize,
    /// How many bad ones gave none.
    pub missed: usize,
}

impl Tried {
    /// Whether no good recording gives an alarm, and every bad one does.
    pub fn fits(&self) -> bool {
        self.false_alarms == 0 && self.missed == 0
    }
}

impl Backtest {
    /// Adds what was said of a recording.
    pub fn add(&mut self, report: &Report, mark: Mark) {
        let number = self.runs.len();
        self.specs.clone_from(&report.specs);
        let mut alarms = 0;
        for property in &report.properties {
            let index = self.record(property);
            let record = &mut self.properties[index];
            let fired = match property.verdict {
                Verdict::Violated => property.violations.len(),
                Verdict::Unmet => 1,
                _ => 0,
            };
            if fired > 0 {
                record.fired_in.push(number);
            }
            if property.verdict == Verdict::Inconclusive {
                record.open_in.push(number);
            } else if !property.vacuous
                && property.obligations.met + property.obligations.failed + property.obligations.open > 0
            {
                record.tested_in.push(number);
            }
            record.alarms += fired;
            record.margins.extend(property.margin.map(|m| (number, m)));
            alarms += fired;
        }
        self.runs.push(Run { trace: report.trace.clone(), mark, alarms, gaps: report.gaps.clone() });
    }

    /// The number of the record of a property; instances that a recording brings come after those known.
    fn record(&mut self, property: &crate::report::Property) -> usize {
        let is_same = |r: &Record| r.name == property.name && r.file == property.file;
        self.properties.iter().position(is_same).unwrap_or_else(|| {
            let (name, file, line) = (property.name.clone(), property.file.clone(), property.line);
            self.properties.push(Record { name, file, line, ..Record::default() });
            self.properties.len() - 1
        })
    }

    /// How many recordings are marked so.
    pub fn marked(&self, mark: Mark) -> usize {
        self.runs.iter().filter(|r| r.mark == mark).count()
    }
}

/// A bar of a histogram: how many lie from here, to there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bar {
    from: f64,
    to: f64,
    count: usize,
}

/// The finite margins of a record in bars of equal width.
fn histogram(margins: &[(usize, f64)]) -> Vec<Bar> {
    let finite: Vec<f64> = margins.iter().map(|(_, m)| *m).filter(|m| m.is_finite()).collect();
    let least = finite.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = finite.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if finite.is_empty() {
        return Vec::new();
    }
    let count = if least == greatest { 1 } else { BARS };
    let width = (greatest - least) / count as f64;
    let edge = |k: usize| if k == count { greatest } else { least + width * k as f64 };
    let mut bars: Vec<Bar> = (0..count).map(|k| Bar { from: edge(k), to: edge(k + 1), count: 0 }).collect();
    for margin in finite {
        let place = if width > 0.0 { (((margin - least) / width) as usize).min(count - 1) } else { 0 };
        bars[place].count += 1;
    }
    bars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_margin_is_in_one_bar() {
        let margins: Vec<(usize, f64)> = [0.0, 0.1, 0.5, 1.0, f64::INFINITY].into_iter().enumerate().collect();
        let bars = histogram(&margins);
        assert_eq!(bars.iter().map(|b| b.count).collect::<Vec<_>>(), [2, 0, 0, 0, 1, 0, 0, 1]);
        assert_eq!((bars[0].from, bars[7].to), (0.0, 1.0));
        assert_eq!(histogram(&[(0, 2.0), (1, 2.0)]), [Bar { from: 2.0, to: 2.0, count: 2 }]);
        assert!(histogram(&[(0, f64::INFINITY)]).is_empty());
    }
}
