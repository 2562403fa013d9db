//! The words of the language, and what a misspelt one was meant to be.

use crate::ast::{Infix, Prefix, Scope, Unit};

/// Words that join two formulas. A line that begins with one goes on with the statement before it.
pub(crate) const CONNECTIVES: &[&str] = &["and", "or", "implies", "iff"];

/// Words that begin a statement.
pub(crate) const STATEMENTS: &[&str] =
    &["decl", "model", "world", "event", "machine", "pattern", "use", "on", "guard", "property", "clock"];

/// Temporal words before a formula.
pub(crate) const PREFIXES: &[(&str, Prefix)] = &[
    ("always", Prefix::Always),
    ("never", Prefix::Never),
    ("eventually", Prefix::Eventually),
    ("next", Prefix::Next),
    ("previously", Prefix::Previously),
    ("once", Prefix::Once),
    ("historically", Prefix::Historically),
    ("becomes", Prefix::Becomes),
];

/// Scopes of two parts.
pub(crate) const SCOPES: &[(&str, Scope)] = &[
    ("after", Scope::After),
    ("until", Scope::Until),
    ("before", Scope::Before),
    ("while", Scope::While),
    ("whenever", Scope::Whenever),
];

/// Temporal words between two formulas.
pub(crate) const INFIXES: &[(&str, Infix)] = &[("until", Infix::Until), ("since", Infix::Since)];

/// The scope of three parts.
pub(crate) const AFTER_UNTIL: &str = "after_until";

/// The word before a time bound.
pub(crate) const WITHIN: &str = "within";

/// Words that begin something else than a name where an operand is expected.
const NO_NAMES: &[&str] = &["not", "true", "false", AFTER_UNTIL];

/// What `word` stands for in a table of words.
pub(crate) fn find<T: Copy>(table: &[(&str, T)], word: &str) -> Option<T> {
    table.iter().find(|(name, _)| *name == word).map(|(_, meaning)| *meaning)
}

/// The word that stands for `meaning` in a table of words.
pub(crate) fn spelling<T: PartialEq>(table: &'static [(&'static str, T)], meaning: T) -> &'static str {
    table.iter().find(|(_, m)| *m == meaning).map_or("", |(name, _)| name)
}

/// Whether the word begins a temporal formula.
pub(crate) fn is_temporal(word: &str) -> bool {
    find(PREFIXES, word).is_some() || find(SCOPES, word).is_some() || word == AFTER_UNTIL
}

/// Whether the word joins or bounds what stands beside it and begins nothing itself.
pub(crate) fn begins_nothing(word: &str) -> bool {
    CONNECTIVES.contains(&word) || word == WITHIN
}

/// Whether the word needs backquotes to be a name at the beginning of an operand, whatever follows it.
pub(crate) fn is_reserved(word: &str) -> bool {
    is_temporal(word) || begins_nothing(word) || NO_NAMES.contains(&word)
}

/// What is written in other tools for a word of ours.
const ALIASES: &[(&str, &str)] = &[
    ("G", "always"),
    ("F", "eventually"),
    ("X", "next"),
    ("H", "historically"),
    ("O", "once"),
    ("U", "until"),
    ("S", "since"),
    ("globally", "always"),
    ("forever", "always"),
    ("finally", "eventually"),
    ("if", "whenever"),
    ("when", "whenever"),
    ("upon", "whenever"),
    ("during", "while"),
    ("import", "use"),
    ("include", "use"),
    ("declare", "decl"),
    ("topic", "decl"),
    ("let", "decl"),
    ("then", "implies"),
    ("xor", "!="),
];

/// The one of `candidates` that `word` was probably meant to be.
pub(crate) fn meant<'w>(word: &str, candidates: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    let alias = find(ALIASES, word);
    candidates
        .into_iter()
        .filter_map(|candidate| Some((distance(word, candidate, alias)?, candidate)))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// How far `word` is from `candidate`; `None` where it is too far to be a slip.
