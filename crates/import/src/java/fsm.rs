//! JavaMOP's finite state machines: `state [ event -> state … default state ]`, `alias NAME = state, …`. The first state is the beginning; an event for which
//! a state has no transition is a failure.

use std::collections::BTreeMap;

use lapwing_diag::{Code, Diagnostic};

use super::automaton::{Automaton, MOST_STATES};
use super::cursor::{Cursor, Name};
use crate::Report;
use lapwing_diag::suggest::{nearest, or_else};

/// A machine that was read.
pub(super) struct Fsm {
    pub automaton: Automaton,
    /// The state of failure.
    pub fail: usize,
    /// States by their names and by their aliases.
    pub named: BTreeMap<String, Vec<usize>>,
}

/// A state as it is written.
struct Written {
    name: Name,
    moves: Vec<(Name, Name)>,
    default: Option<Name>,
}

/// Reads a machine over these events; `None` where something is wrong with it, which is reported.
pub(super) fn read(mut cursor: Cursor<'_>, events: &[&str], report: &mut Report) -> Option<Fsm> {
    let mut states: Vec<Written> = Vec::new();
    let mut aliases: Vec<(Name, Vec<Name>)> = Vec::new();
    while !cursor.is_end() {
        let is_alias = cursor.at(&["alias"]) && cursor.peek(2) == "=";
        if is_alias {
            cursor.next();
            aliases.push(alias(&mut cursor)?);
            continue;
        }
        states.push(state(&mut cursor, report)?);
        if states.len() > MOST_STATES {
            wrong(report, &cursor, &format!("no more than {MOST_STATES} states"));
            return None;
        }
    }
    if states.is_empty() {
        wrong(report, &cursor, "a state, as in `start [ event -> state ]`");
        return None;
    }
    let number: BTreeMap<&str, usize> =
        states.iter().enumerate().rev().map(|(n, s)| (s.name.text.as_str(), n)).collect();
    let mut find = |name: &Name| {
        let found = number.get(name.text.as_str()).copied();
        if found.is_none() {
            unknown(report, "state", name, number.keys().copied());
        }
        found
    };
    let fail = states.len();
    let mut next = Vec::new();
    let mut strangers = Vec::new();
    for state in &states {
        let default = match &state.default {
            Some(default) => find(default)?,
            None => fail,
        };
        let mut row = vec![default; events.len()];
        let mut said = vec![false; events.len()];
        for (event, to) in &state.moves {
            let to = find(to)?;
            match events.iter().position(|e| *e == event.text) {
                // Of two transitions by one event JavaMOP takes the last.
                Some(letter) => (row[letter], said[letter]) = (to, true),
                None => strangers.push(event.clone()),
            }
        }
        next.push(row);
    }
    next.push(vec![fail; events.len()]);
    let mut named: BTreeMap<String, Vec<usize>> = number.iter().map(|(n, s)| ((*n).to_owned(), vec![*s])).collect();
    for (name, of) in &aliases {
        let of = of.iter().map(&mut find).collect::<Option<Vec<usize>>>()?;
        named.insert(name.text.clone(), of);
    }
    if let Some(event) = strangers.first() {
        unknown(report, "event", event, events.iter().copied());
        return None;
    }
    named.entry("fail".to_owned()).or_insert_with(|| vec![fail]);
    let names = states.iter().map(|s| crate::names::slug(&s.name.text)).chain(["fail".to_owned()]).collect();
    Some(Fsm { automaton: Automaton { states: names, next }, fail, named })
}

fn alias(cursor: &mut Cursor<'_>) -> Option<(Name, Vec<Name>)> {
    let name = cursor.name()?;
    cursor.next();
    let mut of = vec![cursor.name()?];
    while cursor.eat(&[","]) {
        of.push(cursor.name()?);
    }
    Some((name, of))
}

fn state(cursor: &mut Cursor<'_>, report: &mut Report) -> Option<Written> {
    let start = *cursor;
    let name = cursor.name();
    let inside = cursor.group("[", "]");
    let (Some(name), Some(mut inside)) = (name, inside) else {
        wrong(report, &start, "a state and its transitions, as in `start [ event -> state ]`");
        return None;
    };
    let mut written = Written { name, moves: Vec::new(), default: None };
    while !inside.is_end() {
        if inside.eat(&[","]) || inside.eat(&[";"]) {
            continue;
        }
        let here = inside;
        let is_default = inside.at(&["default"]) && inside.peek(1) != "-";
        let event = inside.name();
        let arrow = is_default || inside.eat(&["-", ">"]);
        let to = inside.name();
        match (event, to) {
            (Some(_), Some(to)) if is_default => written.default = Some(to),
            (Some(event), Some(to)) if arrow => written.moves.push((event, to)),
            _ => {
                wrong(report, &here, "a transition, as in `event -> state`");
                return None;
            }
        }
    }
    Some(written)
}

fn wrong(report: &mut Report, cursor: &Cursor<'_>, expected: &str) {
    let place = cursor.place();
    let span = report.span(place.start, place.end);
    let message = format!("in the finite state machine, expected {expected}");
    report.push(Diagnostic::new(Code::ImportSyntax, span, message).label("the property is left out"));
}

fn unknown<'n>(report: &mut Report, what: &str, name: &Name, names: impl Iterator<Item = &'n str>) {
    let span = report.span(name.place.start, name.place.end);
    let or_else = or_else(nearest(&name.text, names));
    let message = format!("there is no {what} `{}`{or_else}", name.text);
    report.push(Diagnostic::new(Code::ImportSyntax, span, message).label("the property is left out"));
}
