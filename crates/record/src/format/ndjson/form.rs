//! The quick way through a line of values: most lines of a file differ in their numbers alone.
//!
//! PERF: `benches/read.rs`, "NDJSON". A form is what lines have in common: the text between their values. A line that has this text, and
//! in its gaps a number, a word or a text without escapes each, is read without a look at its structure. Every other line
//! is read the general way, which also says what is wrong with it.

use lapwing_stream::{Time, Value};

use crate::decimal::{self, Plain};
use crate::decode::scan::{Kind, Scanner};
use crate::decode::{set_bool, set_number, set_text};

/// What lines of values have in common.
#[derive(Debug, PartialEq)]
pub(super) struct Form {
    /// What stands before each of the holes.
    holes: Vec<(Fixed, Hole)>,
    /// What stands behind the last.
    end: Fixed,
}

/// What differs between lines.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Hole {
    /// The time, whose unit has so many decimal places in nanoseconds.
    Time(i64),
    /// The value of that number.
    Value(usize),
    /// A value that nobody wants.
    Unread,
}

/// A text that is the same in every line.
#[derive(Debug, PartialEq)]
struct Fixed {
    text: Box<[u8]>,
    /// Its first eight bytes, and which of these it has.
    head: u64,
    mask: u64,
}

impl Form {
    /// The form of a line that was read the general way; `slot` says where the value of a name goes, if it is wanted.
    ///
    /// `None` where the line holds more than a time and plain values.
    pub fn learn(line: &[u8], mut slot: impl FnMut(&str) -> Option<usize>) -> Option<Form> {
        let mut scanner = Scanner::new(line);
        let mut pupil = Pupil { line, from: 0, holes: Vec::new() };
        let (mut timed, mut valued) = (false, false);
        let mut first = true;
        scanner.open(b'{').ok()?;
        while scanner.more(b'}', &mut first).ok()? {
            let unit = match &*scanner.key().ok()? {
                "t" => decimal::SECONDS,
                "t_ns" => decimal::NANOSECONDS,
                "values" if !std::mem::replace(&mut valued, true) => {
                    pupil.values(&mut scanner, &mut slot)?;
                    continue;
                }
                _ => return None,
            };
            if std::mem::replace(&mut timed, true) {
                return None;
            }
            pupil.hole(&mut scanner, Hole::Time(unit))?;
        }
        scanner.end().ok()?;
        (timed && valued).then(|| Form { holes: pupil.holes, end: Fixed::new(&line[pupil.from..]) })
    }

    /// Reads the line at the beginning of `text` into `values`. Gives its time and its length, the end of the line included.
    #[inline]
    pub fn read(&self, text: &[u8], values: &mut [Value]) -> Option<(Time, usize)> {
        let mut time = Time::default();
        let mut at = 0;
        for (before, hole) in &self.holes {
            at = before.end(text, at)?;
            at = match *hole {
                Hole::Value(slot) => value(text, at, values.get_mut(slot)?)?,
                Hole::Unread => end_of_value(text, at)?,
                Hole::Time(unit) => {
                    let plain = Plain::at(text, at)?;
                    time = Time(plain.scaled(unit)?);
                    plain.end
                }
            };
        }
        at = self.end.end(text, at)?;
        let end = if text.get(at) == Some(&b'\r') { at + 1 } else { at };
        (text.get(end) == Some(&b'\n')).then_some((time, end + 1))
    }
}

/// Learns the form of a line.
struct Pupil<'l> {
    line: &'l [u8],
    /// Where the latest hole ends.
    from: usize,
    holes: Vec<(Fixed, Hole)>,
}

impl Pupil<'_> {
    fn values(&mut self, scanner: &mut Scanner<'_>, slot: &mut impl FnMut(&str) -> Option<usize>) -> Option<()> {
        let mut first = true;
        scanner.open(b'{').ok()?;
        while scanner.more(b'}', &mut first).ok()? {
            let hole = slot(&scanner.key().ok()?).map_or(Hole::Unread, Hole::Value);
            self.hole(scanner, hole)?;
        }
        Some(())
    }

    fn hole(&mut self, scanner: &mut Scanner<'_>, hole: Hole) -> Option<()> {
        if matches!(scanner.kind().ok()?, Kind::Array | Kind::Object) {
            return None;
        }
        let start = scanner.at;
        scanner.skip().ok()?;
        self.holes.push((Fixed::new(self.line.get(self.from..start)?), hole));
        self.from = scanner.at;
        Some(())
    }
}

