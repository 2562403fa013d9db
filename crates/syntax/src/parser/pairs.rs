//! Which bracket closes which, and where a statement surely begins: found before parsing, so that one open bracket does not
//! swallow the rest of the file.

use crate::token::{Token, TokenKind};
use crate::words;

/// For every opening bracket the index of the one that closes it. Round and square ones may close one another (`(0 s, 2 s]`).
pub(super) fn pairs(text: &str, tokens: &[Token]) -> Vec<Option<usize>> {
    let mut brackets = Brackets { text, tokens, partners: vec![None; tokens.len()], open: Vec::new(), curly: 0 };
    for (i, token) in tokens.iter().enumerate() {
        if token.kind.opens() {
            brackets.open(i);
        } else if token.kind.closes() {
            brackets.close(i);
        } else if token.starts_line && !brackets.open.is_empty() {
            brackets.abandon(i);
        }
    }
    brackets.partners
}

struct Brackets<'t> {
    text: &'t str,
    tokens: &'t [Token],
    partners: Vec<Option<usize>>,
    /// Those that stand open.
    open: Vec<usize>,
    /// How many of them are curly.
    curly: usize,
}

impl Brackets<'_> {
    fn is_curly(&self, i: usize) -> bool {
        matches!(self.tokens[i].kind, TokenKind::OpenCurly | TokenKind::CloseCurly)
    }

    fn open(&mut self, i: usize) {
        self.curly += usize::from(self.is_curly(i));
        self.open.push(i);
    }

    /// Finds the partner of the closing bracket `i`.
    fn close(&mut self, i: usize) {
        if self.is_curly(i) {
            return self.close_curly(i);
        }
        if let Some(partner) = self.open.pop_if(|&mut open| self.tokens[open].kind != TokenKind::OpenCurly) {
            self.partners[partner] = Some(i);
        }
    }

    /// What stands open inside a curly bracket that closes stays open for good.
    fn close_curly(&mut self, i: usize) {
        if self.curly == 0 {
            return;
        }
        self.abandon_round();
        if let Some(partner) = self.open.pop() {
            self.partners[partner] = Some(i);
            self.curly -= 1;
        }
    }

    /// Gives up brackets that a statement beginning at `i` shows to be unclosed.
    fn abandon(&mut self, i: usize) {
        if begins_statement(self.text, self.tokens, i) {
            self.open.clear();
            self.curly = 0;
        } else if self.operand_ends_before(i) && begins_formula(self.text, self.tokens, i) {
            self.abandon_round();
        }
    }

    /// Whether what stands before token `i` is complete, so that no further operand can follow.
    fn operand_ends_before(&self, i: usize) -> bool {
        let Some(before) = i.checked_sub(1) else { return false };
        let wants_more = |w: &str| w == "not" || words::is_temporal(w) || words::CONNECTIVES.contains(&w);
        self.tokens[before].kind.ends_operand() && !word(self.text, self.tokens, before).is_some_and(wants_more)
    }

    /// Gives up the round and square brackets that stand open inside the innermost curly one.
    fn abandon_round(&mut self) {
        while self.open.pop_if(|&mut open| self.tokens[open].kind != TokenKind::OpenCurly).is_some() {}
    }
}

/// Whether a line that begins with token `i` begins a statement, wherever it stands.
pub(super) fn begins_statement(text: &str, tokens: &[Token], i: usize) -> bool {
    let Some(word) = word(text, tokens, i) else { return false };
    let next = tokens.get(i + 1).filter(|t| !t.starts_line);
    let next_word = next.and_then(|_| self::word(text, tokens, i + 1));
    match word {
        "decl" | "model" | "event" | "machine" | "pattern" | "property" => {
            next_word.is_some_and(|w| !words::CONNECTIVES.contains(&w))
        }
        "on" => next_word == Some("violation"),
        "guard" => rest_of_line(tokens, i).any(|j| self::word(text, tokens, j) == Some("from")),
        _ => false,
    }
}

/// Whether a line that begins with token `i` begins a statement, or an entry of a machine, even behind an operator: as a
/// part of a formula it would be wrong in any case.
pub(super) fn begins_definition(text: &str, tokens: &[Token], i: usize) -> bool {
    let named = tokens.get(i).is_some_and(|t| matches!(t.kind, TokenKind::Name | TokenKind::Quoted));
    let next = tokens.get(i + 1).filter(|t| !t.starts_line).map(|t| t.kind);
    let entry = word(text, tokens, i).is_some_and(|w| matches!(w, "sample" | "initial" | "state" | "else"));
    match next {
        Some(TokenKind::Equals | TokenKind::Colon | TokenKind::Arrow) if named => true,
        Some(TokenKind::Name) if entry => !word(text, tokens, i + 1).is_some_and(|w| words::CONNECTIVES.contains(&w)),
        _ => begins_statement(text, tokens, i),
    }
}

/// The tokens behind token `i` on its line.
fn rest_of_line(tokens: &[Token], i: usize) -> impl Iterator<Item = usize> {
    (i + 1..tokens.len()).take_while(|&j| !tokens[j].starts_line)
}

/// Whether a line that begins with token `i` begins a formula or a definition of its own. In brackets `until` and `since` go on with an
/// operand.
fn begins_formula(text: &str, tokens: &[Token], i: usize) -> bool {
    let Some(word) = word(text, tokens, i) else { return false };
    let next = tokens.get(i + 1).map(|t| t.kind);
    let infix = matches!(word, "until" | "since");
    (words::is_temporal(word) && !infix) || matches!(next, Some(TokenKind::Equals | TokenKind::Colon))
}

/// The word that token `i` is, where it is one.
fn word<'a>(text: &'a str, tokens: &[Token], i: usize) -> Option<&'a str> {
    let token = tokens.get(i).filter(|t| t.kind == TokenKind::Name)?;
    text.get(token.span.start as usize..token.span.end as usize)
}
