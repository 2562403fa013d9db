//! Formulas as text, with no brackets but those they need and those that keep `and` and `or` apart.

use crate::ast::{Binary, Bound, Dur, Expr, ExprKind, Ident, Infix, Number, Prefix, Scope};
use crate::lexer::{is_name_part, is_name_start};
use crate::parser::{is_symbolic_operator, prefix_symbol};
use crate::{text, words};

/// A formula or expression on one line. Parsing it again gives the same tree, places and brackets aside.
///
/// ```
/// use lapwing_syntax::{FileId, ast::ItemKind, parse, print_expr};
///
/// let parsed = parse(FileId(0), "whenever ((cmd) > 0.03), (odom > -0.01)");
/// let ItemKind::Property(property) = &parsed.file.items[0].kind else { unreachable!() };
/// assert_eq!(print_expr(&property.body), "whenever cmd > 0.03, odom > -0.01");
/// ```
pub fn print_expr(expr: &Expr) -> String {
    let mut printer = Printer { out: String::new(), symbolic: false };
    printer.expr(expr, IFF, Follow::Nothing);
    printer.out
}

/// How tightly an expression binds; a tighter one stands in a looser one without brackets.
type Rank = u8;

const IFF: Rank = 1;
const IMPLIES: Rank = 2;
const OR: Rank = 3;
const AND: Rank = 4;
const UNTIL: Rank = 5;
const UNARY: Rank = 6;
const COMPARISON: Rank = 7;
const SUM: Rank = 8;
const PRODUCT: Rank = 9;
const NEGATION: Rank = 10;
const POSTFIX: Rank = 11;
const PRIMARY: Rank = 12;

/// What follows an expression before the next closing bracket: a word that reaches far right would swallow it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Follow {
    Nothing,
    /// A comma. Only a scope would be hard to read before it.
    Comma,
    /// An operator.
    More,
}

struct Printer {
    out: String,
    /// Whether inside `ltl(…)`.
    symbolic: bool,
}

impl Printer {
    fn put(&mut self, text: &str) {
        self.out.push_str(text);
    }

    /// An expression where only those that bind at least as tightly as `least` may stand without brackets.
    fn expr(&mut self, expr: &Expr, least: Rank, follow: Follow) {
        if self.rank(&expr.kind) < least || self.swallows(&expr.kind, follow) {
            self.bracketed(expr);
        } else {
            self.bare(&expr.kind, follow);
        }
    }

    fn bracketed(&mut self, expr: &Expr) {
        self.put("(");
        self.bare(&expr.kind, Follow::Nothing);
        self.put(")");
    }

    /// Whether the expression would take in what follows it.
    fn swallows(&self, kind: &ExprKind, follow: Follow) -> bool {
        match kind {
            ExprKind::Prefix(..) => !self.symbolic && follow == Follow::More,
            ExprKind::Scope(..) | ExprKind::AfterUntil(..) => follow != Follow::Nothing,
            _ => false,
        }
    }

    fn rank(&self, kind: &ExprKind) -> Rank {
        match kind {
            ExprKind::Binary(operator, ..) | ExprKind::WithMargin(operator, ..) => rank_of(*operator),
            ExprKind::Infix(..) => UNTIL,
            ExprKind::Not(_) | ExprKind::Prefix(..) | ExprKind::Held(..) => UNARY,
            ExprKind::Scope(..) | ExprKind::AfterUntil(..) => UNARY,
            ExprKind::Lambda(..) => IFF,
            ExprKind::Neg(_) => NEGATION,
            ExprKind::Field(..) | ExprKind::Index(..) => POSTFIX,
            _ => PRIMARY,
        }
    }

