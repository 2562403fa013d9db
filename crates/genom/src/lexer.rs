//! Text to tokens, for the preprocessor and the parser alike.
//!
//! Nothing is wrong with a token until somebody reads it: in a part of a text that a condition leaves out, an apostrophe is only an apostrophe.

use std::rc::Rc;

use lapwing_diag::{FileId, Span};

use crate::token::{Kind, Token};

/// Signs of more than one character, longest first, with what they stand for.
const SIGNS: &[(&str, &str)] = &[
    ("<%", "{"),
    ("%>", "}"),
    ("<:", "["),
    (":>", "]"),
    ("::", "::"),
    ("<<", "<<"),
    (">>", ">>"),
    ("##", "##"),
    ("&&", "&&"),
    ("||", "||"),
    ("==", "=="),
    ("!=", "!="),
    ("<=", "<="),
    (">=", ">="),
];

/// Words with a hyphen, each of which is one token.
const HYPHENATED: &[&str] = &["codels-requires", "codels-require", "clock-rate", "real-time"];

/// The tokens of a text, without comments.
pub(crate) fn lex(file: FileId, text: &str) -> Vec<Token> {
    let mut lexer = Lexer { file, text, at: 0, starts_line: true, spaced: false, tokens: Vec::new() };
    while lexer.skip_blanks() {
        lexer.token();
    }
    lexer.tokens
}

struct Lexer<'a> {
    file: FileId,
    text: &'a str,
    at: usize,
    starts_line: bool,
    spaced: bool,
    tokens: Vec<Token>,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn push(&mut self, kind: Kind, start: usize, text: impl Into<Rc<str>>) {
        let span = Span::new(self.file, start, self.at);
        let token = Token { kind, text: text.into(), span, starts_line: self.starts_line, spaced: self.spaced };
        self.tokens.push(token);
        (self.starts_line, self.spaced) = (false, false);
    }

    /// Pushes what has been passed over since `start`, as it stands.
    fn push_from(&mut self, kind: Kind, start: usize) {
        self.push(kind, start, self.text.get(start..self.at).unwrap_or(""));
    }

    /// Goes to the next token, past blanks, comments and line ends that a backslash takes away; false at the end.
    fn skip_blanks(&mut self) -> bool {
        loop {
            let rest = self.rest();
            let Some(c) = rest.chars().next() else { return false };
            let continued = ["\\\n", "\\\r\n"].iter().find(|end| rest.starts_with(**end));
            if let Some(end) = continued {
                self.at += end.len();
            } else if rest.starts_with("//") {
                self.line_comment();
            } else if rest.starts_with("/*") {
                self.block_comment();
            } else if c.is_whitespace() || c == '\u{feff}' {
                self.starts_line |= c == '\n';
                self.at += c.len_utf8();
            } else {
                return true;
            }
            self.spaced = true;
        }
    }

    /// A comment to the end of its line, which a backslash moves.
    fn line_comment(&mut self) {
        loop {
            let rest = self.rest();
            let line = rest.split('\n').next().unwrap_or(rest);
            self.at += line.len();
            if !line.trim_end_matches('\r').ends_with('\\') || self.at >= self.text.len() {
                return;
            }
            self.at += 1;
        }
    }

    fn block_comment(&mut self) {
        let start = self.at;
        match self.rest().get(2..).and_then(|inside| inside.find("*/")) {
            Some(length) => self.at += length + 4,
            None => {
                self.at = self.text.len();
                self.push(Kind::Bad, start, "this comment is not closed: `*/` is missing");
            }
        }
    }

    fn token(&mut self) {
        let rest = self.rest();
        let mut characters = rest.chars();
        let (first, second) = (characters.next().unwrap_or(' '), characters.next());
        match first {
            '"' => self.quoted(Kind::Text, '"'),
            '\'' => self.quoted(Kind::Character, '\''),
            c if c.is_ascii_digit() => self.number(),
            '.' if second.is_some_and(|c| c.is_ascii_digit()) => self.number(),
            c if is_word(c) => self.word(),
            _ => self.sign(),
        }
    }

    fn word(&mut self) {
        let (start, rest) = (self.at, self.rest());
        let hyphenated = HYPHENATED.iter().find(|word| {
            let after = rest.strip_prefix(**word).map(|rest| rest.chars().next());
            after.is_some_and(|next| !next.is_some_and(is_word))
        });
        let plain = || rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        self.at += hyphenated.map_or_else(plain, |word| word.len());
        self.push_from(Kind::Word, start);
    }

    /// A number. No blank is needed between it and a unit: `10ms` are two tokens, `10u` is one.
    fn number(&mut self) {
        let (start, bytes) = (self.at, self.text.as_bytes());
        let mut at = self.at;
        let run = |at: &mut usize, wanted: fn(&u8) -> bool| {
            while bytes.get(*at).is_some_and(wanted) {
                *at += 1;
            }
        };
        let is = |at: usize, wanted: &[u8]| bytes.get(at).is_some_and(|b| wanted.contains(b));
        if is(at, b"0") && is(at + 1, b"xX") && bytes.get(at + 2).is_some_and(u8::is_ascii_hexdigit) {
            at += 2;
            run(&mut at, u8::is_ascii_hexdigit);
        } else {
            run(&mut at, u8::is_ascii_digit);
            if is(at, b".") {
                at += 1;
                run(&mut at, u8::is_ascii_digit);
            }
            let exponent = if is(at + 1, b"+-") { at + 2 } else { at + 1 };
            if is(at, b"eE") && bytes.get(exponent).is_some_and(u8::is_ascii_digit) {
                at = exponent;
                run(&mut at, u8::is_ascii_digit);
            }
        }
        let mut suffix = at;
        run(&mut suffix, |b| b"uUlLfFdD".contains(b));
        let goes_on = self.text.get(suffix..).and_then(|rest| rest.chars().next()).is_some_and(is_word);
        self.at = if goes_on { at } else { suffix };
        self.push_from(Kind::Number, start);
    }

    /// A string or a character, on one line; a string may go on over more.
    fn quoted(&mut self, kind: Kind, quote: char) {
        let (start, mut escaped) = (self.at, false);
        for (at, c) in self.rest().char_indices().skip(1) {
            match c {
                '\n' if !escaped => break,
                '\\' => escaped = !escaped,
                c if c == quote && !escaped => {
                    self.at += at + c.len_utf8();
                    return self.push_from(kind, start);
                }
                _ => escaped = false,
            }
        }
        if let Some(length) = (kind == Kind::Text).then(|| over_lines(self.rest())).flatten() {
            self.at += length;
            return self.push_from(kind, start);
        }
        let line = self.rest().split('\n').next().unwrap_or("").len();
        self.at += line.max(1);
        let what = if kind == Kind::Text { "string" } else { "character" };
        self.push(Kind::Bad, start, format!("this {what} is not closed: `{quote}` is missing at the end of its line"));
    }

    fn sign(&mut self) {
        let (start, rest) = (self.at, self.rest());
        // `sequence<::name>` begins no digraph, as in C++.
        let is_scope = |sign: &str| {
            sign == "<:" && rest.starts_with("<::") && !rest.starts_with("<:::") && !rest.starts_with("<::>")
        };
        let known = SIGNS.iter().find(|(sign, _)| rest.starts_with(sign) && !is_scope(sign));
        if let Some((sign, meaning)) = known {
            self.at += sign.len();
            return self.push(Kind::Sign, start, *meaning);
        }
        let c = rest.chars().next().unwrap_or(' ');
        self.at += c.len_utf8();
        if "{}[]()<>:;,.=+-*/%&|^~!?#".contains(c) {
            self.push_from(Kind::Sign, start);
        } else {
            self.push(Kind::Bad, start, format!("`{}` means nothing here", c.escape_debug()));
        }
    }
}

