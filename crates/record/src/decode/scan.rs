//! A scanner of JSON that builds nothing: the caller takes what it wants and skips the rest.
//!
//! Beyond the standard it accepts `NaN`, `Infinity` and `-Infinity`, which Python and others write where a sensor had no echo.

use std::borrow::Cow;

use super::DecodeError;
use crate::decimal::Plain;

type Scan<T> = Result<T, DecodeError>;

/// Objects and arrays may not be nested deeper than this.
const MAX_DEPTH: usize = 128;

/// A position in a JSON text.
#[derive(Clone, Debug)]
pub(crate) struct Scanner<'a> {
    text: &'a [u8],
    /// The byte that comes next, from 0.
    pub at: usize,
    depth: usize,
}

/// What kind of value comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Null,
    Bool,
    Number,
    Text,
    Array,
    Object,
}

impl<'a> Scanner<'a> {
    pub fn new(text: &'a [u8]) -> Scanner<'a> {
        Scanner { text, at: 0, depth: 0 }
    }

    #[cold]
    fn error<T>(&self, what: &str) -> Scan<T> {
        Err(DecodeError::new(format!("no JSON at byte {} of it: {what}", self.at + 1)))
    }

    /// The next byte that is no blank.
    #[inline]
    pub fn peek(&mut self) -> Option<u8> {
        loop {
            match self.text.get(self.at) {
                Some(b' ' | b'\t' | b'\n' | b'\r') => self.at += 1,
                other => return other.copied(),
            }
        }
    }

    pub fn kind(&mut self) -> Scan<Kind> {
        match self.peek() {
            Some(b'{') => Ok(Kind::Object),
            Some(b'[') => Ok(Kind::Array),
            Some(b'"') => Ok(Kind::Text),
            Some(b't' | b'f') => Ok(Kind::Bool),
            Some(b'n') => Ok(Kind::Null),
            Some(b'-' | b'0'..=b'9' | b'N' | b'I') => Ok(Kind::Number),
            Some(_) => self.error("a value was expected"),
            None => self.error("it ends where a value was expected"),
        }
    }

    fn expect(&mut self, byte: u8) -> Scan<()> {
        if self.peek() != Some(byte) {
            return self.error(&format!("`{}` was expected", byte as char));
        }
        self.at += 1;
        Ok(())
    }

    fn word(&mut self, word: &str) -> Scan<()> {
        if !self.text[self.at..].starts_with(word.as_bytes()) {
            return self.error(&format!("`{word}` was expected"));
        }
        self.at += word.len();
        Ok(())
    }

    /// Nothing but blanks may follow.
    pub fn end(&mut self) -> Scan<()> {
        match self.peek() {
            None => Ok(()),
            Some(_) => self.error("something follows after the value"),
        }
    }

    pub fn null(&mut self) -> Scan<()> {
        self.kind()?;
        self.word("null")
    }

    pub fn bool(&mut self) -> Scan<bool> {
        let truth = self.peek() == Some(b't');
        self.word(if truth { "true" } else { "false" })?;
        Ok(truth)
    }

    /// The text of a number, as it stands there.
    pub fn digits(&mut self) -> Scan<&'a [u8]> {
        self.kind()?;
        let rest = &self.text[self.at..];
        let end = rest.iter().position(|b| !is_of_number(b)).unwrap_or(rest.len());
        self.at += end;
        Ok(&rest[..end])
    }

    pub fn number(&mut self) -> Scan<f64> {
        self.kind()?;
        let rest = &self.text[self.at..];
        if matches!(rest, [b'N' | b'I', ..] | [b'-', b'I', ..]) {
            return self.named_number();
        }
        // PERF: what recorders write nearly always.
        if let Some(plain) = Plain::at(self.text, self.at).filter(|p| !self.text.get(p.end).is_some_and(is_of_number))
            && let Some(number) = plain.number()
        {
            self.at = plain.end;
            return Ok(number);
        }
        let start = self.at;
        let digits = self.digits()?;
        match std::str::from_utf8(digits).ok().and_then(|text| text.parse().ok()) {
            Some(number) => Ok(number),
            None => {
                self.at = start;
                self.error("a number was expected")
            }
        }
    }

