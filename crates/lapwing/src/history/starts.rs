//! When each property started: once all that it reads was defined, as far back as it looks.

use lapwing_check::checked::{self, ReadOf};
use lapwing_engine::inputs::Inputs;
use lapwing_stream::{Sample, Time, Value, What};

use super::axis::Axis;

/// When the properties started, in each piece.
#[derive(Debug)]
pub(super) struct Starts {
    /// Which topics have spoken in this piece.
    heard: Vec<bool>,
    properties: Vec<Start>,
}

/// What a property waits for.
#[derive(Debug)]
struct Start {
    reads: Vec<(ReadOf, usize)>,
    /// For how many instants each has been defined.
    waited: Vec<usize>,
    /// In each piece, when it started.
    at: Vec<Option<Time>>,
    /// One over events alone starts with the trace.
    is_over_events: bool,
}

impl Starts {
    pub fn new(meaning: &checked::Spec) -> Starts {
        let start = |p: &checked::Property| Start {
            reads: p.reads.iter().map(|r| (r.what, r.depth)).collect(),
            waited: vec![0; p.reads.len()],
            at: Vec::new(),
            is_over_events: p.alphabet.is_some(),
        };
        let properties = meaning.properties.iter().map(start).collect();
        Starts { heard: vec![false; meaning.topics.len()], properties }
    }

    /// A message came.
    pub fn hear(&mut self, sample: &Sample<'_>) {
        if let What::Message { topic, .. } = sample.what
            && let Some(heard) = self.heard.get_mut(topic)
        {
            *heard = true;
        }
    }

    /// An instant is over.
    pub fn instant(&mut self, inputs: &Inputs, stamp: Time, axis: &Axis) {
        let (piece, heard) = (axis.piece(), &self.heard);
        let is_defined = |what: ReadOf| match what {
            ReadOf::Input(input) => *inputs.value(input) != Value::Missing,
            ReadOf::Topic(topic) => heard.get(topic).copied().unwrap_or_default(),
        };
        for start in &mut self.properties {
            start.at.resize(piece + 1, None);
            if start.at[piece].is_none() && !start.is_over_events && start.is_ready(is_defined) {
                start.at[piece] = Some(axis.now(stamp));
            }
        }
    }

    /// Time jumped: everything starts anew.
    pub fn jump(&mut self) {
        self.heard.fill(false);
        self.properties.iter_mut().for_each(|start| start.waited.fill(0));
    }

    /// When a property started, in each piece.
    pub fn of(&self, property: usize, axis: &Axis) -> Vec<Option<Time>> {
        match self.properties.get(property) {
            Some(start) if start.is_over_events => axis.pieces().iter().map(|piece| Some(piece.from)).collect(),
            Some(start) => start.at.clone(),
            None => Vec::new(),
        }
    }
}

impl Start {
    fn is_ready(&mut self, is_defined: impl Fn(ReadOf) -> bool) -> bool {
        let mut ready = true;
        for ((what, depth), waited) in self.reads.iter().zip(&mut self.waited) {
            *waited += usize::from(is_defined(*what));
            ready &= *waited > *depth;
        }
        ready
    }
}
