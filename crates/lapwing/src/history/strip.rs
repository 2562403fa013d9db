//! How signals go from one look to the next while a run goes on: a few points of each, handed out and forgotten when somebody looks. So the memory
//! does not grow with the run; whoever wants to see further back keeps what was handed out.

use lapwing_check::checked;
use lapwing_draw::Graph;
use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Alarm, Observer, Output};
use lapwing_react::history::{Plot, Shape, Track};

use super::diagrams::Diagrams;
use super::plan::Plan;
use super::tracks::Tracks;
use crate::spec::Spec;

/// So many buckets of a curve, each of up to four points, are handed out at a look: enough for the least and the greatest value since the last.
const BUCKETS: usize = 2;

/// What the signals of one specification did since somebody looked.
#[derive(Debug)]
pub(crate) struct Strip {
    plan: Plan,
    diagrams: Diagrams,
    tracks: Tracks,
    /// Which tracks have come as numbers.
    is_curve: Vec<bool>,
}

impl Strip {
    /// Of a specification.
    pub fn new(spec: &Spec, meaning: &checked::Spec) -> Strip {
        let plan = Plan::new(spec, meaning);
        let diagrams = Diagrams::new(spec, meaning);
        Strip { diagrams, tracks: Tracks::new(&plan.wanted, BUCKETS), is_curve: vec![false; plan.wanted.len()], plan }
    }

    /// What the signals did since this was asked last, in the order of their numbers.
    pub fn take(&mut self) -> Vec<Track> {
        let fresh = Tracks::new(&self.plan.wanted, BUCKETS);
        let tracks = std::mem::replace(&mut self.tracks, fresh).finish(None, &self.plan.wanted);
        for (is_curve, track) in self.is_curve.iter_mut().zip(&tracks) {
            *is_curve |= matches!(&track.shape, Shape::Curve(points) if !points.is_empty());
        }
        tracks
    }

    /// The tracks of a property that are drawn as lanes, and those that are drawn as curves.
    pub fn drawn(&self, property: usize) -> (Vec<usize>, Vec<Plot>) {
        self.plan.drawn(property, |track| self.is_curve.get(track).copied().unwrap_or_default())
    }

    /// The diagram of a property that is one, with the illegal moves of the whole run.
    pub fn diagram(&self, property: usize) -> Option<Graph> {
        self.diagrams.of(property)
    }
}

impl Observer for Strip {
    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        match output {
            Output::Instant(stamp) => self.tracks.instant(inputs, stamp, &self.plan.wanted),
            Output::Alarm(Alarm { property, illegal, .. }) | Output::Further(Alarm { property, illegal, .. }) => {
                illegal.into_iter().for_each(|made| self.diagrams.note(property, made));
            }
            // What was before belongs to another time.
            Output::Jump { .. } => self.tracks = Tracks::new(&self.plan.wanted, BUCKETS),
        }
    }
}
