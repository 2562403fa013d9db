//! The order in which a specification is checked.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_diag::{Code, Diagnostic, Severity, SourceMap};

use crate::checked::Spec;
use crate::context::{Cx, Found, MOST_NODES};
use crate::graph::Graph;
use crate::load::Loaded;
use crate::machine::MachineTable;
use crate::names::Names;
use crate::trace::TraceShape;
use crate::{declare, event, lint, machine, property, reaction, settings};

/// A specification that has been checked.
#[derive(Clone, Debug)]
pub struct Checked {
    /// What it means. Where there are errors without a trace it must not be used; errors with one are in [`Property::problem`].
    ///
    /// [`Property::problem`]: crate::checked::Property::problem
    pub spec: Spec,
    /// What was found, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl Checked {
    /// Whether any error was found.
    pub fn has_errors(&self) -> bool {
        lapwing_diag::has_errors(&self.diagnostics)
    }

    /// The diagnostics that are not among `earlier`: what a trace has revealed beyond what the specification alone had shown.
    pub fn beyond<'c>(&'c self, earlier: &'c [Diagnostic]) -> impl Iterator<Item = &'c Diagnostic> {
        self.diagnostics.iter().filter(move |d| !earlier.contains(d))
    }
}

/// Checks a specification: alone, for what no trace can cure, or against the shape of one trace.
pub fn check(sources: &SourceMap, loaded: &Loaded, trace: Option<&TraceShape>) -> Checked {
    let mut diagnostics = loaded.diagnostics.clone();
    let names = Names::collect(loaded, &mut diagnostics);
    let graph = Graph::new(&names, &mut diagnostics);
    let machines = MachineTable::new(&names, &graph);
    let mut cx = Cx {
        sources,
        names: &names,
        graph: &graph,
        definitions: &loaded.definitions,
        trace,
        machines,
        margin: None,
        spec: Spec::default(),
        diagnostics,
        found: Found::default(),
        event_found: Vec::new(),
        halves: BTreeMap::new(),
        lambdas: 0,
        budget: MOST_NODES,
        expanded: BTreeSet::new(),
    };
    settings::read(&mut cx);
    declare::check(&mut cx);
    event::declare(&mut cx);
    machine::build_all(&mut cx);
    property::build_all(&mut cx);
    reaction::read(&mut cx);
    if trace.is_none() {
        declare::unused(&mut cx);
    }
    lint::text(&mut cx);
    Checked { spec: cx.spec, diagnostics: in_order(cx.diagnostics) }
}

/// Each diagnostic once, in the order of the text; where there are errors, warnings that follow from them are left out.
fn in_order(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let errors = lapwing_diag::has_errors(&diagnostics);
    diagnostics.retain(|d| !errors || !follows_from_errors(d));
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start, d.severity, d.code));
    let mut ordered: Vec<Diagnostic> = Vec::new();
    for diagnostic in diagnostics {
        match ordered.iter_mut().find(|d| same_fault(d, &diagnostic)) {
            Some(first) => also_here(first, &diagnostic),
            None => ordered.push(diagnostic),
        }
    }
    ordered
}

/// What is missing is missing everywhere: it is said once, with the other places beside it.
fn same_fault(first: &Diagnostic, second: &Diagnostic) -> bool {
    let missing = [
        Code::UnknownName,
        Code::UnknownField,
        Code::MissingTopic,
        Code::MissingColumn,
        Code::TopicType,
        Code::TooDeep,
    ];
    let everywhere = first.code == second.code && first.message == second.message && missing.contains(&first.code);
    first == second || (everywhere && first.primary.span.file == second.primary.span.file)
}

/// So many further places of one fault are shown.
const MOST_PLACES: usize = 4;

fn also_here(first: &mut Diagnostic, second: &Diagnostic) {
    let span = second.primary.span;
    let known = first.primary.span == span || first.secondary.iter().any(|label| label.span == span);
    if !known && first.secondary.len() < MOST_PLACES {
        first.secondary.push(lapwing_diag::Label { span, text: "and here".to_owned() });
    }
}

/// Where names could not be resolved, others may only seem unused.
fn follows_from_errors(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity == Severity::Warning && diagnostic.code == Code::UnusedName
}
