//! Tokens of Java, and of the formulas between it.

use std::ops::Range;

/// What a token is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    /// A name or a word of Java.
    Word,
    Number,
    /// A string or a character, quotes and all.
    Text,
    /// One sign; what is made of several is put together where it is read.
    Sign,
}

/// A token, by its place.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Token {
    pub kind: Kind,
    pub start: usize,
    pub end: usize,
}

impl Token {
    pub(crate) fn range(self) -> Range<usize> {
        self.start..self.end
    }
}

/// The tokens of a text; comments and blanks are left out. Whatever the text is, each of its other characters is in a token.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = text.get(at..).and_then(|rest| rest.chars().next()) {
        let rest = text.get(at..).unwrap_or("");
        let length = match c {
            c if c.is_whitespace() => c.len_utf8(),
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => comment(rest),
            _ => {
                let (kind, length) = token(rest, c);
                tokens.push(Token { kind, start: at, end: at + length });
                length
            }
        };
        at += length;
    }
    tokens
}

/// The length of the comment that a text begins with. The star of `/*` is not the one of `*/`: `/*/` only begins a comment.
fn comment(text: &str) -> usize {
    let end = text.get(2..).and_then(|inside| inside.find("*/"));
    end.map_or(text.len(), |end| end + 4)
}

/// The token that `rest` begins with, which has `c` first.
fn token(rest: &str, c: char) -> (Kind, usize) {
    let while_true = |goes_on: fn(char) -> bool| rest.find(|c| !goes_on(c)).unwrap_or(rest.len());
    match c {
        c if is_name_start(c) => (Kind::Word, while_true(is_name_part)),
        c if c.is_ascii_digit() => (Kind::Number, while_true(|c| c == '_' || c.is_alphanumeric())),
        '"' | '\'' => (Kind::Text, text_length(rest, c)),
        c => (Kind::Sign, c.len_utf8()),
    }
}

fn is_name_start(c: char) -> bool {
    c == '_' || c == '$' || c.is_alphabetic()
}

fn is_name_part(c: char) -> bool {
    is_name_start(c) || c.is_numeric()
}

/// How long a string is. It ends with its line; where the line was wrapped by whoever printed it, with the next.
fn text_length(rest: &str, quote: char) -> usize {
    let mut escaped = true;
    let mut line_end = None;
    for (at, c) in rest.char_indices() {
        match c {
            // The opening quote is passed over as if it were escaped.
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return at + c.len_utf8(),
            '\n' if line_end.is_some() || quote == '\'' => return line_end.unwrap_or(at),
            '\n' => line_end = Some(at),
            _ => {}
        }
    }
    line_end.unwrap_or(rest.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        tokens(text).into_iter().map(|t| &text[t.range()]).collect()
    }

    #[test]
    fn comments_are_left_out_and_texts_are_whole() {
        assert_eq!(words("a/*b*/ /* c\n */d // e\nf \"g//h\\\"\" 'i' ="), ["a", "d", "f", "\"g//h\\\"\"", "'i'", "="]);
        assert_eq!(words("log(\"wrapped\n here\");x"), ["log", "(", "\"wrapped\n here\"", ")", ";", "x"]);
        assert_eq!(words("\"never\nclosed\nx"), ["\"never", "closed", "x"]);
        assert_eq!(words("a /*/ b */ c /**/ d"), ["a", "c", "d"]);
        assert_eq!(words("1.5f é→ /* x"), ["1", ".", "5f", "é", "→"]);
    }
}
