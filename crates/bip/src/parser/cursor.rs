//! Where the parser stands, and the smallest things that it reads.

use super::{Parse, Parser};
use crate::ast::{Name, Path};
use crate::lexer::TokenKind;
use lapwing_diag::{Code, Diagnostic, Span};

/// Words that are no names.
pub(super) const RESERVED: &[&str] = &[
    "as",
    "at",
    "atom",
    "clock",
    "component",
    "compound",
    "connector",
    "const",
    "data",
    "define",
    "delayable",
    "do",
    "down",
    "eager",
    "else",
    "end",
    "export",
    "extern",
    "fi",
    "from",
    "if",
    "initial",
    "internal",
    "invariant",
    "lazy",
    "on",
    "package",
    "place",
    "port",
    "priority",
    "provided",
    "resume",
    "then",
    "to",
    "type",
    "unit",
    "up",
    "use",
];

impl Parser<'_> {
    pub(super) fn kind(&self) -> TokenKind {
        self.kind_at(0)
    }

    fn kind_at(&self, ahead: usize) -> TokenKind {
        self.tokens.get(self.at + ahead).map_or(TokenKind::End, |t| t.kind)
    }

    /// The place of the current token; at the end of the text the place behind it.
    pub(super) fn span(&self) -> Span {
        let end = Span::new(self.file, self.text.len(), self.text.len());
        self.tokens.get(self.at).map_or(end, |t| t.span)
    }

    /// The place of the token before the current one.
    pub(super) fn last_span(&self) -> Span {
        self.at.checked_sub(1).and_then(|at| self.tokens.get(at)).map_or(self.span(), |t| t.span)
    }

    fn slice(&self, span: Span) -> &str {
        self.text.get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// The text of the token `ahead`; empty at the end.
    pub(super) fn peek(&self, ahead: usize) -> &str {
        self.tokens.get(self.at + ahead).map_or("", |t| self.slice(t.span))
    }

    /// The text of the token here, as a value of its own.
    pub(super) fn here(&self) -> String {
        self.peek(0).to_owned()
    }

    pub(super) fn advance(&mut self) {
        self.at = (self.at + 1).min(self.tokens.len());
    }

    pub(super) fn at_end(&self) -> bool {
        self.kind() == TokenKind::End
    }

    /// Whether this word or sign stands here.
    pub(super) fn is(&self, what: &str) -> bool {
        self.is_ahead(0, what)
    }

    pub(super) fn is_ahead(&self, ahead: usize, what: &str) -> bool {
        matches!(self.kind_at(ahead), TokenKind::Name | TokenKind::Sign) && self.peek(ahead) == what
    }

    pub(super) fn is_any(&self, words: &[&str]) -> bool {
        words.iter().any(|w| self.is(w))
    }

    /// Passes over this word or sign, if it stands here.
    pub(super) fn take(&mut self, what: &str) -> bool {
        let found = self.is(what);
        if found {
            self.advance();
        }
        found
    }

    pub(super) fn require(&mut self, what: &str) -> Parse<Span> {
        let span = self.span();
        if self.take(what) {
            return Ok(span);
        }
        self.missing(&format!("`{what}`"))
    }

    /// Says what was expected here and what was found.
    pub(super) fn missing<T>(&mut self, what: &str) -> Parse<T> {
        let found = match self.kind() {
            TokenKind::End => "the text ends".to_owned(),
            // It has been reported already, as what it is.
            TokenKind::Bad => return Err(super::Reported(())),
            _ => format!("`{}` stands", self.peek(0)),
        };
        self.fail(Code::Syntax, self.span(), format!("{what} is expected here, where {found}"))
    }

    pub(super) fn name(&mut self, what: &str) -> Parse<Name> {
        if self.kind() != TokenKind::Name {
            return self.missing(what);
        }
        let name = Name { text: self.here(), span: self.span() };
        if RESERVED.contains(&name.text.as_str()) {
            let message = format!("{what} is expected here, and `{}` is a word of the language", name.text);
            return self.fail(Code::ReservedWord, name.span, message);
        }
        self.advance();
        Ok(name)
    }

    pub(super) fn path(&mut self, what: &str) -> Parse<Path> {
        let mut parts = vec![self.name(what)?];
        while self.is(".") {
            self.advance();
            parts.push(self.name("a name")?);
        }
        Ok(Path { parts })
    }

    pub(super) fn names(&mut self, what: &str) -> Parse<Vec<Name>> {
        self.separated(|p| p.name(what))
    }

    pub(super) fn paths(&mut self, what: &str) -> Parse<Vec<Path>> {
        self.separated(|p| p.path(what))
    }

    /// One or more, with commas between them.
    pub(super) fn separated<T>(&mut self, mut one: impl FnMut(&mut Self) -> Parse<T>) -> Parse<Vec<T>> {
        let mut all = vec![one(self)?];
        while self.take(",") {
            all.push(one(self)?);
        }
        Ok(all)
    }

    /// None or more between brackets, with commas between them.
    pub(super) fn bracketed<T>(&mut self, one: impl FnMut(&mut Self) -> Parse<T>) -> Parse<Vec<T>> {
        let open = self.require("(")?;
        if self.take(")") {
            return Ok(Vec::new());
        }
        let all = self.separated(one)?;
        self.close(open)?;
        Ok(all)
    }

    pub(super) fn close(&mut self, open: Span) -> Parse<()> {
        if self.take(")") {
            return Ok(());
        }
        if self.kind() == TokenKind::Bad {
            return Err(super::Reported(()));
        }
        let found = if self.at_end() { "the end of the text".to_owned() } else { format!("`{}`", self.peek(0)) };
        let message = format!("`)` is expected here, and {found} was found");
        let diagnostic = Diagnostic::new(Code::UnclosedBracket, self.span(), message).also(open, "opened here");
        Err(self.report(diagnostic))
    }

    /// Goes to the next token that one of the words begins, or that begins a declaration.
    pub(super) fn skip_to(&mut self, words: &[&str]) {
        while !self.at_end() && !self.is_any(words) && !self.begins_type() {
            self.advance();
        }
    }

    /// Whether a declaration of a type begins here: nothing within a type does so.
    pub(super) fn begins_type(&self) -> bool {
        self.is_any(&["atom", "compound", "connector", "port"]) && self.is_ahead(1, "type")
            || self.is("const") && self.is_ahead(1, "data")
            || self.is("extern") && (self.is_ahead(1, "function") || self.is_ahead(1, "operator"))
            || self.is("extern") && self.is_ahead(1, "data")
    }
}
