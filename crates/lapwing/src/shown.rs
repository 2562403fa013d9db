//! What a report shows of a property: the signals that it reads, as it writes them, and the numbers that it compares.

use std::collections::BTreeMap;

use lapwing_check::checked::{self, Body, Expr, Kind, Property};
use lapwing_diag::Span;
use lapwing_stream::Type;

use crate::eval;
use crate::spec::Spec;

/// The longest expression that is shown, in characters.
const LONGEST: usize = 60;

/// Something of which a report gives the value.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    /// What it is called.
    pub name: String,
    /// How to compute it.
    pub expr: Expr,
}

/// What a report shows of a property, in the order of the text.
pub(crate) fn of(spec: &Spec, meaning: &checked::Spec, property: &Property) -> Vec<Shown> {
    let mut gather = Gather { spec, meaning, renamed: instance(spec, property), found: Vec::new() };
    match &property.body {
        Body::Formula(formula) => gather.walk(formula, property.span, false),
        Body::Machine(machine) => gather.machine(*machine, property.span),
        Body::None => {}
    }
    gather.found
}

/// The variables of `for each`, with what stands for them in this instance.
fn instance(spec: &Spec, property: &Property) -> BTreeMap<String, String> {
    let parts = property.name.split('[').skip(1).filter_map(|p| p.strip_suffix(']'));
    let words: Vec<&str> = spec.slice(property.span).split_whitespace().collect();
    let variables = words.windows(3).filter(|w| w[0] == "for" && w[1] == "each").map(|w| w[2]);
    variables.zip(parts).map(|(var, value)| (var.to_owned(), value.to_owned())).collect()
}

struct Gather<'s> {
    spec: &'s Spec,
    meaning: &'s checked::Spec,
    renamed: BTreeMap<String, String>,
    found: Vec<Shown>,
}

impl Gather<'_> {
    /// Goes through an expression that stands inside one at `outer`. Inside a number that is shown only the signals are.
    fn walk(&mut self, e: &Expr, outer: Span, inside: bool) {
        let text = self.spec.slice(e.span);
        let is_own = e.span != outer;
        let is_signal = is_own && is_name(text);
        if let (Kind::Input(input), false) = (&e.kind, is_signal) {
            let label = self.meaning.inputs.get(*input).map_or(String::new(), |i| i.label.clone());
            return self.add(label, e);
        }
        let is_number = is_own && !inside && matches!(e.ty, Type::Num { .. }) && text.chars().count() <= LONGEST;
        let is_shown = (is_signal || is_number) && reads_signal(e) && eval::is_plain(e);
        if is_shown {
            self.add(self.rename(text), e);
        }
        for child in e.children() {
            // What has the place of a name is how the name is computed.
            if !(is_signal && child.span == e.span) {
                self.walk(child, e.span, inside || is_shown);
            }
        }
    }

    fn machine(&mut self, number: usize, outer: Span) {
        let Some(machine) = self.meaning.machines.get(number) else { return };
        let states = machine.states.iter().filter_map(|s| s.when.as_ref());
        let edges = machine.edges.iter().filter_map(|e| e.when.as_ref());
        machine.sample.iter().chain(states).chain(edges).for_each(|e| self.walk(e, outer, true));
    }

    fn add(&mut self, name: String, expr: &Expr) {
        if self.found.iter().all(|s| s.name != name) {
            self.found.push(Shown { name, expr: expr.clone() });
        }
    }

    /// The text on one line, with what stands for the variables of `for each`.
    fn rename(&self, text: &str) -> String {
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let mut out = String::new();
        let mut rest = line.as_str();
        while let Some(first) = rest.chars().next() {
            let end = rest.find(|c| is_part(c) != is_part(first)).unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            out += self.renamed.get(word).map_or(word, String::as_str);
            rest = after;
        }
        out
    }
}

/// Whether a text is a name, perhaps with fields and indices: `scan.ranges[3]`.
pub(crate) fn is_name(text: &str) -> bool {
    let starts = text.starts_with(|c: char| c.is_alphabetic() || c == '_' || c == '`');
    starts && text.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']' | '`'))
}

fn reads_signal(e: &Expr) -> bool {
    matches!(e.kind, Kind::Input(_)) || e.children().into_iter().any(reads_signal)
}
