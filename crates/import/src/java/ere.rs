//! JavaMOP's extended regular expressions, and the automata that their derivatives are.
//!
//! The states of the automaton are what is left of the expression after some events (J. A. Brzozowski, *Derivatives of regular expressions*, Journal of the
//! ACM 11(4), 1964, section 5): there are finitely many where alternatives are sets. States that accept the same words are then put together.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_diag::{Code, Diagnostic};

use super::automaton::{Automaton, MOST_STATES};
use super::cursor::Cursor;
use crate::Report;
use lapwing_diag::suggest::{nearest, or_else};

/// Expressions nest no deeper, and have no more parts; nor has what is left of them.
const MOST_DEPTH: usize = 40;
const MOST_PARTS: usize = 300;

/// An expression. What is equal by the laws of sets is the same expression.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Regex {
    /// No word at all.
    Never,
    /// The empty word.
    Nothing,
    Event(usize),
    Row(Box<Regex>, Box<Regex>),
    Any(BTreeSet<Regex>),
    All(BTreeSet<Regex>),
    Not(Box<Regex>),
    Star(Box<Regex>),
}

use Regex::{All, Any, Event, Never, Not, Nothing, Row, Star};

/// One after the other.
fn row(first: Regex, then: Regex) -> Regex {
    match (first, then) {
        (Never, _) | (_, Never) => Never,
        (Nothing, other) | (other, Nothing) => other,
        (Row(a, b), then) => row(*a, row(*b, then)),
        (first, then) => Row(Box::new(first), Box::new(then)),
    }
}

fn any(parts: impl IntoIterator<Item = Regex>) -> Regex {
    let mut all = BTreeSet::new();
    for part in parts {
        match part {
            Never => {}
            Any(parts) => all.extend(parts),
            part => _ = all.insert(part),
        }
    }
    let everything = Not(Box::new(Never));
    if all.contains(&everything) {
        return everything;
    }
    one_or(all, Never, Any)
}

fn both(parts: impl IntoIterator<Item = Regex>) -> Regex {
    let mut all = BTreeSet::new();
    for part in parts {
        match part {
            All(parts) => all.extend(parts),
            part => _ = all.insert(part),
        }
    }
    if all.contains(&Never) {
        return Never;
    }
    all.remove(&Not(Box::new(Never)));
    one_or(all, Not(Box::new(Never)), All)
}

/// The only element itself, `none` where there is none.
fn one_or(mut all: BTreeSet<Regex>, none: Regex, several: fn(BTreeSet<Regex>) -> Regex) -> Regex {
    match all.len() {
        0 => none,
        1 => all.pop_first().unwrap_or(none),
        _ => several(all),
    }
}

fn not(of: Regex) -> Regex {
    match of {
        Not(of) => *of,
        of => Not(Box::new(of)),
    }
}

fn star(of: Regex) -> Regex {
    match of {
        Never | Nothing => Nothing,
        Star(of) => Star(of),
        of => Star(Box::new(of)),
    }
}

impl Regex {
    /// Whether the empty word is one of its words.
    fn accepts(&self) -> bool {
        match self {
            Never | Event(_) => false,
            Nothing | Star(_) => true,
            Row(a, b) => a.accepts() && b.accepts(),
            Any(parts) => parts.iter().any(Regex::accepts),
            All(parts) => parts.iter().all(Regex::accepts),
            Not(of) => !of.accepts(),
        }
    }

    /// What is left after an event.
    fn after(&self, event: usize) -> Regex {
        match self {
            Never | Nothing => Never,
            Event(e) if *e == event => Nothing,
            Event(_) => Never,
            Row(a, b) => {
                let first = row(a.after(event), (**b).clone());
                if a.accepts() { any([first, b.after(event)]) } else { first }
            }
            Any(parts) => any(parts.iter().map(|p| p.after(event))),
            All(parts) => both(parts.iter().map(|p| p.after(event))),
            Not(of) => not(of.after(event)),
            Star(of) => row(of.after(event), self.clone()),
        }
    }

    fn parts(&self) -> usize {
        1 + match self {
            Never | Nothing | Event(_) => 0,
            Row(a, b) => a.parts() + b.parts(),
            Any(parts) | All(parts) => parts.iter().map(Regex::parts).sum(),
            Not(of) | Star(of) => of.parts(),
        }
    }
}

/// An automaton that was read, with the states in which the word so far matches, and those from which none can.
pub(super) struct Ere {
    pub automaton: Automaton,
    pub matching: BTreeSet<usize>,
    pub failing: BTreeSet<usize>,
}

/// Reads an expression over these events; `None` where something is wrong with it, which is reported.
pub(super) fn read(mut cursor: Cursor<'_>, events: &[&str], report: &mut Report) -> Option<Ere> {
    let whole = cursor.span();
    let mut reader = Reader { events, report, depth: 0, parts: 0 };
    let regex = reader.any(&mut cursor)?;
    if !cursor.is_end() {
        return reader.wrong(&cursor, "an event, an operator or the end of the expression");
    }
    let found = automaton(regex, events.len());
    if found.is_none() {
        let message = format!("the regular expression has more than {MOST_STATES} states");
        let span = report.span(whole.start, whole.end);
        let diagnostic = Diagnostic::new(Code::ImportRefused, span, message).label("the property is left out");
        report.push(diagnostic.help("say it in several expressions"));
    }
    found
}

