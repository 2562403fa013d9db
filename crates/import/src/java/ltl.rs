//! JavaMOP's linear temporal logic.
//!
//! Future `[] <> o U`, past `[*] <*> (*) S`, and the connectives in all the spellings that JavaMOP knows. Unary operators bind tightest, then `U S`,
//! `and`, `xor`, `or`, `=>`, `<=>`; `U S =>` group to the right.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{Binary, Expr, ExprKind, Infix, Prefix};

use super::cursor::Cursor;
use crate::{Report, expr};
use lapwing_diag::suggest::{nearest, or_else};

/// Formulas nest no deeper.
const MOST_DEPTH: usize = 40;
/// Formulas have no more connectives.
const MOST_CONNECTIVES: usize = 100;

const UNARY: &[(&[&str], Prefix)] = &[
    (&["[", "]"], Prefix::Always),
    (&["<", ">"], Prefix::Eventually),
    (&["<", "*", ">"], Prefix::Once),
    (&["[", "*", "]"], Prefix::Historically),
    (&["(", "*", ")"], Prefix::Previously),
    (&["o"], Prefix::Next),
    (&["X"], Prefix::Next),
];

/// The events that a formula may name.
pub(super) struct Alphabet<'a> {
    /// What stands for an event.
    pub event: &'a dyn Fn(&str) -> Option<Expr>,
    pub names: Vec<&'a str>,
}

/// Reads a whole formula; `None` where something is wrong with it, which is reported.
pub(super) fn read(mut cursor: Cursor<'_>, alphabet: &Alphabet<'_>, report: &mut Report) -> Option<Expr> {
    let mut reader = Reader { alphabet, report, depth: 0, connectives: 0 };
    let formula = reader.iff(&mut cursor)?;
    if !cursor.is_end() {
        return reader.wrong(&cursor, "an operator or the end of the formula");
    }
    Some(formula)
}

struct Reader<'r, 'a> {
    alphabet: &'r Alphabet<'a>,
    report: &'r mut Report,
    depth: usize,
    connectives: usize,
}

impl Reader<'_, '_> {
    fn wrong<T>(&mut self, cursor: &Cursor<'_>, expected: &str) -> Option<T> {
        let place = cursor.place();
        let found = match cursor.peek(0) {
            "" => "its end".to_owned(),
            word => format!("`{}`", word.chars().take(40).collect::<String>()),
        };
        let span = self.report.span(place.start, place.end);
        let message = format!("in the formula, expected {expected}, found {found}");
        self.report.push(Diagnostic::new(Code::ImportSyntax, span, message).label("the property is left out"));
        None
    }

    /// Counts a connective, if one of these stands here.
    fn eat(&mut self, cursor: &mut Cursor<'_>, spellings: &[&[&str]]) -> Option<bool> {
        let there = spellings.iter().any(|signs| cursor.eat(signs));
        self.connectives += usize::from(there);
        if self.connectives > MOST_CONNECTIVES {
            return self.wrong(cursor, &format!("no more than {MOST_CONNECTIVES} connectives"));
        }
        Some(there)
    }

    fn iff(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        let mut left = self.implication(cursor)?;
        while self.eat(cursor, &[&["<", "=", ">"], &["<", "-", ">"], &["iff"]])? {
            let right = self.implication(cursor)?;
            left = expr::binary(Binary::Iff, left, right);
        }
        Some(left)
    }

    fn implication(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        let left = self.or(cursor)?;
        if !self.eat(cursor, &[&["=", ">"], &["-", ">"], &["implies"]])? {
            return Some(left);
        }
        let right = self.deeper(cursor, Self::implication)?;
        Some(expr::binary(Binary::Implies, left, right))
    }

    fn or(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        let mut left = self.xor(cursor)?;
        while self.eat(cursor, &[&["|", "|"], &["or"], &["\\", "/"], &["|"]])? {
            let right = self.xor(cursor)?;
            left = expr::binary(Binary::Or, left, right);
        }
        Some(left)
    }

    fn xor(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        let mut left = self.and(cursor)?;
        while self.eat(cursor, &[&["xor"], &["^"], &["+", "+"]])? {
            let right = self.and(cursor)?;
            left = expr::not(expr::binary(Binary::Iff, left, right));
        }
        Some(left)
    }

    fn and(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        let mut left = self.until(cursor)?;
        while self.eat(cursor, &[&["&", "&"], &["and"], &["/", "\\"], &["&"]])? {
            let right = self.until(cursor)?;
            left = expr::and(left, right);
        }
        Some(left)
    }

    fn until(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        let left = self.unary(cursor)?;
        let infix = match cursor.peek(0) {
            "U" => Infix::Until,
            "S" => Infix::Since,
            _ => return Some(left),
        };
        cursor.next();
        let right = self.deeper(cursor, Self::until)?;
        Some(expr::infix(infix, left, right))
    }

    fn unary(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        if cursor.eat(&["!"]) || cursor.eat(&["not"]) || cursor.eat(&["~"]) {
            return self.deeper(cursor, Self::unary).map(expr::not);
        }
        // An event may be called `o`: it is one where nothing follows that could be its operand.
        let is_event = |c: &Cursor<'_>| matches!(c.peek(0), "o" | "X") && (self.alphabet.event)(c.peek(0)).is_some();
        if !is_event(cursor)
            && let Some((_, prefix)) = UNARY.iter().find(|(signs, _)| cursor.eat(signs))
        {
            return self.deeper(cursor, Self::unary).map(|of| expr::prefix(*prefix, of));
        }
        self.primary(cursor)
    }

