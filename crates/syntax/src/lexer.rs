//! Text to tokens, without any context.

use crate::ast::Unit;
use crate::token::{Place, Role, Token, TokenKind};
use lapwing_diag::{Code, Diagnostic, FileId, Span};

/// What the lexer found.
pub(crate) struct Lexed {
    /// The tokens that the parser reads: no comments.
    pub tokens: Vec<Token>,
    /// The comments, in order.
    pub comments: Vec<Token>,
    /// What was wrong with single tokens.
    pub diagnostics: Vec<Diagnostic>,
}

/// Cuts a text into tokens. Every byte that is no blank belongs to a token; what begins none is [`TokenKind::Bad`].
pub(crate) fn lex(file: FileId, text: &str) -> Lexed {
    let lexed = Lexed { tokens: Vec::new(), comments: Vec::new(), diagnostics: Vec::new() };
    let mut lexer = Lexer { file, text, at: 0, starts_line: true, lexed };
    while lexer.skip_blanks() {
        lexer.token();
    }
    lexer.lexed
}

struct Lexer<'a> {
    file: FileId,
    text: &'a str,
    at: usize,
    starts_line: bool,
    lexed: Lexed,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn span_from(&self, start: usize) -> Span {
        Span::new(self.file, start, self.at)
    }

    /// Passes over as long a run of such characters as there is.
    fn take_while(&mut self, wanted: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|c| !wanted(c)).unwrap_or(rest.len());
    }

    fn push(&mut self, kind: TokenKind, start: usize) {
        let token = Token {
            kind,
            span: self.span_from(start),
            starts_line: self.starts_line,
            role: Role::of(kind),
            place: Place::Free,
        };
        if kind == TokenKind::Comment {
            self.lexed.comments.push(token);
        } else {
            self.starts_line = false;
            self.lexed.tokens.push(token);
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.lexed.diagnostics.push(diagnostic);
    }

    /// Goes to the next token; false at the end of the text.
    fn skip_blanks(&mut self) -> bool {
        while let Some(c) = self.rest().chars().next() {
            match c {
                '\n' => self.starts_line = true,
                '\u{feff}' if self.at == 0 => {}
                c if c.is_whitespace() => {}
                _ => return true,
            }
            self.at += c.len_utf8();
        }
        false
    }

    fn token(&mut self) {
        match self.rest().chars().next() {
            Some('#') => self.comment(),
            Some('"') => self.text_literal(),
            Some('`') => self.quoted(),
            Some('\'') => self.single_quotes(),
            Some(c) if c.is_ascii_digit() => self.number(),
            Some('.') if self.dot_begins_number() => self.number(),
            Some(c) if is_name_start(c) => self.name(),
            _ => self.symbol(),
        }
    }

    fn comment(&mut self) {
        let start = self.at;
        let rest = self.rest();
        let line = rest.split('\n').next().unwrap_or(rest);
        self.at += line.trim_end_matches('\r').len();
        self.push(TokenKind::Comment, start);
    }

    fn name(&mut self) {
        let start = self.at;
        self.take_while(is_name_part);
        self.push(TokenKind::Name, start);
    }

    /// A name in backquotes, on one line.
    fn quoted(&mut self) {
        let start = self.at;
        self.at += 1;
        self.take_while(|c| c != '`' && c != '\n' && c != '\r');
        if !self.rest().starts_with('`') {
            self.push(TokenKind::Bad, start);
            let span = self.span_from(start);
            return self.report(
                Diagnostic::new(Code::BadName, span, "a name that begins with a backquote ends with one")
                    .label("no second backquote on this line"),
            );
        }
        self.at += 1;
        let kind = if self.at - start > 2 { TokenKind::Quoted } else { TokenKind::Bad };
        self.push(kind, start);
        if kind == TokenKind::Bad {
            let span = self.span_from(start);
            self.report(Diagnostic::new(Code::BadName, span, "there is no name between these backquotes"));
        }
    }

    /// A string on one line; its escapes are looked at when it is decoded.
    fn text_literal(&mut self) {
        let start = self.at;
        self.at += 1;
        let mut escaped = false;
        let end = self.rest().find(|c| {
            let ends = matches!(c, '\n' | '\r') || (c == '"' && !escaped);
            escaped = c == '\\' && !escaped;
            ends
        });
        self.at += end.unwrap_or(self.rest().len());
        if self.rest().starts_with('"') {
            self.at += 1;
            return self.push(TokenKind::Text, start);
        }
        self.push(TokenKind::Bad, start);
        let span = self.span_from(start);
        self.report(
            Diagnostic::new(Code::BadText, span, "this text has no closing quotation mark")
                .label("begins here")
                .help("a text stands on one line; a line break in it is written `\\n`"),
        );
    }

    /// `'text'`, which belongs into double quotation marks.
    fn single_quotes(&mut self) {
        let start = self.at;
        self.at += 1;
        let rest = self.rest();
        let end = rest.find(['\'', '\n', '\r']).filter(|&end| rest[end..].starts_with('\''));
        self.at += end.map_or(0, |end| end + 1);
        self.push(TokenKind::Bad, start);
        let span = self.span_from(start);
        let diagnostic = Diagnostic::new(Code::BadText, span, "a text stands in double quotation marks");
        self.report(match end {
            Some(end) => diagnostic.fix(span, format!("\"{}\"", &rest[..end])),
            None => diagnostic,
        });
    }

    /// Whether the `.` here begins something like `.5` rather than following a name.
    fn dot_begins_number(&self) -> bool {
        let after = self.rest().chars().nth(1);
        let follows_operand = self.lexed.tokens.last().is_some_and(|t| {
            t.kind.ends_operand() && t.span.end as usize == self.at && !matches!(t.kind, TokenKind::Number)
        });
        after.is_some_and(|c| c.is_ascii_digit()) && !follows_operand
    }

    /// A number with its exponent, and the unit that follows.
    fn number(&mut self) {
        let start = self.at;
        self.take_while(|c| c.is_ascii_digit());
        self.fraction();
        self.exponent();
        self.take_while(|c| c == '.' || c.is_ascii_digit());
        self.push(TokenKind::Number, start);
        self.check_number(start);
        self.unit();
    }

    fn fraction(&mut self) {
        if self.rest().starts_with('.') && self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()) {
            self.at += 1;
            self.take_while(|c| c.is_ascii_digit());
        }
    }

    fn exponent(&mut self) {
        let rest = self.rest();
        let Some(power) = rest.strip_prefix(['e', 'E']) else { return };
        let digits = power.strip_prefix(['+', '-']).unwrap_or(power);
        if digits.starts_with(|c: char| c.is_ascii_digit()) {
            self.at += rest.len() - digits.len();
            self.take_while(|c| c.is_ascii_digit());
        }
    }

    /// Reports `.5`, `5.`, `1.2.3` and numbers that no double can hold.
    fn check_number(&mut self, start: usize) {
        let span = self.span_from(start);
        let written = &self.text[start..self.at];
        let points = written.matches('.').count();
        let proper = match (written.starts_with('.'), written.ends_with('.')) {
            (true, false) if points == 1 => format!("0{written}"),
            (false, true) if points == 1 => format!("{written}0"),
            _ if points > 1 => {
                return self.report(Diagnostic::new(Code::BadNumber, span, format!("`{written}` is no number")));
            }
            _ if written.parse::<f64>().is_ok_and(f64::is_finite) => return,
            _ => {
                let what = format!("`{written}` is too large a number");
                return self.report(Diagnostic::new(Code::BadNumber, span, what).label("no double can hold it"));
            }
        };
        self.report(
            Diagnostic::new(Code::BadNumber, span, "a number has digits on both sides of its point")
                .help(format!("write `{proper}`"))
                .fix(span, proper),
        );
    }

    /// The longest unit that stands here, directly after a number or after blanks.
    fn unit(&mut self) {
        let rest = self.rest();
        let blanks = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        let Some((name, unit)) = longest_unit(&rest[blanks..]) else { return };
        let start = self.at + blanks;
        self.at = start + name.len();
        self.push(TokenKind::Unit(unit), start);
    }

    fn symbol(&mut self) {
        let start = self.at;
        let rest = self.rest();
        if let Some((symbol, kind)) = SYMBOLS.iter().find(|(symbol, _)| rest.starts_with(symbol)) {
            self.at += symbol.len();
            return self.push(*kind, start);
        }
        let Some(c) = rest.chars().next() else { return };
        // A run of the same foreign sign is one fault.
        self.take_while(|other| other == c);
        self.push(TokenKind::Bad, start);
        let diagnostic = stray_character(self.span_from(start), c);
        self.report(diagnostic);
    }
}

