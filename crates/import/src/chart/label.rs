//! What stands at an arrow: `event [guard] / action` as UML writes it, or the clauses of a machine.

use std::ops::Range;

use lapwing_diag::{FileId, has_errors};
use lapwing_syntax::ast::{Binary, Dur, Expr, ExprKind, Infix, ItemKind, Prefix};
use lapwing_syntax::parse;

use super::Annotation;
use crate::condition::{self, Reading};
use crate::expr;
use crate::names::slug;

/// The clauses of a state or an edge: `on EVENT when CONDITION at most 2 s`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clauses {
    pub on: Option<String>,
    pub when: Option<Expr>,
    pub bounds: Vec<String>,
}

/// A label, read.
#[derive(Debug, Default)]
pub(crate) struct Label {
    pub on: Option<String>,
    pub when: Option<Expr>,
    pub otherwise: bool,
    /// An event whose name is none here, as it is written; its place in the label.
    pub renamed: Option<(String, Range<usize>)>,
    /// A guard in prose, which has become a name; its place in the label.
    pub prose: Option<Range<usize>>,
    /// What stands in brackets behind the event, `timeout(2 s)`; its place in the label.
    pub given: Option<Range<usize>>,
    /// What is done on the way; its place in the label.
    pub action: Option<Range<usize>>,
}

/// How a label is read.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Place {
    /// At an arrow that somebody has drawn.
    Drawn,
    /// At an arrow that leaves a choice: all of it is a guard.
    Choice,
    /// At an arrow that was drawn from a machine.
    Machine,
}

/// Functions of the language that a guard may call; what is called besides is prose.
const FUNCTIONS: &[&str] = &["abs", "age", "delta", "fresh", "isnan", "max", "min", "norm", "rate", "sqrt", "updated"];

/// Reads a label.
pub(crate) fn label(text: &str, place: Place) -> Label {
    let text = text.trim_end();
    if text.trim().is_empty() {
        return Label::default();
    }
    if let Some(clauses) = clauses(text) {
        return Label { on: clauses.on, when: clauses.when, ..Label::default() };
    }
    match place {
        Place::Machine => match formula(text, true) {
            Some(when) => Label { when: Some(when), ..Label::default() },
            None => drawn(text),
        },
        Place::Choice => {
            let inner = text.trim().trim_start_matches('[').trim_end_matches(']').trim();
            let inner = inner.strip_prefix("if ").unwrap_or(inner);
            guarded(inner, text.find(inner).unwrap_or(0))
        }
        Place::Drawn => drawn(text),
    }
}

/// `on EVENT when CONDITION`, as edges of a machine have it; what begins with `on` or `when` and is not that is prose.
fn clauses(text: &str) -> Option<Clauses> {
    let text = text.trim();
    if !(text.starts_with("on ") || text.starts_with("when ")) {
        return None;
    }
    let (clauses, _, _) = annotation(&format!("state a {text}"))?;
    let (_, clauses) = clauses?;
    clauses.when.as_ref().is_none_or(|when| is_sayable(when, true)).then_some(clauses)
}

/// An entry of a machine: `sample when …`, `state NAME …`, `else stay`. `None` where it is none. What it says of a state, and of the machine.
#[allow(clippy::type_complexity)]
pub(crate) fn annotation(entry: &str) -> Option<(Option<(String, Clauses)>, Option<Expr>, bool)> {
    if entry.contains(['\n', '#', '{', '}']) && !entry.contains("@{") || entry.contains('\n') {
        return None;
    }
    let parsed = parse(FileId::default(), &format!("machine m {{\n    initial z\n    {entry}\n}}\n"));
    let [item] = &parsed.file.items[..] else { return None };
    let ItemKind::Machine(machine) = &item.kind else { return None };
    if has_errors(&parsed.diagnostics) || !machine.edges.is_empty() {
        return None;
    }
    let duration = |word: &str, d: &Option<Dur>| match d {
        Some(Dur::Literal(duration, _)) => Some(format!("at {word} {duration}")),
        _ => None,
    };
    let state = machine.states.first().map(|s| {
        let bounds = [duration("most", &s.at_most), duration("least", &s.at_least)].into_iter().flatten().collect();
        (s.name.name.clone(), Clauses { on: s.on.as_ref().map(|e| e.name.clone()), when: s.when.clone(), bounds })
    });
    Some((state, machine.sample.clone(), machine.else_stay))
}

