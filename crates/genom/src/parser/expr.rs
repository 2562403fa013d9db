//! Constant expressions, strings and numbers.

use lapwing_diag::{Code, Diagnostic, Span};

use super::{Parser, Read, Unread};
use crate::ast::{Expr, ExprKind, Quantity};
use crate::token::{Kind, Token};

/// Operators between two operands with the words that stand for them, the weakest first.
const LEVELS: &[&[(&str, &str)]] = &[
    &[("|", "bitor")],
    &[("^", "xor")],
    &[("&", "bitand")],
    &[("<<", ""), (">>", "")],
    &[("+", ""), ("-", "")],
    &[("*", ""), ("/", ""), ("%", "")],
];
/// The level of `+` and `-`: all that binds more strongly than `>>`.
pub(super) const SUM: usize = 4;

impl Parser<'_> {
    /// A constant expression.
    pub(super) fn expr(&mut self) -> Read<Expr> {
        let place = self.peek().span;
        self.nested(place, |parser| parser.level(0))
    }

    pub(super) fn level(&mut self, level: usize) -> Read<Expr> {
        let Some(signs) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.level(level + 1)?;
        let mut length = 0_usize;
        while let Some((sign, _)) = signs.iter().find(|(sign, word)| self.is(sign) || self.peek().is_word(word)) {
            let operator = self.bump();
            // The tree of a chain is as deep as the chain is long.
            length += 1;
            if length > 2 * super::DEEPEST {
                self.report(Diagnostic::new(Code::TooDeep, operator.span, "this chain of operators is too long"));
                return Err(Unread);
            }
            let right = self.level(level + 1)?;
            let span = joined(left.span, right.span);
            left = Expr { kind: ExprKind::Binary(sign, Box::new(left), Box::new(right)), span };
        }
        Ok(left)
    }

    fn unary(&mut self) -> Read<Expr> {
        let sign = match () {
            () if self.is("-") => '-',
            () if self.is("+") => '+',
            () if self.is("~") || self.peek().is_word("compl") => '~',
            () => return self.primary(),
        };
        let operator = self.bump();
        let operand = self.nested(operator.span, Parser::unary)?;
        let span = joined(operator.span, operand.span);
        Ok(Expr { kind: ExprKind::Unary(sign, Box::new(operand)), span })
    }

    fn primary(&mut self) -> Read<Expr> {
        let token = self.peek().clone();
        let kind = match token.kind {
            Kind::Number => return self.number(),
            Kind::Text => {
                let (text, span) = self.strings()?;
                return Ok(Expr { kind: ExprKind::Text(text), span });
            }
            Kind::Character => {
                let inside = token.text.get(1..).unwrap_or("");
                let inside = if inside.starts_with('\\') { inside.get(1..).unwrap_or("") } else { inside };
                ExprKind::Char(inside.chars().next().unwrap_or('\0'))
            }
            Kind::Word if &*token.text == "TRUE" => ExprKind::Bool(true),
            Kind::Word if &*token.text == "FALSE" => ExprKind::Bool(false),
            Kind::Word => {
                let name = self.scoped_name("a constant")?;
                let span = name.span();
                return Ok(Expr { kind: ExprKind::Name(name), span });
            }
            _ if token.is("::") => {
                let name = self.scoped_name("a constant")?;
                let span = name.span();
                return Ok(Expr { kind: ExprKind::Name(name), span });
            }
            _ if token.is("(") => {
                self.bump();
                let inside = self.expr()?;
                self.want(")", "after this expression")?;
                return Ok(inside);
            }
            _ => return Err(self.expected("a value")),
        };
        self.bump();
        Ok(Expr { kind, span: token.span })
    }

    fn number(&mut self) -> Read<Expr> {
        let token = self.bump();
        match value(&token) {
            Ok(kind) => Ok(Expr { kind, span: token.span }),
            Err(message) => {
                self.report(Diagnostic::new(Code::BadNumber, token.span, message));
                Ok(Expr { kind: ExprKind::Int(0), span: token.span })
            }
        }
    }

    /// Strings that stand side by side are one.
    pub(super) fn strings(&mut self) -> Read<(String, Span)> {
        if self.peek().kind != Kind::Text {
            return Err(self.expected("a text between double quotes"));
        }
        let (mut text, first) = (String::new(), self.peek().span);
        let mut span = first;
        while self.peek().kind == Kind::Text {
            let token = self.bump();
            let inside = token.text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or("");
            text += &inside.replace("\\\"", "\"");
            span = joined(first, token.span);
        }
        Ok((text, span))
    }

    /// A number with a unit of time; without one it counts seconds.
    pub(super) fn quantity(&mut self) -> Read<Quantity> {
        let value = self.expr()?;
        let unit_ns = match self.word() {
            "s" => 1_000_000_000,
            "ms" => 1_000_000,
            "us" => 1_000,
            _ => return Ok(Quantity { span: value.span, value, unit_ns: 1_000_000_000 }),
        };
        let unit = self.bump();
        Ok(Quantity { span: joined(value.span, unit.span), value, unit_ns })
    }
}

/// The value of a number.
fn value(token: &Token) -> Result<ExprKind, String> {
    let text = &*token.text;
    if text.starts_with("0x") || text.starts_with("0X") {
        let digits = text.get(2..).unwrap_or("").trim_end_matches(['u', 'U', 'l', 'L']);
        let value = u64::from_str_radix(digits, 16);
        return value.map(ExprKind::Int).map_err(|_| format!("`{text}` does not fit into 64 bits"));
    }
    let digits = text.trim_end_matches(['u', 'U', 'l', 'L', 'f', 'F', 'd', 'D']);
    let suffix = text.get(digits.len()..).unwrap_or("");
    if suffix.contains(['d', 'D']) {
        return Err(format!("`{text}` is a number with a fixed point, which no GenoM3 has implemented"));
    }
    if digits.contains(['.', 'e', 'E']) || suffix.contains(['f', 'F']) {
        return digits.parse().map(ExprKind::Float).map_err(|_| format!("`{text}` is no number"));
    }
    let value = match digits.strip_prefix('0') {
        Some(octal) if !octal.is_empty() => u64::from_str_radix(octal, 8),
        _ => digits.parse(),
    };
    value.map(ExprKind::Int).map_err(|_| format!("`{text}` is no whole number of 64 bits"))
}

/// From one place to another of the same file.
pub(super) fn joined(from: Span, to: Span) -> Span {
    if from.file == to.file { from.to(to) } else { from }
}