    fn deeper(
        &mut self,
        cursor: &mut Cursor<'_>,
        read: fn(&mut Self, &mut Cursor<'_>) -> Option<Expr>,
    ) -> Option<Expr> {
        if self.depth == MOST_DEPTH {
            return self.wrong(cursor, "a formula that is not nested as deeply");
        }
        self.depth += 1;
        let read = read(self, cursor);
        self.depth -= 1;
        read
    }

    fn primary(&mut self, cursor: &mut Cursor<'_>) -> Option<Expr> {
        if cursor.eat(&["("]) {
            let inner = self.deeper(cursor, Self::iff)?;
            return if cursor.eat(&[")"]) { Some(inner) } else { self.wrong(cursor, "`)` or an operator") };
        }
        let start = *cursor;
        let Some(name) = cursor.name() else { return self.wrong(&start, "an event or an operator") };
        match name.text.as_str() {
            "true" => return Some(expr::boolean(true)),
            "false" => return Some(expr::boolean(false)),
            _ => {}
        }
        if let Some(event) = (self.alphabet.event)(&name.text) {
            return Some(event);
        }
        let span = self.report.span(name.place.start, name.place.end);
        let guess = nearest(&name.text, self.alphabet.names.iter().copied());
        let or_else = or_else(guess);
        let message = format!("the monitor has no event `{}`{or_else}", name.text);
        self.report.push(Diagnostic::new(Code::ImportSyntax, span, message).label("the property is left out"));
        None
    }
}

/// Whether a formula says something about the future.
pub(super) fn has_future(e: &Expr) -> bool {
    let here = match &e.kind {
        ExprKind::Prefix(prefix, ..) => matches!(prefix, Prefix::Always | Prefix::Eventually | Prefix::Next),
        ExprKind::Infix(infix, ..) => *infix == Infix::Until,
        _ => false,
    };
    here || e.children().into_iter().any(has_future)
}

fn has_always(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Prefix(Prefix::Always, ..)) || e.children().into_iter().any(has_always)
}

/// A formula with what its author meant by it: where `[]` is left out, every event is meant.
pub(super) struct Everywhere {
    pub formula: Expr,
    /// Whether JavaMOP, which looks at the first event alone, would judge otherwise.
    pub differs: bool,
}

/// A conjunct that is about an event and its past, or that says what an event leads to, is asked at every event. `<>`, `o` and `U` at the top are asked
/// at the first, as in JavaMOP: "sometime" does not mean "again and again".
pub(super) fn everywhere(formula: Expr) -> Everywhere {
    if !has_future(&formula) {
        // A property about the past alone is asked at every position anyway.
        return Everywhere { formula, differs: true };
    }
    match formula.kind {
        ExprKind::Binary(Binary::And, left, right) => {
            let (left, right) = (conjunct(*left), conjunct(*right));
            Everywhere { formula: expr::and(left.formula, right.formula), differs: left.differs || right.differs }
        }
        _ => conjunct(formula),
    }
}

fn conjunct(formula: Expr) -> Everywhere {
    match &formula.kind {
        ExprKind::Binary(Binary::And, ..) if has_future(&formula) => everywhere(formula),
        ExprKind::Prefix(Prefix::Always | Prefix::Eventually | Prefix::Next, ..)
        | ExprKind::Infix(Infix::Until, ..) => Everywhere { formula, differs: false },
        _ if has_always(&formula) => Everywhere { formula, differs: false },
        _ => Everywhere { formula: expr::prefix(Prefix::Always, formula), differs: true },
    }
}

/// Whether a formula is true of every slice in which these events never occur: then no slice without them needs to be looked at.
pub(super) fn holds_without(formula: &Expr, events: &[String]) -> bool {
    known(formula, events) == Some(true)
}

/// What a formula comes to where the events do not occur; `None` where it depends on others.
fn known(e: &Expr, absent: &[String]) -> Option<bool> {
    let of = |e: &Expr| known(e, absent);
    match &e.kind {
        ExprKind::Bool(value) => Some(*value),
        ExprKind::Path(names) => names.first().filter(|n| absent.contains(&n.name)).map(|_| false),
        ExprKind::Ltl(of_it) => of(of_it),
        ExprKind::Not(of_it) => of(of_it).map(|v| !v),
        ExprKind::Binary(Binary::And, l, r) => match (of(l), of(r)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (Some(true), Some(true)) => Some(true),
            _ => None,
        },
        ExprKind::Binary(Binary::Or, l, r) => match (of(l), of(r)) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (Some(false), Some(false)) => Some(false),
            _ => None,
        },
        ExprKind::Binary(Binary::Implies, l, r) => match (of(l), of(r)) {
            (Some(false), _) | (_, Some(true)) => Some(true),
            (Some(true), Some(false)) => Some(false),
            _ => None,
        },
        // Over no position at all `always` is true, and the others are false: only one answer of each is sure.
        ExprKind::Prefix(Prefix::Always | Prefix::Historically, _, of_it) => of(of_it).filter(|v| *v),
        ExprKind::Prefix(_, _, of_it) => of(of_it).filter(|v| !*v),
        ExprKind::Infix(_, _, _, right) => of(right).filter(|v| !*v),
        _ => None,
    }
}
