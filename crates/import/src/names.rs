//! Names: from Java's spelling to Rust's, from prose to a name, and no name twice.

use std::collections::BTreeSet;

use lapwing_syntax::print_expr;

use crate::expr;

/// Words that go on with something, or begin something, where a name of ours may stand.
const PLACED: &[&str] = &[
    "at",
    "below",
    "each",
    "else",
    "entered",
    "event",
    "for",
    "in",
    "initial",
    "least",
    "left",
    "ltl",
    "machine",
    "most",
    "of",
    "on",
    "over",
    "property",
    "sample",
    "since",
    "state",
    "undefined",
    "when",
    "o",
    "X",
    "U",
    "S",
];

/// A name where a declaration or a statement has one: in backquotes where it could be taken for a word of the language.
pub(crate) fn written(name: &str) -> String {
    match PLACED.contains(&name) {
        true => format!("`{name}`"),
        // Where an operand may begin, the printer knows what has to be quoted.
        false => print_expr(&expr::name(name)),
    }
}

/// `GetIR` → `get_ir`, `Gen_TurnToBall` → `gen_turn_to_ball`, `HTTPServer` → `http_server`.
pub(crate) fn snake(name: &str) -> String {
    let mut out = String::new();
    let letters: Vec<char> = name.chars().collect();
    for (i, &c) in letters.iter().enumerate() {
        let before = i.checked_sub(1).and_then(|b| letters.get(b)).copied();
        let after_small = before.is_some_and(|b| b.is_lowercase() || b.is_numeric());
        let ends_capitals =
            before.is_some_and(char::is_uppercase) && letters.get(i + 1).is_some_and(|next| next.is_lowercase());
        if c.is_uppercase() && (after_small || ends_capitals) && !out.ends_with('_') {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    slug(&out)
}

/// A name made of any text: letters and digits stay, what is between them becomes a line.
pub(crate) fn slug(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            c if c == '_' || c.is_alphanumeric() => out.push(c),
            _ if out.is_empty() || out.ends_with('_') => {}
            _ => out.push('_'),
        }
        if out.len() > MOST_LETTERS {
            break;
        }
    }
    if text.ends_with(|c: char| c != '_' && !c.is_alphanumeric()) && out.ends_with('_') {
        out.pop();
    }
    match out.chars().next() {
        None => "unnamed".to_owned(),
        Some(c) if c.is_numeric() => format!("_{out}"),
        Some(_) => out,
    }
}

/// Names are not longer, in bytes, than this and one letter.
const MOST_LETTERS: usize = 120;

/// The names that are taken.
#[derive(Debug, Default)]
pub(crate) struct Taken(BTreeSet<String>);

impl Taken {
    pub(crate) fn has(&self, name: &str) -> bool {
        self.0.contains(name)
    }

    /// That name, or one like it that is free; it is taken then.
    pub(crate) fn take(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 1;
        while !self.0.insert(name.clone()) {
            number += 1;
            name = format!("{wanted}_{number}");
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_java_become_those_of_rust() {
        let pairs = [
            ("GetIR", "get_ir"),
            ("Gen_TurnToBallState", "gen_turn_to_ball_state"),
            ("ballDirMod2", "ball_dir_mod2"),
            ("HTTPServer", "http_server"),
            ("AlwaysIR", "always_ir"),
            ("kick", "kick"),
            ("X", "x"),
        ];
        assert_eq!(pairs.map(|(java, _)| snake(java)), pairs.map(|(_, rust)| rust));
    }

    #[test]
    fn prose_becomes_a_name() {
        let pairs =
            [("ball is lost!", "ball_is_lost"), ("2nd", "_2nd"), ("…", "unnamed"), ("a-b.c", "a_b_c"), ("é→x", "é_x")];
        assert_eq!(pairs.map(|(prose, _)| slug(prose)), pairs.map(|(_, name)| name));
    }

    #[test]
    fn words_of_the_language_are_quoted_and_no_name_comes_twice() {
        assert_eq!(["next", "when", "kick", "o"].map(written), ["`next`", "`when`", "kick", "`o`"]);
        let mut taken = Taken::default();
        assert_eq!([taken.take("a"), taken.take("a"), taken.take("a_2")], ["a", "a_2", "a_2_2"]);
    }
}
