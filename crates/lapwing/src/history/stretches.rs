//! Stretches of time, and how a property stood in each.

use lapwing_react::history::{Phase, Piece, Stand};
use lapwing_stream::Time;

/// From when until when, both included.
pub(super) type Stretch = (Time, Time);

/// Puts stretches in order, joins what touches, and bridges the smallest gaps where there are more than so many.
pub(super) fn thin(mut stretches: Vec<Stretch>, most: usize) -> Vec<Stretch> {
    stretches.sort();
    stretches.dedup_by(|next, before| {
        let touches = next.0 <= before.1;
        if touches {
            before.1 = before.1.max(next.1);
        }
        touches
    });
    let Some(many) = stretches.len().checked_sub(most.max(1)).filter(|n| *n > 0) else { return stretches };
    let gap = |a: &Stretch, b: &Stretch| b.0.0.saturating_sub(a.1.0);
    let mut gaps: Vec<i64> = stretches.windows(2).map(|w| gap(&w[0], &w[1])).collect();
    let (_, bridged, _) = gaps.select_nth_unstable(many - 1);
    let bridged = *bridged;
    stretches.dedup_by(|next, before| {
        let is_near = gap(before, next) <= bridged;
        if is_near {
            before.1 = next.1;
        }
        is_near
    });
    stretches
}

/// What is known of a property over time; each list is in order and without overlaps.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// For each piece, when the property started.
    pub starts: Vec<Option<Time>>,
    pub failed: Vec<Stretch>,
    /// When its outermost scope was open, where it has one that can be looked at.
    pub open: Option<Vec<Stretch>>,
    pub unmet_since: Option<Time>,
    /// It could not be judged.
    pub is_unknown: bool,
}

impl Known {
    /// How the property stood, from the beginning of the recording to its end.
    pub fn phases(&self, pieces: &[Piece]) -> Vec<Phase> {
        let mut cuts: Vec<Time> = pieces.iter().flat_map(|p| [p.from, p.to]).collect();
        let stretches = self.failed.iter().chain(self.open.iter().flatten());
        cuts.extend(stretches.flat_map(|s| [s.0, s.1]).chain(self.starts.iter().flatten().copied()));
        cuts.extend(self.unmet_since);
        cuts.sort();
        cuts.dedup();
        let ends = (pieces.first().map(|p| p.from), pieces.last().map(|p| p.to));
        cuts.retain(|cut| Some(*cut) >= ends.0 && Some(*cut) <= ends.1);
        let mut phases: Vec<Phase> = Vec::new();
        for cut in cuts.windows(2) {
            let stand = self.between(pieces, cut[0], cut[1]);
            match phases.last_mut().filter(|p| p.stand == stand) {
                Some(last) => last.to = cut[1],
                None => phases.push(Phase { from: cut[0], to: cut[1], stand }),
            }
        }
        phases
    }

    /// How it stood between two times between which nothing changes.
    fn between(&self, pieces: &[Piece], from: Time, to: Time) -> Stand {
        let piece = pieces.partition_point(|p| p.from <= from).saturating_sub(1);
        let start = self.starts.get(piece).copied().flatten();
        if covers(&self.failed, from, to) {
            Stand::Failed
        } else if start.is_none_or(|start| to <= start) {
            Stand::NotStarted
        } else if self.unmet_since.is_some_and(|since| since <= from) {
            Stand::Unmet
        } else if self.is_unknown {
            Stand::Unknown
        } else if self.open.as_ref().is_some_and(|open| !covers(open, from, to)) {
            Stand::Idle
        } else {
            Stand::Holds
        }
    }
}

fn covers(stretches: &[Stretch], from: Time, to: Time) -> bool {
    let after = stretches.partition_point(|s| s.0 <= from);
    after.checked_sub(1).and_then(|i| stretches.get(i)).is_some_and(|s| to <= s.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(from: i64, to: i64) -> Stretch {
        (Time(from), Time(to))
    }

    #[test]
    fn the_smallest_gaps_are_bridged() {
        let all = vec![stretch(20, 21), stretch(0, 1), stretch(3, 4), stretch(4, 5), stretch(10, 11)];
        assert_eq!(thin(all.clone(), 9), [stretch(0, 1), stretch(3, 5), stretch(10, 11), stretch(20, 21)]);
        assert_eq!(thin(all.clone(), 3), [stretch(0, 5), stretch(10, 11), stretch(20, 21)]);
        assert_eq!(thin(all, 1), [stretch(0, 21)]);
    }

    #[test]
    fn a_property_waits_stands_and_fails() {
        let pieces = [Piece { from: Time(0), to: Time(50), stamp: Time(0) }];
        let known = Known {
            starts: vec![Some(Time(10))],
            failed: vec![stretch(30, 40)],
            open: Some(vec![stretch(20, 45)]),
            ..Known::default()
        };
        let stands: Vec<(i64, Stand)> = known.phases(&pieces).iter().map(|p| (p.from.0, p.stand)).collect();
        let expected = [
            (0, Stand::NotStarted),
            (10, Stand::Idle),
            (20, Stand::Holds),
            (30, Stand::Failed),
            (40, Stand::Holds),
            (45, Stand::Idle),
        ];
        assert_eq!(stands, expected);
    }

    #[test]
    fn what_never_started_and_what_was_cut_by_a_jump() {
        let piece = |from, to| Piece { from: Time(from), to: Time(to), stamp: Time(0) };
        let known = Known { starts: vec![None, Some(Time(60))], is_unknown: true, ..Known::default() };
        let phases = known.phases(&[piece(0, 50), piece(50, 100)]);
        let expected = [(0, 60, Stand::NotStarted), (60, 100, Stand::Unknown)];
        assert_eq!(phases.iter().map(|p| (p.from.0, p.to.0, p.stand)).collect::<Vec<_>>(), expected);
    }
}