impl Fixed {
    fn new(text: &[u8]) -> Fixed {
        let mut head = [0; 8];
        let mut mask = [0; 8];
        for ((to, marked), byte) in head.iter_mut().zip(&mut mask).zip(text) {
            (*to, *marked) = (*byte, u8::MAX);
        }
        Fixed { text: text.into(), head: u64::from_le_bytes(head), mask: u64::from_le_bytes(mask) }
    }

    /// Where it ends, where it stands there and some bytes follow.
    #[inline(always)]
    fn end(&self, text: &[u8], at: usize) -> Option<usize> {
        let rest = text.get(at..)?;
        let word = u64::from_le_bytes(*rest.first_chunk()?);
        let same = word & self.mask == self.head && (self.text.len() <= 8 || rest.starts_with(&self.text));
        same.then_some(at + self.text.len())
    }
}

const TRUE: u64 = u64::from_le_bytes(*b"true\0\0\0\0");
const FALSE: u64 = u64::from_le_bytes(*b"false\0\0\0");
const NULL: u64 = u64::from_le_bytes(*b"null\0\0\0\0");

/// Reads the value that begins there. Gives where it ends. What follows must be a text of the form, none of which begins
/// with what could go on with a number or a word.
#[inline(always)]
fn value(text: &[u8], at: usize, into: &mut Value) -> Option<usize> {
    let word = u64::from_le_bytes(*text.get(at..)?.first_chunk()?);
    if word & 0xffff_ffff == TRUE {
        set_bool(into, true);
        Some(at + 4)
    } else if word & 0xff_ffff_ffff == FALSE {
        set_bool(into, false);
        Some(at + 5)
    } else if let Some(plain) = Plain::at(text, at) {
        set_number(into, plain.number()?);
        Some(plain.end)
    } else if word & 0xffff_ffff == NULL {
        *into = Value::Missing;
        Some(at + 4)
    } else {
        let end = end_of_text(text, at)?;
        set_text(into, std::str::from_utf8(text.get(at + 1..end - 1)?).ok()?);
        Some(end)
    }
}

/// Where the value ends that begins there, which nobody wants.
#[inline(always)]
fn end_of_value(text: &[u8], at: usize) -> Option<usize> {
    let word = u64::from_le_bytes(*text.get(at..)?.first_chunk()?);
    match word & 0xffff_ffff {
        TRUE | NULL => Some(at + 4),
        _ if word & 0xff_ffff_ffff == FALSE => Some(at + 5),
        _ => Plain::at(text, at).map(|plain| plain.end).or_else(|| end_of_text(text, at)),
    }
}

/// Where the text without escapes ends that begins there with a quote, its closing quote included.
#[inline(never)]
fn end_of_text(text: &[u8], at: usize) -> Option<usize> {
    let inside = text.get(at..)?.strip_prefix(b"\"")?;
    let length = memchr::memchr3(b'"', b'\\', b'\n', inside).filter(|end| inside[*end] == b'"')?;
    Some(at + length + 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_a_form_go_the_quick_way_and_others_do_not() {
        let slot = |name: &str| ["q", "p"].iter().position(|known| *known == name);
        let form = Form::learn(br#"{"t":1, "values":{"p":true,"unread":null,"q":"a"}}"#, slot).unwrap();
        let mut values = [Value::Missing, Value::Missing];
        let text = b"{\"t\":-0.5, \"values\":{\"p\":2.5,\"unread\":\"x\",\"q\":false}}\r\n{\"t\":2}\n";
        assert_eq!(form.read(text, &mut values), Some((Time(-500_000_000), text.len() - 8)));
        assert_eq!(values, [Value::Bool(false), Value::Num(2.5)]);
        for text in [
            r#"{"t":1,"values":{"p":true,"unread":null,"q":"a"}}"#,
            r#"{"t":1, "values":{"p":tru,"unread":null,"q":"a"}}"#,
            r#"{"t":1, "values":{"p":1e5,"unread":null,"q":"a"}}"#,
            r#"{"t":1, "values":{"p":1,"unread":null,"q":"\n"}}"#,
            r#"{"t":1, "values":{"p":1,"unread":[],"q":"a"}}"#,
            r#"{"t":1, "values":{"p":1,"unread":null,"q":"a"}} x"#,
        ] {
            assert_eq!(form.read(format!("{text}\n        ").as_bytes(), &mut values), None, "{text}");
        }
    }

    #[test]
    fn what_holds_more_than_plain_values_has_no_form() {
        for line in
            [r#"{"t":1,"values":{"p":[1]}}"#, r#"{"t":1,"values":{},"more":1}"#, r#"{"t":1,"t":2,"values":{}}"#, "{"]
        {
            assert!(Form::learn(line.as_bytes(), |_| None).is_none(), "{line}");
        }
    }
}