impl Annotation {
    /// Takes in what an entry says of the machine itself.
    pub(crate) fn take(&mut self, sample: Option<Expr>, else_stay: bool) {
        self.sample = sample.or(self.sample.take());
        self.else_stay |= else_stay;
    }
}

/// `event [guard] / action`
fn drawn(text: &str) -> Label {
    let open = text.find('[');
    let close = open.and_then(|open| text.get(open..)?.find(']').map(|c| open + c));
    let behind = close.map_or(0, |c| c + 1);
    let slash = text.get(behind..).and_then(|rest| rest.find('/')).map(|s| behind + s);
    let action = slash.map(|s| s..text.len()).filter(|a| a.len() > 1);
    let event = text.get(..open.or(slash).unwrap_or(text.len())).unwrap_or("").trim();
    let guarded = match (open, close) {
        (Some(open), Some(close)) => guarded(text.get(open + 1..close).unwrap_or(""), open + 1),
        _ => Label::default(),
    };
    if event.is_empty() {
        return Label { action, ..guarded };
    }
    // `speed > 2 m/s` is no name of an event, nor is what follows the stroke an action.
    let compound = |text: &str| formula(text, false).filter(|e| !matches!(e.kind, ExprKind::Path(_)));
    if open.is_none()
        && let Some(when) = compound(text).filter(is_truth)
    {
        return Label { when: Some(when), ..Label::default() };
    }
    if guarded.when.is_none()
        && let Some(when) = compound(event).filter(is_truth)
    {
        return Label { when: Some(when), action, ..Label::default() };
    }
    let start = text.find(event).unwrap_or(0);
    let name = event.split('(').next().unwrap_or(event);
    let (name, given) = match name.trim().is_empty() {
        true => (event, None),
        false => (name, Some(start + name.len()..start + event.len())),
    };
    let given = given.filter(|g| text.get(g.clone()).is_some_and(|t| t.contains(|c: char| c.is_alphanumeric())));
    let (written, on) = (name.trim(), slug(name));
    let renamed = (on != written).then(|| (written.to_owned(), start..start + written.len()));
    Label { on: Some(on), renamed, given, action, ..guarded }
}

fn guarded(text: &str, at: usize) -> Label {
    if matches!(text.trim(), "else" | "otherwise") {
        return Label { otherwise: true, ..Label::default() };
    }
    let (when, is_prose) = guard(text);
    Label { when, prose: is_prose.then_some(at..at + text.len()), ..Label::default() }
}

/// A guard: in the language of specifications, or in that of programs; what is neither becomes a name. Whether it was prose.
pub(crate) fn guard(text: &str) -> (Option<Expr>, bool) {
    if text.trim().is_empty() {
        return (None, false);
    }
    let name = |parts: &[&str]| Some(expr::path(parts));
    let program = || condition::read(text, &Reading { name: &name, compares_truths: false }).ok();
    match formula(text, false).or_else(program) {
        Some(when) if can_hold(&when) => (Some(when), false),
        _ => (Some(expr::name(&slug(text))), true),
    }
}

/// A condition in the language of specifications.
fn formula(text: &str, any_function: bool) -> Option<Expr> {
    if text.contains(['\n', '#']) {
        return None;
    }
    let parsed = parse(FileId::default(), &format!("x = ({text})\n"));
    let [item] = &parsed.file.items[..] else { return None };
    let ItemKind::Definition(definition) = &item.kind else { return None };
    let sayable =
        !has_errors(&parsed.diagnostics) && definition.each.is_empty() && is_sayable(&definition.body, any_function);
    sayable.then(|| definition.body.clone())
}

