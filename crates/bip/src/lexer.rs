//! Text to tokens, without any context.

use lapwing_diag::{Code, Diagnostic, FileId, Span};

/// A token: what it is, and where. What it says is the text at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub kind: TokenKind,
    pub span: Span,
}

/// The kinds of tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    /// A name or a keyword.
    Name,
    /// A number without a point.
    Int,
    /// A number with a point or an exponent.
    Real,
    /// A text in quotation marks.
    Text,
    /// A sign, such as `<=`.
    Sign,
    /// What belongs to no token; it has been reported.
    Bad,
    /// The end of the text.
    End,
}

/// What the lexer found.
pub(crate) struct Lexed {
    pub tokens: Vec<Token>,
    pub diagnostics: Vec<Diagnostic>,
}

/// Signs of several characters, the longest first; every other sign is one character.
const SIGNS: [&str; 6] = ["<=", ">=", "==", "!=", "&&", "||"];

const SINGLE: &str = "(){},;.:*<>=!&|^~+-/%'@";

/// Cuts a text into tokens; comments and blanks are left out.
pub(crate) fn lex(file: FileId, text: &str) -> Lexed {
    let mut lexer = Lexer { file, text, at: 0, lexed: Lexed { tokens: Vec::new(), diagnostics: Vec::new() } };
    while lexer.skip_blanks() {
        lexer.token();
    }
    lexer.lexed
}

struct Lexer<'a> {
    file: FileId,
    text: &'a str,
    at: usize,
    lexed: Lexed,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn span_from(&self, start: usize) -> Span {
        Span::new(self.file, start, self.at)
    }

    fn take_while(&mut self, wanted: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|c| !wanted(c)).unwrap_or(rest.len());
    }

    fn push(&mut self, kind: TokenKind, start: usize) {
        let span = self.span_from(start);
        self.lexed.tokens.push(Token { kind, span });
    }

    fn report(&mut self, code: Code, start: usize, message: &str) {
        let span = self.span_from(start);
        self.lexed.diagnostics.push(Diagnostic::new(code, span, message));
    }

    /// Goes to the next token, over blanks and comments; false at the end of the text.
    fn skip_blanks(&mut self) -> bool {
        loop {
            self.take_while(|c| c.is_whitespace() || c == '\u{feff}');
            let rest = self.rest();
            if rest.starts_with("//") {
                self.at += rest.find('\n').unwrap_or(rest.len());
            } else if rest.starts_with("/*") {
                self.block_comment();
            } else {
                return !rest.is_empty();
            }
        }
    }

    fn block_comment(&mut self) {
        let start = self.at;
        // The star of `/*` is not the one of `*/`: `/*/` only begins a comment.
        match self.rest().get(2..).and_then(|inside| inside.find("*/")) {
            Some(end) => self.at += end + 4,
            None => {
                self.at = start + 2;
                self.report(Code::UnclosedBracket, start, "this comment has no end");
                self.at = self.text.len();
            }
        }
    }

    fn token(&mut self) {
        let start = self.at;
        match self.rest().chars().next() {
            Some(c) if c.is_alphabetic() || c == '_' => {
                self.take_while(|c| c.is_alphanumeric() || c == '_');
                self.push(TokenKind::Name, start);
            }
            Some(c) if c.is_ascii_digit() => self.number(start),
            Some('.') if self.begins_fraction() => self.number(start),
            Some('"') => self.text_literal(start),
            Some(c) => self.sign(start, c),
            None => {}
        }
    }

    fn number(&mut self, start: usize) {
        let digit = |c: char| c.is_ascii_digit();
        self.take_while(digit);
        let mut kind = TokenKind::Int;
        // `1.` and `.5` are numbers too.
        if self.rest().starts_with('.') && !self.rest().starts_with("..") {
            kind = TokenKind::Real;
            self.at += 1;
            self.take_while(digit);
        }
        if let Some(length) = exponent(self.rest()) {
            kind = TokenKind::Real;
            self.at += length;
        }
        if self.rest().starts_with(|c: char| c.is_alphabetic() || c == '_') {
            self.take_while(|c| c.is_alphanumeric() || c == '_');
            self.report(Code::BadNumber, start, "a number and a name stand together here");
            kind = TokenKind::Bad;
        }
        self.push(kind, start);
    }

    /// Whether a point begins a number, as in `.5`, and no field of what stands before it.
    fn begins_fraction(&self) -> bool {
        let follows_name = self.lexed.tokens.last().is_some_and(|t| t.kind == TokenKind::Name);
        !follows_name && self.rest().as_bytes().get(1).is_some_and(u8::is_ascii_digit)
    }

    /// A text, which may go over several lines. Without an end it is taken to end with its line, so that what follows is read all the same.
    fn text_literal(&mut self, start: usize) {
        let mut escaped = false;
        self.at += 1;
        let end = self.rest().find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        if let Some(length) = end {
            self.at += length + 1;
            return self.push(TokenKind::Text, start);
        }
        self.take_while(|c| c != '\n');
        let span = self.span_from(start);
        let mut diagnostic = Diagnostic::new(Code::BadText, span, "this text has no closing quotation mark");
        if let Some(before) = self.first_of_several_lines() {
            diagnostic =
                diagnostic.also(before, "or this one, which goes over several lines, should have ended before");
        }
        self.lexed.diagnostics.push(diagnostic);
        self.push(TokenKind::Bad, start);
    }

    /// The first text before here that goes over several lines.
    fn first_of_several_lines(&self) -> Option<Span> {
        let is_broken =
            |span: &Span| self.text.get(span.start as usize..span.end as usize).is_some_and(|text| text.contains('\n'));
        let texts = self.lexed.tokens.iter().filter(|t| t.kind == TokenKind::Text);
        texts.map(|t| t.span).find(is_broken)
    }

    fn sign(&mut self, start: usize, c: char) {
        let rest = self.rest();
        if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
            self.at += sign.len();
            return self.push(TokenKind::Sign, start);
        }
        self.at += c.len_utf8();
        if SINGLE.contains(c) {
            return self.push(TokenKind::Sign, start);
        }
        self.report(Code::StrayCharacter, start, "this character has no meaning here");
        self.push(TokenKind::Bad, start);
    }
}

/// The length of `e-3`, if one stands here.
fn exponent(rest: &str) -> Option<usize> {
    let after = rest.strip_prefix(['e', 'E'])?;
    let digits = after.strip_prefix(['+', '-']).unwrap_or(after);
    let count = digits.bytes().take_while(u8::is_ascii_digit).count();
    (count > 0).then(|| rest.len() - digits.len() + count)
}
