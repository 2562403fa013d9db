//! Counts over several recordings, and how things stand.

use lapwing_stream::Verdict;

use crate::report::Report;

/// How things stand after one or several recordings, from the best to the worst.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub enum Standing {
    /// Every property came out well on everything that there was.
    #[default]
    Good,
    /// None failed, but one could not be judged, or not everything was looked at.
    Open,
    /// At least one failed.
    Failed,
}

/// Counts over several recordings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Recordings.
    pub traces: u64,
    /// Verdicts of each kind, from the worst to the best.
    pub verdicts: [u64; 5],
    /// Successes in which nothing was put to the test.
    pub vacuous: u64,
    /// Recordings of which not everything was looked at.
    pub gaps: u64,
    /// Whether these are runs of a live robot, and no recordings.
    pub is_live: bool,
}

impl Tally {
    /// All verdicts, from the worst to the best: the order of [`Tally::verdicts`].
    pub const VERDICTS: [Verdict; 5] =
        [Verdict::Violated, Verdict::Unmet, Verdict::Inconclusive, Verdict::Holds, Verdict::Satisfied];

    /// Counts a report.
    pub fn add(&mut self, report: &Report) {
        self.traces += 1;
        self.gaps += u64::from(!report.gaps.is_empty());
        for property in &report.properties {
            self.vacuous += u64::from(property.vacuous);
            if let Some(kind) = Tally::VERDICTS.iter().position(|v| *v == property.verdict) {
                self.verdicts[kind] += 1;
            }
        }
    }

    /// Adds what was counted elsewhere.
    pub fn join(&mut self, other: &Tally) {
        self.traces += other.traces;
        self.vacuous += other.vacuous;
        self.gaps += other.gaps;
        self.verdicts.iter_mut().zip(other.verdicts).for_each(|(a, b)| *a += b);
    }

    /// How things stand.
    pub fn standing(&self) -> Standing {
        let [violated, unmet, inconclusive, ..] = self.verdicts;
        match () {
            () if violated + unmet > 0 => Standing::Failed,
            () if inconclusive + self.gaps > 0 => Standing::Open,
            () => Standing::Good,
        }
    }
}

impl Report {
    /// How things stand after this recording.
    pub fn standing(&self) -> Standing {
        let mut tally = Tally::default();
        tally.add(self);
        tally.standing()
    }
}
