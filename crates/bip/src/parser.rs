//! Tokens to tree: a recursive-descent parser, one function per production.
//!
//! A production returns [`Parse`]: what it read, or [`Reported`], the proof that a diagnostic says why not. Whoever can go on after a
//! fault catches it: a member of an atom or a compound goes on with the next member, a declaration with the next declaration.

mod atom;
mod compound;
mod connector;
mod cursor;
mod declaration;
mod expr;
mod stmt;

use crate::ast::Package;
use crate::lexer::{Lexed, Token, lex};
use lapwing_diag::{Code, Diagnostic, FileId, Span};

/// A text, read as far as it could be.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// What it declares; what holds an error is left out.
    pub package: Package,
    /// What is wrong with the text, in the order of the places.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads the text of a package. It never fails and never stops at the first error.
///
/// ```
/// use lapwing_bip::{FileId, parse};
///
/// let parsed = parse(FileId(0), "package p\n  port type Go()\nend\n");
/// assert_eq!(parsed.package.decls.len(), 1);
/// assert!(parsed.diagnostics.is_empty());
/// ```
pub fn parse(file: FileId, text: &str) -> Parsed {
    let Lexed { tokens, diagnostics } = lex(file, text);
    let mut parser = Parser { file, text, tokens, at: 0, diagnostics, nesting: 0, height: 0 };
    let package = parser.package();
    let mut diagnostics = parser.diagnostics;
    diagnostics.sort_by_key(|d| (d.primary.span.start, d.primary.span.end));
    Parsed { package, diagnostics }
}

/// The proof that a diagnostic has been reported: what was to be read could not be.
#[derive(Clone, Copy, Debug)]
struct Reported(());

/// What a production gives.
type Parse<T> = Result<T, Reported>;

/// How deep brackets and `if`s may stand in one another.
const MAX_NESTING: usize = 120;

/// How high a tree of expressions may grow: whoever walks it must not run out of stack.
const MAX_HEIGHT: usize = 500;

/// After so many faults nobody reads on.
const MAX_FAULTS: usize = 200;

/// The state of a run over one text.
struct Parser<'a> {
    file: FileId,
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    diagnostics: Vec<Diagnostic>,
    /// How many productions that nest stand open.
    nesting: usize,
    /// The height of the expression that was read last.
    height: usize,
}

impl Parser<'_> {
    /// Reports a fault that the production can go on after.
    fn report(&mut self, diagnostic: Diagnostic) -> Reported {
        if self.diagnostics.len() < MAX_FAULTS {
            self.diagnostics.push(diagnostic);
        }
        Reported(())
    }

    /// Reports a fault that ends the production.
    fn fail<T>(&mut self, code: Code, span: Span, message: impl Into<String>) -> Parse<T> {
        Err(self.report(Diagnostic::new(code, span, message)))
    }

    /// Runs a production that may hold itself, unless it stands too deep.
    fn nested<T>(&mut self, production: impl FnOnce(&mut Self) -> Parse<T>) -> Parse<T> {
        if self.nesting == MAX_NESTING {
            return self.fail(Code::TooDeep, self.span(), "this is nested too deeply");
        }
        self.nesting += 1;
        let result = production(self);
        self.nesting -= 1;
        result
    }
}
