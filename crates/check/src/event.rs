//! Events: where each comes from, and when it counts.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{self, ActivityPhase, EventDecl, Ident};

use crate::checked::{Event, EventSource, Point, PointKind};
use crate::context::{Cx, Env, Found};
use crate::service::ServiceHalf;
use lapwing_diag::suggest;

/// Declares the events, and after that reads their conditions. Gives what was found wrong with each.
pub(crate) fn declare(cx: &mut Cx) {
    let decls = cx.names.event_decls();
    let written_down = has_points(cx, &decls);
    for decl in &decls {
        let (source, found) = cx.apart(|cx| source(cx, decl, written_down));
        if let (EventSource::Message { .. }, Some(half)) = (&source, half(decl)) {
            cx.halves.insert(cx.spec.events.len(), half);
        }
        cx.spec.events.push(Event { name: decl.name.name.clone(), source, fields: Vec::new(), when: None });
        cx.event_found.push(found);
    }
    for (index, decl) in decls.iter().enumerate() {
        let (condition, found) = cx.apart(|cx| {
            let own = decl.when.as_ref().map(|when| {
                let env = Env { event: Some(index), ..Env::default() }.inside("an event's condition", when.span);
                cx.formula_of(&env, when)
            });
            match cx.halves.get(&index).copied() {
                Some(half) => cx.is_half(index, half, own, decl.name.span),
                None => own,
            }
        });
        cx.spec.events[index].when = condition;
        let known: &mut Found = &mut cx.event_found[index];
        known.failed |= found.failed;
        found.causes.into_iter().for_each(|cause| known.blame(cause));
    }
}

/// Whether a trace has calls, returns or fields of a program under the names that a specification gives them: it is the log of a program that
/// was watched, and which of them it lacks did not occur.
fn has_points(cx: &Cx, decls: &[&EventDecl]) -> bool {
    let is_point = |decl: &&&EventDecl| {
        matches!(decl.source, Some(ast::EventSource::Call(_) | ast::EventSource::Return(_) | ast::EventSource::Set(_)))
    };
    let in_trace = |decl: &&EventDecl| cx.trace.is_some_and(|t| t.events.contains(&decl.name.name));
    decls.iter().filter(is_point).any(in_trace)
}

fn source(cx: &mut Cx, decl: &EventDecl, written_down: bool) -> EventSource {
    let Some(source) = &decl.source else {
        missing_event(cx, &decl.name);
        return EventSource::Named;
    };
    let below = || decl.below.as_ref().map(|path| segments(&path.segments));
    if let Some(topic) = component_topic(cx, source, decl) {
        return EventSource::Message { topic: cx.open(&Env::default(), &topic, None).topic };
    }
    let point = |kind, path: &[Ident]| EventSource::Point(Point { kind, path: segments(path), below: below() });
    let found = match source {
        ast::EventSource::Message(topic, ty) => {
            let opened = cx.open(&Env::default(), topic, ty.as_ref());
            return EventSource::Message { topic: opened.topic };
        }
        ast::EventSource::Call(path) => point(PointKind::Call, &path.segments),
        ast::EventSource::Return(path) => point(PointKind::Return, &path.segments),
        ast::EventSource::Set(names) => point(PointKind::Set, names),
        ast::EventSource::Request(service) | ast::EventSource::Reply(service) => {
            let word = if matches!(source, ast::EventSource::Request(_)) { "request" } else { "reply" };
            match cx.service_events(service) {
                Some(messages) => return messages,
                None => outside(decl, format!("{word} {}", service.absolute())),
            }
        }
        ast::EventSource::Write(names) => outside(decl, format!("write {}", dotted(names))),
        ast::EventSource::Activity(phase, names) => outside(decl, format!("{} {}", phase_word(*phase), dotted(names))),
    };
    let is_known = written_down && matches!(found, EventSource::Point(_));
    if cx.trace.is_some_and(|t| !t.live) && !is_known {
        let text = match &found {
            EventSource::Point(point) => point.to_string(),
            EventSource::Program(text) => text.clone(),
            _ => String::new(),
        };
        cx.found.blame(format!("a recording has no such events: `{}` is `{text}`", decl.name.name));
    }
    found
}

/// The half of a service that an event is.
fn half(decl: &EventDecl) -> Option<ServiceHalf> {
    match decl.source {
        Some(ast::EventSource::Request(_)) => Some(ServiceHalf::Request),
        Some(ast::EventSource::Reply(_)) => Some(ServiceHalf::Reply),
        _ => None,
    }
}

/// The topic on which a component system tells of it.
fn component_topic(cx: &Cx, source: &ast::EventSource, decl: &EventDecl) -> Option<ast::Topic> {
    cx.trace.filter(|t| t.is_of_components() && decl.below.is_none())?;
    let (names, phase) = match source {
        ast::EventSource::Write(names) => (names, None),
        ast::EventSource::Activity(phase, names) => (names, Some(phase_word(*phase))),
        _ => return None,
    };
    let path: Vec<&str> = names.iter().map(|n| n.name.as_str()).chain(phase).collect();
    let span = names.iter().map(|n| n.span).reduce(|a, b| a.to(b)).unwrap_or(decl.name.span);
    Some(ast::Topic { name: format!("/{}", path.join("/")), span })
}

/// What neither a recording nor a Rust program has.
fn outside(decl: &EventDecl, text: String) -> EventSource {
    let below = decl.below.as_ref().map(|path| format!(" below {}", segments(&path.segments).join("::")));
    EventSource::Program(text + &below.unwrap_or_default())
}

/// Says so where a trace has events, but none of this name.
fn missing_event(cx: &mut Cx, name: &Ident) {
    let Some(trace) = cx.trace.filter(|t| !t.columns_open && !t.live) else { return };
    if trace.events.contains(&name.name) {
        return;
    }
    let guess = suggest::nearest(&name.name, trace.events.iter().map(String::as_str));
    let message = format!("no event `{}` in this recording{}", name.name, suggest::or_else(guess));
    let mut diagnostic = Diagnostic::new(Code::MissingEvent, name.span, message).label("never occurs");
    if let Some(guess) = guess {
        diagnostic = diagnostic.fix(name.span, guess);
    }
    cx.report(&Env::default(), diagnostic);
}

impl Cx<'_> {
    /// Notes that what is being read needs an event: if that cannot be seen, this cannot be judged.
    pub fn needs_event(&mut self, event: usize) {
        let Some(found) = self.event_found.get(event).cloned() else { return };
        self.found.failed |= found.failed;
        found.causes.into_iter().for_each(|cause| self.found.blame(cause));
    }
}

fn segments(path: &[Ident]) -> Vec<String> {
    path.iter().map(|s| s.name.clone()).collect()
}

fn dotted(names: &[Ident]) -> String {
    names.iter().map(|n| n.name.as_str()).collect::<Vec<_>>().join(".")
}

fn phase_word(phase: ActivityPhase) -> &'static str {
    match phase {
        ActivityPhase::Start => "start",
        ActivityPhase::End => "end",
        ActivityPhase::Request => "request",
        ActivityPhase::Report => "report",
    }
}
