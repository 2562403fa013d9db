//! State diagrams, with the moves that were made although they do not have them.

use std::collections::BTreeMap;

use lapwing_check::checked;
use lapwing_draw::{Graph, Shape};
use lapwing_engine::Move;

use crate::explain;
use crate::spec::Spec;

/// The diagram of each property that is one. What is kept does not grow with a run: there are no more moves than pairs of states.
#[derive(Debug)]
pub(super) struct Diagrams {
    all: Vec<Option<Diagram>>,
}

/// A diagram as it was written, and how often each illegal move was made.
#[derive(Debug)]
struct Diagram {
    graph: Graph,
    moves: BTreeMap<Move, u64>,
}

impl Diagrams {
    /// Of a specification.
    pub fn new(spec: &Spec, meaning: &checked::Spec) -> Diagrams {
        let diagram =
            |property| explain::diagram(spec, meaning, property).map(|graph| Diagram { graph, moves: BTreeMap::new() });
        Diagrams { all: meaning.properties.iter().map(diagram).collect() }
    }

    /// A machine has made a move that its diagram does not have.
    pub fn note(&mut self, property: usize, made: Move) {
        if let Some(Some(diagram)) = self.all.get_mut(property) {
            *diagram.moves.entry(made).or_default() += 1;
        }
    }

    /// How it looks by now.
    pub fn of(&self, property: usize) -> Option<Graph> {
        self.all.get(property)?.as_ref().map(Diagram::marked)
    }
}

impl Diagram {
    fn marked(&self) -> Graph {
        let mut graph = self.graph.clone();
        let mut nowhere = None;
        for (made, count) in &self.moves {
            let mut place = |state: Option<usize>| match state {
                Some(state) => state,
                None => *nowhere.get_or_insert_with(|| graph.node(Shape::Nowhere, "undefined")),
            };
            let (from, to) = (place(made.from), place(made.to));
            let what = if made.to.is_none() { "no state fits" } else { "illegal" };
            graph.wrong(from, to, format!("{what}, {}", often(*count)));
        }
        graph
    }
}

fn often(count: u64) -> String {
    match count {
        1 => "once".to_owned(),
        n => format!("{n} times"),
    }
}