    fn bare(&mut self, kind: &ExprKind, follow: Follow) {
        match kind {
            ExprKind::Number(number) => self.number(number),
            ExprKind::Str(string) => self.put(&text::encode(string)),
            ExprKind::Bool(value) => self.put(if *value { "true" } else { "false" }),
            ExprKind::Path(names) => self.path(names),
            ExprKind::Topic(topic) => self.put(&topic.name),
            ExprKind::Field(value, name) => self.field(value, name),
            ExprKind::Index(value, index) => {
                self.expr(value, POSTFIX, Follow::More);
                self.put(&format!("[{index}]"));
            }
            ExprKind::Call(function, arguments) => self.call(function, arguments),
            ExprKind::Lambda(variable, body) => {
                self.name(variable);
                self.put(" => ");
                self.expr(body, IFF, follow);
            }
            ExprKind::Lookback(value, depth) => {
                self.put("@{");
                self.expr(value, IFF, Follow::Comma);
                self.put(&format!(", -{depth}}}"));
            }
            ExprKind::Neg(value) => {
                self.put("-");
                self.expr(value, NEGATION, follow);
            }
            ExprKind::Not(operand) => {
                self.put(if self.symbolic { "!" } else { "not " });
                self.expr(operand, UNARY, follow);
            }
            ExprKind::Binary(operator, left, right) => self.binary(*operator, left, right, follow),
            ExprKind::WithMargin(operator, left, margin, right) => self.with_margin(*operator, left, margin, right),
            ExprKind::Prefix(prefix, bound, body) => self.prefix(*prefix, bound.as_ref(), body, follow),
            ExprKind::Infix(infix, bound, left, right) => self.infix(*infix, bound.as_ref(), left, right, follow),
            ExprKind::Held(duration, operand) => {
                self.put("held for ");
                self.duration(duration);
                self.put(" ");
                self.expr(operand, UNARY, follow);
            }
            ExprKind::Scope(scope, trigger, body) => self.scope(*scope, trigger, body),
            ExprKind::AfterUntil(opening, closing, body) => self.after_until(opening, closing, body),
            ExprKind::Ltl(formula) => self.ltl(formula),
            ExprKind::Error => self.put("…"),
        }
    }

    fn number(&mut self, number: &Number) {
        self.put(&number.text);
        if let Some(unit) = number.unit {
            self.put(" ");
            self.put(unit.name());
        }
    }

    /// A name where no word of the language can stand.
    fn name(&mut self, name: &Ident) {
        if is_plain(&name.name) { self.put(&name.name) } else { self.put(&format!("`{}`", name.name)) }
    }

    /// A name at the beginning of an operand.
    fn head(&mut self, name: &Ident) {
        let word = name.name.as_str();
        // A line that begins with `since` would go on with the line before it; `for` behind `always` begins a bound.
        let operator = matches!(word, "since" | "for") || self.symbolic && is_symbolic_operator(word);
        if words::is_reserved(word) || operator { self.put(&format!("`{}`", name.name)) } else { self.name(name) }
    }

    fn path(&mut self, names: &[Ident]) {
        for (i, name) in names.iter().enumerate() {
            if i == 0 {
                self.head(name);
            } else {
                self.put(".");
                self.name(name);
            }
        }
    }

    /// `e.field`: a path or number before the dot needs brackets, or the field would belong to it.
    fn field(&mut self, value: &Expr, name: &Ident) {
        match value.kind {
            ExprKind::Path(_) | ExprKind::Number(_) => self.bracketed(value),
            _ => self.expr(value, POSTFIX, Follow::More),
        }
        self.put(".");
        self.name(name);
    }

    fn call(&mut self, function: &Ident, arguments: &[Expr]) {
        if function.name == "ltl" {
            self.put("`ltl`")
        } else {
            self.head(function)
        }
        let symbolic = std::mem::replace(&mut self.symbolic, false);
        self.put("(");
        for (i, argument) in arguments.iter().enumerate() {
            self.put(if i > 0 { ", " } else { "" });
            self.expr(argument, IFF, if arguments.len() > 1 { Follow::Comma } else { Follow::Nothing });
        }
        self.put(")");
        self.symbolic = symbolic;
    }

    fn binary(&mut self, operator: Binary, left: &Expr, right: &Expr, follow: Follow) {
        let (left_least, right_least) = sides(operator);
        self.side(operator, left, left_least, Follow::More);
        self.put(" ");
        self.put(self.spelling(operator));
        self.put(" ");
        self.side(operator, right, right_least, follow);
    }

    /// One side of an operator. An `and` beside an `or` stands in brackets, though it binds tighter.
    fn side(&mut self, operator: Binary, side: &Expr, least: Rank, follow: Follow) {
        let mixed = operator == Binary::Or && matches!(side.kind, ExprKind::Binary(Binary::And, ..));
        if mixed { self.bracketed(side) } else { self.expr(side, least, follow) }
    }

    fn with_margin(&mut self, operator: Binary, left: &Expr, margin: &Expr, right: &Expr) {
        self.expr(left, SUM, Follow::More);
        self.put(&format!(" {}{{", self.spelling(operator)));
        self.expr(margin, SUM, Follow::Nothing);
        self.put("} ");
        self.expr(right, SUM, Follow::More);
    }

