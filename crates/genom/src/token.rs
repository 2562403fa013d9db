//! What a specification is made of, after and before the preprocessor.

use std::rc::Rc;

use lapwing_diag::Span;

/// What a token is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    /// A name or a word: which of them, only the place says.
    Word,
    /// A number as it was written, its suffix with it.
    Number,
    /// A string, quotes and all.
    Text,
    /// A character between single quotes.
    Character,
    /// A sign. Digraphs are written as what they stand for.
    Sign,
    /// A `#pragma`; its text is the rest of its line.
    Pragma,
    /// What begins no token; the text says what is wrong with it.
    Bad,
    /// The end of everything.
    End,
}

/// A token.
#[derive(Clone, Debug)]
pub(crate) struct Token {
    pub kind: Kind,
    pub text: Rc<str>,
    /// Where it stands. What a macro put there stands where the macro was named.
    pub span: Span,
    /// Whether it is the first of its line.
    pub starts_line: bool,
    /// Whether a blank or a comment is before it.
    pub spaced: bool,
}

impl Token {
    /// Whether it is this sign.
    pub(crate) fn is(&self, sign: &str) -> bool {
        self.kind == Kind::Sign && &*self.text == sign
    }

    /// Whether it is this word.
    pub(crate) fn is_word(&self, word: &str) -> bool {
        self.kind == Kind::Word && &*self.text == word
    }
}
