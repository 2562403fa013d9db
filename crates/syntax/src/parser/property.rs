//! Properties, definitions and patterns: what has a formula for a body.

use super::{Parse, Parser};
use crate::ast::{Definition, EachSet, Expr, ExprKind, ForEach, ItemKind, Pattern, Property};
use crate::token::{Role, TokenKind};
use lapwing_diag::{Code, Diagnostic};

impl Parser<'_> {
    /// What follows the word `property`.
    pub(super) fn property(&mut self) -> Parse<ItemKind> {
        if !self.at_name() {
            return self.expected("the property's name");
        }
        self.named_property()
    }

    /// `NAME: …`, `NAME over (a, b): …`
    pub(super) fn named_property(&mut self) -> Parse<ItemKind> {
        let start = self.cursor.position();
        let name = self.new_name()?;
        let over = self.over()?;
        if self.cursor.kind() == TokenKind::Equals {
            let diagnostic = self.expectation("`:` after the property's name").fix(self.cursor.span(), ":");
            return self.fail(diagnostic.help("write `property NAME: …`, or `NAME = …` without `property`"));
        }
        self.token(TokenKind::Colon, "`:` after the property's name")?;
        let (each, body) = self.body(start);
        Ok(ItemKind::Property(Property { name: Some(name), over, each, body }))
    }

    fn over(&mut self) -> Parse<Option<Vec<Expr>>> {
        if !self.eat_word("over") {
            return Ok(None);
        }
        let listed =
            self.bracketed(TokenKind::OpenRound, "a comma or `)`", |p| p.comma_separated(Parser::event_of_alphabet))?;
        listed.map(Some).ok_or(super::Reported(()))
    }

    /// `kick`, `entered(soccer.goto_ball)`
    fn event_of_alphabet(&mut self) -> Parse<Expr> {
        if self.cursor.ahead(1) == TokenKind::OpenRound {
            return self.formula().map(|tree| *tree);
        }
        let name = self.ident("the name of an event")?;
        let span = name.span;
        Ok(Expr { kind: ExprKind::Path(vec![name]), span, parens: false })
    }

    /// A formula on its own: a property called by its line.
    pub(super) fn bare_property(&mut self) -> Parse<ItemKind> {
        let start = self.cursor.position();
        let each = self.quantifiers()?;
        let body = self.formula();
        if each.is_empty() {
            return Ok(ItemKind::Property(Property { name: None, over: None, each, body: *body? }));
        }
        let body = self.or_rest(start, body, |p| p.error_expr(start));
        Ok(ItemKind::Property(Property { name: None, over: None, each, body: *body }))
    }

    /// `NAME = …`
    pub(super) fn definition(&mut self) -> Parse<ItemKind> {
        let start = self.cursor.position();
        let name = self.new_name()?;
        self.token(TokenKind::Equals, "`=`")?;
        let (each, body) = self.body(start);
        Ok(ItemKind::Definition(Definition { name, each, body }))
    }

    /// What follows the word `pattern`: `NAME(a, b): FORMULA`
    pub(super) fn pattern(&mut self) -> Parse<Pattern> {
        let start = self.cursor.position();
        let name = self.ident_as(Role::Function, "the pattern's name")?;
        self.cursor.glue();
        let params = self.name_list("the name of a parameter")?;
        self.token(TokenKind::Colon, "`:` after the pattern's parameters")?;
        let body = self.formula();
        let body = self.or_rest(start, body, |p| p.error_expr(start));
        Ok(Pattern { name, params, body: *body })
    }

    /// The quantifiers and the formula of a statement that begins at `start`: a fault in them does not undo its name.
    fn body(&mut self, start: usize) -> (Vec<ForEach>, Expr) {
        let read = self.quantifiers().and_then(|each| Ok((each, *self.formula()?)));
        self.or_rest(start, read, |p| (Vec::new(), *p.error_expr(start)))
    }

    /// `for each r in (a, b): for each …:`
    fn quantifiers(&mut self) -> Parse<Vec<ForEach>> {
        let mut each = Vec::new();
        while self.cursor.at_word("for") {
            each.push(self.quantifier()?);
        }
        Ok(each)
    }

    fn quantifier(&mut self) -> Parse<ForEach> {
        self.word("for")?;
        self.word("each")?;
        let var = self.ident("a name that stands for each of them")?;
        let set = self.set()?;
        self.token(TokenKind::Colon, "`:` before the formula")?;
        Ok(ForEach { var, set })
    }

    fn set(&mut self) -> Parse<EachSet> {
        if self.eat_word("of") {
            return self.values();
        }
        if !self.eat_word("in") {
            return self.expected("`in (a, b)`, `in topics /{r}/odom` or `of EVENT.field`");
        }
        if self.cursor.at_word("topics") {
            self.cursor.bump(Role::Keyword);
            return Ok(EachSet::Topics(self.topic_template("a topic, as in `/{r}/odom`")?));
        }
        if self.cursor.kind() != TokenKind::OpenRound {
            return self.expected("`(a, b)` or `topics /{r}/odom` after `in`");
        }
        self.name_list("a name").map(EachSet::List)
    }

    /// `EVENT.field`
    fn values(&mut self) -> Parse<EachSet> {
        let start = self.cursor.position();
        let mut names = self.dotted("an event and its field, as in `kick.robot`")?;
        if names.len() < 2 {
            let message = "`of` is followed by an event and one of its fields, as in `kick.robot`";
            let diagnostic = Diagnostic::new(Code::Syntax, self.cursor.span_since(start), message);
            return self.fail(diagnostic);
        }
        let event = names.remove(0);
        Ok(EachSet::Values(event, names))
    }
}
