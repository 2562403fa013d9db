//! Conditions as Java, ECMAScript and UML's guards write them: names, literals, comparisons, `&& || !` and sums.
//!
//! A call, an index, an assignment is beyond a specification: the condition as a whole is refused then, with the place.

use std::ops::Range;

use lapwing_syntax::ast::{Binary, Expr, ExprKind};

use crate::expr;

/// Conditions nest no deeper.
const MOST_DEPTH: usize = 48;

/// Conditions have no more operators.
const MOST_OPERATORS: usize = 100;

/// How names in a condition are read.
pub(crate) struct Reading<'r> {
    /// What a name, its parts joined by dots, stands for; `None`: it stands for nothing that a specification sees.
    pub name: &'r dyn Fn(&[&str]) -> Option<Expr>,
    /// Whether a name that stands alone where a truth value is wanted is compared with `true` or `false`: an event's field is.
    pub compares_truths: bool,
}

/// Why a condition cannot be said, and where in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Refused {
    pub why: String,
    pub place: Range<usize>,
}

/// Reads a condition.
pub(crate) fn read(text: &str, reading: &Reading<'_>) -> Result<Expr, Refused> {
    let mut parser = Parser { text, at: 0, depth: 0, operators: 0, reading };
    let condition = parser.or()?;
    parser.blanks();
    if parser.at < text.len() {
        return Err(parser.unexpected());
    }
    Ok(parser.truth(condition))
}

/// A part of a condition. A name is set apart: what it becomes depends on where it stands.
enum Part {
    Name(Expr),
    Other(Expr),
}

impl Part {
    fn value(self) -> Expr {
        match self {
            Part::Name(e) | Part::Other(e) => e,
        }
    }
}

struct Parser<'p> {
    text: &'p str,
    at: usize,
    depth: usize,
    /// How many operators there were: each makes the tree higher.
    operators: usize,
    reading: &'p Reading<'p>,
}

const COMPARISONS: &[(&str, Binary)] = &[
    ("===", Binary::Eq),
    ("!==", Binary::Ne),
    ("==", Binary::Eq),
    ("!=", Binary::Ne),
    ("<=", Binary::Le),
    (">=", Binary::Ge),
    ("<", Binary::Lt),
    (">", Binary::Gt),
];

type Read = Result<Part, Refused>;

