//! The symbolic notation of linear temporal logic, inside `ltl(…)`.
//!
//! It gives the same nodes as the words do: `[] p` is `always p`. Unary operators bind tightest, then `U S`, `and`, `or`, `=>`,
//! `<=>`; `U S =>` group to the right.

use super::arithmetic::is_symbolic_operator;
use super::{Parse, Parser, Tree};
use crate::ast::{Binary, ExprKind, Infix, Prefix};
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic};

/// The unary operators that are made of several signs.
const SYMBOLS: &[(&[TokenKind], Prefix)] = &[
    (&[TokenKind::OpenSquare, TokenKind::CloseSquare], Prefix::Always),
    (&[TokenKind::Less, TokenKind::Greater], Prefix::Eventually),
    (&[TokenKind::Less, TokenKind::Star, TokenKind::Greater], Prefix::Once),
    (&[TokenKind::OpenSquare, TokenKind::Star, TokenKind::CloseSquare], Prefix::Historically),
    (&[TokenKind::OpenRound, TokenKind::Star, TokenKind::CloseRound], Prefix::Previously),
];

impl Parser<'_> {
    /// `ltl(…)`
    pub(super) fn ltl(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        self.cursor.bump(Role::Keyword);
        self.cursor.glue();
        let symbolic = std::mem::replace(&mut self.symbolic, true);
        let inner = self.bracketed(TokenKind::OpenRound, "an operator or `)`", Self::formula);
        self.symbolic = symbolic;
        match inner? {
            Some(inner) => self.node(start, ExprKind::Ltl(inner)),
            None => Ok(self.error_expr(start)),
        }
    }

    /// `<=>`
    pub(super) fn symbolic_iff(&mut self) -> Parse<Tree> {
        self.chain(Binary::Iff, Self::symbolic_implication)
    }

    /// `=>`, to the right.
    fn symbolic_implication(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let left = self.symbolic_disjunction()?;
        if !self.eat_connective(Binary::Implies) {
            return Ok(left);
        }
        let height = self.height;
        let right = self.nested(Self::symbolic_implication)?;
        self.join(height, start, ExprKind::Binary(Binary::Implies, left, right))
    }

    fn symbolic_disjunction(&mut self) -> Parse<Tree> {
        self.chain(Binary::Or, Self::symbolic_conjunction)
    }

    fn symbolic_conjunction(&mut self) -> Parse<Tree> {
        self.chain(Binary::And, Self::symbolic_until)
    }

    /// Passes over the connective, if it stands here; `->` and words are reported.
    pub(super) fn eat_symbol(&mut self, connective: Binary) -> bool {
        let kind = self.cursor.kind();
        let word = self.cursor.word();
        let (own, foreign) = match connective {
            Binary::And => (kind == TokenKind::DoubleAmpersand || word == Some("and"), kind == TokenKind::Ampersand),
            Binary::Or => (kind == TokenKind::BarBar || word == Some("or"), kind == TokenKind::Bar),
            Binary::Implies => (kind == TokenKind::FatArrow, kind == TokenKind::Arrow || word == Some("implies")),
            _ => (kind == TokenKind::BothWays, word == Some("iff")),
        };
        if foreign {
            self.report_word(symbol(connective));
        }
        if own || foreign {
            self.cursor.bump_joining(if word.is_some() { Role::Keyword } else { Role::Operator });
        }
        own || foreign
    }

    /// `U` and `S`, to the right.
    fn symbolic_until(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let left = self.symbolic_unary()?;
        let operator = match self.cursor.word() {
            Some("U" | "until") => Infix::Until,
            Some("S" | "since") => Infix::Since,
            _ => return Ok(left),
        };
        if self.cursor.word().is_some_and(|word| word.len() > 1) {
            self.report_word(if operator == Infix::Until { "U" } else { "S" });
        }
        let height = self.height;
        self.cursor.bump_joining(Role::Keyword);
        let right = self.nested(Self::symbolic_until)?;
        self.join(height, start, ExprKind::Infix(operator, None, left, right))
    }

    fn symbolic_unary(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        if self.cursor.kind() == TokenKind::Bang || self.cursor.at_word("not") {
            return self.symbolic_not();
        }
        let Some(prefix) = self.symbolic_prefix() else { return self.comparison() };
        let operand = self.nested(Self::symbolic_unary)?;
        self.node(start, ExprKind::Prefix(prefix, None, operand))
    }

    fn symbolic_not(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        if self.cursor.kind() == TokenKind::Bang {
            self.cursor.bump_joining(Role::Operator);
            self.cursor.glue();
        } else {
            self.cursor.bump_joining(Role::Keyword);
        }
        let operand = self.nested(Self::symbolic_unary)?;
        self.node(start, ExprKind::Not(operand))
    }

    /// Passes over a unary temporal operator, if one stands here: symbols, `o`, `X`, or a word (which is reported).
    fn symbolic_prefix(&mut self) -> Option<Prefix> {
        if let Some((signs, prefix)) = SYMBOLS.iter().find(|(signs, _)| self.at_signs(signs)) {
            for (i, _) in signs.iter().enumerate() {
                if i > 0 {
                    self.cursor.glue();
                }
                self.cursor.bump_joining(Role::Operator);
            }
            return Some(*prefix);
        }
        let word = self.cursor.word()?;
        if matches!(word, "o" | "X") {
            self.cursor.bump_joining(Role::Keyword);
            return Some(Prefix::Next);
        }
        let prefix = words::find(words::PREFIXES, word)?;
        self.report_word(prefix_symbol(prefix)?);
        self.cursor.bump_joining(Role::Keyword);
        Some(prefix)
    }

    fn at_signs(&self, signs: &[TokenKind]) -> bool {
        signs.iter().enumerate().all(|(i, sign)| self.cursor.ahead(i) == *sign)
    }

    /// A word or foreign symbol stands where `ltl(…)` has a symbol of its own.
    fn report_word(&mut self, symbol: &str) {
        let span = self.cursor.span();
        let message = format!("inside `ltl(…)`, `{}` is written `{symbol}`", self.cursor.slice(span));
        self.report(Diagnostic::new(Code::LtlNotation, span, message).fix(span, symbol));
    }

    /// One of `o X U S` stands where a name should.
    pub(super) fn symbolic_name(&mut self, word: &str) -> Parse<Tree> {
        debug_assert!(is_symbolic_operator(word));
        let message = format!("inside `ltl(…)`, `{word}` is an operator");
        let help = format!("a name that is spelt like it stands in backquotes: `` `{word}` ``");
        let diagnostic = Diagnostic::new(Code::LtlNotation, self.cursor.span(), message).help(help);
        self.fail(diagnostic.label("expected a value or a formula here"))
    }
}

/// How a connective is written inside `ltl(…)`.
fn symbol(connective: Binary) -> &'static str {
    match connective {
        Binary::And => "and",
        Binary::Or => "or",
        Binary::Implies => "=>",
        _ => "<=>",
    }
}

/// How a temporal word is written inside `ltl(…)`; `None` for those that have no symbol.
pub(crate) fn prefix_symbol(prefix: Prefix) -> Option<&'static str> {
    Some(match prefix {
        Prefix::Always => "[]",
        Prefix::Eventually => "<>",
        Prefix::Next => "o",
        Prefix::Once => "<*>",
        Prefix::Historically => "[*]",
        Prefix::Previously => "(*)",
        Prefix::Never | Prefix::Becomes => return None,
    })
}
