//! A state diagram on the page, with the moves that were made although it does not have them.

use lapwing_draw::Graph;

use crate::html::{name, text};

/// A diagram with more states or more arrows is nothing that one would look at in a card.
const STATES: usize = 60;
const ARROWS: usize = 240;

/// The diagram of a property as HTML, the number being its own on the page, and below it in words what is wrong in it: nobody has to tell colours apart, or to see at all.
pub fn figure(graph: &Graph, property: usize) -> String {
    let drawing = match graph.nodes.len() <= STATES && graph.edges.len() <= ARROWS {
        true => drawing(graph, property),
        false => String::new(),
    };
    format!(
        "<figure class=\"diagram\">\n{drawing}<figcaption>{}</figcaption>\n</figure>\n",
        caption(graph, drawing.is_empty())
    )
}

/// The picture, which is drawn smaller where there is little room for it, and scrolls where there is still less.
fn drawing(graph: &Graph, property: usize) -> String {
    let told = format!("State diagram of {}: {}", graph.title, told(graph));
    let svg = lapwing_draw::figure(graph, &format!("head-{property}"), &told);
    format!(
        "<div class=\"drawing\" tabindex=\"0\" role=\"group\" aria-label=\"Drawing, which may be scrolled\">\n{svg}</div>\n"
    )
}

/// Its arrows, in words.
fn told(graph: &Graph) -> String {
    let arrow = |edge: &lapwing_draw::Edge| {
        let label = if edge.label.is_empty() { String::new() } else { format!(" ({})", edge.label.replace('\n', " ")) };
        format!("{} to {}{label}", graph.name(edge.from), graph.name(edge.to))
    };
    graph.edges.iter().map(arrow).collect::<Vec<_>>().join("; ")
}

fn caption(graph: &Graph, is_left_out: bool) -> String {
    let item = |edge: &lapwing_draw::Edge| {
        let (from, to) = (name(graph.name(edge.from)), name(graph.name(edge.to)));
        format!("<li>{from} → {to}: {}</li>\n", text(&edge.label))
    };
    let wrong: String = graph.edges.iter().filter(|e| e.is_wrong).map(item).collect();
    let large = match is_left_out {
        true => {
            format!(" Its {} states and {} arrows are too many to be drawn here.", graph.nodes.len(), graph.edges.len())
        }
        false => String::new(),
    };
    match wrong.as_str() {
        "" => format!("<p>The state diagram. No move was seen that it does not have.{large}</p>"),
        wrong => format!(
            "<p>The state diagram. Dashed arrows are moves that were made and that it does not have:{large}</p>\n<ul>\n{wrong}</ul>\n"
        ),
    }
}
