//! From tokens to monitors.

use std::ops::Range;

use lapwing_diag::{Code, Diagnostic};

use super::ast::{Atom, Block, Event, Handler, Parameter, Pointcut, Side, Spec};
use super::cursor::{Cursor, Name};
use super::lexer::Kind;
use crate::Report;

/// Pointcuts nest no deeper.
const MOST_DEPTH: usize = 32;
/// The type of what an `around` event returns has no more tokens.
const MOST_TYPE: usize = 32;

/// The words that may stand before a monitor's name.
const MODIFIERS: &[&str] = &[
    "unsynchronized",
    "decentralized",
    "perthread",
    "suffix",
    "connected",
    "avoid",
    "enforce",
    "public",
    "private",
    "static",
];

/// All monitors of a file.
pub(crate) fn parse<'t>(mut cursor: Cursor<'t>, report: &mut Report) -> Vec<Spec<'t>> {
    let mut specs = Vec::new();
    let mut modifiers = Vec::new();
    while !cursor.is_end() {
        if matches!(cursor.peek(0), "import" | "package") {
            cursor.until(|c| c.peek(0) == ";");
            cursor.next();
        } else if MODIFIERS.contains(&cursor.peek(0)) {
            modifiers.extend(cursor.name());
        } else if cursor.eat(&["-"]) {
            cursor.next();
            // `full-binding`
        } else if matches!(cursor.peek(0), "full" | "maximal" | "any") && cursor.peek(1) == "-" {
            (0..3).for_each(|_| _ = cursor.next());
        } else if cursor.peek(0) == "}" && !specs.is_empty() {
            let place = cursor.place();
            let message = "this `}` closes nothing, and is passed over";
            report.push(Diagnostic::new(Code::ImportDiffers, report.span(place.start, place.end), message));
            cursor.next();
        } else {
            match spec(&mut cursor, std::mem::take(&mut modifiers), report) {
                Some(spec) => specs.push(spec),
                None => break,
            }
        }
    }
    specs
}

fn wrong(report: &mut Report, cursor: &Cursor<'_>, expected: &str) -> Diagnostic {
    let place = cursor.place();
    let found = match cursor.peek(0) {
        "" => "the end of the file".to_owned(),
        word => format!("`{}`", word.chars().take(40).collect::<String>()),
    };
    Diagnostic::new(
        Code::ImportSyntax,
        report.span(place.start, place.end),
        format!("expected {expected}, found {found}"),
    )
}

/// A bracket that is not closed.
fn unclosed(report: &Report, open: Range<usize>, what: &str) -> Diagnostic {
    Diagnostic::new(Code::ImportSyntax, report.span(open.start, open.end), format!("{what} is not closed"))
}

/// `NAME(PARAMETERS) { … }`
fn spec<'t>(cursor: &mut Cursor<'t>, modifiers: Vec<Name>, report: &mut Report) -> Option<Spec<'t>> {
    let is_monitor = cursor.peek(1) == "(" && !matches!(cursor.peek(0), "if" | "for" | "while" | "switch" | "catch");
    let name = if is_monitor { cursor.name() } else { None };
    let Some(name) = name else {
        let diagnostic = wrong(report, cursor, "a monitor, as in `Init(Kicker k) { … }`");
        report.push(diagnostic);
        return None;
    };
    let parameters = cursor.group("(", ")").map(parameters).unwrap_or_default();
    // `includes …` and what else may stand before the body.
    cursor.until(|c| c.peek(0) == "{");
    // Where a brace inside of it is missing, so is its own.
    if let Some(open) = cursor.unclosed("{", "}").filter(|open| *open == cursor.place()) {
        report.push(
            unclosed(report, open, "the monitor's `{`").label("everything up to the end of the file is taken for it"),
        );
    }
    let Some(mut body) = cursor.group("{", "}") else {
        let diagnostic = wrong(report, cursor, "`{` and the monitor's body");
        report.push(diagnostic);
        return None;
    };
    let mut spec = Spec { modifiers, name, parameters, events: Vec::new(), blocks: Vec::new(), members: Vec::new() };
    while !body.is_end() {
        member(&mut body, &mut spec, report);
    }
    Some(spec)
}

