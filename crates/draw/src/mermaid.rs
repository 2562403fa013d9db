//! Graphs for Mermaid: a state diagram where there is nothing else, else a flow chart with a part for each.

use std::fmt::Write;

use super::{Graph, Node, Shape};

/// The document.
pub(super) fn document(graphs: &[Graph]) -> String {
    match graphs.iter().all(|g| g.is_machine) {
        true => states(graphs),
        false => flow(graphs),
    }
}

fn states(graphs: &[Graph]) -> String {
    let mut out = String::from("stateDiagram-v2\n");
    for graph in graphs {
        let id = |node: usize| format!("{}_{}", graph.title, graph.name(node));
        let _ = writeln!(out, "  state {} {{", graph.title);
        for remark in &graph.remarks {
            let _ = writeln!(out, "    %% lapwing: {}", remark.replace('\n', " "));
        }
        for (k, node) in graph.nodes.iter().enumerate() {
            let _ = writeln!(out, "    {} : {}", id(k), escaped(&node.label));
            if node.shape == Shape::Initial {
                let _ = writeln!(out, "    [*] --> {}", id(k));
            }
        }
        for edge in &graph.edges {
            let label = if edge.label.is_empty() { String::new() } else { format!(" : {}", escaped(&edge.label)) };
            let _ = writeln!(out, "    {} --> {}{label}", id(edge.from), id(edge.to));
        }
        out += "  }\n";
    }
    out
}

fn flow(graphs: &[Graph]) -> String {
    let mut out = String::from("flowchart TD\n");
    for (number, graph) in graphs.iter().enumerate() {
        let id = |node: usize| format!("g{number}n{node}");
        let _ = writeln!(out, "  subgraph g{number}[\"{}\"]", escaped(&graph.title));
        for (k, node) in graph.nodes.iter().enumerate() {
            let _ = writeln!(out, "    {}{}", id(k), boxed(node));
        }
        for edge in &graph.edges {
            let label = if edge.label.is_empty() { String::new() } else { format!("|\"{}\"|", escaped(&edge.label)) };
            let line = if edge.is_wrong { "-.->" } else { "-->" };
            let _ = writeln!(out, "    {} {line}{label} {}", id(edge.from), id(edge.to));
        }
        out += "  end\n";
    }
    out
}

fn boxed(node: &Node) -> String {
    let label = escaped(&node.label);
    match node.shape {
        Shape::State | Shape::Nowhere | Shape::Operator => format!("(\"{label}\")"),
        Shape::Initial => format!("(((\"{label}\")))"),
        Shape::When => format!("{{{{\"{label}\"}}}}"),
        Shape::Condition | Shape::Component => format!("[\"{label}\"]"),
        Shape::Task => format!("[[\"{label}\"]]"),
        Shape::Port => format!("{{{{\"{label}\"}}}}"),
    }
}

/// A text without what Mermaid takes for its own.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\n' => out += "<br>",
            '"' | '#' | ';' | '&' | '`' => out += &format!("#{};", u32::from(c)),
            c => out.push(c),
        }
    }
    out
}
