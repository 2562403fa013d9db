//! Printing a formula and parsing it again gives the same formula, for many random ones.

mod common;

use common::{Random, formula, sexpr};
use lapwing_diag::Span;
use lapwing_stream::Duration;
use lapwing_syntax::ast::{Binary, Bound, Dur, Expr, ExprKind, Ident, Infix, Number, Prefix, Scope, Topic, Unit};
use lapwing_syntax::{format, print_expr};

const NAMES: &[&str] =
    &["a", "b", "x1", "next", "o", "U", "since", "and", "within", "held", "ltl", "stop sign", "é", "for"];

/// Makes random trees of the kind the parser makes.
struct Generator {
    random: Random,
}

impl Generator {
    fn ident(&mut self) -> Ident {
        Ident { name: self.random.pick(NAMES).to_owned(), span: Span::default() }
    }

    fn boxed(&mut self, depth: usize) -> Box<Expr> {
        Box::new(self.expr(depth))
    }

    fn expr(&mut self, depth: usize) -> Expr {
        let kind = if depth == 0 { self.leaf() } else { self.inner(depth - 1) };
        Expr { kind, span: Span::default(), parens: false }
    }

    fn leaf(&mut self) -> ExprKind {
        match self.random.below(5) {
            0 => ExprKind::Number(self.number()),
            1 => ExprKind::Str(self.random.pick(&["", "text", "\"quoted\"\n\\ é🤖\u{1}"]).to_owned()),
            2 => ExprKind::Bool(self.random.below(2) == 0),
            _ => ExprKind::Path((0..=self.random.below(3)).map(|_| self.ident()).collect()),
        }
    }

    fn number(&mut self) -> Number {
        let text = self.random.pick(&["0", "2", "2.50", "1e-6", "3E+2"]).to_owned();
        let unit = if self.random.below(2) == 0 { None } else { Some(self.random.pick(Unit::ALL)) };
        // No duration is shorter than a nanosecond.
        let unit = unit.filter(|unit| text != "1e-6" || !matches!(unit, Unit::Ns | Unit::Us));
        Number { value: text.parse().unwrap(), text, unit, span: Span::default() }
    }

    fn inner(&mut self, depth: usize) -> ExprKind {
        match self.random.below(16) {
            0 => ExprKind::Field(self.boxed(depth), self.ident()),
            1 => ExprKind::Index(self.boxed(depth), self.random.below(9)),
            2 => ExprKind::Call(self.ident(), (0..self.random.below(3)).map(|_| self.argument(depth)).collect()),
            3 => ExprKind::Lookback(self.boxed(depth), self.random.below(9)),
            4 => ExprKind::Neg(self.boxed(depth)),
            5 => ExprKind::Not(self.boxed(depth)),
            6..=8 => ExprKind::Binary(self.binary(), self.boxed(depth), self.boxed(depth)),
            9 => ExprKind::WithMargin(self.comparison(), self.boxed(depth), self.boxed(depth), self.boxed(depth)),
            10 => self.prefix(depth),
            11 => ExprKind::Infix(self.infix(), self.bound(), self.boxed(depth), self.boxed(depth)),
            12 => ExprKind::Held(self.dur(), self.boxed(depth)),
            13 => ExprKind::Scope(self.scope(), self.boxed(depth), self.boxed(depth)),
            14 => ExprKind::AfterUntil(self.boxed(depth), self.boxed(depth), self.boxed(depth)),
            _ => ExprKind::Ltl(Box::new(self.symbolic(depth))),
        }
    }

    fn argument(&mut self, depth: usize) -> Expr {
        let kind = match self.random.below(4) {
            0 => ExprKind::Topic(Topic { name: "/robot1/scan".to_owned(), span: Span::default() }),
            1 => ExprKind::Lambda(self.ident(), self.boxed(depth)),
            _ => return self.expr(depth),
        };
        Expr { kind, span: Span::default(), parens: false }
    }

    fn binary(&mut self) -> Binary {
        use Binary::*;
        self.random.pick(&[Add, Sub, Mul, Div, And, Or, Implies, Iff, Eq, Ne, Lt, Le, Gt, Ge])
    }

    fn comparison(&mut self) -> Binary {
        use Binary::*;
        self.random.pick(&[Eq, Ne, Lt, Le, Gt, Ge])
    }

    fn infix(&mut self) -> Infix {
        self.random.pick(&[Infix::Until, Infix::Since])
    }

    fn scope(&mut self) -> Scope {
        self.random.pick(&[Scope::After, Scope::Until, Scope::Before, Scope::While, Scope::Whenever])
    }

    fn prefix(&mut self, depth: usize) -> ExprKind {
        use Prefix::*;
        let bounded = self.random.below(2) == 0;
        if bounded {
            let prefix = self.random.pick(&[Always, Eventually, Once, Historically]);
            return ExprKind::Prefix(prefix, self.bound(), self.boxed(depth));
        }
        let prefix = self.random.pick(&[Always, Never, Eventually, Next, Previously, Once, Historically, Becomes]);
        ExprKind::Prefix(prefix, None, self.boxed(depth))
    }

    fn bound(&mut self) -> Option<Bound> {
        let span = Span::default();
        match self.random.below(3) {
            0 => None,
            1 => Some(Bound { lo: None, lo_closed: true, hi: self.dur(), hi_closed: true, span }),
            _ => Some(Bound {
                lo: Some(self.dur()),
                lo_closed: self.random.below(2) == 0,
                hi: self.dur(),
                hi_closed: self.random.below(2) == 0,
                span,
            }),
        }
    }

    fn dur(&mut self) -> Dur {
        let literals = [0, 1, 1_000, 1_500_000, 999_999_999, 2_000_000_000, 90_000_000_000, i64::MAX];
        match self.random.below(3) {
            0 => Dur::Name(self.ident()),
            _ => Dur::Literal(Duration::from_nanos(self.random.pick(&literals)), Span::default()),
        }
    }

    /// A formula that the symbolic notation can say.
    fn symbolic(&mut self, depth: usize) -> Expr {
        let kind = if depth == 0 { self.leaf() } else { self.symbolic_inner(depth - 1) };
        Expr { kind, span: Span::default(), parens: false }
    }

    fn symbolic_inner(&mut self, depth: usize) -> ExprKind {
        use Prefix::*;
        let mut part = || Box::new(self.symbolic(depth));
        let (left, right) = (part(), part());
        match self.random.below(6) {
            0 => ExprKind::Not(left),
            1 => ExprKind::Prefix(
                self.random.pick(&[Always, Eventually, Next, Once, Historically, Previously]),
                None,
                left,
            ),
            2 => ExprKind::Infix(self.infix(), None, left, right),
            3 => ExprKind::Call(self.ident(), vec![self.argument(depth)]),
            _ => ExprKind::Binary(self.binary(), left, right),
        }
    }
}

#[test]
fn printed_formulas_parse_to_themselves() {
    let mut generator = Generator { random: Random(7) };
    for round in 0..20_000 {
        let expr = generator.expr(round % 6);
        let printed = print_expr(&expr);
        let again = formula(&format!("p: {printed}"));
        assert_eq!(sexpr(&again), sexpr(&expr), "{printed}");
        assert_eq!(print_expr(&again), printed);
    }
}

#[test]
fn printed_formulas_are_laid_out_canonically() {
    let mut generator = Generator { random: Random(8) };
    for round in 0..5_000 {
        let text = format!("p: {}\n", print_expr(&generator.expr(round % 6)));
        let formatted = format(&text).unwrap();
        // `o(…)`, `2 s` and their like are set one way by both.
        assert_eq!(formatted, text);
    }
}
