//! Formulas: `iff`, `implies`, `or`, `and`, and the infix `until` and `since`; brackets of all kinds.

use super::{Parse, Parser, Tree};
use crate::ast::{Binary, Expr, ExprKind};
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic, Span};

impl Parser<'_> {
    /// A whole formula, in the notation that is in force.
    pub(super) fn formula(&mut self) -> Parse<Tree> {
        self.nested(|p| if p.symbolic { p.symbolic_iff() } else { p.iff() })
    }

    fn iff(&mut self) -> Parse<Tree> {
        self.chain(Binary::Iff, Self::implication)
    }

    /// `implies` groups to the right.
    fn implication(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let left = self.disjunction()?;
        if !self.eat_connective(Binary::Implies) {
            return Ok(left);
        }
        let height = self.height;
        let right = self.nested(Self::implication)?;
        self.join(height, start, ExprKind::Binary(Binary::Implies, left, right))
    }

    fn disjunction(&mut self) -> Parse<Tree> {
        self.chain(Binary::Or, Self::conjunction)
    }

    fn conjunction(&mut self) -> Parse<Tree> {
        self.chain(Binary::And, Self::until_since)
    }

    /// Operands joined by one connective, grouped to the left.
    pub(super) fn chain(&mut self, connective: Binary, operand: fn(&mut Self) -> Parse<Tree>) -> Parse<Tree> {
        let start = self.cursor.position();
        let mut left = operand(self)?;
        while self.eat_connective(connective) {
            let height = self.height;
            let right = operand(self)?;
            left = self.join(height, start, ExprKind::Binary(connective, left, right))?;
        }
        Ok(left)
    }

    /// `until` and `since`, with their bounds, grouped to the left.
    fn until_since(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let mut left = self.unary()?;
        while let Some(word) = self.cursor.word().and_then(|word| words::find(words::INFIXES, word)) {
            let height = self.height;
            self.cursor.bump_joining(Role::Keyword);
            let bound = self.bound(false)?;
            let right = self.unary()?;
            left = self.join(height, start, ExprKind::Infix(word, bound, left, right))?;
        }
        Ok(left)
    }

    /// Passes over the connective, if it stands here, also in the spelling of another language (which is reported).
    pub(super) fn eat_connective(&mut self, connective: Binary) -> bool {
        if self.symbolic {
            return self.eat_symbol(connective);
        }
        let word = connective_word(connective);
        if self.cursor.at_word(word) {
            self.cursor.bump_joining(Role::Keyword);
            return true;
        }
        let foreign = is_foreign(connective, self.cursor.kind());
        if foreign {
            let span = self.cursor.span();
            let diagnostic = foreign_operator(span, self.cursor.slice(span), word);
            self.report(diagnostic);
            self.cursor.bump_joining(Role::Operator);
        }
        foreign
    }

    /// A node of the tree above what was read last.
    pub(super) fn node(&mut self, start: usize, kind: ExprKind) -> Parse<Tree> {
        self.join(0, start, kind)
    }

    /// A node above what was read last and something of the given height.
    pub(super) fn join(&mut self, height: usize, start: usize, kind: ExprKind) -> Parse<Tree> {
        self.height = self.height.max(height) + 1;
        let span = self.cursor.span_since(start);
        if self.height > super::MAX_HEIGHT {
            return self.too_deep(span);
        }
        Ok(Box::new(Expr { kind, span, parens: false }))
    }

    /// A node with nothing below it.
    pub(super) fn leaf(&mut self, start: usize, kind: ExprKind) -> Tree {
        self.height = 1;
        Box::new(Expr { kind, span: self.cursor.span_since(start), parens: false })
    }

    /// What stands between two brackets; `rest` says what may follow it there. Behind a fault in them the parser goes on
    /// after the closing one (`None`); only a bracket that is never closed stops it.
    pub(super) fn bracketed<T>(
        &mut self,
        open: TokenKind,
        rest: &str,
        production: impl FnOnce(&mut Self) -> Parse<T>,
    ) -> Parse<Option<T>> {
        if self.cursor.kind() != open {
            return self.expected(if open == TokenKind::OpenRound { "`(`" } else { "`{`" });
        }
        let opening = self.cursor.span();
        let Some(inside) = self.cursor.enter() else { return self.unclosed() };
        let result = production(self).and_then(|value| match self.cursor.at_close(&inside) {
            true => Ok(value),
            false => Err(self.leftover(rest)),
        });
        let result = result.and_then(|value| self.check_close(open, opening, self.cursor.closes_with(&inside), value));
        self.cursor.leave(inside);
        Ok(result.ok())
    }

    /// Round and square brackets may close one another only in time bounds.
    fn check_close<T>(&mut self, open: TokenKind, opening: Span, close: TokenKind, value: T) -> Parse<T> {
        if closing(open) == close {
            return Ok(value);
        }
        let message = format!("`{}` is closed by {}", self.cursor.slice(opening), self.found());
        let span = self.cursor.span();
        self.fail(Diagnostic::new(Code::UnclosedBracket, span, message).also(opening, "opened here"))
    }

    /// One or more, with commas between.
    pub(super) fn comma_separated<T>(&mut self, mut production: impl FnMut(&mut Self) -> Parse<T>) -> Parse<Vec<T>> {
        let mut all = vec![production(self)?];
        while self.eat(TokenKind::Comma) {
            all.push(production(self)?);
        }
        Ok(all)
    }

    /// What stands for an expression that could not be read.
    pub(super) fn error_expr(&mut self, start: usize) -> Tree {
        self.leaf(start, ExprKind::Error)
    }
}

fn connective_word(connective: Binary) -> &'static str {
    match connective {
        Binary::And => "and",
        Binary::Or => "or",
        Binary::Implies => "implies",
        _ => "iff",
    }
}

/// Whether other languages write the connective so.
fn is_foreign(connective: Binary, kind: TokenKind) -> bool {
    use TokenKind::*;
    match connective {
        Binary::And => matches!(kind, DoubleAmpersand | Ampersand),
        Binary::Or => matches!(kind, BarBar | Bar),
        Binary::Implies => matches!(kind, Arrow | FatArrow),
        _ => kind == BothWays,
    }
}

/// What to say of an operator in the spelling of another language.
pub(super) fn foreign_operator(span: Span, written: &str, word: &str) -> Diagnostic {
    Diagnostic::new(Code::ForeignOperator, span, format!("`{written}` is written `{word}` here"))
        .help("the symbols of logic are understood inside `ltl(…)`")
        .fix(span, word)
}

fn closing(open: TokenKind) -> TokenKind {
    match open {
        TokenKind::OpenRound => TokenKind::CloseRound,
        TokenKind::OpenSquare => TokenKind::CloseSquare,
        _ => TokenKind::CloseCurly,
    }
}
