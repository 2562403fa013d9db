//! A value that was recorded as text, by its `Debug` or `Display`, read as the literal that it looks like.

/// What a text looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Literal<'t> {
    Bool(bool),
    Num(f64),
    /// A text without escapes, or one that is no literal at all.
    Plain(&'t str),
    /// What stands between quotation marks, with escapes.
    Escaped(&'t str),
}

/// Reads `true`, `-0.5`, `NaN`, `"a text"`, `'c'`; anything else is the text that it is.
pub(crate) fn read(text: &str) -> Literal<'_> {
    match text {
        "true" => return Literal::Bool(true),
        "false" => return Literal::Bool(false),
        "NaN" | "inf" | "-inf" => return text.parse().map_or(Literal::Plain(text), Literal::Num),
        _ => {}
    }
    let starts_number = |c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.');
    if text.starts_with(starts_number)
        && text.ends_with(|c: char| c.is_ascii_digit() || c == '.')
        && let Ok(number) = text.parse()
    {
        return Literal::Num(number);
    }
    let quoted = |mark| text.strip_prefix(mark).and_then(|t: &str| t.strip_suffix(mark));
    match quoted('"').or_else(|| quoted('\'')) {
        Some(inner) if inner.contains('\\') => Literal::Escaped(inner),
        Some(inner) => Literal::Plain(inner),
        None => Literal::Plain(text),
    }
}

/// Appends a text with Rust's escapes resolved; one that is none stays as it is.
pub(crate) fn unescape(text: &str, into: &mut String) {
    let mut rest = text.chars();
    while let Some(c) = rest.next() {
        if c != '\\' {
            into.push(c);
            continue;
        }
        let mut ahead = rest.clone();
        let resolved = match ahead.next() {
            Some('n') => Some('\n'),
            Some('t') => Some('\t'),
            Some('r') => Some('\r'),
            Some('0') => Some('\0'),
            Some(mark @ ('\\' | '"' | '\'')) => Some(mark),
            Some('u') => unicode(&mut ahead),
            _ => None,
        };
        match resolved {
            Some(c) => {
                into.push(c);
                rest = ahead;
            }
            None => into.push('\\'),
        }
    }
}

/// `{1f916}` after `\u`.
fn unicode(rest: &mut std::str::Chars<'_>) -> Option<char> {
    let (digits, after) = rest.as_str().strip_prefix('{')?.split_once('}')?;
    let c = char::from_u32(u32::from_str_radix(digits, 16).ok()?)?;
    *rest = after.chars();
    Some(c)
}

#[cfg(test)]
mod tests {
    use lapwing_stream::Value;

    use super::*;

    fn value(text: &str) -> Value {
        match read(text) {
            Literal::Bool(b) => Value::Bool(b),
            Literal::Num(x) => Value::Num(x),
            Literal::Plain(s) => Value::from(s),
            Literal::Escaped(s) => {
                let mut text = String::new();
                unescape(s, &mut text);
                Value::Str(text)
            }
        }
    }

    #[test]
    fn literals_are_read_as_what_they_look_like() {
        assert_eq!(value("true"), Value::Bool(true));
        assert_eq!([value("-12"), value("0.5"), value("1e-7")], [Value::Num(-12.0), Value::Num(0.5), Value::Num(1e-7)]);
        assert_eq!(value("inf"), Value::Num(f64::INFINITY));
        assert!(matches!(value("NaN"), Value::Num(x) if x.is_nan()));
        assert_eq!(value("\"a \\\"b\\\" \\u{e9}\\n\""), Value::from("a \"b\" é\n"));
        assert_eq!(value("'x'"), Value::from("x"));
    }

    #[test]
    fn what_is_no_literal_is_a_text() {
        for text in ["Some(0.5)", "Infinity", "1.5 m", "-", "2024-01-01", "", "\"", "\\q", "nan"] {
            assert_eq!(value(text), Value::from(text), "{text}");
        }
        assert_eq!(value("\"\\q\\u{}\""), Value::from("\\q\\u{}"));
    }
}
