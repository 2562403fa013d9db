//! Graphs as SVG, one below the other, light or dark as the viewer is.

use std::fmt::Write;

use super::layout::{Layout, Place, Size, Wanted, layout};
use super::{Graph, Shape};

/// The width of a character and the height of a line, in the font of the labels.
const CHARACTER: f64 = 7.3;
const LINE: f64 = 16.0;
/// What is around the text of a box.
const PADDING: Size = (12.0, 8.0);
/// What is around everything.
const MARGIN: f64 = 20.0;
/// What is around a graph in a page, for the lines of its boxes.
const EDGE: f64 = 2.0;
/// The height of a title.
const TITLE: f64 = 34.0;
/// Labels are broken into lines that are not much longer, in characters.
const LONG: usize = 34;
/// What an arrow from a box to itself takes on its right.
const LOOP: f64 = 36.0;

const STYLE: &str = "\
svg { background: #fff; color: #1f2328; }
text { font: 12px ui-monospace, Menlo, Consolas, 'DejaVu Sans Mono', monospace; fill: currentColor; }
.title { font: 600 15px system-ui, sans-serif; }
rect, path.arrow { fill: none; stroke: currentColor; stroke-width: 1.2; }
path.arrow { stroke: #6e7781; } .head { fill: #6e7781; }
.wrong path.arrow, .nowhere rect { stroke: #c63d0f; stroke-dasharray: 5 3; } .wrong text, .head.wrong { fill: #c63d0f; }
.state rect { fill: #ddf4ff; stroke: #0969da; } .initial rect { fill: #ddf4ff; stroke: #0969da; stroke-width: 3; }
.when rect { fill: #fff8c5; stroke: #9a6700; } .operator rect { fill: #f6f8fa; stroke: #6e7781; }
.condition rect, .port rect { fill: #dafbe1; stroke: #1a7f37; }
.component rect { fill: #f6f8fa; stroke: #1f2328; stroke-width: 2; } .task rect { fill: #fff8c5; stroke: #9a6700; }
rect.ground { fill: #fff; stroke: none; }
@media (prefers-color-scheme: dark) {
svg { background: #0d1117; color: #e6edf3; }
.state rect, .initial rect { fill: #0c2d6b; stroke: #58a6ff; } .when rect { fill: #3b2300; stroke: #d29922; }
.operator rect { fill: #161b22; stroke: #8b949e; } .condition rect, .port rect { fill: #033a16; stroke: #3fb950; }
.component rect { fill: #161b22; stroke: #e6edf3; } .task rect { fill: #3b2300; stroke: #d29922; }
rect.ground { fill: #0d1117; }
.wrong path.arrow, .nowhere rect { stroke: #ff7d47; } .wrong text, .head.wrong { fill: #ff7d47; }
}
";

/// A document of all graphs; `name` is what it is called.
pub(super) fn document(name: &str, graphs: &[Graph]) -> String {
    let mut body = String::new();
    let (mut width, mut y) = (0.0_f64, MARGIN);
    for graph in graphs {
        let boxes = Boxes::of(graph);
        let laid = layout(&boxes.wanted);
        let _ = writeln!(
            body,
            "<g transform=\"translate({MARGIN} {y:.1})\">\n<text class=\"title\" x=\"0\" y=\"14\">{}</text>\n<g transform=\"translate(0 {TITLE})\">",
            escaped(&graph.title)
        );
        boxes.draw(graph, &laid, "head", &mut body);
        body += "</g>\n</g>\n";
        width = width.max(laid.size.0).max(graph.title.chars().count() as f64 * CHARACTER * 1.3);
        y += TITLE + laid.size.1 + MARGIN;
    }
    let (width, height) = (width + 2.0 * MARGIN, y);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         role=\"img\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n{}{body}</svg>\n",
        escaped(name),
        heads("head")
    )
}

/// A page may draw a graph smaller, to so much of its size: letters of 12 pixels can be read then.
const LEAST: f64 = 0.75;

/// One graph without styles, for a page that has its own.
pub(super) fn figure(graph: &Graph, id: &str, told: &str) -> String {
    let boxes = Boxes::of(graph);
    let laid = layout(&boxes.wanted);
    let (width, height) = (laid.size.0 + 2.0 * EDGE, laid.size.1 + 2.0 * EDGE);
    let (id, mut body) = (escaped(id), String::new());
    boxes.draw(graph, &laid, &id, &mut body);
    let least = width * LEAST;
    format!(
        "<svg width=\"{width:.0}\" height=\"{height:.0}\" style=\"min-width: {least:.0}px\" viewBox=\"{:.0} {:.0} {width:.0} {height:.0}\" role=\"img\" aria-label=\"{}\">\n{}{body}</svg>\n",
        -EDGE,
        -EDGE,
        escaped(told),
        heads(&id)
    )
}

/// The heads of arrows, and of those that are wrong.
fn heads(id: &str) -> String {
    let head = |id: &str, class: &str| {
        format!(
            "<marker id=\"{id}\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"7\" markerHeight=\"7\" \
             orient=\"auto\"><path class=\"{class}\" d=\"M0 0L10 5L0 10z\"/></marker>"
        )
    };
    format!("<defs>{}{}</defs>\n", head(id, "head"), head(&format!("{id}-wrong"), "head wrong"))
}

/// The texts of a graph in lines, with what room they take.
struct Boxes {
    nodes: Vec<Vec<String>>,
    labels: Vec<Vec<String>>,
    wanted: Wanted,
}

impl Boxes {
    fn of(graph: &Graph) -> Boxes {
        let nodes: Vec<Vec<String>> = graph.nodes.iter().map(|n| lines(&n.label)).collect();
        let labels: Vec<Vec<String>> = graph.edges.iter().map(|e| lines(&e.label)).collect();
        let mut boxes: Vec<Size> = nodes.iter().map(|n| grown(text_size(n))).collect();
        for (edge, label) in graph.edges.iter().zip(&labels).filter(|(e, _)| e.from == e.to) {
            if let Some(size) = boxes.get_mut(edge.from) {
                // Room on both sides, so that the box stays in the middle.
                size.0 += 2.0 * (LOOP + text_size(label).0);
            }
        }
        let label = |label: &Vec<String>| (!label.is_empty()).then(|| text_size(label));
        let arrows = graph.edges.iter().zip(&labels).map(|(e, l)| (e.from, e.to, label(l))).collect();
        Boxes { nodes, labels, wanted: Wanted { boxes, arrows } }
    }

    /// Draws everything; `head` is what the heads of arrows are called.
    fn draw(&self, graph: &Graph, laid: &Layout, head: &str, out: &mut String) {
        for ((edge, way), (label, place)) in
            graph.edges.iter().zip(&laid.arrows).zip(self.labels.iter().zip(&laid.labels))
        {
            let path = if edge.from == edge.to { self.loop_of(edge.from, laid) } else { curve(way) };
            let kind = if edge.is_wrong { "-wrong" } else { "" };
            if edge.is_wrong {
                let said = format!("{} to {}: {}", graph.name(edge.from), graph.name(edge.to), edge.label);
                let _ = writeln!(out, "<g class=\"wrong\"><title>{}</title>", escaped(&said));
            }
            let _ = writeln!(out, "<path class=\"arrow\" marker-end=\"url(#{head}{kind})\" d=\"{path}\"/>");
            match place {
                Some(place) => label_at(label, *place, out),
                None if edge.from == edge.to && !label.is_empty() => {
                    let ((x, y), width) = (laid.boxes[edge.from], self.own_width(edge.from));
                    label_at(label, (x + width / 2.0 + LOOP * 0.8 + text_size(label).0 / 2.0, y), out);
                }
                None => {}
            }
            if edge.is_wrong {
                *out += "</g>\n";
            }
        }
        for (number, (node, (x, y))) in graph.nodes.iter().zip(&laid.boxes).enumerate() {
            let (width, height) = (self.own_width(number), self.wanted.boxes[number].1);
            let (left, top, round) = (x - width / 2.0, y - height / 2.0, corner(node.shape));
            let class = class(node.shape);
            let _ = writeln!(
                out,
                "<g class=\"{class}\"><rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{round}\"/>"
            );
            text_at(&self.nodes[number], (*x, *y), out);
            *out += "</g>\n";
        }
    }

    /// The width of a box without the room for an arrow to itself.
    fn own_width(&self, node: usize) -> f64 {
        grown(text_size(&self.nodes[node])).0
    }

    fn loop_of(&self, node: usize, laid: &Layout) -> String {
        let ((x, y), right) = (laid.boxes[node], self.own_width(node) / 2.0);
        let (start, far) = (x + right, x + right + LOOP * 0.8);
        format!(
            "M{start:.1} {:.1}C{far:.1} {:.1} {far:.1} {:.1} {start:.1} {:.1}",
            y - 6.0,
            y - 18.0,
            y + 18.0,
            y + 6.0
        )
    }
}

/// A line through the places that leaves and reaches each of them vertically; through a label it goes straight.
fn curve(way: &[Place]) -> String {
    let mut path = way.first().map(|(x, y)| format!("M{x:.1} {y:.1}")).unwrap_or_default();
    for pair in way.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let middle = (y + to_y) / 2.0;
        let _ = write!(path, "C{x:.1} {middle:.1} {to_x:.1} {middle:.1} {to_x:.1} {to_y:.1}");
    }
    path
}

/// A label on its arrow, with a ground of its own.
fn label_at(label: &[String], (x, y): Place, out: &mut String) {
    let (width, height) = text_size(label);
    let _ = writeln!(
        out,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" class=\"ground\"/>",
        x - width / 2.0,
        y - height / 2.0
    );
    text_at(label, (x, y), out);
}

fn text_at(lines: &[String], (x, y): Place, out: &mut String) {
    let first = y - (lines.len() as f64 - 1.0) * LINE / 2.0;
    for (k, line) in lines.iter().enumerate() {
        let y = first + k as f64 * LINE + 4.0;
        let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>", escaped(line));
    }
}

fn text_size(lines: &[String]) -> Size {
    let longest = lines.iter().map(|l| l.chars().count()).max().unwrap_or(0);
    (longest as f64 * CHARACTER, lines.len() as f64 * LINE)
}

fn grown((width, height): Size) -> Size {
    (width + 2.0 * PADDING.0, height + 2.0 * PADDING.1)
}

/// A text in lines that are not too long, broken at blanks.
fn lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split(' ') {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > LONG {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line += word;
        }
        lines.push(line);
    }
    lines
}

fn class(shape: Shape) -> &'static str {
    match shape {
        Shape::State => "state",
        Shape::Initial => "initial",
        Shape::Nowhere => "nowhere",
        Shape::When => "when",
        Shape::Operator => "operator",
        Shape::Condition => "condition",
        Shape::Component => "component",
        Shape::Task => "task",
        Shape::Port => "port",
    }
}

fn corner(shape: Shape) -> u32 {
    match shape {
        Shape::State | Shape::Initial | Shape::Nowhere => 14,
        Shape::Operator | Shape::Task | Shape::Port => 8,
        Shape::When | Shape::Condition | Shape::Component => 2,
    }
}

/// A text as XML has it.
fn escaped(text: &str) -> String {
    let allowed = text.chars().filter(|c| !c.is_control());
    let one = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        c => c.to_string(),
    };
    allowed.map(one).collect()
}
