//! Takes the steps of a plan over one message, packed or in CDR.

use std::sync::Arc;

use lapwing_stream::{Name, Value};

use super::DecodeError;
use super::cursor::{CdrBig, CdrLittle, Cursor, Packed, Wire};
use super::plan::{Body, Count, Plan, Shape, Step};

type Run = Result<(), DecodeError>;

/// A ROS 1 message: packed, little-endian, nothing before it and nothing after.
pub(super) fn packed(plan: &Plan, message: &[u8], elements: usize, values: &mut [Value]) -> Run {
    whole::<Packed>(plan, message, elements, 4, 0, values)
}

/// A CDR message: four bytes that say how it is encoded, then its fields, then up to three bytes of padding.
pub(super) fn cdr(plan: &Plan, message: &[u8], elements: usize, values: &mut [Value]) -> Run {
    let Some((head, body)) = message.split_at_checked(4) else {
        return Err(DecodeError::new("it is too short for CDR: the four bytes of its header are not there"));
    };
    // How wide a character is differs between DDS vendors, and no header says it: the width that fits is taken.
    let widths: &[usize] = if plan.wide { &[4, 2] } else { &[4] };
    let mut result = Ok(());
    for &wide in widths {
        result = match (head[0], head[1]) {
            (0, 0) => whole::<CdrBig>(plan, body, elements, wide, 3, values),
            (0, 1) => whole::<CdrLittle>(plan, body, elements, wide, 3, values),
            (0, 2 | 3) => Err(DecodeError::new(
                "it is encoded as a parameter list (PL_CDR), which is not supported: plain CDR is",
            )),
            (0, 6..=11) => Err(DecodeError::new(
                "it is encoded in XCDR2, which is not supported: have the publisher use XCDR1 (plain CDR)",
            )),
            (a, b) => Err(DecodeError::new(format!("its first bytes, {a:02x} {b:02x}, are no CDR header"))),
        };
        if result.is_ok() {
            break;
        }
    }
    result
}

fn whole<W: Wire>(plan: &Plan, data: &[u8], elements: usize, wide: usize, padding: usize, values: &mut [Value]) -> Run {
    let mut cursor = Cursor::<W>::new(data, elements, wide);
    steps(&plan.steps, &mut cursor, values)?;
    match cursor.left() {
        left if plan.complete && left > padding => {
            Err(DecodeError::new(format!("{left} bytes are left over at its end: it does not fit its definition")))
        }
        _ => Ok(()),
    }
}

fn steps<W: Wire>(list: &[Step], cursor: &mut Cursor<'_, W>, values: &mut [Value]) -> Run {
    for step in list {
        match step {
            Step::Jump(span) => cursor.jump(span.from(cursor.at as u64))?,
            Step::Text => {
                cursor.text()?;
            }
            Step::WideText => cursor.wide_text(|_| {})?,
            Step::Array(count, body) => {
                let count = number(*count, cursor)?;
                over(count, body, cursor)?;
            }
            Step::Read(slot, shape) => {
                if let Some(value) = values.get_mut(*slot) {
                    read(shape, cursor, value)?;
                }
            }
            Step::Peek(inner) => {
                let at = cursor.at;
                steps(inner, cursor, values)?;
                cursor.at = at;
            }
            Step::Index { count, index, over: body, then, missed } => {
                if *index < number(*count, cursor)? {
                    over(*index, body, cursor)?;
                    steps(then, cursor, values)?;
                } else {
                    missed.iter().for_each(|slot| values[*slot] = Value::Missing);
                }
            }
        }
    }
    Ok(())
}

fn number<W: Wire>(count: Count, cursor: &mut Cursor<'_, W>) -> Result<usize, DecodeError> {
    count.map_or_else(|| cursor.length(), Ok)
}

/// Over so many elements of an array.
fn over<W: Wire>(count: usize, body: &Body, cursor: &mut Cursor<'_, W>) -> Run {
    match body {
        Body::Fixed(span) => cursor.jump(span.times(count as u64).from(cursor.at as u64)),
        Body::Steps(inner) => {
            // An element that is not of fixed size takes four bytes or more: a count beyond the data ends there.
            for _ in 0..count {
                steps(inner, cursor, &mut [])?;
            }
            Ok(())
        }
    }
}

