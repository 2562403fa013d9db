//! What follows `#if`: an integer expression in which names that are no macros are 0.

use lapwing_diag::{Code, Diagnostic, Span};

use super::macros::{Failed, Macros};
use crate::token::{Kind, Token};

/// Brackets and operators nest no deeper.
const DEEPEST: usize = 64;

/// Whether a condition is true. `span` is where the directive stands.
pub(crate) fn holds(macros: &mut Macros, tokens: &[Token], span: Span) -> Result<bool, Failed> {
    let tokens = macros.expand(defined(macros, tokens)?)?;
    let mut reader = Reader { tokens: &tokens, at: 0, span, depth: 0 };
    let value = reader.choice()?;
    match reader.peek() {
        None => Ok(value != 0),
        Some(token) => Err(wrong(token.span, format!("`{}` follows a condition that is complete", token.text))),
    }
}

/// The tokens with every `defined X` and `defined(X)` answered.
fn defined(macros: &Macros, tokens: &[Token]) -> Result<Vec<Token>, Failed> {
    let mut out = Vec::new();
    let mut tokens = tokens.iter().peekable();
    while let Some(token) = tokens.next() {
        if !token.is_word("defined") {
            out.push(token.clone());
            continue;
        }
        let bracket = tokens.next_if(|t| t.is("("));
        let Some(name) = tokens.next_if(|t| t.kind == Kind::Word) else {
            return Err(wrong(token.span, "`defined` needs a name".to_owned()));
        };
        if bracket.is_some() && tokens.next_if(|t| t.is(")")).is_none() {
            return Err(wrong(token.span, "the bracket after `defined` is not closed".to_owned()));
        }
        let text = if macros.defined.contains_key(&name.text) { "1" } else { "0" };
        out.push(Token { kind: Kind::Number, text: text.into(), ..token.clone() });
    }
    Ok(out)
}

fn wrong(span: Span, message: String) -> Failed {
    Box::new(Diagnostic::new(Code::BadDirective, span, message))
}

struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
    span: Span,
    depth: usize,
}

/// Operators between two operands, by their strength.
const LEVELS: &[&[&str]] = &[
    &["||"],
    &["&&"],
    &["|"],
    &["^"],
    &["&"],
    &["==", "!="],
    &["<", "<=", ">", ">="],
    &["<<", ">>"],
    &["+", "-"],
    &["*", "/", "%"],
];

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn eat(&mut self, sign: &str) -> bool {
        let is_it = self.peek().is_some_and(|t| t.is(sign));
        self.at += usize::from(is_it);
        is_it
    }

    fn choice(&mut self) -> Result<i64, Failed> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(wrong(self.span, "this condition nests too deeply".to_owned()));
        }
        let condition = self.level(0)?;
        let value = if self.eat("?") {
            let yes = self.choice()?;
            if !self.eat(":") {
                return Err(wrong(self.span, "`?` needs a `:`".to_owned()));
            }
            let no = self.choice()?;
            if condition != 0 { yes } else { no }
        } else {
            condition
        };
        self.depth -= 1;
        Ok(value)
    }

    fn level(&mut self, level: usize) -> Result<i64, Failed> {
        let Some(signs) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.level(level + 1)?;
        while let Some(sign) = signs.iter().find(|s| self.peek().is_some_and(|t| t.is(s))) {
            self.at += 1;
            let right = self.level(level + 1)?;
            left = self.joined(sign, left, right)?;
        }
        Ok(left)
    }

    fn joined(&self, sign: &str, left: i64, right: i64) -> Result<i64, Failed> {
        let shift = |by: i64| u32::try_from(by).unwrap_or(u32::MAX);
        Ok(match sign {
            "||" => i64::from(left != 0 || right != 0),
            "&&" => i64::from(left != 0 && right != 0),
            "|" => left | right,
            "^" => left ^ right,
            "&" => left & right,
            "==" => i64::from(left == right),
            "!=" => i64::from(left != right),
            "<" => i64::from(left < right),
            "<=" => i64::from(left <= right),
            ">" => i64::from(left > right),
            ">=" => i64::from(left >= right),
            "<<" => left.checked_shl(shift(right)).unwrap_or(0),
            ">>" => left.checked_shr(shift(right)).unwrap_or(0),
            "+" => left.wrapping_add(right),
            "-" => left.wrapping_sub(right),
            "*" => left.wrapping_mul(right),
            _ if right == 0 => return Err(wrong(self.span, "this condition divides by zero".to_owned())),
            "/" => left.wrapping_div(right),
            _ => left.wrapping_rem(right),
        })
    }

    fn unary(&mut self) -> Result<i64, Failed> {
        // Signs in front of an operand are counted, not nested.
        let mut signs = Vec::new();
        while let Some(sign) = ["!", "-", "+", "~"].into_iter().find(|s| self.peek().is_some_and(|t| t.is(s))) {
            self.at += 1;
            signs.push(sign);
        }
        let mut value = self.primary()?;
        for sign in signs.into_iter().rev() {
            value = match sign {
                "!" => i64::from(value == 0),
                "-" => value.wrapping_neg(),
                "~" => !value,
                _ => value,
            };
        }
        Ok(value)
    }

    fn primary(&mut self) -> Result<i64, Failed> {
        let Some(token) = self.peek().cloned() else {
            return Err(wrong(self.span, "this condition ends where a value should stand".to_owned()));
        };
        self.at += 1;
        match token.kind {
            Kind::Word => Ok(0),
            Kind::Number => number(&token),
            Kind::Character => Ok(token.text.chars().nth(1).map_or(0, |c| i64::from(u32::from(c)))),
            _ if token.is("(") => {
                let value = self.choice()?;
                if self.eat(")") { Ok(value) } else { Err(wrong(token.span, "this bracket is not closed".to_owned())) }
            }
            _ => Err(wrong(token.span, format!("`{}` is no value", token.text))),
        }
    }
}

fn number(token: &Token) -> Result<i64, Failed> {
    let digits = token.text.trim_end_matches(['u', 'U', 'l', 'L']);
    let value = match (digits.strip_prefix("0x").or(digits.strip_prefix("0X")), digits.strip_prefix('0')) {
        (Some(hex), _) => i64::from_str_radix(hex, 16),
        (None, Some(octal)) if !octal.is_empty() => i64::from_str_radix(octal, 8),
        _ => digits.parse(),
    };
    value.map_err(|_| wrong(token.span, format!("`{}` is no whole number that a condition can hold", token.text)))
}
