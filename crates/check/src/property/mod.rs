//! Properties: what is judged, under which name, reading what.

mod each;
mod substitute;
mod text;

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast::{self, EachSet, ForEach, Ident, ItemKind};

use crate::checked::{Body, EventField, EventSource, Expr, Kind, Property, Slice, Step};
use crate::context::{Cx, Env, Found};
use crate::lint;
use crate::machine::event_named;
use crate::reads::Uses;

use each::{Instance, Instances, instances};

/// A statement that is judged.
struct Judged<'a> {
    name: Option<&'a Ident>,
    over: Option<&'a [ast::Expr]>,
    each: &'a [ForEach],
    body: &'a ast::Expr,
    span: Span,
}

/// Builds all properties, in the order of the text.
pub(crate) fn build_all(cx: &mut Cx) {
    let names = cx.names;
    for (index, entry) in names.items.iter().enumerate().filter(|(_, entry)| !entry.library) {
        let span = entry.item.span;
        match &entry.item.kind {
            ItemKind::Property(p) => {
                let judged =
                    Judged { name: p.name.as_ref(), over: p.over.as_deref(), each: &p.each, body: &p.body, span };
                build(cx, index, &judged);
            }
            ItemKind::Definition(d) if is_judged(cx, index, &d.each) => {
                build(cx, index, &Judged { name: Some(&d.name), over: None, each: &d.each, body: &d.body, span });
            }
            ItemKind::Machine(machine) => of_machine(cx, index, machine, span),
            _ => {}
        }
    }
}

/// Whether a definition is a property of its own: it is about time, and nobody else uses it.
pub(crate) fn is_judged(cx: &Cx, item: usize, each: &[ForEach]) -> bool {
    !each.is_empty() || (cx.graph.is_temporal(item) && cx.graph.users(item).next().is_none())
}

fn build(cx: &mut Cx, item: usize, judged: &Judged) {
    let line = cx.sources.position(judged.span).0;
    let name = unique(cx, judged.name.map_or_else(|| format!("line {line}"), |n| n.name.clone()), item);
    let env = Env::default();
    let (all, outer) = cx.apart(|cx| instances(cx, &env, judged.each));
    let blank = Property {
        name,
        span: judged.span,
        line,
        text: text::source_text(cx.sources.slice(judged.span)),
        body: Body::None,
        reads: Vec::new(),
        machines: Vec::new(),
        alphabet: None,
        slices: Vec::new(),
        problem: None,
    };
    if all.list.is_empty() {
        cx.spec.properties.push(Property { problem: all.nothing, ..blank });
        return;
    }
    let first = cx.spec.properties.len();
    for instance in &all.list {
        let ((), mut found) = cx.apart(|cx| instance_of(cx, item, judged, &all, instance, blank.clone()));
        let Some(property) = cx.spec.properties.last_mut() else { continue };
        outer.causes.iter().for_each(|cause| found.blame(cause.clone()));
        if found.failed || outer.failed {
            property.body = Body::None;
            (property.reads, property.machines, property.alphabet) = (Vec::new(), Vec::new(), None);
        }
        property.problem = found.problem();
    }
    if let Some(Property { body: Body::Formula(formula), .. }) = cx.spec.properties.get(first).cloned() {
        lint::property(cx, judged.body, &formula, first);
    }
}

fn instance_of(cx: &mut Cx, item: usize, judged: &Judged, all: &Instances, instance: &Instance, blank: Property) {
    let names: Vec<String> = all.slices.iter().map(|(name, ..)| name.clone()).collect();
    // Without a trace the formula is read once, for all topics.
    let topics: Vec<String> = judged.each.iter().filter(|e| is_open(cx, e)).map(|e| e.var.name.clone()).collect();
    let env = Env { slices: &names, topics: &topics, ..Env::default() };
    let body = instance.formula(judged.body);
    if cx.graph.is_cyclic(item) {
        cx.found = Found { causes: vec!["it is defined by itself".to_owned()], failed: true };
    }
    let formula = if cx.found.failed { crate::context::poison(judged.span) } else { cx.formula_of(&env, &body) };
    let mut uses = Uses::of(&cx.spec.inputs, &cx.machines, &formula);
    if let Some(over) = judged.over {
        let listed: Vec<usize> = over.iter().filter_map(|event| listed_event(cx, &env, event)).collect();
        if uses.signals {
            over_signals(cx, &env, over, &formula);
        }
        uses.events.extend(listed);
    }
    uses.wait_for_machines(&cx.machines, &cx.spec.events);
    let slices = slices(cx, &all.slices, &uses);
    let only_events = !uses.signals && !uses.events.is_empty();
    let name = format!("{}{}", blank.name, instance.suffix());
    cx.spec.properties.push(Property {
        name,
        body: Body::Formula(formula),
        reads: uses.reads(),
        machines: uses.machines.iter().copied().collect(),
        alphabet: only_events.then(|| uses.events.iter().copied().collect()),
        slices,
        ..blank
    });
}

