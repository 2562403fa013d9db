//! Numbers, durations and time bounds.

use super::{Parse, Parser};
use crate::ast::{Bound, Dur, Number, Unit};
use crate::token::{Role, TokenKind};
use crate::unit::{DurationError, nanoseconds};
use lapwing_diag::{Code, Diagnostic};
use lapwing_stream::Duration;

impl Parser<'_> {
    /// A number and its unit.
    pub(super) fn number(&mut self) -> Parse<Number> {
        if self.cursor.kind() != TokenKind::Number {
            return self.expected("a number");
        }
        let span = self.cursor.bump(Role::Number);
        let text = self.cursor.slice(span).to_owned();
        let value = text.parse().unwrap_or(f64::NAN);
        match self.cursor.kind() {
            TokenKind::Unit(unit) => {
                let end = self.cursor.bump(Role::Unit);
                Ok(Number { value, text, unit: Some(unit), span: span.to(end) })
            }
            _ => Ok(Number { value, text, unit: None, span }),
        }
    }

    /// `100 ms`, or a name that stands for a duration (and is never a call).
    pub(super) fn duration(&mut self) -> Parse<Dur> {
        match self.cursor.kind() {
            TokenKind::Number => {
                let number = self.number()?;
                Ok(Dur::Literal(self.literal_duration(&number), number.span))
            }
            TokenKind::Name | TokenKind::Quoted => Ok(Dur::Name(self.ident("the name of a duration")?)),
            TokenKind::Minus => {
                let diagnostic = self.expectation("a duration, such as `2 s`");
                self.fail(diagnostic.help("a duration is never negative"))
            }
            _ => self.expected("a duration, such as `2 s`"),
        }
    }

    /// The nanoseconds of a literal; what is wrong with it is reported, and does not stop the parser.
    fn literal_duration(&mut self, number: &Number) -> Duration {
        let Some(scale) = number.unit.and_then(Unit::nanoseconds) else {
            self.no_duration(number);
            return Duration::ZERO;
        };
        match nanoseconds(&number.text, scale) {
            Ok(nanos) => return Duration::from_nanos(nanos),
            Err(DurationError::TooShort) => self.too_short(number),
            Err(DurationError::TooLong) => {
                let diagnostic = Diagnostic::new(Code::DurationRange, number.span, "this duration is too long");
                self.report(
                    diagnostic.help("the longest is about 292 years; leave the bound out where none is needed"),
                );
            }
        }
        Duration::ZERO
    }

    /// Reports a duration among numbers that is shorter than a nanosecond. There a long one is a number as any other.
    pub(super) fn check_shortest(&mut self, number: &Number) {
        let scale = number.unit.and_then(Unit::nanoseconds);
        if scale.map(|scale| nanoseconds(&number.text, scale)) == Some(Err(DurationError::TooShort)) {
            self.too_short(number);
        }
    }

    fn too_short(&mut self, number: &Number) {
        self.report(
            Diagnostic::new(Code::DurationRange, number.span, "this duration is shorter than a nanosecond")
                .help("the shortest is `1 ns`; no time at all is written `0 s`"),
        );
    }

    fn no_duration(&mut self, number: &Number) {
        if let Some(diagnostic) = self.cursor.word().and_then(|word| self.unknown_unit(self.cursor.span(), word)) {
            self.report(diagnostic);
            self.cursor.bump(Role::Unit);
            return;
        }
        let written = self.cursor.slice(number.span);
        let text = &number.text;
        let diagnostic = Diagnostic::new(Code::BareDuration, number.span, format!("`{written}` is no duration"));
        self.report(match number.unit {
            None => diagnostic
                .label("a unit is missing")
                .help(format!("write `{text} s`"))
                .fix(number.span, format!("{text} s")),
            Some(Unit::M) => diagnostic.label("`m` is metres").help(format!("minutes are written `{text} min`")),
            Some(_) => diagnostic.help("the units of time are `ns us ms s min h`"),
        });
    }

    /// A bound, where one stands here: `within …`, or `for d` where that is another word for it.
    pub(super) fn bound(&mut self, takes_for: bool) -> Parse<Option<Bound>> {
        let start = self.cursor.position();
        if self.eat_word("within") {
            return self.within(start).map(Some);
        }
        let quantifier = self.cursor.word_ahead(1) == Some("each");
        if takes_for && !quantifier && self.eat_word("for") {
            return self.single(start).map(Some);
        }
        Ok(None)
    }

    /// What follows `within`.
    fn within(&mut self, start: usize) -> Parse<Bound> {
        match self.cursor.kind() {
            TokenKind::OpenRound | TokenKind::OpenSquare => self.interval(start),
            _ => self.single(start),
        }
    }

    /// `d`: from no time at all to `d`, both in.
    fn single(&mut self, start: usize) -> Parse<Bound> {
        let hi = self.duration()?;
        Ok(Bound { lo: None, lo_closed: true, hi, hi_closed: true, span: self.cursor.span_since(start) })
    }

    /// `[a, b]`, `(a, b]`, `[a, b)`, `(a, b)`: a round bracket leaves its end out.
    fn interval(&mut self, start: usize) -> Parse<Bound> {
        let lo_closed = self.cursor.kind() == TokenKind::OpenSquare;
        let Some(inside) = self.cursor.enter() else { return self.unclosed() };
        let ends = self.interval_ends().and_then(|ends| match self.cursor.at_close(&inside) {
            true => Ok(ends),
            false => Err(self.leftover("the end of the interval")),
        });
        let hi_closed = self.cursor.closes_with(&inside) == TokenKind::CloseSquare;
        self.cursor.leave(inside);
        let (lo, hi) = ends?;
        Ok(Bound { lo: Some(lo), lo_closed, hi, hi_closed, span: self.cursor.span_since(start) })
    }

    fn interval_ends(&mut self) -> Parse<(Dur, Dur)> {
        let lo = self.duration()?;
        if self.cursor.kind().closes() {
            let diagnostic = self.expectation("a comma and the upper end of the interval");
            return self.fail(
                diagnostic.help("an interval has two ends, as in `within (0 s, 2 s]`; `within 2 s` has no brackets"),
            );
        }
        self.token(TokenKind::Comma, "a comma between the two ends of the interval")?;
        Ok((lo, self.duration()?))
    }
}
