//! What a property puts as obligations, and what each of them asks: a tree.

use lapwing_check::checked::{Bound, Connective, Expr, Kind, Scope};

use super::super::formula::{Printer, bound};
use crate::words;
use lapwing_draw::{Graph, Shape};

/// The tree of a property: when obligations arise, and below that the formula of each.
pub(super) fn graph(printer: &Printer<'_>, name: &str, formula: &Expr) -> Graph {
    let mut tree = Tree { printer, graph: Graph { title: name.to_owned(), ..Graph::default() } };
    tree.body(None, formula, "of the recording");
    tree.graph
}

struct Tree<'t> {
    printer: &'t Printer<'t>,
    graph: Graph,
}

impl Tree<'_> {
    /// What stands at the top or in the body of a scope: conjunctions split, and what is about the present counts at every instant.
    fn body(&mut self, parent: Option<usize>, e: &Expr, stretch: &str) {
        match &e.kind {
            _ if !e.has_future() => {
                let when = self.when(parent, format!("at every instant {stretch}"));
                self.ask(when, "", e);
            }
            Kind::Connective(Connective::And, l, r) => [l, r].into_iter().for_each(|e| self.body(parent, e, stretch)),
            Kind::Always(within, of) => {
                let when = self.when(parent, format!("at every instant {stretch}{}", from_start(within)));
                self.split(when, of);
            }
            Kind::Scope(Scope::Whenever, x, body) => {
                let when = self.when(parent, format!("at every instant {stretch}\nwith {}", self.printer.print(x)));
                self.ask(when, "", body);
            }
            Kind::Scope(scope, x, body) if !x.has_future() => self.scope(parent, *scope, x, body, stretch),
            Kind::AfterUntil(x, y, body) if !x.has_future() && !y.has_future() => {
                let (x, y) = (self.printer.print(x), self.printer.print(y));
                let when = self.when(parent, format!("in every stretch from {x}\nup to {y}"));
                self.body(Some(when), body, "of the stretch");
            }
            _ => {
                let when = self.when(parent, format!("once, at the beginning {stretch}"));
                self.ask(when, "", e);
            }
        }
    }

    fn scope(&mut self, parent: Option<usize>, scope: Scope, x: &Expr, body: &Expr, stretch: &str) {
        let text = self.printer.print(x);
        if scope == Scope::Until {
            let when = self.when(parent, format!("once, at the beginning {stretch}"));
            self.graph.below(when, "", Shape::Operator, format!("eventually {text}"));
        }
        let when = match scope {
            Scope::After => format!("from the first {text} on"),
            Scope::While => format!("in every stretch with {text}"),
            _ => format!("{} the first {text}", words::scope(scope)),
        };
        let when = self.when(parent, when);
        self.body(Some(when), body, "of the stretch");
    }

    /// What stands directly under `always`: conjunctions split.
    fn split(&mut self, when: usize, e: &Expr) {
        match &e.kind {
            Kind::Connective(Connective::And, l, r) if e.has_future() => {
                [l, r].into_iter().for_each(|e| self.split(when, e))
            }
            _ => self.ask(when, "", e),
        }
    }

    fn when(&mut self, parent: Option<usize>, label: String) -> usize {
        match parent {
            Some(parent) => self.graph.below(parent, "", Shape::When, label),
            None => self.graph.node(Shape::When, label),
        }
    }

    /// What is asked there.
    fn ask(&mut self, parent: usize, arrow: &str, e: &Expr) {
        if !e.has_future() {
            self.graph.below(parent, arrow, Shape::Condition, self.printer.print(e));
            return;
        }
        let (label, parts): (String, Vec<(&str, &Expr)>) = match &e.kind {
            Kind::Always(within, of) => (format!("always{}", bound(within)), vec![("", of)]),
            Kind::Eventually(within, of) => (format!("eventually{}", bound(within)), vec![("", of)]),
            Kind::Next(of) => ("next".to_owned(), vec![("", of)]),
            Kind::Not(of) => ("not".to_owned(), vec![("", of)]),
            Kind::Until(within, l, r) => (format!("until{}", bound(within)), vec![("all the while", l), ("then", r)]),
            Kind::Connective(Connective::And, l, r) => ("and".to_owned(), vec![("", l), ("", r)]),
            Kind::Connective(Connective::Or, l, r) => ("or".to_owned(), vec![("", l), ("", r)]),
            Kind::Connective(Connective::Implies, l, r) => ("implies".to_owned(), vec![("if", l), ("then", r)]),
            Kind::Connective(Connective::Iff, l, r) => ("iff".to_owned(), vec![("", l), ("", r)]),
            Kind::Scope(scope, x, body) => (words::scope(*scope).to_owned(), vec![("when", x), ("that", body)]),
            Kind::AfterUntil(x, y, body) => ("after_until".to_owned(), vec![("from", x), ("to", y), ("that", body)]),
            _ => (self.printer.print(e), Vec::new()),
        };
        let node = self.graph.below(parent, arrow, Shape::Operator, label);
        parts.into_iter().for_each(|(arrow, part)| self.ask(node, arrow, part));
    }
}

/// How far from its beginning.
fn from_start(within: &Bound) -> String {
    let text = bound(within);
    if text.is_empty() { text } else { format!("{text} of its beginning") }
}