    fn named_number(&mut self) -> Scan<f64> {
        for (word, value) in [("NaN", f64::NAN), ("Infinity", f64::INFINITY), ("-Infinity", f64::NEG_INFINITY)] {
            if self.text[self.at..].starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(value);
            }
        }
        self.error("a number was expected")
    }

    /// A text. It is borrowed where it holds no escape and is valid UTF-8.
    pub fn text(&mut self) -> Scan<Cow<'a, str>> {
        self.expect(b'"')?;
        let start = self.at;
        loop {
            match self.text.get(self.at) {
                Some(b'"') => {
                    let plain = String::from_utf8_lossy(&self.text[start..self.at]);
                    self.at += 1;
                    return Ok(plain);
                }
                Some(b'\\') => return self.escaped(start).map(Cow::Owned),
                Some(_) => self.at += 1,
                None => return self.error("a text is not closed"),
            }
        }
    }

    /// The rest of a text, from its first escape on.
    fn escaped(&mut self, start: usize) -> Scan<String> {
        let mut out = String::from_utf8_lossy(&self.text[start..self.at]).into_owned();
        loop {
            let plain = self.at;
            while !matches!(self.text.get(self.at), Some(b'"' | b'\\') | None) {
                self.at += 1;
            }
            out.push_str(&String::from_utf8_lossy(&self.text[plain..self.at]));
            match self.text.get(self.at) {
                Some(b'"') => {
                    self.at += 1;
                    return Ok(out);
                }
                Some(_) => out.push(self.escape()?),
                None => return self.error("a text is not closed"),
            }
        }
    }

    fn escape(&mut self) -> Scan<char> {
        let letter = self.text.get(self.at + 1).copied();
        self.at = (self.at + 2).min(self.text.len());
        Ok(match letter {
            Some(c @ (b'"' | b'\\' | b'/')) => c as char,
            Some(b'b') => '\u{8}',
            Some(b'f') => '\u{c}',
            Some(b'n') => '\n',
            Some(b'r') => '\r',
            Some(b't') => '\t',
            Some(b'u') => return self.unicode(),
            _ => return self.error("this escape does not exist"),
        })
    }

    /// `\u` and four hexadecimal digits, or a pair of that for a character beyond the first 65,536.
    fn unicode(&mut self) -> Scan<char> {
        let high = self.hex()?;
        let low = matches!(high, 0xD800..=0xDBFF) && self.text[self.at..].starts_with(b"\\u");
        if !low {
            return Ok(char::from_u32(high).unwrap_or(char::REPLACEMENT_CHARACTER));
        }
        self.at += 2;
        let low = self.hex()?;
        let code = 0x10000 + ((high - 0xD800) << 10) + (low.wrapping_sub(0xDC00) & 0x3FF);
        Ok(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER))
    }

    fn hex(&mut self) -> Scan<u32> {
        let digits = self.text.get(self.at..self.at + 4).and_then(|d| std::str::from_utf8(d).ok());
        match digits.and_then(|d| u32::from_str_radix(d, 16).ok()) {
            Some(code) => {
                self.at += 4;
                Ok(code)
            }
            None => self.error("four hexadecimal digits were expected"),
        }
    }

    /// Begins an object or an array; `]` or `}` must be looked for by [`Scanner::more`].
    pub fn open(&mut self, bracket: u8) -> Scan<()> {
        if self.depth >= MAX_DEPTH {
            return self.error("it is nested too deeply");
        }
        self.depth += 1;
        self.expect(bracket)
    }

    /// Whether one more member or element follows. `first` must be true before the first one, and is false thereafter.
    pub fn more(&mut self, close: u8, first: &mut bool) -> Scan<bool> {
        if self.peek() == Some(close) {
            self.at += 1;
            self.depth -= 1;
            return Ok(false);
        }
        if !std::mem::replace(first, false) {
            self.expect(b',')?;
        }
        Ok(true)
    }

    /// The next member's name, the colon after it passed.
    pub fn key(&mut self) -> Scan<Cow<'a, str>> {
        let key = self.text()?;
        self.expect(b':')?;
        Ok(key)
    }

    /// Over the next value, whatever it is.
    pub fn skip(&mut self) -> Scan<()> {
        match self.kind()? {
            Kind::Null => self.null(),
            Kind::Bool => self.bool().map(drop),
            Kind::Number => self.number().map(drop),
            Kind::Text => self.skip_text(),
            Kind::Array => {
                self.open(b'[')?;
                let mut first = true;
                while self.more(b']', &mut first)? {
                    self.skip()?;
                }
                Ok(())
            }
            Kind::Object => {
                self.open(b'{')?;
                let mut first = true;
                while self.more(b'}', &mut first)? {
                    self.skip_text()?;
                    self.expect(b':')?;
                    self.skip()?;
                }
                Ok(())
            }
        }
    }

    /// Over a text.
    fn skip_text(&mut self) -> Scan<()> {
        self.expect(b'"')?;
        while let Some(found) = memchr::memchr2(b'"', b'\\', &self.text[self.at..]) {
            self.at += found;
            if self.text[self.at] == b'"' {
                self.at += 1;
                return Ok(());
            }
            self.escape()?;
        }
        self.error("a text is not closed")
    }

    /// The bytes of the next value, as they stand there.
    pub fn raw(&mut self) -> Scan<&'a [u8]> {
        self.peek();
        let start = self.at;
        self.skip()?;
        Ok(&self.text[start..self.at])
    }
}

/// Whether a number may have that byte.
fn is_of_number(byte: &u8) -> bool {
    matches!(byte, b'0'..=b'9' | b'-' | b'+' | b'.' | b'e' | b'E')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_numbers() {
        let text = |t: &str| Scanner::new(t.as_bytes()).text().map(Cow::into_owned);
        assert_eq!(text(r#""plain""#).unwrap(), "plain");
        assert_eq!(text(r#""a\n\"\u00e9\ud83d\ude00\\""#).unwrap(), "a\n\"é😀\\");
        for bad in [r#"""#, r#""\"#, r#""\u12"#, r#""\x""#, r#""abc"#] {
            assert!(text(bad).is_err(), "{bad}");
        }
        assert_eq!(Scanner::new(b" -1.5e3 ").number().unwrap(), -1500.0);
        assert!(Scanner::new(b"NaN").number().unwrap().is_nan());
        assert!(Scanner::new(b"-").number().is_err());
    }

    #[test]
    fn skipping_agrees_with_another_parser() {
        let good = [r#"{"a":[1,2,{"b":null}],"c":"\"}]"}"#, "[]", "{}", "[[],{}]", "true", " 1 "];
        let bad = ["{", "[1,]", r#"{"a"}"#, "[1 2]", "tru", "", r#"{"a":1,}"#, "]"];
        for text in good.iter().chain(&bad) {
            let mut scanner = Scanner::new(text.as_bytes());
            let ours = scanner.skip().and_then(|()| scanner.end()).is_ok();
            assert_eq!(ours, serde_json::from_str::<serde_json::Value>(text).is_ok(), "{text}");
        }
        assert!(Scanner::new("[".repeat(100_000).as_bytes()).skip().is_err());
    }
}
