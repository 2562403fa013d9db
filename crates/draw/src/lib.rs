//! Graphs as pictures: what a property asks, a state diagram, the components of a robot.
//!
//! Whoever has something to show makes [`Graph`]s of it; this crate lays them out and writes them, and knows nothing of what they mean.

#![forbid(unsafe_code)]

mod dot;
mod layout;
mod mermaid;
mod svg;

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

/// Something with nodes and arrows, before it is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// What stands above it.
    pub title: String,
    /// Whether it is a state diagram.
    pub is_machine: bool,
    /// The nodes; arrows name them by their place in this list.
    pub nodes: Vec<Node>,
    /// The arrows.
    pub edges: Vec<Edge>,
    /// What the drawing does not show, a line each: in formats with comments they are comments.
    pub remarks: Vec<String>,
}

/// A node.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// What stands in it, in one line or several.
    pub label: String,
    /// How it looks.
    pub shape: Shape,
}

/// What a node is, and so how it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
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
    /// A component.
    Component,
    /// A task of a component.
    Task,
    /// A port of a component.
    Port,
}

/// An arrow.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Where it begins.
    pub from: usize,
    /// Where it ends.
    pub to: usize,
    /// What stands at it; may be empty.
    pub label: String,
}

impl Graph {
    /// Adds a node. Gives its number.
    pub fn node(&mut self, shape: Shape, label: impl Into<String>) -> usize {
        self.nodes.push(Node { label: label.into(), shape });
        self.nodes.len() - 1
    }

    /// Adds a node below another.
    pub fn below(&mut self, parent: usize, arrow: &str, shape: Shape, label: impl Into<String>) -> usize {
        let node = self.node(shape, label);
        self.edge(parent, node, arrow);
        node
    }

    /// Adds an arrow.
    pub fn edge(&mut self, from: usize, to: usize, label: impl Into<String>) {
        self.edges.push(Edge { from, to, label: label.into() });
    }
}

/// One document with all the graphs; `name` is what it is called.
pub fn draw(name: &str, graphs: &[Graph], picture: Picture) -> String {
    match picture {
        Picture::Dot => dot::document(graphs),
        Picture::Mermaid => mermaid::document(graphs),
        Picture::Svg => svg::document(name, graphs),
    }
}
