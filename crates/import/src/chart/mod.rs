//! State charts as they are drawn: states in states, arrows with labels, pseudo-states. [`flat`] makes machines of them.

mod flat;
mod label;

use std::ops::Range;

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast::Expr;

pub(crate) use flat::write;
pub(crate) use label::{Clauses, Place, annotation, guard, label};

/// Charts with more states or arrows are not read.
pub(crate) const MOST_NODES: usize = 1_000;
pub(crate) const MOST_ARROWS: usize = 4_000;
/// States nest no deeper.
pub(crate) const MOST_DEPTH: usize = 32;

/// A chart. Its first node is the whole.
#[derive(Debug)]
pub(crate) struct Chart {
    /// What it is called.
    pub name: String,
    pub nodes: Vec<Node>,
    pub arrows: Vec<Arrow>,
    /// Whether of two arrows from one state the earlier is tried first.
    pub ordered: bool,
}

/// A state, or what looks like one.
#[derive(Debug)]
pub(crate) struct Node {
    /// Its name as it is written; empty for the whole and for regions.
    pub id: String,
    pub kind: Kind,
    pub parent: usize,
    pub children: Vec<usize>,
    /// Which of the children it begins in.
    pub initial: Option<usize>,
    /// What is said of the state itself.
    pub own: Clauses,
    /// Whether what an arrow's label says is in the language of specifications, and what a state's condition is stands beside it: a drawing of ours.
    pub annotation: Option<Annotation>,
    /// Where it comes among the states of a machine.
    pub rank: usize,
    pub place: Range<usize>,
}

/// What a drawing of a machine says besides the drawing.
#[derive(Debug, Default)]
pub(crate) struct Annotation {
    pub sample: Option<Expr>,
    pub else_stay: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    State,
    /// Its parent is done once it is entered.
    Final,
    /// Left at once, by the arrow whose guard holds.
    Choice,
    /// Its children are all active at once.
    Parallel,
    /// One of them.
    Region,
    History,
    /// Where the ways of regions part or meet.
    Fork,
}

/// An arrow between nodes.
#[derive(Debug)]
pub(crate) struct Arrow {
    pub from: usize,
    pub to: usize,
    pub trigger: Trigger,
    pub when: Option<Expr>,
    /// `else` at a choice.
    pub otherwise: bool,
    /// Whether it leads nowhere: whoever takes it stays where it is.
    pub stays: bool,
    pub place: Range<usize>,
}

/// When an arrow is taken.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Trigger {
    /// When the event occurs.
    Event(String),
    /// When the state that it leaves is done.
    Done,
    /// As soon as its guard holds; at once where it has none.
    Eventless,
    /// It is drawn, and nothing says when.
    Unsaid,
}

/// A state or an event, `what`, is called otherwise here, since its name is none of the language.
pub(crate) fn renamed(what: &str, written: &str, name: &str, place: Span) -> Diagnostic {
    Diagnostic::new(Code::ImportRenamed, place, format!("the {what} `{written}` is called `{name}` here"))
}

impl Chart {
    /// With nothing in it yet.
    pub(crate) fn new(name: &str, ordered: bool) -> Chart {
        let mut chart = Chart { name: name.to_owned(), nodes: Vec::new(), arrows: Vec::new(), ordered };
        chart.add("", Kind::State, 0, 0..0);
        chart
    }

    /// Adds a node. Gives its number.
    pub(crate) fn add(&mut self, id: &str, kind: Kind, parent: usize, place: Range<usize>) -> usize {
        let number = self.nodes.len();
        self.nodes.push(Node {
            id: id.to_owned(),
            kind,
            parent,
            children: Vec::new(),
            initial: None,
            own: Clauses::default(),
            annotation: None,
            rank: number,
            place,
        });
        if number != parent
            && let Some(parent) = self.nodes.get_mut(parent)
        {
            parent.children.push(number);
        }
        number
    }

    /// A node, and those around it, up to the whole.
    pub(crate) fn around(&self, node: usize) -> impl Iterator<Item = usize> {
        let parent = |n: &usize| self.nodes.get(*n).filter(|_| *n != 0).map(|node| node.parent);
        // No way up is longer than there are nodes.
        std::iter::successors(Some(node), parent).take(self.nodes.len())
    }

    /// Whether one node is another, or inside of it.
    pub(crate) fn is_in(&self, node: usize, outer: usize) -> bool {
        self.around(node).any(|n| n == outer)
    }
}
