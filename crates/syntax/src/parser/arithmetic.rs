//! Comparisons, arithmetic and what they are made of.

use super::{Parse, Parser, Tree};
use crate::ast::{Binary, Expr, ExprKind, Ident};
use crate::token::{Role, TokenKind};
use crate::{text, words};
use lapwing_diag::{Code, Diagnostic};

impl Parser<'_> {
    /// `a`, `a < b`, `a =={m} b`; it does not chain.
    pub(super) fn comparison(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let left = self.sum()?;
        let Some(operator) = comparison_operator(self.cursor.kind()) else { return Ok(left) };
        let comparison = self.compared(start, left, operator)?;
        if comparison_operator(self.cursor.kind()).is_some() { self.chained(start) } else { Ok(comparison) }
    }

    /// The operator, its margin, the right side.
    fn compared(&mut self, start: usize, left: Tree, operator: Binary) -> Parse<Tree> {
        let height = self.height;
        let operator = self.check_equals(operator);
        self.cursor.bump_joining(Role::Operator);
        let margin = self.margin()?;
        let height = height.max(self.height);
        let right = self.right_side(operator)?;
        let kind = match margin {
            Some(margin) => ExprKind::WithMargin(operator, left, margin, right),
            None => ExprKind::Binary(operator, left, right),
        };
        self.join(height, start, kind)
    }

    /// What follows a comparison and its margin. A bare number behind `==` is remembered: another operand behind it makes it
    /// look like a margin without its brackets.
    fn right_side(&mut self, operator: Binary) -> Parse<Tree> {
        let first = self.cursor.position();
        let right = self.sum()?;
        let equality = matches!(operator, Binary::Eq | Binary::Ne);
        let bare = equality && matches!(right.kind, ExprKind::Number(_)) && self.cursor.position() == first + 1;
        self.bare_number = bare.then_some(right.span);
        Ok(right)
    }

    /// `=` in place of `==`, `=<` in place of `<=`: the operator that was meant, at its last token.
    fn check_equals(&mut self, operator: Binary) -> Binary {
        if self.cursor.kind() != TokenKind::Equals {
            return operator;
        }
        let span = self.cursor.span();
        let both = self.cursor.span_ahead(1);
        if self.cursor.ahead(1) == TokenKind::Less && self.cursor.slice(both) == "=<" {
            self.cursor.bump(Role::Operator);
            let diagnostic = Diagnostic::new(Code::ForeignOperator, both, "`=<` is written `<=` here");
            self.report(diagnostic.fix(both, "<="));
            return Binary::Le;
        }
        let diagnostic = Diagnostic::new(Code::SingleEquals, span, "`=` gives something a name; it does not compare");
        self.report(diagnostic.help("to compare, write `==`").fix(span, "=="));
        operator
    }

    /// `{0.05}`
    fn margin(&mut self) -> Parse<Option<Tree>> {
        if self.cursor.kind() != TokenKind::OpenCurly {
            self.height = 0;
            return Ok(None);
        }
        let start = self.cursor.position();
        self.cursor.glue();
        let margin = self.bracketed(TokenKind::OpenCurly, "`}` behind the margin", |p| {
            p.cursor.glue();
            let margin = p.sum();
            p.cursor.glue();
            margin
        })?;
        Ok(Some(margin.unwrap_or_else(|| self.error_expr(start))))
    }

    /// `a < b < c`
    fn chained(&mut self, start: usize) -> Parse<Tree> {
        let span = self.cursor.span();
        let whole = self.cursor.span_since(start);
        let diagnostic = Diagnostic::new(Code::ChainedComparison, span, "comparisons do not chain")
            .also(whole, "this is already a comparison")
            .help("write `a < b and b < c`");
        self.fail(diagnostic)
    }

    pub(super) fn sum(&mut self) -> Parse<Tree> {
        self.arithmetic(additive, Self::product)
    }

    fn product(&mut self) -> Parse<Tree> {
        self.arithmetic(multiplicative, Self::negation)
    }

    /// Operands joined by arithmetic operators of one rank, grouped to the left.
    fn arithmetic(
        &mut self,
        operator: fn(TokenKind) -> Option<Binary>,
        operand: fn(&mut Self) -> Parse<Tree>,
    ) -> Parse<Tree> {
        let start = self.cursor.position();
        let mut left = operand(self)?;
        while let Some(operator) = operator(self.cursor.kind()) {
            let height = self.height;
            self.cursor.bump_joining(Role::Operator);
            let right = operand(self)?;
            left = self.join(height, start, ExprKind::Binary(operator, left, right))?;
        }
        Ok(left)
    }

    fn negation(&mut self) -> Parse<Tree> {
        if self.cursor.kind() != TokenKind::Minus {
            return self.postfix();
        }
        let start = self.cursor.position();
        self.cursor.bump_joining(Role::Operator);
        self.cursor.glue();
        let operand = self.nested(Self::negation)?;
        self.node(start, ExprKind::Neg(operand))
    }

    /// `x.y`, `x[3]`
    fn postfix(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let mut value = self.primary()?;
        loop {
            match self.cursor.kind() {
                TokenKind::Dot => value = self.field(start, value)?,
                TokenKind::OpenSquare => {
                    let (index, _) = self.index()?;
                    value = self.node(start, ExprKind::Index(value, index))?;
                }
                _ => return Ok(value),
            }
        }
    }

    /// `.y`: one more component of a dotted name, or a field of another value.
    fn field(&mut self, start: usize, value: Tree) -> Parse<Tree> {
        self.cursor.bump(Role::Punctuation);
        let name = self.ident("a name after the dot")?;
        match value.kind {
            ExprKind::Path(mut names) if !value.parens => {
                self.path_end = Some(name.span.end);
                names.push(name);
                Ok(self.leaf(start, ExprKind::Path(names)))
            }
            _ => self.node(start, ExprKind::Field(value, name)),
        }
    }

    fn primary(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        match self.cursor.kind() {
            TokenKind::Number => {
                let number = self.number()?;
                self.check_shortest(&number);
                Ok(self.leaf(start, ExprKind::Number(number)))
            }
            TokenKind::Text => {
                let text = self.text()?;
                Ok(self.leaf(start, ExprKind::Str(text)))
            }
            TokenKind::Name => self.word_primary(),
            TokenKind::Quoted => self.named(),
            TokenKind::At => self.lookback(),
            TokenKind::OpenRound => self.parenthesized(),
            _ => self.no_operand(),
        }
    }

    /// What begins with a word: a constant, `ltl(…)`, `running C.A`, a name, a call.
    fn word_primary(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let word = self.cursor.word().unwrap_or("");
        match word {
            "true" | "false" => {
                self.cursor.bump(Role::Keyword);
                Ok(self.leaf(start, ExprKind::Bool(word == "true")))
            }
            "ltl" if self.cursor.ahead(1) == TokenKind::OpenRound => self.ltl(),
            "running" if self.cursor.word_ahead(1).is_some() && self.cursor.ahead(2) == TokenKind::Dot => {
                self.running()
            }
            _ if self.symbolic && is_symbolic_operator(word) => self.symbolic_name(word),
            _ if words::is_reserved(word) && !self.names_operand(word) => self.misplaced_word(word),
            _ => self.named(),
        }
    }

    /// Whether a word that begins no operand is a name here: `within > 1`. Where an operand follows it was meant to join or bound.
    fn names_operand(&self, word: &str) -> bool {
        use TokenKind::*;
        let operand_follows = match self.cursor.ahead(1) {
            Name => !self.joining_word_ahead(),
            Quoted | Number | Text | At | OpenRound | OpenSquare | Bang => true,
            Less => self.symbolic,
            _ => false,
        };
        words::begins_nothing(word) && !operand_follows
    }

    /// `running Navigation.GotoPosition`: as `running(Navigation.GotoPosition)`.
    fn running(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let function = self.ident_as(Role::Keyword, "`running`")?;
        let argument = self.cursor.position();
        let activity = self.dotted("an activity, as in `Navigation.GotoPosition`")?;
        let activity = self.leaf(argument, ExprKind::Path(activity));
        self.node(start, ExprKind::Call(function, vec![*activity]))
    }

    /// A name, or a call of a function or pattern.
    fn named(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        let calls = self.cursor.ahead(1) == TokenKind::OpenRound;
        let name = self.ident_as(if calls { Role::Function } else { Role::Name }, "a name")?;
        if calls {
            return self.call(start, name);
        }
        self.path_end = Some(name.span.end);
        Ok(self.leaf(start, ExprKind::Path(vec![name])))
    }

    fn call(&mut self, start: usize, function: Ident) -> Parse<Tree> {
        self.cursor.glue();
        let symbolic = std::mem::replace(&mut self.symbolic, false);
        let arguments = self.bracketed(TokenKind::OpenRound, "an operator, a comma or `)`", Self::arguments);
        self.symbolic = symbolic;
        match arguments? {
            Some(arguments) => self.node(start, ExprKind::Call(function, arguments)),
            None => Ok(self.error_expr(start)),
        }
    }

    fn arguments(&mut self) -> Parse<Vec<Expr>> {
        if self.cursor.kind() == TokenKind::CloseRound {
            self.height = 0;
            return Ok(Vec::new());
        }
        let mut height = 0;
        let arguments = self.comma_separated(|p| {
            let argument = p.argument();
            height = p.height.max(height);
            argument.map(|argument| *argument)
        });
        self.height = height;
        arguments
    }

    /// A topic, `v => …`, or any formula.
    fn argument(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        match self.cursor.kind() {
            TokenKind::Slash => {
                let topic = self.topic_template("a topic")?;
                Ok(self.leaf(start, ExprKind::Topic(topic)))
            }
            TokenKind::Name | TokenKind::Quoted if self.cursor.ahead(1) == TokenKind::FatArrow => {
                let variable = self.ident("a name")?;
                self.token(TokenKind::FatArrow, "`=>`")?;
                let body = self.formula()?;
                self.node(start, ExprKind::Lambda(variable, body))
            }
            _ => self.formula(),
        }
    }

    /// `@{x, -3}`
    fn lookback(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        self.cursor.bump(Role::Operator);
        self.cursor.glue();
        let read = self.bracketed(TokenKind::OpenCurly, "`}`, as in `@{x, -3}`", |p| {
            p.cursor.glue();
            let value = p.formula()?;
            let height = p.height;
            p.token(TokenKind::Comma, "a comma and how many instants ago, as in `@{x, -3}`")?;
            let depth = p.depth()?;
            p.height = height;
            p.cursor.glue();
            Ok((value, depth))
        })?;
        match read {
            Some((value, depth)) => self.node(start, ExprKind::Lookback(value, depth)),
            None => Ok(self.error_expr(start)),
        }
    }

    /// `-3`: how many instants ago.
    fn depth(&mut self) -> Parse<usize> {
        if self.cursor.kind() == TokenKind::Number {
            let span = self.cursor.span();
            let written = self.cursor.slice(span);
            let diagnostic = Diagnostic::new(Code::Syntax, span, "only earlier instants can be looked back to");
            return self.fail(diagnostic.help(format!("write `-{written}`")).fix(span, format!("-{written}")));
        }
        self.token(TokenKind::Minus, "how many instants ago, as in `-3`")?;
        self.cursor.glue();
        self.integer("a whole number of instants")
    }

    fn parenthesized(&mut self) -> Parse<Tree> {
        let start = self.cursor.position();
        if let Some(symbol) = self.symbol_outside_ltl() {
            return self.fail(symbol);
        }
        let inner = self.bracketed(TokenKind::OpenRound, "an operator or `)`", Self::formula)?;
        let mut inner = inner.unwrap_or_else(|| self.error_expr(start));
        inner.parens = true;
        Ok(inner)
    }

    /// A string; its escapes are JSON's.
    pub(super) fn text(&mut self) -> Parse<String> {
        if self.cursor.kind() != TokenKind::Text {
            return self.expected("a text in quotation marks");
        }
        let span = self.cursor.bump(Role::Text);
        let (decoded, faults) = text::decode(self.cursor.slice(span));
        for (range, message) in faults {
            let start = span.start as usize;
            let at = lapwing_diag::Span::new(self.cursor.file, start + range.start, start + range.end);
            let help = "the escapes are those of JSON: `\\\" \\\\ \\/ \\b \\f \\n \\r \\t \\u0041`";
            self.report(Diagnostic::new(Code::BadText, at, message).help(help));
        }
        Ok(decoded)
    }

    /// A word that cannot stand where a value is expected.
    fn misplaced_word(&mut self, word: &str) -> Parse<Tree> {
        let span = self.cursor.span();
        let own_brackets = words::is_temporal(word) || word == "not";
        if self.cursor.begins_line() || !own_brackets {
            return self.no_operand();
        }
        let message = format!("`{word} …` stands in brackets where a value is expected");
        let report = Diagnostic::new(Code::Syntax, span, message).help(format!("write `({word} …)`"));
        self.report(report);
        self.nested(Self::unary)
    }

    /// Neither a value nor a formula stands here.
    fn no_operand(&mut self) -> Parse<Tree> {
        let diagnostic = self.no_operand_diagnostic();
        self.complain(diagnostic)
    }

    fn no_operand_diagnostic(&self) -> Diagnostic {
        let span = self.cursor.span();
        let expectation = self.expectation("a value or a formula");
        let previous = self.cursor.previous_token();
        if self.cursor.kind() == TokenKind::End {
            let help = "a formula goes on in the next line inside brackets, after a comma and after an operator";
            return if self.cursor.at_end() { expectation } else { expectation.help(help) };
        }
        if self.cursor.begins_line() && self.first != span {
            return self.expectation_before_line("a value or a formula");
        }
        if let Some(symbol) = self.symbol_outside_ltl() {
            return symbol;
        }
        match (self.cursor.kind(), self.cursor.ahead(1)) {
            (TokenKind::Slash, TokenKind::Slash) => expectation.help("a comment begins with `#`"),
            (TokenKind::Slash, _) if previous.is_some_and(|t| t.kind == TokenKind::Slash) => {
                expectation.help("a comment begins with `#`")
            }
            (TokenKind::Slash, _) => expectation.help(
                "a topic stands only in brackets, as in `age(/scan)`; a field of its messages gets a name by `decl`",
            ),
            (TokenKind::Name, _) if self.cursor.at_word("within") => expectation
                .help("a time bound follows `always`, `eventually`, `until`, `once`, `historically` or `since`"),
            (TokenKind::Name, _) => self.nothing_before(),
            _ => expectation,
        }
    }

    /// A symbol of `ltl(…)` outside it.
    fn symbol_outside_ltl(&self) -> Option<Diagnostic> {
        let (symbol, word, more) = match (self.cursor.kind(), self.cursor.ahead(1)) {
            _ if self.symbolic => return None,
            (TokenKind::OpenSquare, TokenKind::CloseSquare) => ("[]", "always", 1),
            (TokenKind::OpenSquare, TokenKind::Star) => ("[*]", "historically", 2),
            (TokenKind::Less, TokenKind::Greater) => ("<>", "eventually", 1),
            (TokenKind::Less, TokenKind::Star) => ("<*>", "once", 2),
            (TokenKind::OpenRound, TokenKind::Star) => ("(*)", "previously", 2),
            _ => return None,
        };
        let message = format!("`{symbol}` is understood inside `ltl(…)` only");
        let diagnostic = Diagnostic::new(Code::LtlNotation, self.cursor.span_ahead(more), message);
        Some(diagnostic.help(format!("write `{word}`, or put the formula into `ltl(…)`")))
    }

    /// A connective without its left side, or another reserved word.
    fn nothing_before(&self) -> Diagnostic {
        let span = self.cursor.span();
        let word = self.cursor.slice(span);
        if words::joining_words().any(|w| w == word) && self.first == span {
            return Diagnostic::new(
                Code::Syntax,
                span,
                format!("there is nothing before this `{word}` that it could join"),
            );
        }
        self.reserved("a value").label("expected a value or a formula here")
    }
}

/// The names that are operators inside `ltl(…)`.
pub(crate) fn is_symbolic_operator(word: &str) -> bool {
    matches!(word, "o" | "X" | "U" | "S")
}

fn comparison_operator(kind: TokenKind) -> Option<Binary> {
    Some(match kind {
        TokenKind::EqualEqual | TokenKind::Equals => Binary::Eq,
        TokenKind::NotEqual => Binary::Ne,
        TokenKind::Less => Binary::Lt,
        TokenKind::LessEqual => Binary::Le,
        TokenKind::Greater => Binary::Gt,
        TokenKind::GreaterEqual => Binary::Ge,
        _ => return None,
    })
}

fn additive(kind: TokenKind) -> Option<Binary> {
    match kind {
        TokenKind::Plus => Some(Binary::Add),
        TokenKind::Minus => Some(Binary::Sub),
        _ => None,
    }
}

fn multiplicative(kind: TokenKind) -> Option<Binary> {
    match kind {
        TokenKind::Star => Some(Binary::Mul),
        TokenKind::Slash => Some(Binary::Div),
        _ => None,
    }
}
