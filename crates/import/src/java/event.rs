//! From pointcuts to events: where each event comes from, as far as a specification can say it.
//!
//! A pointcut is a formula over join points. It is brought into alternatives, each a conjunction; each alternative becomes an event of its own. What
//! part of a conjunction is always true, because AspectJ's kinds of join points exclude each other, is left out; what narrows it and cannot be said makes
//! the event one that the program has to tell by its name, since an event that occurs more often than it should would be worse than none.

use std::collections::BTreeSet;
use std::ops::Range;

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::Expr;

use super::ast::{Atom, Event, Pointcut, Side};
use super::cursor::Cursor;
use super::lexer::Kind;
use crate::condition::{self, Reading};
use crate::names::{slug, snake};
use crate::sheet::{self, Sheet, Source};
use crate::{Report, expr};

/// A pointcut with more alternatives is not taken apart.
const MOST_ALTERNATIVES: usize = 8;
/// Nor one with more parts in one of them.
const MOST_PARTS: usize = 32;

/// What became of an event.
#[derive(Clone, Debug)]
pub(super) struct Meant {
    /// The events that stand for it: several where its pointcut has alternatives.
    pub names: Vec<String>,
    /// The parameters that it binds.
    pub binds: BTreeSet<String>,
}

/// A part of a pointcut, perhaps negated.
type Literal<'t> = (Atom<'t>, bool);

/// Declares an event of the monitor `spec`.
pub(super) fn declare(spec: &str, event: &Event<'_>, sheet: &mut Sheet, report: &mut Report) -> Meant {
    let mut binds = BTreeSet::new();
    binds.extend(event.returning.iter().map(|r| r.name.text.clone()));
    let found = match alternatives(&event.pointcut, false) {
        Some(found) => found,
        None => {
            let place = report.span(event.place.start, event.place.end);
            unsaid(event, report, place, "its pointcut has too many alternatives");
            vec![Vec::new()]
        }
    };
    let mut all: Vec<sheet::Event> = Vec::new();
    for parts in &found {
        let declared = found_at(event, parts, &mut binds).unwrap_or_else(|(place, why)| {
            let place = report.span(place.start, place.end);
            unsaid(event, report, place, &why);
            blank()
        });
        if declared.source.is_some() {
            parts.iter().filter(|(_, negated)| !negated).for_each(|(atom, _)| mention_subtypes(atom, report));
        }
        // Overloads of a function are one function in Rust, and whatever is told by its name is told by one.
        if !all.contains(&declared) {
            all.push(declared);
        }
    }
    let several = all.len() > 1;
    let mut names = Vec::new();
    for (number, declared) in all.into_iter().enumerate() {
        let wanted = if several { format!("{}_{}", event.name.text, number + 1) } else { event.name.text.clone() };
        names.push(place_in(spec, event, sheet::Event { name: slug(&wanted), ..declared }, sheet, report));
    }
    Meant { names, binds }
}

fn blank() -> sheet::Event {
    sheet::Event { name: String::new(), source: None, when: None, below: None }
}

/// Puts the event under its name, or under another one where that is taken.
fn place_in(
    spec: &str,
    event: &Event<'_>,
    mut declared: sheet::Event,
    sheet: &mut Sheet,
    report: &mut Report,
) -> String {
    if !sheet.events.contains(&declared) {
        let wanted = declared.name.clone();
        let is_taken = sheet.taken.has(&wanted);
        // `_2` says nothing; the name of the monitor does.
        let wanted = if is_taken { format!("{}_{wanted}", snake(spec)) } else { wanted };
        declared.name = sheet.taken.take(&wanted);
        if is_taken {
            let span = report.span(event.name.place.start, event.name.place.end);
            let message = format!("the event `{}` is called `{}` here", event.name.text, declared.name);
            report.push(Diagnostic::new(Code::ImportRenamed, span, message).label("another one has that name"));
        }
    }
    sheet.event(declared)
}

/// `Collection+` is a class with all that extend it; a function of ours stands in one module.
fn mention_subtypes(atom: &Atom<'_>, report: &mut Report) {
    let found = kind(atom.word).and_then(|kind| join(atom, kind)).filter(|j| j.with_subtypes);
    let Some(class) = found.and_then(|j| j.class) else { return };
    let place = atom.place();
    let message = format!("`{class}+` is read as `{class}`");
    report.push(
        Diagnostic::new(Code::ImportDiffers, report.span(place.start, place.end), message)
            .label("what extends it has functions of its own: say which are meant"),
    );
}

fn unsaid(event: &Event<'_>, report: &mut Report, place: lapwing_diag::Span, why: &str) {
    let name = &event.name.text;
    let message = format!("it is not said where the event `{name}` comes from");
    report.push(
        Diagnostic::new(Code::ImportEvent, place, message)
            .label(why)
            .help(format!("write it yourself, `event {name} = call …`, or let the program tell it by its name")),
    );
}