fn read<W: Wire>(shape: &Shape, cursor: &mut Cursor<'_, W>, into: &mut Value) -> Run {
    match shape {
        Shape::Bool => set_bool(into, cursor.num(crate::definition::Prim::Bool)? != 0.0),
        Shape::Num(prim) => set_number(into, cursor.num(*prim)?),
        Shape::Text => set_text(into, &String::from_utf8_lossy(cursor.text()?)),
        Shape::WideText => read_wide(cursor, into)?,
        Shape::Nums(count, prim) => {
            let count = number(*count, cursor)?;
            cursor.nums(*prim, count, nums_of(into))?;
        }
        Shape::List(count, element) => {
            let count = number(*count, cursor)?;
            read_list(count, element, cursor, into)?;
        }
        Shape::Record(fields) => read_record(fields, cursor, into)?,
        Shape::Nothing(span) => {
            cursor.jump(span.from(cursor.at as u64))?;
            record_of(into).clear();
        }
    }
    Ok(())
}

fn read_wide<W: Wire>(cursor: &mut Cursor<'_, W>, into: &mut Value) -> Run {
    let text = text_of(into);
    text.clear();
    let mut high: Option<u32> = None;
    cursor.wide_text(|unit| {
        // A pair of surrogates makes one character; one alone is none.
        let code = match (high.take(), unit) {
            (Some(first), 0xDC00..=0xDFFF) => 0x10000 + ((first - 0xD800) << 10) + (unit - 0xDC00),
            (_, 0xD800..=0xDBFF) => {
                high = Some(unit);
                return;
            }
            (_, other) => other,
        };
        text.push(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER));
    })
}

fn read_list<W: Wire>(count: usize, element: &Shape, cursor: &mut Cursor<'_, W>, into: &mut Value) -> Run {
    cursor.spend(count)?;
    let list = list_of(into);
    list.truncate(count);
    for k in 0..count {
        if k == list.len() {
            list.push(Value::Missing);
        }
        read(element, cursor, &mut list[k])?;
    }
    Ok(())
}

fn read_record<W: Wire>(fields: &[(Name, Shape)], cursor: &mut Cursor<'_, W>, into: &mut Value) -> Run {
    let record = record_of(into);
    if record.len() != fields.len() {
        record.clear();
        record.extend(fields.iter().map(|(name, _)| (name.clone(), Value::Missing)));
    }
    for ((name, shape), (named, value)) in fields.iter().zip(record) {
        if !Arc::ptr_eq(name, named) {
            named.clone_from(name);
        }
        read(shape, cursor, value)?;
    }
    Ok(())
}

/// The text in a value, made one where it was none.
pub(super) fn text_of(value: &mut Value) -> &mut String {
    if !matches!(value, Value::Str(_)) {
        *value = Value::Str(String::new());
    }
    match value {
        Value::Str(text) => text,
        _ => unreachable!("it was just made a text"),
    }
}

/// Overwrites a value by a text.
pub(crate) fn set_text(value: &mut Value, text: &str) {
    let into = text_of(value);
    into.clear();
    into.push_str(text);
}

/// Overwrites a value by a number. PERF: what a field holds stays of one kind, and then there is nothing to drop.
#[inline]
pub(crate) fn set_number(value: &mut Value, number: f64) {
    match value {
        Value::Num(old) => *old = number,
        other => *other = Value::Num(number),
    }
}

/// Overwrites a value by a truth value, as [`set_number`] does.
#[inline]
pub(crate) fn set_bool(value: &mut Value, truth: bool) {
    match value {
        Value::Bool(old) => *old = truth,
        other => *other = Value::Bool(truth),
    }
}

/// The numbers in a value, made an array of numbers where it was none.
pub(super) fn nums_of(value: &mut Value) -> &mut Vec<f64> {
    if !matches!(value, Value::Nums(_)) {
        *value = Value::Nums(Vec::new());
    }
    match value {
        Value::Nums(nums) => nums,
        _ => unreachable!("it was just made an array of numbers"),
    }
}

/// The list in a value, made one where it was none.
pub(super) fn list_of(value: &mut Value) -> &mut Vec<Value> {
    if !matches!(value, Value::List(_)) {
        *value = Value::List(Vec::new());
    }
    match value {
        Value::List(list) => list,
        _ => unreachable!("it was just made a list"),
    }
}

/// The fields in a value, made a record where it was none.
pub(super) fn record_of(value: &mut Value) -> &mut Vec<(Name, Value)> {
    if !matches!(value, Value::Record(_)) {
        *value = Value::Record(Vec::new());
    }
    match value {
        Value::Record(record) => record,
        _ => unreachable!("it was just made a record"),
    }
}
