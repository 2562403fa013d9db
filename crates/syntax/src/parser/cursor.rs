//! A place in the list of tokens, and the rules for newlines.

use super::pairs::{begins_definition, begins_statement, pairs};
use crate::token::{Place, Role, Token, TokenKind};
use crate::words;
use lapwing_diag::{FileId, Span};

/// Where the parser stands.
pub(super) struct Cursor<'a> {
    pub file: FileId,
    pub text: &'a str,
    tokens: Vec<Token>,
    partners: Vec<Option<usize>>,
    at: usize,
    /// How many brackets stand open: inside them a newline means nothing.
    brackets: usize,
    /// Whether the token before joins lines: an operator, a comma, a colon.
    joined: bool,
    /// Where the statement or entry began: no newline before it ends it.
    began: usize,
}

impl<'a> Cursor<'a> {
    pub fn new(file: FileId, text: &'a str, tokens: Vec<Token>) -> Cursor<'a> {
        let partners = pairs(text, &tokens);
        Cursor { file, text, tokens, partners, at: 0, brackets: 0, joined: false, began: 0 }
    }

    pub fn into_tokens(self) -> Vec<Token> {
        self.tokens
    }

    /// The index of the current token: it only grows.
    pub fn position(&self) -> usize {
        self.at
    }

    /// The current token, [`TokenKind::End`] where the statement ends.
    pub fn kind(&self) -> TokenKind {
        if self.statement_ends() { TokenKind::End } else { self.raw_kind() }
    }

    /// The current token, newlines aside.
    fn raw_kind(&self) -> TokenKind {
        self.tokens.get(self.at).map_or(TokenKind::End, |t| t.kind)
    }

    fn statement_ends(&self) -> bool {
        self.begins_line() && self.brackets == 0 && self.at != self.began && !self.goes_on()
    }

    /// Whether the line that begins here goes on with the statement: the token before it or its own first says so. What
    /// is surely another statement never does, whatever stands before it.
    fn goes_on(&self) -> bool {
        let other = self.raw_kind().closes() || begins_definition(self.text, &self.tokens, self.at);
        self.continues() || self.joined && !other
    }

    /// Whether the current token is the first of its line.
    pub fn begins_line(&self) -> bool {
        self.tokens.get(self.at).is_none_or(|t| t.starts_line)
    }

    /// Whether the file ends here.
    pub fn at_end(&self) -> bool {
        self.at >= self.tokens.len()
    }

    /// Whether the current token, the first of its line, goes on with the statement before it.
    ///
    /// `since` begins no statement, so a line that begins with it goes on too, unless it is clearly used as a name.
    fn continues(&self) -> bool {
        match self.raw_word(0) {
            Some("since") => !self.is_operator(1),
            Some(word) => words::CONNECTIVES.contains(&word),
            None => false,
        }
    }

    /// Whether the token `n` further on is one that follows a name.
    fn is_operator(&self, n: usize) -> bool {
        use TokenKind::*;
        let kind = self.tokens.get(self.at + n).map_or(End, |t| t.kind);
        matches!(kind, Equals | EqualEqual | NotEqual | Less | LessEqual | Greater | GreaterEqual)
            || matches!(kind, Plus | Star | Slash | Dot | Colon | End)
    }

    /// The token `n` further on; [`TokenKind::End`] where the line ends before it.
    pub fn ahead(&self, n: usize) -> TokenKind {
        let between = self.tokens.get(self.at + 1..=self.at + n).unwrap_or(&[]);
        if self.brackets == 0 && between.iter().any(|t| t.starts_line) {
            return TokenKind::End;
        }
        self.tokens.get(self.at + n).map_or(TokenKind::End, |t| t.kind)
    }

    /// The word `n` tokens further on, on this line, where one stands there.
    pub fn word_ahead(&self, n: usize) -> Option<&'a str> {
        if self.ahead(n) == TokenKind::Name { self.raw_word(n) } else { None }
    }

