//! Specifications as pictures: state diagrams, and which obligations a property puts when.

mod dot;
mod layout;
mod machine;
mod mermaid;
mod obligations;
mod svg;

use lapwing_check::checked::{Body, Spec as Meaning};

use super::formula::Printer;
use crate::spec::Spec;

/// A kind of picture.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Picture {
    /// For Graphviz.
    Dot,
    /// For Mermaid.
    Mermaid,
    /// To be looked at as it is.
    Svg,
}

/// The pictures of a specification: one for each property. `None` where it has none.
pub(super) fn draw(spec: &Spec, meaning: &Meaning, picture: Picture) -> Option<String> {
    let printer = Printer { spec, meaning };
    let graph = |property: &lapwing_check::checked::Property| match &property.body {
        Body::Machine(number) => machine::graph(&printer, meaning.machines.get(*number)?),
        Body::Formula(formula) => Some(obligations::graph(&printer, &property.name, formula)),
        Body::None => None,
    };
    let graphs: Vec<Graph> = meaning.properties.iter().filter_map(graph).collect();
    let text = match picture {
        Picture::Dot => dot::document(&graphs),
        Picture::Mermaid => mermaid::document(&graphs),
        Picture::Svg => svg::document(spec.name(), &graphs),
    };
    (!graphs.is_empty()).then_some(text)
}

/// Something with nodes and arrows, before it is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
struct Graph {
    title: String,
    /// Whether it is a state diagram.
    is_machine: bool,
    nodes: Vec<Node>,
    edges: Vec<Edge>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    label: String,
    shape: Shape,
}

/// What a node is, and so how it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// A state of a machine.
    State,
    /// The one that it begins in.
    Initial,
    /// When obligations arise.
    When,
    /// An operator.
    Operator,
    /// What is true or false at an instant.
    Condition,
}

#[derive(Clone, Debug, PartialEq)]
struct Edge {
    from: usize,
    to: usize,
    label: String,
}

impl Graph {
    /// Adds a node. Gives its number.
    fn node(&mut self, shape: Shape, label: impl Into<String>) -> usize {
        self.nodes.push(Node { label: label.into(), shape });
        self.nodes.len() - 1
    }

    /// Adds a node below another.
    fn below(&mut self, parent: usize, arrow: &str, shape: Shape, label: impl Into<String>) -> usize {
        let node = self.node(shape, label);
        self.edges.push(Edge { from: parent, to: node, label: arrow.to_owned() });
        node
    }
}