    fn spelling(&self, operator: Binary) -> &'static str {
        match operator {
            Binary::Add => "+",
            Binary::Sub => "-",
            Binary::Mul => "*",
            Binary::Div => "/",
            Binary::Eq => "==",
            Binary::Ne => "!=",
            Binary::Lt => "<",
            Binary::Le => "<=",
            Binary::Gt => ">",
            Binary::Ge => ">=",
            Binary::And => "and",
            Binary::Or => "or",
            Binary::Implies if self.symbolic => "=>",
            Binary::Implies => "implies",
            Binary::Iff if self.symbolic => "<=>",
            Binary::Iff => "iff",
        }
    }

    fn prefix(&mut self, prefix: Prefix, bound: Option<&Bound>, body: &Expr, follow: Follow) {
        if let (true, Some(symbol)) = (self.symbolic, prefix_symbol(prefix)) {
            self.put(symbol);
            self.put(" ");
            return self.expr(body, UNARY, follow);
        }
        self.put(words::spelling(words::PREFIXES, prefix));
        self.put(" ");
        self.bound(bound);
        self.expr(body, IFF, follow);
    }

    fn infix(&mut self, infix: Infix, bound: Option<&Bound>, left: &Expr, right: &Expr, follow: Follow) {
        let word = match (self.symbolic, infix) {
            (true, Infix::Until) => "U",
            (true, Infix::Since) => "S",
            (false, _) => words::spelling(words::INFIXES, infix),
        };
        let (left_least, right_least) = if self.symbolic { (UNARY, UNTIL) } else { (UNTIL, UNARY) };
        self.expr(left, left_least, Follow::More);
        self.put(&format!(" {word} "));
        self.bound(bound);
        self.expr(right, right_least, follow);
    }

    /// A bound and a blank behind it.
    fn bound(&mut self, bound: Option<&Bound>) {
        let Some(bound) = bound else { return };
        self.put("within ");
        if let Some(lo) = &bound.lo {
            self.put(if bound.lo_closed { "[" } else { "(" });
            self.duration(lo);
            self.put(", ");
            self.duration(&bound.hi);
            self.put(if bound.hi_closed { "]" } else { ")" });
        } else {
            self.duration(&bound.hi);
        }
        self.put(" ");
    }

    fn duration(&mut self, duration: &Dur) {
        match duration {
            Dur::Literal(duration, _) => self.put(&duration.to_string()),
            Dur::Name(name) => self.name(name),
        }
    }

    fn scope(&mut self, scope: Scope, trigger: &Expr, body: &Expr) {
        self.put(words::spelling(words::SCOPES, scope));
        self.put(" ");
        self.expr(trigger, IFF, Follow::Comma);
        self.put(", ");
        self.expr(body, IFF, Follow::Nothing);
    }

    fn after_until(&mut self, opening: &Expr, closing: &Expr, body: &Expr) {
        self.put("after_until ");
        self.expr(opening, IFF, Follow::Comma);
        self.put(", ");
        self.expr(closing, IFF, Follow::Comma);
        self.put(", ");
        self.expr(body, IFF, Follow::Nothing);
    }

    fn ltl(&mut self, formula: &Expr) {
        let symbolic = std::mem::replace(&mut self.symbolic, true);
        self.put("ltl(");
        self.expr(formula, IFF, Follow::Nothing);
        self.put(")");
        self.symbolic = symbolic;
    }
}

fn rank_of(operator: Binary) -> Rank {
    match operator {
        Binary::Iff => IFF,
        Binary::Implies => IMPLIES,
        Binary::Or => OR,
        Binary::And => AND,
        Binary::Eq | Binary::Ne | Binary::Lt | Binary::Le | Binary::Gt | Binary::Ge => COMPARISON,
        Binary::Add | Binary::Sub => SUM,
        Binary::Mul | Binary::Div => PRODUCT,
    }
}

/// How tightly the sides of an operator must bind to stand without brackets.
fn sides(operator: Binary) -> (Rank, Rank) {
    let rank = rank_of(operator);
    match operator {
        Binary::Implies => (rank + 1, rank),
        _ if rank == COMPARISON => (rank + 1, rank + 1),
        _ => (rank, rank + 1),
    }
}

/// Whether the name can stand without backquotes where no word of the language can.
fn is_plain(name: &str) -> bool {
    name.starts_with(is_name_start) && name.chars().all(is_name_part)
}
