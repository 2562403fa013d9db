//! Expressions, with the precedences of C.

use super::{MAX_HEIGHT, Parse, Parser};
use crate::ast::{BinaryOp, Expr, ExprKind, Literal, UnaryOp};
use crate::lexer::TokenKind;
use lapwing_diag::Code;

impl Parser<'_> {
    pub(super) fn expr(&mut self) -> Parse<Expr> {
        self.nested(|p| p.binary(1))
    }

    /// An expression in brackets, as after `provided`.
    pub(super) fn condition(&mut self) -> Parse<Expr> {
        let open = self.require("(")?;
        let expr = self.expr()?;
        self.close(open)?;
        Ok(expr)
    }

    /// Operators that bind at least so tightly.
    fn binary(&mut self, at_least: u8) -> Parse<Expr> {
        let mut left = self.unary()?;
        let mut height = self.height;
        while let Some(op) = self.binary_op().filter(|op| op.precedence() >= at_least) {
            let at = self.span();
            self.advance();
            let right = self.nested(|p| p.binary(op.precedence() + 1))?;
            height = height.max(self.height) + 1;
            if height > MAX_HEIGHT {
                return self.fail(Code::TooDeep, at, "this expression has too many operators");
            }
            let span = left.span.to(right.span);
            left = Expr { kind: ExprKind::Binary(op, Box::new(left), Box::new(right)), span };
        }
        self.height = height;
        Ok(left)
    }

    fn binary_op(&self) -> Option<BinaryOp> {
        if self.kind() != TokenKind::Sign {
            return None;
        }
        BinaryOp::ALL.into_iter().find(|op| op.symbol() == self.peek(0))
    }

    fn unary(&mut self) -> Parse<Expr> {
        let op = match self.peek(0) {
            "!" => UnaryOp::Not,
            "-" => UnaryOp::Minus,
            "+" => UnaryOp::Plus,
            "~" => UnaryOp::Complement,
            _ => return self.primary(),
        };
        if self.kind() != TokenKind::Sign {
            return self.primary();
        }
        let start = self.span();
        self.advance();
        let operand = self.nested(Self::unary)?;
        self.height += 1;
        let span = start.to(operand.span);
        Ok(Expr { kind: ExprKind::Unary(op, Box::new(operand)), span })
    }

    fn primary(&mut self) -> Parse<Expr> {
        self.height = 1;
        let span = self.span();
        let literal = |literal| Ok(Expr { kind: ExprKind::Literal(literal), span });
        match self.kind() {
            TokenKind::Int => literal(Literal::Int(self.int()?)),
            TokenKind::Real => {
                let text = self.here();
                self.advance();
                literal(Literal::Real(text))
            }
            TokenKind::Text => literal(Literal::Text(self.text_literal()?)),
            TokenKind::Name if self.is("true") || self.is("false") => {
                let value = self.is("true");
                self.advance();
                literal(Literal::Bool(value))
            }
            TokenKind::Name => self.path_or_call(),
            TokenKind::Sign if self.is("(") => {
                let mut expr = self.condition()?;
                expr.span = span.to(self.last_span());
                self.height += 1;
                Ok(expr)
            }
            _ => self.missing("an expression"),
        }
    }

    fn path_or_call(&mut self) -> Parse<Expr> {
        let path = self.path("a name")?;
        let start = path.span();
        if !self.is("(") {
            return Ok(Expr { kind: ExprKind::Path(path), span: start });
        }
        // A function of another package may be named with it.
        let Some(name) = path.parts.into_iter().next_back() else { return self.missing("a name") };
        let mut height = 0;
        let args = self.bracketed(|p| {
            let arg = p.expr()?;
            height = height.max(p.height);
            Ok(arg)
        })?;
        self.height = height + 1;
        Ok(Expr { kind: ExprKind::Call(name, args), span: start.to(self.last_span()) })
    }

    fn int(&mut self) -> Parse<i64> {
        let Ok(value) = self.peek(0).parse() else {
            return self.fail(Code::BadNumber, self.span(), "this number is too large: numbers have 64 bits");
        };
        self.advance();
        Ok(value)
    }

    /// A text in quotation marks, its escapes resolved: those of C, a line's end among them that does not count.
    pub(super) fn text_literal(&mut self) -> Parse<String> {
        if self.kind() != TokenKind::Text {
            return self.missing("a text in quotation marks");
        }
        let raw = self.here();
        let inside = raw.get(1..raw.len().saturating_sub(1)).unwrap_or("");
        match unescaped(inside) {
            Some(text) => {
                self.advance();
                Ok(text)
            }
            None => self.fail(Code::BadText, self.span(), "this text has an escape that does not exist"),
        }
    }
}

/// A text without its escapes; `None` where there is one that does not exist.
fn unescaped(inside: &str) -> Option<String> {
    let mut text = String::with_capacity(inside.len());
    let mut rest = inside;
    while let Some(at) = rest.find('\\') {
        text.push_str(rest.get(..at)?);
        let after = rest.get(at + 1..)?;
        let sign = after.chars().next()?;
        rest = after.get(sign.len_utf8()..)?;
        match sign {
            'n' => text.push('\n'),
            't' => text.push('\t'),
            'r' => text.push('\r'),
            'a' => text.push('\u{7}'),
            'b' => text.push('\u{8}'),
            'f' => text.push('\u{c}'),
            'v' => text.push('\u{b}'),
            '"' | '\\' | '\'' | '?' => text.push(sign),
            '\n' => {}
            '\r' => rest = rest.strip_prefix('\n')?,
            'x' => text.push(number(&mut rest, 16, 2)?),
            '0'..='7' => {
                rest = after;
                text.push(number(&mut rest, 8, 3)?);
            }
            _ => return None,
        }
    }
    text.push_str(rest);
    Some(text)
}

/// A character by its number, of so many digits at most: a byte in C, and the same character of Unicode here.
fn number(rest: &mut &str, radix: u32, most: usize) -> Option<char> {
    let length = rest.chars().take(most).take_while(|c| c.is_digit(radix)).count();
    let (digits, after) = rest.split_at_checked(length)?;
    *rest = after;
    u8::from_str_radix(digits, radix).ok().map(char::from)
}