/// Whether a quantifier's variable still stands for any topic.
fn is_open(cx: &Cx, each: &ForEach) -> bool {
    cx.trace.is_none() && matches!(each.set, EachSet::Topics(_))
}

/// A name that no property has yet: two bare formulas may stand on one line.
fn unique(cx: &Cx, name: String, item: usize) -> String {
    let taken = |name: &str| {
        let declared = cx.names.values.get(name).is_some_and(|&i| i != item);
        declared || cx.spec.properties.iter().any(|p| p.name.split('[').next() == Some(name))
    };
    let numbered = (2..).map(|n| format!("{name}#{n}"));
    std::iter::once(name.clone()).chain(numbered).find(|n| !taken(n)).unwrap_or(name)
}

fn of_machine(cx: &mut Cx, item: usize, ast: &ast::Machine, span: Span) {
    let Some(index) = cx.machines.index(&ast.name.name) else { return };
    let (Some(entry), Some(machine)) = (cx.machines.get(index), cx.spec.machines.get(index)) else { return };
    // A second machine of the same name has been reported.
    if entry.item != item {
        return;
    }
    let failed = entry.found.failed || cx.graph.is_cyclic(item);
    let problem = entry.found.problem();
    cx.spec.properties.push(Property {
        name: ast.name.name.clone(),
        span,
        line: cx.sources.position(span).0,
        text: text::source_text(cx.sources.slice(span)),
        body: if failed { Body::None } else { Body::Machine(index) },
        reads: machine.reads.clone(),
        machines: entry.uses.machines.iter().copied().collect(),
        alphabet: machine.alphabet.clone(),
        slices: Vec::new(),
        problem: problem.or_else(|| failed.then(|| "it reads its own state".to_owned())),
    });
}

/// The slices, each with the field of its name in every event that the property names, in its formula or after `over`, and that has one.
fn slices(cx: &mut Cx, slices: &[(String, usize, crate::checked::Path)], uses: &Uses) -> Vec<Slice> {
    let mut built = Vec::new();
    for (_, event, path) in slices {
        let mut events = uses.events.clone();
        events.insert(*event);
        let fields = events.into_iter().filter_map(|e| Some((e, field_of(cx, e, path)?))).collect();
        let mut field = cx.event_place(*event, Span::default()).path;
        field.extend_from_slice(path);
        built.push(Slice { event: *event, field, fields });
    }
    built
}

/// The number of a field of an event; `None` where it has none.
fn field_of(cx: &mut Cx, event: usize, path: &[Step]) -> Option<usize> {
    let place = cx.event_place(event, Span::default());
    let (mut ty, mut whole) = (place.ty, place.path);
    whole.extend_from_slice(path);
    for step in path {
        ty = match (&ty, step) {
            (Type::Message(schema), Step::Field(name)) => schema.field(name)?.ty.clone(),
            (Type::Any, _) => Type::Any,
            _ => return None,
        };
    }
    let wanted = match cx.spec.events.get(event)?.source {
        EventSource::Message { topic } => Some(cx.field(topic, &whole)),
        EventSource::Entered { .. } | EventSource::Left { .. } => return None,
        EventSource::Named | EventSource::Point(_) | EventSource::Program(_) => None,
    };
    Some(cx.event_field(event, EventField { path: whole, wanted, ty }))
}

/// An event of an alphabet: a declared one by its name, or one of a state diagram.
fn listed_event(cx: &mut Cx, env: &Env, event: &ast::Expr) -> Option<usize> {
    if let ast::ExprKind::Path(names) = &event.kind
        && let [name] = &names[..]
    {
        return event_named(cx, env, name);
    }
    let lowered = cx.formula_of(env, event);
    if let Kind::Event(event) = lowered.kind {
        return Some(event);
    }
    if !cx.found.failed {
        let message = "only events can be listed here";
        let help = "an event by its name, or `entered(MACHINE.STATE)` and `left(MACHINE.STATE)`";
        cx.report(env, Diagnostic::new(Code::Misplaced, event.span, message).label("this is no event").help(help));
    }
    None
}

fn over_signals(cx: &mut Cx, env: &Env, over: &[ast::Expr], formula: &Expr) {
    let span = over.iter().map(|o| o.span).reduce(Span::to).unwrap_or(formula.span);
    let mut diagnostic = Diagnostic::new(Code::OverSignals, span, "`over` belongs to a property over events alone")
        .label("these cannot be its only instants")
        .help("a property that reads a signal is checked at every instant; leave `over (…)` out");
    if let Some(signal) = first_signal(formula) {
        diagnostic = diagnostic.also(signal.span, "a signal is read here");
    }
    cx.report(env, diagnostic);
}

fn first_signal(formula: &Expr) -> Option<&Expr> {
    let is_signal = matches!(
        formula.kind,
        Kind::Input(_) | Kind::InState { .. } | Kind::Age(_) | Kind::Frequency(..) | Kind::Fresh(_) | Kind::Updated(_)
    );
    if is_signal { Some(formula) } else { formula.children().into_iter().find_map(first_signal) }
}
