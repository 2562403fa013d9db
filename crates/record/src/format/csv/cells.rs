//! The cells of a line, one after the other, quotes included: what the quick way does not understand is read by these.

use std::borrow::Cow;

use lapwing_stream::Value;

use crate::decode::set_text;

/// The cells of a line.
pub(super) struct Cells<'a> {
    /// What follows the last comma; `None` after the last cell.
    rest: Option<&'a [u8]>,
    /// The byte of the line at which that begins, from 0.
    at: u64,
}

/// One cell.
pub(super) struct Cell<'a> {
    /// Without blanks around it, or what stands between its quotes.
    pub text: Cow<'a, [u8]>,
    pub quoted: bool,
    /// The byte of the line at which it begins, from 1.
    pub at: u64,
}

impl<'a> Cells<'a> {
    /// Of a line without its end.
    pub fn of(line: &'a [u8]) -> Cells<'a> {
        Cells { rest: Some(line), at: 0 }
    }

    /// The next cell; an error is where a quote begins that is not closed.
    pub fn next(&mut self) -> Option<Result<Cell<'a>, u64>> {
        let rest = self.rest?;
        let at = self.at + 1;
        if rest.first() == Some(&b'"') {
            return Some(self.quoted(rest, at).ok_or(at));
        }
        let end = memchr::memchr(b',', rest).unwrap_or(rest.len());
        self.go_on(rest, end);
        Some(Ok(Cell { text: Cow::Borrowed(rest[..end].trim_ascii()), quoted: false, at }))
    }

    /// Past the comma after `end`, or to the end of the line.
    fn go_on(&mut self, rest: &'a [u8], end: usize) {
        self.rest = rest.get(end + 1..);
        self.at += end as u64 + 1;
    }

    /// A cell in quotes, in which two quotes stand for one. What stands between the closing quote and the comma is passed over.
    fn quoted(&mut self, rest: &'a [u8], at: u64) -> Option<Cell<'a>> {
        let mut text = Cow::Borrowed(&rest[..0]);
        let mut from = 1;
        loop {
            let quote = from + memchr::memchr(b'"', &rest[from..])?;
            let part = &rest[from..quote];
            if text.is_empty() {
                text = Cow::Borrowed(part);
            } else {
                text.to_mut().extend_from_slice(part);
            }
            if rest.get(quote + 1) != Some(&b'"') {
                let after = &rest[quote + 1..];
                let end = quote + 1 + memchr::memchr(b',', after).unwrap_or(after.len());
                self.go_on(rest, end);
                return Some(Cell { text, quoted: true, at });
            }
            text.to_mut().push(b'"');
            from = quote + 2;
        }
    }
}

/// Overwrites a value by a cell: nothing, a boolean, a number, or else a text. What is quoted is a text.
pub(super) fn set(value: &mut Value, text: &[u8], quoted: bool) {
    match text {
        b"" => *value = Value::Missing,
        b"true" if !quoted => *value = Value::Bool(true),
        b"false" if !quoted => *value = Value::Bool(false),
        _ => match number(text).filter(|_| !quoted) {
            Some(number) => *value = Value::Num(number),
            None => set_text(value, &String::from_utf8_lossy(text)),
        },
    }
}

/// A number, also `nan`, `inf` and `infinity` in any case, with a sign or without.
fn number(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}