/// The symbols; of two that begin alike the longer comes first.
const SYMBOLS: &[(&str, TokenKind)] = &[
    ("<=>", TokenKind::BothWays),
    ("::", TokenKind::ColonColon),
    ("==", TokenKind::EqualEqual),
    ("!=", TokenKind::NotEqual),
    ("<=", TokenKind::LessEqual),
    (">=", TokenKind::GreaterEqual),
    ("=>", TokenKind::FatArrow),
    ("->", TokenKind::Arrow),
    ("||", TokenKind::BarBar),
    ("&&", TokenKind::DoubleAmpersand),
    ("(", TokenKind::OpenRound),
    (")", TokenKind::CloseRound),
    ("[", TokenKind::OpenSquare),
    ("]", TokenKind::CloseSquare),
    ("{", TokenKind::OpenCurly),
    ("}", TokenKind::CloseCurly),
    (",", TokenKind::Comma),
    (":", TokenKind::Colon),
    (";", TokenKind::Semicolon),
    (".", TokenKind::Dot),
    ("@", TokenKind::At),
    ("=", TokenKind::Equals),
    ("<", TokenKind::Less),
    (">", TokenKind::Greater),
    ("+", TokenKind::Plus),
    ("-", TokenKind::Minus),
    ("*", TokenKind::Star),
    ("/", TokenKind::Slash),
    ("|", TokenKind::Bar),
    ("&", TokenKind::Ampersand),
    ("!", TokenKind::Bang),
];

