//! In which piece of a recording an episode of failures was: its stamps alone do not say so once time has jumped.

use std::collections::BTreeMap;

use lapwing_engine::Episode;
use lapwing_react::history::Mark;
use lapwing_stream::Value;

use super::axis::Axis;
use crate::instance::Instance;

/// How many episodes each property had in each piece. The engine lists episodes piece by piece.
#[derive(Debug, Default)]
pub(super) struct Alarms {
    counts: BTreeMap<Instance, Vec<usize>>,
}

impl Alarms {
    /// An episode of a property, or of an instance of it, began in this piece.
    pub fn note(&mut self, property: usize, instance: &[Option<Value>], piece: usize) {
        let counts = self.counts.entry(Instance::running(property, instance)).or_default();
        if counts.len() <= piece {
            counts.resize(piece + 1, 0);
        }
        counts[piece] += 1;
    }

    /// Where the episodes of a property, or of an instance of it, are on the axis.
    pub fn marks(&self, property: usize, instance: &[Value], episodes: &[Episode], axis: &Axis) -> Vec<Mark> {
        let counts = self.counts.get(&Instance::of(property, instance));
        let counts = counts.into_iter().flatten().enumerate();
        let pieces = counts.flat_map(|(piece, count)| std::iter::repeat_n(piece, *count));
        let pieces = pieces.chain(std::iter::repeat(axis.piece()));
        let mark = |(episode, piece): (&Episode, usize)| Mark {
            began: axis.at(piece, episode.began),
            failed: axis.at(piece, episode.failed),
            until: axis.at(piece, episode.until),
        };
        episodes.iter().zip(pieces).map(mark).collect()
    }
}
