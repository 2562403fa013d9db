//! Where a reader of tokens stands.

use std::ops::Range;

use super::lexer::{Kind, Token};

/// A place in tokens. What is read is a copy: readers look ahead by cloning it.
#[derive(Clone, Copy)]
pub(crate) struct Cursor<'t> {
    pub text: &'t str,
    tokens: &'t [Token],
    at: usize,
}

impl<'t> Cursor<'t> {
    pub(crate) fn new(text: &'t str, tokens: &'t [Token]) -> Cursor<'t> {
        Cursor { text, tokens, at: 0 }
    }

    /// The token ahead by so many.
    pub(crate) fn ahead(&self, by: usize) -> Option<Token> {
        self.tokens.get(self.at + by).copied()
    }

    /// The text of the token ahead by so many; empty at the end.
    pub(crate) fn peek(&self, by: usize) -> &'t str {
        self.ahead(by).and_then(|t| self.text.get(t.range())).unwrap_or("")
    }

    pub(crate) fn is_end(&self) -> bool {
        self.at >= self.tokens.len()
    }

    pub(crate) fn next(&mut self) -> Option<Token> {
        let token = self.ahead(0);
        self.at += usize::from(token.is_some());
        token
    }

    /// Where the next token begins, or the last ended.
    pub(crate) fn place(&self) -> Range<usize> {
        match self.ahead(0) {
            Some(token) => token.range(),
            None => self.tokens.last().map_or(0..0, |last| last.end..last.end),
        }
    }

    /// Where the token that was read last ended.
    pub(crate) fn before(&self) -> usize {
        self.at.checked_sub(1).and_then(|at| self.tokens.get(at)).map_or(0, |t| t.end)
    }

    /// Whether these tokens stand ahead.
    pub(crate) fn at(&self, signs: &[&str]) -> bool {
        signs.iter().enumerate().all(|(i, sign)| self.peek(i) == *sign)
    }

    /// Passes over these tokens, if they stand here.
    pub(crate) fn eat(&mut self, signs: &[&str]) -> bool {
        let there = self.at(signs);
        self.at += if there { signs.len() } else { 0 };
        there
    }

    /// The name that stands here.
    pub(crate) fn name(&mut self) -> Option<Name> {
        let token = self.ahead(0).filter(|t| t.kind == Kind::Word)?;
        self.at += 1;
        Some(Name { text: self.text.get(token.range()).unwrap_or("").to_owned(), place: token.range() })
    }

    /// What stands between the bracket here and the one that closes it; the cursor is behind that then. `None` where no such bracket opens here.
    /// One that nobody closes reaches to the end.
    pub(crate) fn group(&mut self, open: &str, close: &str) -> Option<Cursor<'t>> {
        if self.peek(0) != open {
            return None;
        }
        let start = self.at + 1;
        let mut depth = 0;
        while !self.is_end() {
            let word = self.peek(0);
            depth += usize::from(word == open);
            depth -= usize::from(word == close);
            self.at += 1;
            if depth == 0 {
                return Some(self.part(start, self.at - 1));
            }
        }
        Some(self.part(start, self.at))
    }

    /// The first bracket of what is left that nobody closes.
    pub(crate) fn unclosed(&self, open: &str, close: &str) -> Option<Range<usize>> {
        let mut opened = Vec::new();
        for token in self.rest() {
            let word = self.text.get(token.range());
            if word == Some(open) {
                opened.push(token.range());
            } else if word == Some(close) {
                opened.pop();
            }
        }
        opened.into_iter().next()
    }

    /// What stands before the first token for which that is so; the cursor stands at that then.
    pub(crate) fn until(&mut self, ends: impl Fn(&Cursor<'t>) -> bool) -> Cursor<'t> {
        let start = self.at;
        while !self.is_end() && !ends(self) {
            self.at += 1;
        }
        self.part(start, self.at)
    }

    /// So many tokens; the cursor is behind them then.
    pub(crate) fn take(&mut self, count: usize) -> Cursor<'t> {
        let start = self.at;
        self.at = (start + count).min(self.tokens.len());
        self.part(start, self.at)
    }

    fn part(&self, start: usize, end: usize) -> Cursor<'t> {
        Cursor { text: self.text, tokens: self.tokens.get(start..end).unwrap_or(&[]), at: 0 }
    }

    /// The tokens that are left.
    pub(crate) fn rest(&self) -> &'t [Token] {
        self.tokens.get(self.at..).unwrap_or(&[])
    }

    /// The place of all that is left.
    pub(crate) fn span(&self) -> Range<usize> {
        match (self.rest().first(), self.rest().last()) {
            (Some(first), Some(last)) => first.start..last.end,
            _ => self.place(),
        }
    }

    /// The parts between commas outside of any brackets.
    pub(crate) fn by_commas(mut self) -> Vec<Cursor<'t>> {
        let mut parts = Vec::new();
        let (mut start, mut depth) = (self.at, 0_usize);
        while let Some(token) = self.next() {
            match self.text.get(token.range()).unwrap_or("") {
                "(" | "[" | "{" | "<" => depth += 1,
                ")" | "]" | "}" | ">" => depth = depth.saturating_sub(1),
                "," if depth == 0 => {
                    parts.push(self.part(start, self.at - 1));
                    start = self.at;
                }
                _ => {}
            }
        }
        parts.push(self.part(start, self.at));
        parts.retain(|part| !part.is_end());
        parts
    }

    /// What is left as one line, comments left out.
    pub(crate) fn line(&self) -> String {
        let mut out = String::new();
        let mut end = None;
        for token in self.rest() {
            if end.is_some_and(|end| end < token.start) {
                out.push(' ');
            }
            out.push_str(self.text.get(token.range()).unwrap_or(""));
            end = Some(token.end);
        }
        out
    }
}

/// A name and its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Name {
    pub text: String,
    pub place: Range<usize>,
}