/// Whether a name may begin with it.
pub(crate) fn is_name_start(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

/// Whether a name may go on with it.
pub(crate) fn is_name_part(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

/// The longest unit that `rest` begins with and that nothing like a name continues.
fn longest_unit(rest: &str) -> Option<(&'static str, Unit)> {
    let ends = |name: &str| !rest[name.len()..].starts_with(|c: char| is_name_part(c) || c == '`');
    Unit::ALL
        .iter()
        .map(|&unit| (unit.name(), unit))
        .filter(|(name, _)| rest.starts_with(name) && ends(name))
        .max_by_key(|(name, _)| name.len())
}

/// What to say of a character that begins no token.
fn stray_character(span: Span, c: char) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::StrayCharacter, span, format!("`{c}` has no meaning here"));
    match c {
        '\\' => diagnostic.help("`\\` is a mark of text conversion or of shells; leave it out"),
        '%' | '^' => diagnostic.help("the operators of arithmetic are `+ - * /`"),
        '≤' => diagnostic.help("write `<=`").fix(span, "<="),
        '≥' => diagnostic.help("write `>=`").fix(span, ">="),
        '≠' => diagnostic.help("write `!=`").fix(span, "!="),
        '∧' => diagnostic.help("write `and`").fix(span, "and"),
        '∨' => diagnostic.help("write `or`").fix(span, "or"),
        '¬' => diagnostic.help("write `not`").fix(span, "not"),
        '“' | '”' => diagnostic.help("write plain quotation marks: `\"`"),
        '°' => diagnostic.help("write `deg`").fix(span, " deg"),
        _ => diagnostic,
    }
}