/// An event, a formula with its handlers, or something of Java.
fn member<'t>(body: &mut Cursor<'t>, spec: &mut Spec<'t>, report: &mut Report) {
    let is_event = |c: &Cursor<'_>| c.peek(0) == "event" && c.ahead(1).is_some_and(|t| t.kind == Kind::Word);
    let mut creates = false;
    while matches!(body.peek(0), "creation" | "static") && matches!(body.peek(1), "creation" | "static" | "event") {
        creates |= body.peek(0) == "creation";
        body.next();
    }
    if is_event(body) {
        spec.events.extend(event(body, creates, report));
    } else if begins_formula(body) {
        spec.blocks.extend(block(body));
    } else if body.peek(0) == "@" {
        handlers(body).into_iter().for_each(|stray| {
            let message = format!("`@{}` belongs to no formula", stray.name.text);
            let span = report.span(stray.name.place.start, stray.name.place.end);
            report.push(Diagnostic::new(Code::ImportSyntax, span, message).help("a handler stands behind its formula"));
        });
    } else {
        let place = java(body);
        if place.len() > 1 {
            spec.members.push(place);
        }
    }
}

/// Whether a formalism and its colon stand here.
fn begins_formula(cursor: &Cursor<'_>) -> bool {
    cursor.ahead(0).is_some_and(|t| t.kind == Kind::Word) && cursor.peek(1) == ":" && cursor.peek(2) != ":"
}

/// A field or a method: up to its semicolon or the end of its block.
fn java(body: &mut Cursor<'_>) -> Range<usize> {
    let start = body.place().start;
    let mut assigned = false;
    while !body.is_end() {
        match body.peek(0) {
            ";" => {
                body.next();
                break;
            }
            "{" => {
                body.group("{", "}");
                if !assigned {
                    break;
                }
            }
            word => {
                assigned |= word == "=";
                body.next();
            }
        }
    }
    start..body.before()
}

/// `Kicker MK, int x`
fn parameters(inside: Cursor<'_>) -> Vec<Parameter> {
    inside.by_commas().into_iter().filter_map(parameter).collect()
}

/// The last name is the parameter's; what stands before it is its type, whose own parameters do not matter.
fn parameter(mut part: Cursor<'_>) -> Option<Parameter> {
    let mut name = None;
    let mut class = None;
    while let Some(token) = part.ahead(0) {
        if token.kind == Kind::Word {
            class = std::mem::replace(&mut name, part.name());
        } else if part.group("<", ">").is_none() {
            part.next();
        }
    }
    Some(Parameter { class: class.map(|c: Name| c.text).unwrap_or_default(), name: name? })
}

/// `event NAME before|after|TYPE around (…) returning (…) : POINTCUT { … }`
fn event<'t>(body: &mut Cursor<'t>, creates: bool, report: &mut Report) -> Option<Event<'t>> {
    let start = body.place().start;
    body.next();
    let name = body.name()?;
    // `Integer around(…)`: what is returned in the place of the call stands before the word.
    let of_type = |by: &usize| !matches!(body.peek(*by), "" | "(" | ":" | "{" | ";");
    if let Some(by) = (0..MOST_TYPE).take_while(of_type).find(|by| body.peek(*by) == "around") {
        body.take(by);
    }
    let side = match body.peek(0) {
        // The event is there before the call is made, or is not.
        "before" | "around" => Side::Before,
        "after" => Side::After,
        _ => {
            let diagnostic = wrong(report, body, "`before`, `after` or `around`");
            report.push(diagnostic.label("when is the event?"));
            java(body);
            return None;
        }
    };
    body.next();
    let parameters = body.group("(", ")").map(self::parameters).unwrap_or_default();
    let (mut returning, mut throwing) = (None, None);
    loop {
        let place = body.place();
        if body.eat(&["returning"]) {
            returning = body.group("(", ")").and_then(parameter);
        } else if body.eat(&["throwing"]) {
            body.group("(", ")");
            throwing = Some(place);
        } else {
            break;
        }
    }
    let pointcut = match body.eat(&[":"]) {
        true => {
            let written = body.until(|c| matches!(c.peek(0), "{" | ";") || c.peek(0) == "event" || c.peek(0) == "@");
            pointcut(written, report)
        }
        false => Pointcut::Nothing,
    };
    let place = start..body.before();
    let advice = body.group("{", "}").unwrap_or_else(|| Cursor::new(body.text, &[]));
    body.eat(&[";"]);
    Some(Event { name, creates, side, parameters, returning, throwing, pointcut, place, advice })
}

