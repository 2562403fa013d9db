//! The text of a specification: lexer, parser, syntax tree, formatter.
//!
//! [`parse`] reads a text and never fails: it gives the statements that it understood, and what is wrong with the others.
//! [`format`] lays a text out canonically, [`print_expr`] shows a formula, [`tokens`] is for editors. Nothing here knows
//! what a name stands for.

#![forbid(unsafe_code)]

pub mod ast;
mod format;
mod lexer;
mod parser;
mod print;
mod text;
mod token;
mod unit;
mod words;

pub use format::format;
pub use lapwing_diag::FileId;
pub use parser::{Parsed, parse};
pub use print::print_expr;
pub use token::{Place, Role, Token, TokenKind};
pub use unit::{DurationError, nanoseconds};

/// A name of a recording as a specification has to write it: as it is, in backquotes where it would mean something else, or not at all.
pub fn written(name: &str) -> Option<String> {
    let stands = |written: &str| parse(FileId::default(), &format!("never {written} > 0\n")).diagnostics.is_empty();
    let is_bare = name.starts_with(lexer::is_name_start) && name.chars().all(|c| c == '.' || lexer::is_name_part(c));
    if is_bare && stands(name) {
        return Some(name.to_owned());
    }
    let quoted = format!("`{name}`");
    (!name.contains(['`', '\n', '\r']) && stands(&quoted)).then_some(quoted)
}

/// What was meant by a name that ends what seems to be the unit of a number, as `s2` does in `1.5 m/s2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeantUnit {
    /// So many bytes before the name the unit begins.
    pub before: usize,
    /// The unit, where there is such a one.
    pub unit: Option<&'static str>,
}

/// Whether a name is the end of what seems to be the unit of a number; `before` is the text in front of it.
pub fn meant_unit(before: &str, name: &str) -> Option<MeantUnit> {
    words::unit_around(before, name).map(|(before, unit)| MeantUnit { before, unit })
}

/// The units that a number may have, in a sentence.
pub fn units_listed() -> String {
    words::listed(words::units())
}

/// The tokens of a text, comments among them, each with what it is where it stands: for an editor.
pub fn tokens(text: &str) -> Vec<Token> {
    parse(FileId::default(), text).tokens
}