/// The alternatives of a pointcut; `None` where there are too many.
fn alternatives<'t>(pointcut: &Pointcut<'t>, negated: bool) -> Option<Vec<Vec<Literal<'t>>>> {
    match (pointcut, negated) {
        (Pointcut::Nothing, _) => Some(vec![Vec::new()]),
        (Pointcut::Atom(atom), negated) => Some(vec![vec![(*atom, negated)]]),
        (Pointcut::Not(inner), negated) => alternatives(inner, !negated),
        (Pointcut::And(parts), false) | (Pointcut::Or(parts), true) => {
            let mut all: Vec<Vec<Literal<'t>>> = vec![Vec::new()];
            for part in parts {
                let more = alternatives(part, negated)?;
                all = all.iter().flat_map(|a| more.iter().map(|b| [a.as_slice(), b].concat())).collect();
                let too_much = all.len() > MOST_ALTERNATIVES || all.iter().any(|a| a.len() > MOST_PARTS);
                if too_much {
                    return None;
                }
            }
            Some(all)
        }
        (Pointcut::Or(parts), false) | (Pointcut::And(parts), true) => {
            let mut all = Vec::new();
            for part in parts {
                all.extend(alternatives(part, negated)?);
            }
            (all.len() <= MOST_ALTERNATIVES).then_some(all)
        }
    }
}

/// Why something cannot be said, and where it stands.
type Unsaid = (Range<usize>, String);

/// The join point of an alternative.
struct Join {
    kind: &'static str,
    /// The class, where it is named.
    class: Option<String>,
    /// Whether what extends the class is meant too.
    with_subtypes: bool,
    member: String,
    /// Whether a part of it is a wildcard.
    wild: bool,
}

impl Join {
    fn path(&self) -> Vec<String> {
        self.class.iter().cloned().chain([self.member.clone()]).collect()
    }
}

fn found_at(event: &Event<'_>, parts: &[Literal<'_>], binds: &mut BTreeSet<String>) -> Result<sheet::Event, Unsaid> {
    if let Some(place) = &event.throwing {
        return Err((place.clone(), "what ends by an exception records no return".to_owned()));
    }
    // What binds does so whatever becomes of the rest.
    let bound = parts.iter().filter(|(atom, negated)| !negated && matches!(atom.word, "target" | "this" | "args"));
    let names: Vec<&str> = bound.flat_map(|(atom, _)| words(&atom.inside)).collect();
    let own = |name: &&str| event.parameters.iter().any(|p| p.name.text == *name);
    binds.extend(names.into_iter().filter(own).map(str::to_owned));

    let mut joins = parts.iter().filter(|(_, negated)| !negated).filter_map(|(atom, _)| Some((atom, kind(atom.word)?)));
    let Some((atom, kind)) = joins.next() else {
        return Err((event.place.clone(), "no `call`, `execution` or `set` says at what it happens".to_owned()));
    };
    let join = join(atom, kind)
        .filter(|j| !j.wild)
        .ok_or_else(|| (atom.place(), format!("`{}` is a pattern, and an event has one place", atom.inside.line())))?;
    if let Some((second, _)) = joins.next() {
        return Err((second.place(), "no join point is of two kinds".to_owned()));
    }
    let path = join.path();
    let source = match (kind, event.side) {
        ("set", _) => Source::Set(path),
        (_, Side::Before) => Source::Call(path),
        (_, Side::After) => Source::Return(path),
    };
    let mut declared = sheet::Event { source: Some(source), ..blank() };
    let mut conditions = Vec::new();
    for (part, negated) in parts {
        narrow(event, &join, *part, *negated, &mut declared, &mut conditions)?;
    }
    declared.when = expr::all(conditions);
    Ok(declared)
}

/// The kinds of join points that a program can show.
fn kind(word: &str) -> Option<&'static str> {
    ["call", "execution", "set"].into_iter().find(|kind| *kind == word)
}

/// Adds what a part of the conjunction says besides the join point.
fn narrow(
    event: &Event<'_>,
    join: &Join,
    part: Atom<'_>,
    negated: bool,
    declared: &mut sheet::Event,
    conditions: &mut Vec<Expr>,
) -> Result<(), Unsaid> {
    let beyond = |why: &str| Err((part.place(), why.to_owned()));
    match part.word {
        "call" | "execution" | "set" if !negated => Ok(()),
        "call" | "execution" | "set" | "get" if excludes(join, &part) => Ok(()),
        "adviceexecution" if negated => Ok(()),
        "condition" | "if" => {
            let condition = condition(event, join, &part)?;
            conditions.push(if negated { expr::not(condition) } else { condition });
            Ok(())
        }
        "target" | "this" | "args" if !negated => {
            let class = |w: &str| !event.parameters.iter().any(|p| p.name.text == w);
            let other = words(&part.inside).into_iter().find(|w| class(w) && Some(*w) != join.class.as_deref());
            match other {
                // The types of arguments choose between overloads, which Rust does not have.
                Some(class) if part.word != "args" => beyond(&format!("whether it is a `{class}` cannot be seen")),
                _ => Ok(()),
            }
        }
        "cflow" | "cflowbelow" | "withincode" if !negated => below(join, &part, declared),
        "within" => {
            // Code of a class runs functions of the class, and sets its private fields.
            let (mut inside, here) = (words(&part.inside), join.class.as_deref());
            let named = inside.pop().filter(|_| inside.is_empty() && !part.inside.line().contains(['*', '+']));
            let own = join.kind != "call" && here.is_some();
            match named {
                Some(named) if own && (named == here.unwrap_or_default()) != negated => Ok(()),
                _ => beyond("from which code it is reached cannot be seen"),
            }
        }
        "" => beyond("this is not read"),
        word => {
            let not = if negated { "`!`, " } else { "" };
            beyond(&format!("{not}`{word}` has no counterpart"))
        }
    }
}