/// Whether it is a condition by its form: `kick / beep` is a quotient by its form.
fn is_truth(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Binary(operator, ..) => !matches!(operator, Binary::Add | Binary::Sub | Binary::Mul | Binary::Div),
        ExprKind::Not(_)
        | ExprKind::WithMargin(..)
        | ExprKind::Prefix(..)
        | ExprKind::Infix(..)
        | ExprKind::Held(..) => true,
        _ => false,
    }
}

/// Whether it can be a condition by its form, and so can its parts: a text and a sum are none, though some languages take them for true.
fn can_hold(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Number(_) | ExprKind::Str(_) | ExprKind::Neg(_) => false,
        ExprKind::Binary(operator, left, right) => match operator {
            Binary::Add | Binary::Sub | Binary::Mul | Binary::Div => false,
            Binary::And | Binary::Or | Binary::Implies | Binary::Iff => can_hold(left) && can_hold(right),
            _ => true,
        },
        ExprKind::Not(of) => can_hold(of),
        _ => true,
    }
}

/// Whether it says nothing of the future, and calls what there is.
fn is_sayable(e: &Expr, any_function: bool) -> bool {
    let here = match &e.kind {
        ExprKind::Prefix(Prefix::Always | Prefix::Never | Prefix::Eventually | Prefix::Next, ..) => false,
        ExprKind::Infix(Infix::Until, ..) | ExprKind::Scope(..) | ExprKind::AfterUntil(..) | ExprKind::Error => false,
        ExprKind::Call(name, _) => any_function || FUNCTIONS.contains(&name.name.as_str()),
        _ => true,
    };
    here && e.children().into_iter().all(|child| is_sayable(child, any_function))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lapwing_syntax::print_expr;

    fn told(text: &str, place: Place) -> String {
        let label = label(text, place);
        let on = label.on.map(|on| format!("on {on}"));
        let when = label.when.map(|w| format!("when {}", print_expr(&w)));
        let rest = [(label.otherwise, "else"), (label.prose.is_some(), "prose"), (label.action.is_some(), "action")];
        let rest = rest.into_iter().filter(|(is, _)| *is).map(|(_, what)| what.to_owned());
        on.into_iter().chain(when).chain(rest).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn labels_are_read_as_they_are_written() {
        for (text, clauses) in [
            ("kick", "on kick"),
            ("kick(power) [power > 3] / score++", "on kick when power > 3 action"),
            ("[!ready && x<2]", "when not ready and x < 2"),
            ("ball is lost", "on ball_is_lost"),
            ("speed > 2.0 m/s", "when speed > 2.0 m/s"),
            ("on kick when power > 3", "on kick when power > 3"),
            ("when once playing", "when once playing"),
            ("on the way", "on on_the_way"),
            ("[the ball is near]", "when the_ball_is_near prose"),
            ("go [f(x)]", "on go when f_x prose"),
            ("[always x > 1]", "when always_x_1 prose"),
            ("['gone']", "when gone prose"),
            ("[!(ready && 2 * n)]", "when ready_2_n prose"),
            ("kick / beep", "on kick action"),
            ("kick[x] / y / z", "on kick when x action"),
            ("/ beep", "action"),
            ("", ""),
        ] {
            assert_eq!(told(text, Place::Drawn), clauses, "{text}");
        }
        assert_eq!(told("if n < 0", Place::Choice), "when n < 0");
        assert_eq!(told("[else]", Place::Choice), "else");
        assert_eq!(told("playing", Place::Machine), "when playing");
        assert_eq!(told("on go when not playing", Place::Machine), "on go when not playing");
    }
}