fn distance(word: &str, candidate: &str, alias: Option<&str>) -> Option<usize> {
    if alias == Some(candidate) || word.eq_ignore_ascii_case(candidate) {
        return Some(0);
    }
    // Comparing takes time that grows with the product of the lengths, and no slip triples a word.
    if word.len() > 3 * candidate.len() {
        return None;
    }
    let edits = strsim::osa_distance(&word.to_lowercase(), candidate);
    let allowed = match candidate.len() {
        0..=2 => 0,
        3..=5 => 1,
        _ => 2,
    };
    let swapped = candidate.len() == 2 && word.len() == 2 && word.bytes().rev().eq(candidate.bytes());
    (swapped || edits <= allowed).then_some(edits)
}

/// The words that may begin a formula.
pub(crate) fn formula_words() -> impl Iterator<Item = &'static str> {
    let prefixes = PREFIXES.iter().map(|(word, _)| *word);
    prefixes.chain(SCOPES.iter().map(|(word, _)| *word)).chain([AFTER_UNTIL, "not", "held"])
}

/// The words that may stand between two formulas.
pub(crate) fn joining_words() -> impl Iterator<Item = &'static str> {
    CONNECTIVES.iter().copied().chain(INFIXES.iter().map(|(word, _)| *word))
}

/// The units as they are written.
pub(crate) fn units() -> impl Iterator<Item = &'static str> + Clone {
    Unit::ALL.iter().map(|unit| unit.name())
}

/// The unit that was meant by a longer name of it.
pub(crate) fn unit_meant(written: &str) -> Option<&'static str> {
    let lower = written.to_lowercase();
    let known = units().find(|name| name.eq_ignore_ascii_case(written));
    known.or_else(|| long_name(&lower)).or_else(|| quotient(&lower))
}

/// The unit of a quotient whose parts or whose square are written otherwise: `m/s2`, `m/s/s`, `meters/sec`.
fn quotient(written: &str) -> Option<&'static str> {
    let (above, below) = written.split_once('/')?;
    let (below, square) = match below.strip_suffix(['2', '²']).map(|base| base.trim_end_matches(['^', '*'])) {
        Some(base) => (base, "^2"),
        None => match below.split_once('/') {
            Some((once, twice)) if unit_meant(once) == unit_meant(twice) => (once, "^2"),
            _ => (below, ""),
        },
    };
    let meant = format!("{}/{}{square}", unit_meant(above)?, unit_meant(below)?);
    units().find(|name| *name == meant)
}

/// Where a name is the end of what was meant as the unit of a number, as `s2` in `1.5 m/s2`: how many bytes before the name that unit begins, and
/// what it was meant to be.
pub(crate) fn unit_around(before: &str, name: &str) -> Option<(usize, Option<&'static str>)> {
    let is_of_unit = |c: char| c.is_alphabetic() || c == '/';
    let start = before.trim_end_matches(is_of_unit);
    let begun = &before[start.len()..];
    let is_number = start.trim_end_matches([' ', '\t']).ends_with(|c: char| c.is_ascii_digit());
    let known = begun.strip_suffix('/').filter(|unit| units().any(|known| known == *unit));
    (is_number && known.is_some()).then(|| (begun.len(), unit_meant(&format!("{begun}{name}"))))
}

/// The unit of a longer name.
fn long_name(written: &str) -> Option<&'static str> {
    Some(match written {
        "sec" | "secs" | "second" | "seconds" => "s",
        "msec" | "msecs" | "millisecond" | "milliseconds" => "ms",
        "usec" | "usecs" | "µs" | "microsecond" | "microseconds" => "us",
        "nsec" | "nsecs" | "nanosecond" | "nanoseconds" => "ns",
        "mins" | "minute" | "minutes" => "min",
        "hr" | "hrs" | "hour" | "hours" => "h",
        "meter" | "meters" | "metre" | "metres" => "m",
        "mps" => "m/s",
        "mps2" | "mpss" => "m/s^2",
        "degree" | "degrees" => "deg",
        "radian" | "radians" => "rad",
        "hertz" => "Hz",
        _ => return None,
    })
}

/// `a, b and c`, each in backquotes.
pub(crate) fn listed<'w>(words: impl IntoIterator<Item = &'w str>) -> String {
    let quoted: Vec<String> = words.into_iter().map(|word| format!("`{word}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        None => String::new(),
    }
}
