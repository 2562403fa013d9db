//! Events: where each comes from, and when it counts.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{self, ActivityPhase, CallPath, EventDecl, Ident};

use crate::checked::{Event, EventSource};
use crate::context::{Cx, Env, Found};
use crate::suggest;

/// Declares the events, and after that reads their conditions. Gives what was found wrong with each.
pub(crate) fn declare(cx: &mut Cx) {
    let decls = cx.names.event_decls();
    for decl in &decls {
        let (source, found) = cx.apart(|cx| source(cx, decl));
        cx.spec.events.push(Event { name: decl.name.name.clone(), source, fields: Vec::new(), when: None });
        cx.event_found.push(found);
    }
    for (index, decl) in decls.iter().enumerate() {
        let Some(when) = &decl.when else { continue };
        let (condition, found) = cx.apart(|cx| {
            let env = Env { event: Some(index), ..Env::default() }.inside("an event's condition", when.span);
            cx.formula_of(&env, when)
        });
        cx.spec.events[index].when = Some(condition);
        let known: &mut Found = &mut cx.event_found[index];
        known.failed |= found.failed;
        found.causes.into_iter().for_each(|cause| known.blame(cause));
    }
}

fn source(cx: &mut Cx, decl: &EventDecl) -> EventSource {
    let Some(source) = &decl.source else {
        missing_event(cx, &decl.name);
        return EventSource::Named;
    };
    let mut text = match source {
        ast::EventSource::Message(topic, ty) => {
            let opened = cx.open(&Env::default(), topic, ty.as_ref());
            return EventSource::Message { topic: opened.topic };
        }
        ast::EventSource::Call(path) => format!("call {}", call_path(path)),
        ast::EventSource::Return(path) => format!("return {}", call_path(path)),
        ast::EventSource::Set(names) => format!("set {}", dotted(names)),
        ast::EventSource::Request(topic) => format!("request {}", topic.absolute()),
        ast::EventSource::Reply(topic) => format!("reply {}", topic.absolute()),
        ast::EventSource::Write(names) => format!("write {}", dotted(names)),
        ast::EventSource::Activity(phase, names) => format!("{} {}", phase_word(*phase), dotted(names)),
    };
    if let Some(below) = &decl.below {
        text.push_str(&format!(" below {}", call_path(below)));
    }
    if cx.trace.is_some_and(|t| !t.live) {
        cx.found.blame(format!("a recording has no such events: `{}` is `{text}`", decl.name.name));
    }
    EventSource::Program(text)
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

fn call_path(path: &CallPath) -> String {
    path.segments.iter().map(|s| s.name.as_str()).collect::<Vec<_>>().join("::")
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
