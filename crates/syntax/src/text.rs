//! Strings: JSON's escapes, both ways.

use std::ops::Range;

/// What a string literal (with its quotation marks) says, and the escapes in it that are none, by their places in it.
pub(crate) fn decode(literal: &str) -> (String, Vec<(Range<usize>, String)>) {
    let inner = literal.strip_prefix('"').unwrap_or(literal);
    let inner = inner.strip_suffix('"').unwrap_or(inner);
    let mut decoded = String::with_capacity(inner.len());
    let mut faults = Vec::new();
    let mut at = 0;
    while let Some(c) = inner[at..].chars().next() {
        if c != '\\' {
            if c < ' ' && c != '\t' {
                faults.push((at + 1..at + 2, "a control character stands in a text only as an escape".to_owned()));
            }
            decoded.push(c);
            at += c.len_utf8();
            continue;
        }
        let (length, escaped) = escape(&inner[at..]);
        match escaped {
            Some(c) => decoded.push(c),
            None => faults.push((at + 1..at + 1 + length, format!("`{}` is no escape", &inner[at..at + length]))),
        }
        at += length;
    }
    (decoded, faults)
}

/// The escape that `rest` begins with: how long it is, and what it stands for.
fn escape(rest: &str) -> (usize, Option<char>) {
    let Some(c) = rest.chars().nth(1) else { return (rest.len(), None) };
    let simple = match c {
        '"' | '\\' | '/' => c,
        'b' => '\u{8}',
        'f' => '\u{c}',
        'n' => '\n',
        'r' => '\r',
        't' => '\t',
        'u' => return unicode(rest),
        _ => return (1 + c.len_utf8(), None),
    };
    (2, Some(simple))
}

/// `\u0041`, or a surrogate pair of two such.
fn unicode(rest: &str) -> (usize, Option<char>) {
    let Some(first) = code_unit(rest) else { return (2, None) };
    if let Some(c) = char::from_u32(first) {
        return (6, Some(c));
    }
    let second = rest.get(6..).and_then(code_unit).filter(|low| (0xdc00..0xe000).contains(low));
    match second {
        Some(low) if first < 0xdc00 => (12, char::from_u32(0x10000 + ((first - 0xd800) << 10) + (low - 0xdc00))),
        _ => (6, None),
    }
}

/// The number of `\u0041`.
fn code_unit(rest: &str) -> Option<u32> {
    let digits = rest.strip_prefix("\\u")?.get(..4)?;
    if digits.bytes().all(|b| b.is_ascii_hexdigit()) { u32::from_str_radix(digits, 16).ok() } else { None }
}

/// A string as a literal, with its quotation marks.
pub(crate) fn encode(text: &str) -> String {
    let mut literal = String::with_capacity(text.len() + 2);
    literal.push('"');
    for c in text.chars() {
        match c {
            '"' => literal.push_str("\\\""),
            '\\' => literal.push_str("\\\\"),
            '\n' => literal.push_str("\\n"),
            '\r' => literal.push_str("\\r"),
            '\t' => literal.push_str("\\t"),
            c if c < ' ' => literal.push_str(&format!("\\u{:04x}", c as u32)),
            c => literal.push(c),
        }
    }
    literal.push('"');
    literal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_those_of_json() {
        let (text, faults) = decode(r#""a\"b\\\/\b\f\n\r\t\u0041\ud83e\udd16""#);
        assert_eq!(text, "a\"b\\/\u{8}\u{c}\n\r\tA🤖");
        assert!(faults.is_empty());
    }

    #[test]
    fn what_is_no_escape_is_found_where_it_stands() {
        let (_, faults) = decode(r#""a\q \ud800 \u12 é\é""#);
        let found: Vec<&str> = faults.iter().map(|(range, _)| &r#""a\q \ud800 \u12 é\é""#[range.clone()]).collect();
        assert_eq!(found, ["\\q", "\\ud800", "\\u", "\\é"]);
    }

    #[test]
    fn encoding_and_decoding_give_the_same_text() {
        let text = "a\"b\\ \n\r\t\u{1} é🤖";
        assert_eq!(decode(&encode(text)).0, text);
    }
}
