//! Graphs for Graphviz.

use std::fmt::Write;

use super::{Edge, Graph, Node, Shape};

/// A document with a cluster for each graph.
pub(super) fn document(graphs: &[Graph]) -> String {
    let mut out = String::from("digraph {\n  node [fontname=\"sans-serif\"];\n  edge [fontname=\"sans-serif\"];\n");
    for (number, graph) in graphs.iter().enumerate() {
        let id = |node: usize| format!("\"{number}.{node}\"");
        let _ = writeln!(out, "  subgraph \"cluster_{number}\" {{\n    label={};", quoted(&graph.title));
        for (k, node) in graph.nodes.iter().enumerate() {
            let _ = writeln!(out, "    {} [label={}{}];", id(k), quoted(&node.label), look(node));
        }
        for edge in &graph.edges {
            let _ = writeln!(out, "    {} -> {}{};", id(edge.from), id(edge.to), attributes(edge));
        }
        out += "  }\n";
    }
    out + "}\n"
}

fn attributes(edge: &Edge) -> String {
    let label = (!edge.label.is_empty()).then(|| format!("label={}", quoted(&edge.label)));
    let wrong = edge.is_wrong.then(|| "style=dashed, color=\"#c63d0f\", fontcolor=\"#c63d0f\"".to_owned());
    let all: Vec<String> = label.into_iter().chain(wrong).collect();
    if all.is_empty() { String::new() } else { format!(" [{}]", all.join(", ")) }
}

fn look(node: &Node) -> &'static str {
    match node.shape {
        Shape::State => "",
        Shape::Initial => ", peripheries=2",
        Shape::Nowhere => ", style=dashed, color=\"#c63d0f\"",
        Shape::When => ", shape=note",
        Shape::Operator => ", shape=box, style=rounded",
        Shape::Condition => ", shape=box",
        Shape::Component => ", shape=box, penwidth=2",
        Shape::Task => ", shape=component",
        Shape::Port => ", shape=octagon",
    }
}

/// A text between quotes, as Graphviz reads them: only quotes and backslashes are special.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}