/// Whether what is excluded is never a join point of this kind and place.
fn excludes(join: &Join, part: &Atom<'_>) -> bool {
    if part.word != join.kind {
        return true;
    }
    kind(part.word)
        .and_then(|kind| self::join(part, kind))
        .is_some_and(|other| !other.wild && other.path() != join.path())
}

/// `cflowbelow(call(void Kicker.BallInFront()))`
fn below(join: &Join, part: &Atom<'_>, declared: &mut sheet::Event) -> Result<(), Unsaid> {
    let mut inside = part.inside;
    let span = inside.span();
    let around = match part.word {
        "withincode" => self::join(part, "execution"),
        _ => inside.name().map(|n| n.text).filter(|w| w == "call" || w == "execution").and_then(|_| {
            let signature = inside.group("(", ")").filter(|_| inside.is_end())?;
            self::join(&Atom { word: "call", inside: signature, start: span.start, end: span.end }, "call")
        }),
    };
    let around = around.filter(|around| !around.wild);
    match around {
        Some(around) if part.word == "cflow" && around.path() == join.path() => Ok(()),
        Some(around) if declared.below.is_none() => {
            declared.below = Some(around.path());
            Ok(())
        }
        Some(_) => Err((part.place(), "an event is below one call".to_owned())),
        None => Err((part.place(), "below what, is not one function".to_owned())),
    }
}

/// The words inside of brackets.
fn words<'t>(inside: &Cursor<'t>) -> Vec<&'t str> {
    let text = inside.text;
    inside.rest().iter().filter(|t| t.kind == Kind::Word).filter_map(|t| text.get(t.range())).collect()
}

/// The function or field that a signature names.
fn join(atom: &Atom<'_>, kind: &'static str) -> Option<Join> {
    let (text, tokens) = (atom.inside.text, atom.inside.rest());
    let of = |at: usize| tokens.get(at).and_then(|t| text.get(t.range())).unwrap_or("");
    let end = (0..tokens.len()).find(|&at| of(at) == "(").unwrap_or(tokens.len());
    let glued = |at: usize| at + 1 == end || tokens.get(at).map(|t| t.end) == tokens.get(at + 1).map(|t| t.start);
    let belongs = |at: usize| {
        let word = tokens.get(at).is_some_and(|t| t.kind == Kind::Word);
        (word || matches!(of(at), "." | "*" | "+")) && glued(at)
    };
    let mut begin = end;
    while begin > 0 && belongs(begin - 1) {
        begin -= 1;
    }
    let pattern: String = (begin..end).map(of).collect();
    let mut segments: Vec<&str> = pattern.split('.').filter(|s| !s.is_empty()).collect();
    let member = segments.pop()?;
    let class = segments.pop();
    let with_subtypes = class.is_some_and(|class| class.ends_with('+'));
    let class = class.map(|class| class.trim_end_matches('+'));
    let wild = member.contains('*') || class.is_some_and(|class| class.contains('*') && class != "*");
    let class = class.filter(|class| *class != "*").map(slug);
    Some(Join { kind, class, with_subtypes, member: snake(member), wild })
}

/// `condition(!res)`
fn condition(event: &Event<'_>, join: &Join, part: &Atom<'_>) -> Result<Expr, Unsaid> {
    let place = part.inside.span();
    let text = part.inside.text.get(place.clone()).unwrap_or("");
    let returned = event.returning.as_ref().map(|r| r.name.text.as_str());
    let name = |parts: &[&str]| match parts {
        [name] if Some(*name) == returned => Some(expr::name("result")),
        // The value that a field gets is the field's.
        [name] if event.parameters.iter().any(|p| p.name.text == *name) && join.kind == "set" => {
            Some(expr::name(&join.member))
        }
        [name] if event.parameters.iter().any(|p| p.name.text == *name) => Some(expr::name(&slug(name))),
        _ => None,
    };
    condition::read(text, &Reading { name: &name, compares_truths: true })
        .map_err(|refused| (place.start + refused.place.start..place.start + refused.place.end, refused.why))
}
