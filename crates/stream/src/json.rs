//! Values as recordings in JSON have them.

use alloc::string::String;
use core::fmt::Write;

use crate::Value;

/// Writes a value at the end of a line. What is no number, and what has no end, is written beyond the standard, as readers of recordings take it.
///
/// ```
/// use lapwing_stream::{Value, json};
///
/// let mut line = String::from("values: ");
/// json::value(&mut line, &Value::List(vec![Value::Num(1.0), Value::Str("a \"b\"".into()), Value::Missing]));
/// assert_eq!(line, r#"values: [1.0,"a \"b\"",null]"#);
/// ```
pub fn value(line: &mut String, value: &Value) {
    match value {
        Value::Missing => line.push_str("null"),
        Value::Bool(b) => line.push_str(if *b { "true" } else { "false" }),
        Value::Num(x) => number(line, *x),
        Value::Str(s) => text(line, s),
        Value::Nums(numbers) => list(line, numbers, |line, x| number(line, *x)),
        Value::List(items) => list(line, items, self::value),
        Value::Record(fields) => {
            line.push('{');
            for (place, (name, field)) in fields.iter().enumerate() {
                if place > 0 {
                    line.push(',');
                }
                text(line, name);
                line.push(':');
                self::value(line, field);
            }
            line.push('}');
        }
    }
}

/// Writes a text at the end of a line, in quotes.
pub fn text(line: &mut String, text: &str) {
    line.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => line.extend(['\\', c]),
            // Writing to a text cannot fail.
            c if c < ' ' => _ = write!(line, "\\u{:04x}", u32::from(c)),
            c => line.push(c),
        }
    }
    line.push('"');
}

fn number(line: &mut String, x: f64) {
    if x.is_nan() {
        line.push_str("NaN");
    } else if x.is_infinite() {
        line.push_str(if x > 0.0 { "Infinity" } else { "-Infinity" });
    } else {
        // Writing to a text cannot fail.
        let _ = write!(line, "{x:?}");
    }
}

fn list<T>(line: &mut String, items: &[T], one: impl Fn(&mut String, &T)) {
    line.push('[');
    for (place, item) in items.iter().enumerate() {
        if place > 0 {
            line.push(',');
        }
        one(line, item);
    }
    line.push(']');
}