struct Reader<'r> {
    events: &'r [&'r str],
    report: &'r mut Report,
    depth: usize,
    parts: usize,
}

impl Reader<'_> {
    fn wrong<T>(&mut self, cursor: &Cursor<'_>, expected: &str) -> Option<T> {
        let place = cursor.place();
        let span = self.report.span(place.start, place.end);
        let message = format!("in the regular expression, expected {expected}");
        self.report.push(Diagnostic::new(Code::ImportSyntax, span, message).label("the property is left out"));
        None
    }

    fn any(&mut self, cursor: &mut Cursor<'_>) -> Option<Regex> {
        let mut parts = vec![self.both(cursor)?];
        while cursor.eat(&["|"]) {
            cursor.eat(&["|"]);
            parts.push(self.both(cursor)?);
        }
        Some(any(parts))
    }

    fn both(&mut self, cursor: &mut Cursor<'_>) -> Option<Regex> {
        let mut parts = vec![self.row(cursor)?];
        while cursor.eat(&["&"]) {
            cursor.eat(&["&"]);
            parts.push(self.row(cursor)?);
        }
        Some(both(parts))
    }

    fn row(&mut self, cursor: &mut Cursor<'_>) -> Option<Regex> {
        let mut parts = vec![self.unary(cursor)?];
        while !cursor.is_end() && !matches!(cursor.peek(0), "|" | "&" | ")") {
            parts.push(self.unary(cursor)?);
        }
        Some(parts.into_iter().rev().fold(Nothing, |then, first| row(first, then)))
    }

    fn unary(&mut self, cursor: &mut Cursor<'_>) -> Option<Regex> {
        self.parts += 1;
        if self.depth == MOST_DEPTH || self.parts > MOST_PARTS {
            return self.wrong(cursor, "an expression of a smaller size");
        }
        self.depth += 1;
        let read = if cursor.eat(&["~"]) || cursor.eat(&["!"]) {
            self.unary(cursor).map(not)
        } else {
            self.primary(cursor).map(|of| repeated(of, cursor))
        };
        self.depth -= 1;
        read
    }

    fn primary(&mut self, cursor: &mut Cursor<'_>) -> Option<Regex> {
        if cursor.eat(&["("]) {
            let inner = self.any(cursor)?;
            return if cursor.eat(&[")"]) { Some(inner) } else { self.wrong(cursor, "`)`") };
        }
        let start = *cursor;
        let Some(name) = cursor.name() else { return self.wrong(&start, "an event or `(`") };
        if let Some(event) = self.events.iter().position(|e| *e == name.text) {
            return Some(Event(event));
        }
        match name.text.as_str() {
            "epsilon" => Some(Nothing),
            "empty" => Some(Never),
            text => {
                let guess = nearest(text, self.events.iter().copied());
                let or_else = or_else(guess);
                self.wrong(&start, &format!("an event, and `{text}` is none{or_else}"))
            }
        }
    }
}

/// `e*`, `e+`, `e?`
fn repeated(mut of: Regex, cursor: &mut Cursor<'_>) -> Regex {
    loop {
        if cursor.eat(&["*"]) {
            of = star(of);
        } else if cursor.eat(&["+"]) {
            of = row(of.clone(), star(of));
        } else if cursor.eat(&["?"]) {
            of = any([Nothing, of]);
        } else {
            return of;
        }
        if of.parts() > 4 * MOST_PARTS {
            return of;
        }
    }
}

/// The automaton of an expression; `None` where it is too large.
fn automaton(regex: Regex, events: usize) -> Option<Ere> {
    let mut known = BTreeMap::from([(regex.clone(), 0)]);
    let mut states = vec![regex];
    let mut next: Vec<Vec<usize>> = Vec::new();
    while let Some(state) = states.get(next.len()).cloned() {
        if state.parts() > MOST_PARTS {
            return None;
        }
        let mut row = Vec::new();
        for event in 0..events {
            let after = state.after(event);
            let number = known.len();
            let number = *known.entry(after.clone()).or_insert(number);
            if number == states.len() {
                states.push(after);
            }
            row.push(number);
        }
        next.push(row);
        // What derivatives tell apart may be alike: twice as many may still become few enough.
        if states.len() > 4 * MOST_STATES {
            return None;
        }
    }
    let accepting: Vec<bool> = states.iter().map(Regex::accepts).collect();
    let (class, count) = classes(&accepting, &next);
    if count > MOST_STATES {
        return None;
    }
    Some(merged(&class, count, &accepting, &next))
}

