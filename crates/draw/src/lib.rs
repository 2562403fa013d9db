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
    /// Where a machine is that is in none of its states.
    Nowhere,
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
    /// Whether it is a way that was taken although the graph does not have it.
    pub is_wrong: bool,
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
        self.edges.push(Edge { from, to, label: label.into(), is_wrong: false });
    }

    /// Adds a way that was taken although the graph does not have it.
    pub fn wrong(&mut self, from: usize, to: usize, label: impl Into<String>) {
        self.edges.push(Edge { from, to, label: label.into(), is_wrong: true });
    }

    /// The first line of a node's label: what it is called.
    pub fn name(&self, node: usize) -> &str {
        self.nodes.get(node).and_then(|n| n.label.lines().next()).unwrap_or_default()
    }
}

/// A graph as an element of an HTML page, whose styles say how it looks: `.state`, `.initial` and `.nowhere` are boxes, `.arrow` and `.head` arrows, `.wrong` what
/// was a wrong way, `.ground` what is behind a label. `id` is the page's, for this graph alone; `told` is what a reader hears who does not see it.
pub fn figure(graph: &Graph, id: &str, told: &str) -> String {
    svg::figure(graph, id, told)
}

/// One document with all the graphs; `name` is what it is called.
pub fn draw(name: &str, graphs: &[Graph], picture: Picture) -> String {
    match picture {
        Picture::Dot => dot::document(graphs),
        Picture::Mermaid => mermaid::document(graphs),
        Picture::Svg => svg::document(name, graphs),
    }
}