impl<'p> Parser<'p> {
    fn rest(&self) -> &'p str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn eat(&mut self, sign: &str) -> bool {
        self.blanks();
        let there = self.rest().starts_with(sign);
        self.at += if there { sign.len() } else { 0 };
        there
    }

    fn eat_word(&mut self, word: &str) -> bool {
        self.blanks();
        let goes_on = |c: char| c == '_' || c.is_alphanumeric();
        let there = self.rest().strip_prefix(word).is_some_and(|rest| !rest.starts_with(goes_on));
        self.at += if there { word.len() } else { 0 };
        there
    }

    fn refused<T>(&self, why: impl Into<String>, place: Range<usize>) -> Result<T, Refused> {
        Err(Refused { why: why.into(), place })
    }

    fn unexpected(&self) -> Refused {
        let found = self.rest().chars().next();
        let length = found.map_or(0, char::len_utf8);
        let why = found.map_or("it ends too early".to_owned(), |c| format!("`{c}` is not read in a condition"));
        Refused { why, place: self.at..self.at + length }
    }

    fn one_more(&mut self) -> Result<(), Refused> {
        self.operators += 1;
        if self.operators > MOST_OPERATORS { self.refused("it has too many parts", self.at..self.at) } else { Ok(()) }
    }

    /// A part where a truth value is wanted.
    fn truth(&self, part: Part) -> Expr {
        match part {
            Part::Name(e) if self.reading.compares_truths => expr::binary(Binary::Eq, e, expr::boolean(true)),
            part => part.value(),
        }
    }

    fn negated(&self, part: Part) -> Expr {
        match part {
            Part::Name(e) if self.reading.compares_truths => expr::binary(Binary::Eq, e, expr::boolean(false)),
            part => expr::not(part.value()),
        }
    }

    fn or(&mut self) -> Read {
        self.chain(&["||"], "or", Binary::Or, Self::and)
    }

    fn and(&mut self) -> Read {
        self.chain(&["&&"], "and", Binary::And, Self::comparison)
    }

    fn chain(&mut self, signs: &[&str], word: &str, operator: Binary, part: fn(&mut Self) -> Read) -> Read {
        let mut left = part(self)?;
        while signs.iter().any(|s| self.eat(s)) || self.eat_word(word) {
            self.one_more()?;
            let right = part(self)?;
            left = Part::Other(expr::binary(operator, self.truth(left), self.truth(right)));
        }
        Ok(left)
    }

    fn comparison(&mut self) -> Read {
        let left = self.sum()?;
        self.blanks();
        let Some((sign, operator)) = COMPARISONS.iter().find(|(sign, _)| self.rest().starts_with(sign)) else {
            return Ok(left);
        };
        self.at += sign.len();
        let right = self.sum()?;
        Ok(Part::Other(expr::binary(*operator, left.value(), right.value())))
    }

    fn sum(&mut self) -> Read {
        self.arithmetic(&[('+', Binary::Add), ('-', Binary::Sub)], Self::product)
    }

    fn product(&mut self) -> Read {
        self.arithmetic(&[('*', Binary::Mul), ('/', Binary::Div)], Self::unary)
    }

    fn arithmetic(&mut self, operators: &[(char, Binary)], part: fn(&mut Self) -> Read) -> Read {
        let mut left = part(self)?;
        loop {
            self.blanks();
            let Some((sign, operator)) = operators.iter().find(|(sign, _)| self.rest().starts_with(*sign)) else {
                return Ok(left);
            };
            self.at += sign.len_utf8();
            self.one_more()?;
            let right = part(self)?;
            left = Part::Other(expr::binary(*operator, left.value(), right.value()));
        }
    }

    fn unary(&mut self) -> Read {
        self.depth += 1;
        if self.depth > MOST_DEPTH {
            return self.refused("it is nested too deeply", self.at..self.at);
        }
        let read = if self.eat_word("not") || self.eat("!") {
            let of = self.unary()?;
            Ok(Part::Other(self.negated(of)))
        } else if self.eat("-") {
            let of = self.unary()?;
            Ok(Part::Other(expr::negative(of.value())))
        } else {
            self.primary()
        };
        self.depth -= 1;
        read
    }

    fn primary(&mut self) -> Read {
        if self.eat("(") {
            let inner = self.or()?;
            return if self.eat(")") { Ok(inner) } else { Err(self.unexpected()) };
        }
        match self.rest().chars().next() {
            Some(c) if c.is_ascii_digit() => Ok(Part::Other(self.number())),
            Some(quote @ ('"' | '\'')) => self.text(quote),
            Some(c) if c == '_' || c == '$' || c.is_alphabetic() => self.name(),
            _ => Err(self.unexpected()),
        }
    }

    fn number(&mut self) -> Expr {
        let rest = self.rest();
        let whole = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        let behind = rest.get(whole..).and_then(|r| r.strip_prefix('.')).unwrap_or("");
        let decimals = behind.find(|c: char| !c.is_ascii_digit()).unwrap_or(behind.len());
        let length = if decimals > 0 { whole + 1 + decimals } else { whole };
        self.at += length;
        // `1.0f`, `5L`
        self.at += usize::from(self.rest().starts_with(['f', 'F', 'd', 'D', 'l', 'L']));
        expr::number(rest.get(..length).unwrap_or("0"))
    }

    fn text(&mut self, quote: char) -> Read {
        let start = self.at;
        let inside = self.rest().get(1..).unwrap_or("");
        let Some(end) = inside.find(quote) else { return self.refused("a text is not closed", start..self.text.len()) };
        let value = inside.get(..end).unwrap_or("");
        self.at += end + 2;
        if value.contains('\\') {
            return self.refused("a text with escapes", start..self.at);
        }
        Ok(Part::Other(expr::text(value)))
    }

    fn name(&mut self) -> Read {
        let start = self.at;
        let rest = self.rest();
        let part = |c: char| c == '_' || c == '$' || c == '.' || c.is_alphanumeric();
        let length = rest.find(|c| !part(c)).unwrap_or(rest.len());
        self.at += length;
        let written = rest.get(..length).unwrap_or("");
        let place = start..self.at;
        match written {
            "true" | "false" => return Ok(Part::Other(expr::boolean(written == "true"))),
            "null" | "undefined" => return self.refused(format!("`{written}` is no value here"), place),
            _ => {}
        }
        self.blanks();
        if self.rest().starts_with(['(', '[']) {
            return self.refused(format!("`{written}` is called or indexed, which nobody does here"), place);
        }
        let parts: Vec<&str> = written.split('.').collect();
        let meant = if parts.iter().any(|p| p.is_empty()) { None } else { (self.reading.name)(&parts) };
        match meant {
            Some(e @ Expr { kind: ExprKind::Path(_), .. }) => Ok(Part::Name(e)),
            Some(e) => Ok(Part::Other(e)),
            None => self.refused(format!("`{written}` cannot be seen from outside"), place),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lapwing_syntax::print_expr;

    fn told(text: &str, compares_truths: bool) -> String {
        let name = |parts: &[&str]| (parts[0] != "hidden").then(|| expr::path(parts));
        match read(text, &Reading { name: &name, compares_truths }) {
            Ok(e) => print_expr(&e),
            Err(refused) => format!("{:?}: {}", &text[refused.place], refused.why),
        }
    }

    #[test]
    fn conditions_are_read_as_their_languages_mean_them() {
        for (java, ours) in [
            ("res", "res"),
            ("!a && b || c", "(not a and b) or c"),
            ("x>=1.5f && n != -2", "x >= 1.5 and n != -2"),
            ("a.b === 'left' && !(x < 2 * y + 1)", "a.b == \"left\" and not x < 2 * y + 1"),
            ("until && next", "`until` and `next`"),
        ] {
            assert_eq!(told(java, false), ours, "{java}");
        }
        assert_eq!(told("res && !done", true), "res == true and done == false");
        assert_eq!(told("!(res)", true), "res == false");
    }

    #[test]
    fn what_cannot_be_said_is_refused_with_its_place() {
        assert_eq!(told("a && f(x)", false), "\"f\": `f` is called or indexed, which nobody does here");
        assert_eq!(told("a = 1", false), "\"=\": `=` is not read in a condition");
        assert_eq!(told("hidden.x", false), "\"hidden.x\": `hidden.x` cannot be seen from outside");
        assert_eq!(told("x == null", false), "\"null\": `null` is no value here");
        assert_eq!(told("a &&", false), "\"\": it ends too early");
        assert_eq!(told("'a", false), "\"'a\": a text is not closed");
        assert!(told(&"(".repeat(9999), false).contains("too deeply"));
        assert!(told(&"!".repeat(9999), false).contains("too deeply"));
    }
}
