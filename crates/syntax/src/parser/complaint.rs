//! What to say when something else stands where something was expected.

use super::{Parse, Parser, Reported};
use crate::token::{Token, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic, Span};

/// A word that stands where it means nothing, and the word that was probably meant.
struct Misspelt {
    span: Span,
    written: String,
    meant: &'static str,
}

impl Parser<'_> {
    /// What stands here, in words.
    pub(super) fn found(&self) -> String {
        let written = self.cursor.slice(self.cursor.span());
        match self.cursor.kind() {
            TokenKind::End if self.cursor.at_end() => "the end of the file".into(),
            TokenKind::End => "the end of the line".into(),
            TokenKind::Number => format!("the number `{written}`"),
            TokenKind::Text => "a text in quotation marks".into(),
            _ => format!("`{written}`"),
        }
    }

    /// Reports that `what` was expected here. What the lexer has reported is not reported again.
    pub(super) fn expected<T>(&mut self, what: &str) -> Parse<T> {
        let diagnostic = self.expectation(what);
        self.complain(diagnostic)
    }

    /// Reports a fault at the current token, unless the lexer has reported that token.
    pub(super) fn complain<T>(&mut self, diagnostic: Diagnostic) -> Parse<T> {
        Err(self.complaint(diagnostic))
    }

    fn complaint(&mut self, diagnostic: Diagnostic) -> Reported {
        if self.cursor.kind() == TokenKind::Bad { Reported(()) } else { self.report(diagnostic) }
    }

    pub(super) fn expectation(&self, what: &str) -> Diagnostic {
        let span = self.cursor.span();
        match self.cursor.kind() {
            TokenKind::End => {
                let end = if self.cursor.at_end() { "the file" } else { "the line" };
                let message = format!("expected {what}, but {end} ends");
                Diagnostic::new(Code::Syntax, span, message).label("expected here")
            }
            _ => Diagnostic::new(Code::Syntax, span, format!("expected {what}, found {}", self.found())),
        }
    }

    /// Something was expected behind the last token of a line, where the next line cannot go on with it.
    pub(super) fn expectation_before_line(&self, what: &str) -> Diagnostic {
        let previous = self.cursor.previous();
        let message = format!("expected {what} after `{}`", self.cursor.slice(previous));
        Diagnostic::new(Code::Syntax, self.cursor.behind_previous(), message).label("expected here")
    }

    /// Reports a bracket that is never closed.
    pub(super) fn unclosed<T>(&mut self) -> Parse<T> {
        let span = self.cursor.span();
        let what = format!("this `{}` is never closed", self.cursor.slice(span));
        self.fail(Diagnostic::new(Code::UnclosedBracket, span, what).label("its partner is missing"))
    }

    /// Reports what stands behind a formula or a statement that is complete: `what` would have been in order here.
    pub(super) fn leftover(&mut self, what: &str) -> Reported {
        let diagnostic = self.leftover_diagnostic(what);
        self.complaint(diagnostic)
    }

    pub(super) fn leftover_diagnostic(&self, what: &str) -> Diagnostic {
        let span = self.cursor.span();
        let unmatched = |c: &str| Diagnostic::new(Code::UnclosedBracket, span, format!("this `{c}` closes nothing"));
        let previous = self.cursor.previous_token();
        match self.cursor.kind() {
            TokenKind::CloseRound => unmatched(")"),
            TokenKind::CloseSquare => unmatched("]"),
            TokenKind::CloseCurly => unmatched("}"),
            TokenKind::Semicolon => self.expectation(what).help("a statement ends with its line and needs no `;`"),
            TokenKind::Name => self.stray_word(what),
            TokenKind::Number | TokenKind::OpenRound if self.after_bare_margin() => self.bare_margin(),
            TokenKind::Slash if previous.is_some_and(|t| t.kind == TokenKind::Slash) => {
                self.expectation(what).help("a comment begins with `#`")
            }
            TokenKind::Comma if previous.is_some_and(|t| t.kind == TokenKind::Number) => {
                self.expectation(what).help("the decimal sign of a number is a point: `1.5`")
            }
            TokenKind::Colon => {
                self.expectation(what).help("a property is written `NAME: FORMULA`, on a line of its own")
            }
            _ => self.expectation(what),
        }
    }

    /// Two words in a row: one of them is probably misspelt.
    fn stray_word(&self, what: &str) -> Diagnostic {
        let span = self.cursor.span();
        let written = self.cursor.slice(span);
        if let Some(unit) = self.unknown_unit(span, written) {
            return unit;
        }
        if let Some(slip) = self.misspelt(span, written) {
            return self.unknown_word(slip);
        }
        if self.at_bound() {
            return self.expectation(what).help(
                "a time bound stands before what it bounds: `eventually within 2 s X`, `always for 2 s X`, `held for 2 s (X)`",
            );
        }
        // What follows `x == 0` in `whenever x == 0 eventually …` is no second side.
        if self.after_bare_margin() && !words::formula_words().any(|word| word == written) {
            return self.bare_margin();
        }
        let previous = self.cursor.previous();
        if self.cursor.previous_token().is_some_and(|t| t.kind == TokenKind::Number) {
            let units = words::listed(words::units());
            return self.expectation(what).help(format!("if `{written}` is meant as a unit: the units are {units}"));
        }
        if self.symbolic || self.path_end != Some(previous.end) {
            return self.expectation(what);
        }
        let before = self.cursor.slice(previous);
        self.expectation(what).help(format!("a part of `{before}` is written with a dot: `{before}.{written}`"))
    }

    /// A word where one of `known` should stand; `help` says what is in order otherwise.
    pub(super) fn unknown_choice<T>(&mut self, what: &str, known: &[&'static str], help: &str) -> Parse<T> {
        let span = self.cursor.span();
        let written = self.cursor.word().unwrap_or("");
        let diagnostic = match words::meant(written, known.iter().copied()) {
            Some(meant) => self.unknown_word(Misspelt { span, written: written.to_owned(), meant }),
            None => self.expectation(what),
        };
        self.complain(diagnostic.help(help))
    }

    fn unknown_word(&self, slip: Misspelt) -> Diagnostic {
        let Misspelt { span, written, meant } = slip;
        Diagnostic::new(Code::UnknownWord, span, format!("`{written}` is no word of the language here"))
            .label(format!("did you mean `{meant}`?"))
            .fix(span, meant)
    }

    /// Which of the current word and the one before it was meant to be a word of the language.
    fn misspelt(&self, span: Span, written: &str) -> Option<Misspelt> {
        let joining = words::meant(written, self.joining_words()).filter(|_| self.symbolic || !written.eq("X"));
        let before = self.cursor.previous_token().filter(|t| t.kind == TokenKind::Name && !self.cursor.begins_line());
        let beginning = before.and_then(|token| self.misspelt_beginning(token));
        let joining = joining.map(|meant| Misspelt { span, written: written.to_owned(), meant });
        beginning.or(joining)
    }

    fn joining_words(&self) -> Vec<&'static str> {
        if self.symbolic {
            return vec!["and", "or", "=>", "<=>", "U", "S"];
        }
        words::joining_words().chain(self.clauses.iter().copied()).collect()
    }

    /// The word that `token`, which stands directly before another operand, was meant to be.
    fn misspelt_beginning(&self, token: Token) -> Option<Misspelt> {
        let written = self.cursor.slice(token.span);
        let meant = if self.symbolic {
            symbol_meant(written)
        } else if self.is_first(token) {
            let known = words::STATEMENTS.iter().copied().chain(words::formula_words());
            words::meant(written, known).filter(|meant| *meant != written)
        } else {
            words::meant(written, words::formula_words()).filter(|meant| *meant != written)
        };
        Some(Misspelt { span: token.span, written: written.to_owned(), meant: meant? })
    }

    /// Whether the token is the first of the statement.
    fn is_first(&self, token: Token) -> bool {
        self.first == token.span
    }

    /// A word behind a number that was meant as its unit: `5sec`, `5 sec`.
    pub(super) fn unknown_unit(&self, span: Span, written: &str) -> Option<Diagnostic> {
        let before = self.cursor.previous_token().filter(|t| t.kind == TokenKind::Number)?;
        let adjacent = before.span.end == span.start;
        let meant = words::unit_meant(written);
        if !adjacent && meant.is_none() {
            return None;
        }
        let diagnostic = Diagnostic::new(Code::UnknownUnit, span, format!("`{written}` is no unit"));
        Some(match meant {
            Some(unit) => diagnostic.help(format!("write `{unit}`")).fix(span, unit),
            None => diagnostic.help(format!("the units are {}", words::listed(words::units()))),
        })
    }

    /// Whether a time bound begins here.
    pub(super) fn at_bound(&self) -> bool {
        self.cursor.at_word("within") || self.cursor.at_word("for")
    }

    /// Whether the token before is a number directly after a comparison: `x == 0.05 y`.
    fn after_bare_margin(&self) -> bool {
        self.bare_number == Some(self.cursor.previous())
    }

    fn bare_margin(&self) -> Diagnostic {
        let span = self.cursor.previous();
        let margin = self.cursor.slice(span);
        Diagnostic::new(Code::BareMargin, span, "a margin stands in curly brackets")
            .label(format!("write `{{{margin}}}`"))
            .help(format!("`A =={{{margin}}} B` holds where A and B differ by at most {margin}"))
            .fix(span, format!("{{{margin}}}"))
    }

    /// A word of the language stands where a name should.
    pub(super) fn reserved(&self, what: &str) -> Diagnostic {
        let span = self.cursor.span();
        let word = self.cursor.slice(span);
        Diagnostic::new(Code::ReservedWord, span, format!("`{word}` is a word of the language, not {what}"))
            .help(format!("a name that is spelt like it stands in backquotes: `` `{word}` ``"))
    }
}

/// The symbol of `ltl(…)` for the letters of other tools.
fn symbol_meant(written: &str) -> Option<&'static str> {
    Some(match written {
        "G" | "always" => "[]",
        "F" | "eventually" => "<>",
        "N" | "next" => "o",
        "O" | "P" | "once" => "<*>",
        "H" | "historically" => "[*]",
        "Y" | "previously" => "(*)",
        _ => return None,
    })
}