    fn raw_word(&self, n: usize) -> Option<&'a str> {
        let token = self.tokens.get(self.at + n).filter(|t| t.kind == TokenKind::Name)?;
        Some(self.slice(token.span))
    }

    /// The current word; `None` where something else stands.
    pub fn word(&self) -> Option<&'a str> {
        if self.kind() == TokenKind::Name { self.raw_word(0) } else { None }
    }

    /// Whether this word is the current token.
    pub fn at_word(&self, word: &str) -> bool {
        self.word() == Some(word)
    }

    /// The place of the current token; at the end of a statement the place directly behind the last token.
    pub fn span(&self) -> Span {
        match self.tokens.get(self.at) {
            Some(token) if !self.statement_ends() => token.span,
            _ => self.behind_previous(),
        }
    }

    /// The place of this token and the `n` after it.
    pub fn span_ahead(&self, n: usize) -> Span {
        match self.tokens.get(self.at + n) {
            Some(last) => self.span().to(last.span),
            None => self.span(),
        }
    }

    /// The place directly behind the token before.
    pub fn behind_previous(&self) -> Span {
        Span { start: self.previous().end, ..self.previous() }
    }

    /// The place of the token before.
    pub fn previous(&self) -> Span {
        match self.previous_token() {
            Some(token) => token.span,
            None => Span::new(self.file, 0, 0),
        }
    }

    /// The token before.
    pub fn previous_token(&self) -> Option<Token> {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).copied()
    }

    /// The place of the first token that was read at or after `position`, to the last.
    pub fn span_since(&self, position: usize) -> Span {
        match self.tokens.get(position) {
            Some(first) if position < self.at => first.span.to(self.previous()),
            _ => self.span(),
        }
    }

    /// What a span covers.
    pub fn slice(&self, span: Span) -> &'a str {
        self.text.get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// Passes over the current token and says what it is.
    pub fn bump(&mut self, role: Role) -> Span {
        let span = self.span();
        if let Some(token) = self.tokens.get_mut(self.at) {
            token.role = role;
            self.at += 1;
        }
        self.joined = false;
        span
    }

    /// Passes over an operator, comma or colon: a newline after it means nothing.
    pub fn bump_joining(&mut self, role: Role) -> Span {
        let span = self.bump(role);
        self.joined = true;
        span
    }

    /// Lets the current token stand directly after the one before, in the canonical layout.
    pub fn glue(&mut self) {
        self.set_place(Place::Glued);
    }

    fn set_place(&mut self, place: Place) {
        if let Some(token) = self.tokens.get_mut(self.at) {
            token.place = place;
        }
    }

    /// Passes over an opening bracket whose partner is known; newlines mean nothing until [`Cursor::leave`].
    pub fn enter(&mut self) -> Option<Inside> {
        let close = self.partners.get(self.at).copied().flatten()?;
        self.bump(Role::Punctuation);
        self.brackets += 1;
        Some(Inside { close, outer: self.brackets - 1 })
    }

    /// Goes behind the closing bracket, whatever stands before it.
    pub fn leave(&mut self, inside: Inside) {
        self.brackets = inside.outer;
        self.at = self.at.max(inside.close);
        self.bump(Role::Punctuation);
    }

    /// After a fault: brackets that were opened further inside no longer count.
    pub fn leave_inner(&mut self, inside: &Inside) {
        self.brackets = inside.outer + 1;
    }

    /// The closing bracket.
    pub fn closes_with(&self, inside: &Inside) -> TokenKind {
        self.tokens.get(inside.close).map_or(TokenKind::End, |t| t.kind)
    }

    /// Whether only the closing bracket is left.
    pub fn at_close(&self, inside: &Inside) -> bool {
        self.at >= inside.close
    }

    /// Passes over an opening bracket inside which newlines go on meaning what they mean outside.
    pub fn enter_block(&mut self) -> Option<Inside> {
        let close = self.partners.get(self.at).copied().flatten()?;
        self.bump(Role::Punctuation);
        Some(Inside { close, outer: self.brackets })
    }

    /// From here newlines mean nothing, as in brackets, until [`Cursor::end_region`].
    pub fn begin_region(&mut self) {
        self.brackets += 1;
    }

    /// From here newlines mean something again.
    pub fn end_region(&mut self) {
        self.brackets = self.brackets.saturating_sub(1);
    }

    /// Begins a statement, or an entry of a block: the current token stands for itself, whatever line it is on.
    pub fn begin(&mut self) {
        self.set_place(Place::First);
        self.brackets = 0;
        self.joined = false;
        self.began = self.at;
    }

    /// The current token opens a block of entries.
    pub fn mark_block(&mut self) {
        self.set_place(Place::Block);
    }

    /// Begins an entry of a block in which newlines mean nothing.
    pub fn begin_inside(&mut self) {
        self.set_place(Place::First);
    }

    /// After a fault in the statement that begins at `start`: goes to the next line that does not go on with it, but not
    /// beyond `limit`. Brackets that are closed are passed over whole.
    pub fn skip_statement(&mut self, start: usize, limit: Option<&Inside>) {
        self.brackets = 0;
        self.joined = false;
        let end = limit.map_or(self.tokens.len(), |inside| inside.close);
        while self.at < end && (self.at == start || !self.begins_line() || self.continues()) {
            self.skip_token();
        }
    }

    /// After a fault that leaves the extent of a statement unknown: goes to the next line that surely begins one.
    pub fn skip_to_statement(&mut self) {
        self.brackets = 0;
        self.joined = false;
        self.skip_token();
        let begins = |at: usize| self.tokens[at].starts_line && begins_statement(self.text, &self.tokens, at);
        self.at = (self.at..self.tokens.len()).find(|&at| begins(at)).unwrap_or(self.tokens.len());
    }

    /// Passes over a token, or over a whole pair of brackets.
    pub fn skip_token(&mut self) {
        self.at = self.partners.get(self.at).copied().flatten().unwrap_or(self.at) + 1;
        self.at = self.at.min(self.tokens.len());
    }

    /// Passes over all tokens that begin before byte `end` as pieces of one topic.
    pub fn bump_topic(&mut self, end: usize) {
        let mut first = true;
        while let Some(token) = self.tokens.get_mut(self.at).filter(|t| (t.span.start as usize) < end) {
            token.role = Role::Topic;
            if !std::mem::take(&mut first) {
                token.place = Place::Glued;
            }
            self.at += 1;
        }
        self.joined = false;
    }
}

/// A bracket that stands open.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    close: usize,
    /// How many brackets stood open outside.
    outer: usize,
}
