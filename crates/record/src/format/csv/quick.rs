//! The quick way through a row: its cells are found and read in one pass, without a look for the end of the line before.
//!
//! PERF: `benches/read.rs`, "CSV". It gives up where a cell is quoted, and where the row does not have the right number of cells or
//! does not end within what was read so far; such a row is read anew the general way, which also says what is wrong with it.

use lapwing_stream::{Time, Value};

use super::cells::set;
use super::plan::{Column, Plan};
use crate::decimal::Plain;
use crate::decode::{set_bool, set_number};

/// Reads the row at the beginning of `text` into `values`. Gives its time and its length, the end of the line included.
#[inline]
pub(super) fn row(text: &[u8], plan: &Plan, values: &mut [Value]) -> Option<(Time, usize)> {
    let mut time = None;
    let mut at = 0;
    let mut is_first = true;
    for column in &plan.columns {
        if !is_first {
            at = past(text, at, b',')?;
        }
        is_first = false;
        at = match *column {
            Column::Value(slot) => cell(text, at, values.get_mut(slot)?)?,
            Column::Unread => word(text, at).map(|(_, end)| end).or_else(|| end_of_cell(text, at))?,
            Column::Time => {
                let plain = Plain::at(text, at)?;
                time = Some(Time(plain.scaled(plan.unit)?));
                plain.end
            }
        };
    }
    let end = past(text, at, b'\n').or_else(|| past(text, past(text, at, b'\r')?, b'\n'))?;
    Some((time?, end))
}

/// Past a byte that must stand there.
#[inline(always)]
fn past(text: &[u8], at: usize, byte: u8) -> Option<usize> {
    (*text.get(at)? == byte).then_some(at + 1)
}

/// Reads the cell that begins there. Gives where it ends.
#[inline(always)]
fn cell(text: &[u8], at: usize, into: &mut Value) -> Option<usize> {
    if let Some((truth, end)) = word(text, at) {
        set_bool(into, truth);
        Some(end)
    } else if let Some(plain) = Plain::at(text, at)
        && is_end(text, plain.end)
        && let Some(number) = plain.number()
    {
        set_number(into, number);
        Some(plain.end)
    } else {
        any(text, at, into)
    }
}

/// The cell that begins there and where it ends, if it is `true` or `false`.
#[inline(always)]
fn word(text: &[u8], at: usize) -> Option<(bool, usize)> {
    const TRUE: u64 = u64::from_le_bytes(*b"true\0\0\0\0");
    const FALSE: u64 = u64::from_le_bytes(*b"false\0\0\0");
    let word = u64::from_le_bytes(*text.get(at..)?.first_chunk()?);
    let found = match (word & 0xffff_ffff == TRUE, word & 0xff_ffff_ffff == FALSE) {
        (true, _) => (true, at + 4),
        (_, true) => (false, at + 5),
        _ => return None,
    };
    is_end(text, found.1).then_some(found)
}

/// Reads the cell that begins there, of any kind but a quoted one. Gives where it ends.
#[inline(never)]
fn any(text: &[u8], at: usize, into: &mut Value) -> Option<usize> {
    let end = end_of_cell(text, at)?;
    set(into, text[at..end].trim_ascii(), false);
    Some(end)
}

/// Whether a cell ends there.
#[inline(always)]
fn is_end(text: &[u8], at: usize) -> bool {
    matches!(text.get(at), Some(b',' | b'\n' | b'\r'))
}

/// Where the cell ends that begins there; `None` where it is quoted, or goes on beyond the text.
///
/// PERF: eight bytes at once, for most cells are shorter.
#[inline(always)]
fn end_of_cell(text: &[u8], from: usize) -> Option<usize> {
    const EACH: u64 = u64::MAX / 255;
    // The first byte that is zero has its highest bit set, and none before it has.
    let zeros = |word: u64| word.wrapping_sub(EACH) & !word & (EACH * 0x80);
    if text.get(from) == Some(&b'"') {
        return None;
    }
    let mut at = from;
    while let Some(eight) = text.get(at..)?.first_chunk() {
        let word = u64::from_le_bytes(*eight);
        let ends = zeros(word ^ (EACH * u64::from(b','))) | zeros(word ^ (EACH * u64::from(b'\n')));
        if ends != 0 {
            return Some(at + ends.trailing_zeros() as usize / 8);
        }
        at += 8;
    }
    Some(at + text[at..].iter().position(|b| matches!(b, b',' | b'\n'))?)
}

#[cfg(test)]
mod tests {
    use lapwing_stream::Name;

    use super::*;
    use crate::decimal::SECONDS;
    use crate::format::signals::Signals;

    #[test]
    fn plain_rows_go_the_quick_way_and_others_do_not() {
        let names = ["a", "b", "c"].map(Name::from);
        let signals = Signals::new(&["c", "a"].map(Name::from));
        let plan = Plan::new(&names, (1, SECONDS), &signals);
        let mut values = signals.blank();
        let text = b"-1.5,2.25,\tunread ,true\r\n7,8,9,false\n";
        assert_eq!(row(text, &plan, &mut values), Some((Time(2_250_000_000), 25)));
        assert_eq!(values, [Value::Bool(true), Value::Num(-1.5)]);
        assert_eq!(row(&text[25..], &plan, &mut values), Some((Time(8_000_000_000), 12)));
        for text in ["1,2,3\n", "1,2,3,4,5\n", "1,2,3,4", "1,2,\"3\",4\n", "1,\"2\",3,4\n", "1,soon,3,4\n", "\n", ""] {
            assert_eq!(row(text.as_bytes(), &plan, &mut values), None, "{text:?}");
        }
    }
}
