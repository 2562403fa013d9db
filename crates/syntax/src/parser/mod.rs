//! Tokens to syntax tree: a recursive-descent parser, one function per production.
//!
//! A production returns [`Parse`]: what it read, or [`Reported`], the proof that a diagnostic says why not. Whoever can go
//! on after a fault catches it: a bracket whose partner is known goes on behind it, an entry of a machine or a reaction with
//! the next, a statement with the next. So one mistake gives one diagnostic, and every mistake gives one.
//!
//! Newlines: [`Cursor::kind`] shows [`TokenKind::End`] where a newline ends the statement, so the productions need not
//! know about lines at all.

mod action;
mod arithmetic;
mod bound;
mod complaint;
mod connective;
mod cursor;
mod declaration;
mod event;
mod ltl;
mod machine;
mod name;
mod pairs;
mod property;
mod statement;
mod temporal;

use crate::ast;
use crate::lexer::{Lexed, lex};
use crate::token::Token;
pub(crate) use arithmetic::is_symbolic_operator;
use cursor::Cursor;
use lapwing_diag::{Diagnostic, FileId, Span};
pub(crate) use ltl::prefix_symbol;

/// A text, read as far as it could be.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The statements; those that hold an error are left out or hold [`ast::ExprKind::Error`].
    pub file: ast::File,
    /// What is wrong with the text, in the order of the places.
    pub diagnostics: Vec<Diagnostic>,
    /// The tokens, comments among them, in order.
    pub tokens: Vec<Token>,
}

/// Reads the text of a specification. It never fails and never stops at the first error.
///
/// ```
/// use lapwing_syntax::{FileId, parse};
///
/// let parsed = parse(FileId(0), "limit = 2.0 m/s\nnever robot.velocity > limit\n");
/// assert_eq!(parsed.file.items.len(), 2);
/// assert!(parsed.diagnostics.is_empty());
/// ```
pub fn parse(file: FileId, text: &str) -> Parsed {
    let Lexed { tokens, comments, diagnostics } = lex(file, text);
    let mut parser = Parser::new(Cursor::new(file, text, tokens), diagnostics);
    let items = parser.statements();
    let Parser { cursor, mut diagnostics, .. } = parser;
    diagnostics.sort_by_key(|d| (d.primary.span.start, d.primary.span.end));
    Parsed { file: ast::File { items }, diagnostics, tokens: merge(cursor.into_tokens(), comments) }
}

/// Two lists of tokens as one, in order.
fn merge(mut tokens: Vec<Token>, comments: Vec<Token>) -> Vec<Token> {
    tokens.extend(comments);
    tokens.sort_by_key(|token| token.span.start);
    tokens
}

/// The proof that a diagnostic has been reported: what was to be read could not be.
#[derive(Clone, Copy, Debug)]
struct Reported(());

/// What a production gives.
type Parse<T> = Result<T, Reported>;

/// An expression: boxed, since it goes through many hands on its way up and a formula may nest deeply.
type Tree = Box<ast::Expr>;

/// How deep brackets and prefix words may stand in one another.
const MAX_NESTING: usize = 100;

/// How high a tree of expressions may grow: whoever walks it must not run out of stack.
const MAX_HEIGHT: usize = 400;

/// The state of a run over one text.
struct Parser<'a> {
    cursor: Cursor<'a>,
    diagnostics: Vec<Diagnostic>,
    /// How many productions that nest stand open.
    nesting: usize,
    /// The height of the expression that was read last.
    height: usize,
    /// Whether the symbols of `ltl(…)` are in force.
    symbolic: bool,
    /// The first token of the statement.
    first: Span,
    /// The words that may go on with the statement.
    clauses: &'static [&'static str],
    /// A number directly after a comparison, the last that was read.
    bare_number: Option<Span>,
    /// Where the name in a formula that was read last ends.
    path_end: Option<u32>,
}

impl<'a> Parser<'a> {
    fn new(cursor: Cursor<'a>, diagnostics: Vec<Diagnostic>) -> Parser<'a> {
        let first = cursor.span();
        Parser {
            cursor,
            diagnostics,
            nesting: 0,
            height: 0,
            symbolic: false,
            first,
            clauses: &[],
            bare_number: None,
            path_end: None,
        }
    }

    /// Reports a fault that the production can go on after.
    fn report(&mut self, diagnostic: Diagnostic) -> Reported {
        self.diagnostics.push(diagnostic);
        Reported(())
    }

    /// Reports a fault that ends the production.
    fn fail<T>(&mut self, diagnostic: Diagnostic) -> Parse<T> {
        Err(self.report(diagnostic))
    }

    /// Runs a production that may hold itself, unless it stands too deep.
    fn nested<T>(&mut self, production: impl FnOnce(&mut Self) -> Parse<T>) -> Parse<T> {
        if self.nesting == MAX_NESTING {
            return self.too_deep(self.cursor.span());
        }
        self.nesting += 1;
        let result = production(self);
        self.nesting -= 1;
        result
    }

    fn too_deep<T>(&mut self, at: Span) -> Parse<T> {
        let what = "this formula is nested too deeply";
        let diagnostic = Diagnostic::new(lapwing_diag::Code::TooDeep, at, what);
        self.fail(diagnostic.help("give parts of it names of their own: `part = …`"))
    }
}
