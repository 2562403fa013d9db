//! Tokens: the smallest pieces of a specification that mean something.
//!
//! The lexer knows no context; a token's [`TokenKind`] follows from its characters alone. What a token *is* in its place (a
//! keyword or a name, a division or a part of a topic) the parser finds out and writes down as the token's [`Role`], for
//! the formatter and for editors.

use crate::ast::Unit;
use lapwing_diag::Span;

/// One token.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Token {
    /// What its characters make it.
    pub kind: TokenKind,
    /// Where it stands.
    pub span: Span,
    /// Whether it is the first of its line, comments aside.
    pub starts_line: bool,
    /// What it is where it stands.
    pub role: Role,
    /// How the canonical layout sets it.
    pub place: Place,
}

/// How the canonical layout sets a token.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Place {
    /// As its kind says.
    Free,
    /// Directly after the token before it.
    Glued,
    /// It begins a statement, or an entry of a block.
    First,
    /// It opens a block of entries.
    Block,
}

/// What the characters of a token make it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TokenKind {
    /// `velocity`, `always`: words, reserved or not.
    Name,
    /// `` `stop sign` ``: always a name.
    Quoted,
    /// `2.5`, `1e-6`
    Number,
    /// The unit of the number before it.
    Unit(Unit),
    /// `"text"`
    Text,
    /// `(`
    OpenRound,
    /// `)`
    CloseRound,
    /// `[`
    OpenSquare,
    /// `]`
    CloseSquare,
    /// `{`
    OpenCurly,
    /// `}`
    CloseCurly,
    /// `,`
    Comma,
    /// `:`
    Colon,
    /// `::`
    ColonColon,
    /// `;`
    Semicolon,
    /// `.`
    Dot,
    /// `@`
    At,
    /// `=`
    Equals,
    /// `==`
    EqualEqual,
    /// `!=`
    NotEqual,
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `*`
    Star,
    /// `/`
    Slash,
    /// `->`
    Arrow,
    /// `=>`
    FatArrow,
    /// `<=>`
    BothWays,
    /// `|`
    Bar,
    /// `||`
    BarBar,
    /// `&`
    Ampersand,
    /// `&&`
    DoubleAmpersand,
    /// `!`
    Bang,
    /// `# …`, to the end of the line. The parser never sees one.
    Comment,
    /// What begins no token; the lexer has reported it.
    Bad,
    /// No more tokens in this statement. It stands in no list of tokens: the parser sees it at the end of a line.
    End,
}

impl TokenKind {
    /// Whether it is one of `( [ {`.
    pub fn opens(self) -> bool {
        matches!(self, TokenKind::OpenRound | TokenKind::OpenSquare | TokenKind::OpenCurly)
    }

    /// Whether it is one of `) ] }`.
    pub fn closes(self) -> bool {
        matches!(self, TokenKind::CloseRound | TokenKind::CloseSquare | TokenKind::CloseCurly)
    }

    /// Whether an operand may end with it.
    pub(crate) fn ends_operand(self) -> bool {
        use TokenKind::*;
        matches!(self, Name | Quoted | Number | Unit(_) | Text) || self.closes()
    }
}

/// What a token is where it stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// A word of the language.
    Keyword,
    /// The name of a signal, field, state, property, …
    Name,
    /// The name of a function or pattern that is called.
    Function,
    /// A message type or its package.
    Type,
    /// A piece of a topic.
    Topic,
    /// A number.
    Number,
    /// A unit.
    Unit,
    /// A string.
    Text,
    /// An operator.
    Operator,
    /// Brackets, commas, colons, dots.
    Punctuation,
    /// A comment.
    Comment,
    /// What could not be read.
    Bad,
}

impl Role {
    /// What a token of that kind is as long as nobody knows better.
    pub(crate) fn of(kind: TokenKind) -> Role {
        use TokenKind::*;
        match kind {
            Name | Quoted => Role::Name,
            Number => Role::Number,
            Unit(_) => Role::Unit,
            Text => Role::Text,
            Comment => Role::Comment,
            Bad | End => Role::Bad,
            OpenRound | CloseRound | OpenSquare | CloseSquare | OpenCurly | CloseCurly => Role::Punctuation,
            Comma | Colon | ColonColon | Semicolon | Dot | At => Role::Punctuation,
            _ => Role::Operator,
        }
    }
}