fn pointcut<'t>(mut written: Cursor<'t>, report: &mut Report) -> Pointcut<'t> {
    if let Some(open) = written.unclosed("(", ")") {
        report.push(unclosed(report, open, "this `(`").label("the pointcut is not read"));
        return unread(written);
    }
    let read = either(&mut written, 0);
    if !written.is_end() {
        let diagnostic = wrong(report, &written, "`&&`, `||` or the event's block");
        report.push(diagnostic.label("the rest of the pointcut is not read"));
        // What is not read may leave join points out.
        let end = written.span();
        let rest = Atom { word: "", inside: written, start: end.start, end: end.end };
        return Pointcut::And(vec![read, Pointcut::Atom(rest)]);
    }
    read
}

fn either<'t>(cursor: &mut Cursor<'t>, depth: usize) -> Pointcut<'t> {
    let mut parts = vec![both(cursor, depth)];
    while cursor.eat(&["|", "|"]) {
        parts.push(both(cursor, depth));
    }
    if parts.len() > 1 { Pointcut::Or(parts) } else { parts.pop().unwrap_or(Pointcut::Nothing) }
}

fn both<'t>(cursor: &mut Cursor<'t>, depth: usize) -> Pointcut<'t> {
    let mut parts = vec![unary(cursor, depth)];
    while cursor.eat(&["&", "&"]) {
        parts.push(unary(cursor, depth));
    }
    if parts.len() > 1 { Pointcut::And(parts) } else { parts.pop().unwrap_or(Pointcut::Nothing) }
}

fn unary<'t>(cursor: &mut Cursor<'t>, depth: usize) -> Pointcut<'t> {
    if depth > MOST_DEPTH {
        return Pointcut::Nothing;
    }
    if cursor.eat(&["!"]) {
        return Pointcut::Not(Box::new(unary(cursor, depth + 1)));
    }
    if let Some(mut inside) = cursor.group("(", ")") {
        let read = either(&mut inside, depth + 1);
        return if inside.is_end() { read } else { unread(inside) };
    }
    let place = cursor.place();
    match cursor.name() {
        Some(_) => {
            let word = cursor.text.get(place.clone()).unwrap_or("");
            let inside = cursor.group("(", ")").unwrap_or_else(|| Cursor::new(cursor.text, &[]));
            Pointcut::Atom(Atom { word, inside, start: place.start, end: cursor.before() })
        }
        None => Pointcut::Nothing,
    }
}

fn unread(inside: Cursor<'_>) -> Pointcut<'_> {
    let place = inside.span();
    Pointcut::Atom(Atom { word: "", inside, start: place.start, end: place.end })
}

/// `ltl: FORMULA @violation { … }`
fn block<'t>(body: &mut Cursor<'t>) -> Option<Block<'t>> {
    let formalism = body.name()?;
    body.next();
    let formula = body.until(|c| {
        c.peek(0) == "@"
            || begins_formula(c)
            || (c.peek(0) == "event" && c.ahead(1).is_some_and(|t| t.kind == Kind::Word))
    });
    Some(Block { formalism, formula, handlers: handlers(body) })
}

fn handlers<'t>(body: &mut Cursor<'t>) -> Vec<Handler<'t>> {
    let mut handlers = Vec::new();
    while body.eat(&["@"]) {
        let Some(name) = body.name() else { break };
        let Some(block) = body.group("{", "}") else { break };
        handlers.push(Handler { name, body: block });
    }
    handlers
}