/// Which states accept the same words (Moore's partition refinement). Classes are numbered in the order of their first states.
fn classes(accepting: &[bool], next: &[Vec<usize>]) -> (Vec<usize>, usize) {
    let mut class: Vec<usize> = accepting.iter().map(|a| usize::from(*a)).collect();
    let mut count = 0;
    loop {
        let mut known = BTreeMap::new();
        let finer: Vec<usize> = next
            .iter()
            .zip(&class)
            .map(|(row, own)| {
                let key = (*own, row.iter().map(|to| class[*to]).collect::<Vec<_>>());
                let number = known.len();
                *known.entry(key).or_insert(number)
            })
            .collect();
        let finer_count = known.len();
        class = finer;
        if finer_count == count {
            return (class, count);
        }
        count = finer_count;
    }
}

fn merged(class: &[usize], count: usize, accepting: &[bool], next: &[Vec<usize>]) -> Ere {
    let first = |c: usize| class.iter().position(|k| *k == c).unwrap_or(0);
    let rows: Vec<Vec<usize>> = (0..count).map(|c| next[first(c)].iter().map(|to| class[*to]).collect()).collect();
    let matching: BTreeSet<usize> = (0..count).filter(|c| accepting[first(*c)]).collect();
    let mut hopeful = matching.clone();
    loop {
        let more: Vec<usize> =
            (0..count).filter(|c| !hopeful.contains(c) && rows[*c].iter().any(|to| hopeful.contains(to))).collect();
        if more.is_empty() {
            break;
        }
        hopeful.extend(more);
    }
    let failing: BTreeSet<usize> = (0..count).filter(|c| !hopeful.contains(c)).collect();
    let mut others = 0;
    let mut name = |c: usize| match c {
        0 => "start".to_owned(),
        c if matching.contains(&c) => "match".to_owned(),
        c if failing.contains(&c) => "fail".to_owned(),
        _ => {
            others += 1;
            format!("s{others}")
        }
    };
    Ere { automaton: Automaton { states: (0..count).map(&mut name).collect(), next: rows }, matching, failing }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::java::lexer::tokens;
    use lapwing_diag::FileId;

    fn found(text: &str) -> Option<Ere> {
        let tokens = tokens(text);
        let mut report = Report { file: FileId(0), diagnostics: Vec::new() };
        read(Cursor::new(text, &tokens), &["a", "b"], &mut report)
    }

    /// Whether a word is matched, and whether a longer one still can be.
    fn told(ere: &Ere, word: &str) -> (bool, bool) {
        let letter = |c| usize::from(c == 'b');
        let end = word.chars().fold(0, |state, c| ere.automaton.next[state][letter(c)]);
        (ere.matching.contains(&end), !ere.failing.contains(&end))
    }

    /// All words over the two letters up to that length.
    fn words(length: usize) -> Vec<String> {
        let mut all = vec![String::new()];
        let mut last = all.clone();
        for _ in 0..length {
            last = last.iter().flat_map(|w| [format!("{w}a"), format!("{w}b")]).collect();
            all.extend(last.clone());
        }
        all
    }

    #[test]
    fn automata_accept_the_words_of_their_expressions() {
        type Words = fn(&str) -> bool;
        let is_in: [(&str, Words); 7] = [
            ("a b*", |w| w.strip_prefix('a').is_some_and(|rest| !rest.contains('a'))),
            ("(a b)+", |w| !w.is_empty() && w.replace("ab", "").is_empty()),
            ("~(a*)", |w| w.contains('b')),
            ("((a|b)* a) & ((a|b)(a|b))", |w| w.len() == 2 && w.ends_with('a')),
            ("a? b | epsilon", |w| ["", "b", "ab"].contains(&w)),
            ("empty", |_| false),
            ("~empty", |_| true),
        ];
        for (text, is_in) in is_in {
            let ere = found(text).unwrap();
            for word in words(6) {
                assert_eq!(told(&ere, &word).0, is_in(&word), "{text}: {word:?}");
                let hope = words(4).iter().any(|more| is_in(&format!("{word}{more}")));
                assert_eq!(told(&ere, &word).1, hope, "{text}: {word:?} and what may follow");
            }
        }
    }

    #[test]
    fn automata_are_as_small_as_can_be_and_never_too_large() {
        let states = |text: &str| found(text).map(|ere| ere.automaton.states.len());
        assert_eq!(states("(a b)+"), Some(4));
        assert_eq!(states("(a | a b b* | a b+)"), Some(3));
        // The n-th letter from the end needs 2^n states.
        assert_eq!(states(&format!("(a|b)* a {}", "(a|b) ".repeat(3))), Some(16));
        assert_eq!(states(&format!("(a|b)* a {}", "(a|b) ".repeat(9))), None);
        assert!(found(&"(".repeat(9999)).is_none() && found(&"~".repeat(9999)).is_none());
        assert!(found(&format!("a{}", "+".repeat(9999))).is_none_or(|ere| ere.automaton.states.len() < 9));
        assert!(found(&"a? ".repeat(3000)).is_none());
    }
}
