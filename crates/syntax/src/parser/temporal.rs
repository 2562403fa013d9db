//! Temporal words before a formula, scopes, `not` and `held for`.

use super::connective::foreign_operator;
use super::{Parse, Parser, Tree};
use crate::ast::{Bound, ExprKind, Prefix, Scope};
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic};

impl Parser<'_> {
    /// `not`, a temporal word, a scope, or a comparison.
    pub(super) fn unary(&mut self) -> Parse<Tree> {
        if self.cursor.kind() == TokenKind::Bang {
            return self.foreign_not();
        }
        let Some(word) = self.cursor.word() else { return self.comparison() };
        if word == "held" && self.cursor.word_ahead(1) == Some("for") {
            return self.held();
        }
        if word != "not" && !words::is_temporal(word) {
            return self.comparison();
        }
        if self.reserved_word_as_name() {
            let diagnostic = self.reserved("a name");
            return self.complain(diagnostic);
        }
        match word {
            "not" => self.not(),
            words::AFTER_UNTIL => self.after_until(),
            _ => match (words::find(words::PREFIXES, word), words::find(words::SCOPES, word)) {
                (Some(prefix), _) => self.prefix(prefix),
                (_, Some(scope)) => self.scope(scope),
                _ => self.comparison(),
            },
        }
    }

    /// Whether the reserved word here is followed by what can only follow a name: `next.x`, `once == 3`.
    fn reserved_word_as_name(&self) -> bool {
        use TokenKind::*;
        matches!(
            self.cursor.ahead(1),
            Dot | EqualEqual
                | NotEqual
                | LessEqual
                | Greater
                | GreaterEqual
                | Equals
                | Plus
                | Star
                | CloseRound
                | Comma
        )
    }

    fn not(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        self.cursor.bump_joining(Role::Keyword);
        let operand = self.nested(Self::unary)?;
        self.node(start, ExprKind::Not(operand))
    }

    /// `!x`, which is reported and read as `not x`.
    fn foreign_not(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let diagnostic = foreign_operator(self.cursor.span(), "!", "not").fix(self.cursor.span(), "not ");
        self.report(diagnostic);
        self.cursor.bump_joining(Role::Operator);
        let operand = self.nested(Self::unary)?;
        self.node(start, ExprKind::Not(operand))
    }

    /// `always within 2 s φ`: reaches as far right as it can.
    fn prefix(&mut self, prefix: Prefix) -> Parse<Tree> {
        let start = self.cursor.position();
        self.cursor.bump_joining(Role::Keyword);
        let bound = self.bound(matches!(prefix, Prefix::Always | Prefix::Historically))?;
        if let Some(bound) = &bound {
            self.check_bound(prefix, bound);
        }
        self.check_for(prefix)?;
        let operand = self.formula()?;
        self.node(start, ExprKind::Prefix(prefix, bound, operand))
    }

    /// Only some words take a bound.
    fn check_bound(&mut self, prefix: Prefix, bound: &Bound) {
        let word = words::spelling(words::PREFIXES, prefix);
        let help = match prefix {
            Prefix::Always | Prefix::Eventually | Prefix::Once | Prefix::Historically => return,
            Prefix::Never => "write `always within … not …`",
            Prefix::Next => "write `eventually within …`",
            _ => "write `once within …`",
        };
        let diagnostic = Diagnostic::new(Code::BoundNotAllowed, bound.span, format!("`{word}` takes no time bound"));
        self.report(diagnostic.help(help));
    }

    /// `for` after a word that knows only `within`, and `for each` inside a formula.
    fn check_for(&mut self, prefix: Prefix) -> Parse<()> {
        let duration = matches!(self.cursor.ahead(1), TokenKind::Number | TokenKind::Name | TokenKind::Quoted);
        if !self.cursor.at_word("for") || !duration || self.joining_word_ahead() {
            return Ok(());
        }
        if self.cursor.word_ahead(1) == Some("each") {
            let diagnostic = self.expectation("a formula");
            return self.fail(diagnostic.help("`for each … :` stands before the whole formula"));
        }
        let word = words::spelling(words::PREFIXES, prefix);
        let message = format!("`{word}` takes no `for`");
        let diagnostic = Diagnostic::new(Code::BoundNotAllowed, self.cursor.span(), message);
        self.fail(
            diagnostic.help("a time bound is written `within`; `for` follows `always`, `historically` and `held`"),
        )
    }

    /// Whether the next word joins formulas: then the current one is a name.
    pub(super) fn joining_word_ahead(&self) -> bool {
        self.cursor.word_ahead(1).is_some_and(|next| words::joining_words().any(|word| word == next))
    }

    /// `held for d φ`: binds as `not` does.
    fn held(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        self.word("held")?;
        self.word("for")?;
        let duration = self.duration()?;
        let operand = self.nested(Self::unary)?;
        self.node(start, ExprKind::Held(duration, operand))
    }

    /// `after X, φ`
    fn scope(&mut self, scope: Scope) -> Parse<Tree> {
        let start = self.cursor.position();
        let word = words::spelling(words::SCOPES, scope);
        self.cursor.bump_joining(Role::Keyword);
        self.no_bound(word)?;
        let trigger = self.formula()?;
        let height = self.height;
        self.scope_comma(word)?;
        let body = self.formula()?;
        self.join(height, start, ExprKind::Scope(scope, trigger, body))
    }

    /// `after_until X, Y, φ`
    fn after_until(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let word = words::AFTER_UNTIL;
        self.cursor.bump_joining(Role::Keyword);
        self.no_bound(word)?;
        let opening = self.formula()?;
        let height = self.height;
        self.scope_comma(word)?;
        let closing = self.formula()?;
        let height = height.max(self.height);
        self.scope_comma(word)?;
        let body = self.formula()?;
        self.join(height, start, ExprKind::AfterUntil(opening, closing, body))
    }

    /// Scopes take no bound.
    fn no_bound(&mut self, word: &str) -> Parse<()> {
        if !self.cursor.at_word("within") {
            return Ok(());
        }
        let diagnostic =
            Diagnostic::new(Code::BoundNotAllowed, self.cursor.span(), format!("`{word}` takes no time bound"));
        self.fail(diagnostic.help(format!("bound the formula inside it: `{word} X, eventually within 2 s …`")))
    }

    /// The comma between two parts of a scope. Where it is missing and a formula follows, it is reported and read into it.
    fn scope_comma(&mut self, word: &str) -> Parse<()> {
        if self.eat(TokenKind::Comma) {
            return Ok(());
        }
        let leftover = self.leftover_diagnostic(&format!("a comma and the next part of `{word}`"));
        if leftover.code != Code::Syntax || self.at_bound() || !self.at_operand() {
            return self.complain(leftover);
        }
        let after = self.cursor.behind_previous();
        let next = self.cursor.slice(self.cursor.span()).to_owned();
        let diagnostic = Diagnostic::new(Code::MissingComma, after, format!("a comma is missing before `{next}`"));
        self.report(diagnostic.label(format!("the parts of `{word}` are separated by commas")).fix(after, ","));
        Ok(())
    }

    /// Whether a formula may begin here.
    fn at_operand(&self) -> bool {
        use TokenKind::*;
        matches!(self.cursor.kind(), Name | Quoted | Number | Text | OpenRound | At)
    }
}