/// No string goes on over more lines.
const MOST_LINES: usize = 100;

/// The length of a string that goes on over several lines, as a `doc` may.
///
/// A quote that is only missing must not swallow what follows up to the next string. So what stands after the string has to be what can stand there,
/// and no directive is in it.
fn over_lines(text: &str) -> Option<usize> {
    let (mut lines, mut escaped) = (1, false);
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '\\' => escaped = !escaped,
            '"' if !escaped => {
                let after = text.get(at + 1..)?.trim_start().chars().next()?;
                return ";,:)}\"".contains(after).then_some(at + 1);
            }
            '\n' => {
                lines += 1;
                let is_directive = text.get(at + 1..)?.trim_start_matches([' ', '\t']).starts_with('#');
                if lines > MOST_LINES || is_directive {
                    return None;
                }
                escaped = false;
            }
            _ => escaped = false,
        }
    }
    None
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        lex(FileId(0), text).iter().map(|t| t.text.to_string()).collect()
    }

    #[test]
    fn numbers_stand_apart_from_their_units() {
        assert_eq!(
            words("10ms 1.5ms 5us 0x1Fu 1e3s .5 1000.: 10L 7d2 2k"),
            ["10", "ms", "1.5", "ms", "5", "us", "0x1Fu", "1e3", "s", ".5", "1000.", ":", "10L", "7", "d2", "2", "k"]
        );
    }

    #[test]
    fn digraphs_hyphens_and_scopes() {
        assert_eq!(
            words("<% a<:2:> %> sequence<::x> sequence<sequence<y>>"),
            [
                "{", "a", "[", "2", "]", "}", "sequence", "<", "::", "x", ">", "sequence", "<", "sequence", "<", "y",
                ">>"
            ]
        );
        assert_eq!(
            words("codels-require clock-rate a-b clock-rates"),
            ["codels-require", "clock-rate", "a", "-", "b", "clock", "-", "rates"]
        );
    }

    #[test]
    fn comments_and_continued_lines() {
        assert_eq!(words("a /* b\n c */ d // e \\\n f\ng /*/ notice */ h"), ["a", "d", "g", "h"]);
        let starts = lex(FileId(0), "a \\\n b\nc");
        assert_eq!(starts.iter().map(|t| t.starts_line).collect::<Vec<_>>(), [true, false, true]);
    }

    #[test]
    fn what_is_no_token_says_why() {
        let bad = lex(FileId(0), "\"a\\\" b\n'x @ /* open");
        let kinds: Vec<Kind> = bad.iter().map(|t| t.kind).collect();
        assert_eq!(kinds, [Kind::Bad, Kind::Bad], "{bad:?}");
        assert_eq!(lex(FileId(0), "@ §").len(), 2);
        assert_eq!(words(r#""a \"b\" \\""#), [r#""a \"b\" \\""#]);
    }

    #[test]
    fn a_string_may_go_on_over_lines() {
        assert_eq!(words("doc \"one\n  \\\"two\\\"\n\" ;"), ["doc", "\"one\n  \\\"two\\\"\n\"", ";"]);
        // A quote that is missing does not make one string of two.
        let kinds = |text: &str| lex(FileId(0), text).iter().filter(|t| t.kind == Kind::Bad).count();
        assert_eq!(kinds("doc \"one;\nlang \"c\";"), 1);
        assert_eq!(kinds("doc \"one\n#if 1\n\";"), 2);
        assert_eq!(kinds(&format!("doc \"one{}\";", "\n".repeat(MOST_LINES))), 2);
    }
}
