//! The functions that a model run from the command line finds: to print, and to wait.

use crate::host::Registry;
use crate::log::Sink;
use crate::value::Value;
use std::cmp::Ordering;
use std::time::Duration;

/// Whether waiting takes time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// It takes none.
    Simulated,
    /// It does.
    RealTime,
}

/// `print`, `println`, `puts` and `printf`, which write into the log; `sleep`, `msleep` and `usleep`; `abs`, `min` and `max`.
pub fn standard<'w>(sink: &Sink<'w>, pace: Pace) -> Registry<'w> {
    let printer = |ending: &'static str| {
        let sink = sink.clone();
        move |args: &mut [Value]| {
            let text: String = args.iter().map(Value::to_string).collect();
            let _ = write!(sink.borrow_mut(), "{text}{ending}");
            Ok(Value::Int(text.len() as i64))
        }
    };
    let formatted = sink.clone();
    let waiter = |unit: u64| {
        move |args: &mut [Value]| {
            let count = args.first().and_then(Value::as_int).unwrap_or(0);
            let time = u64::try_from(count).unwrap_or(0).saturating_mul(unit);
            if pace == Pace::RealTime {
                std::thread::sleep(Duration::from_nanos(time));
            }
            Ok(Value::Int(0))
        }
    };
    Registry::default()
        .with("print", printer(""))
        .with("println", printer("\n"))
        .with("puts", printer("\n"))
        .with("printf", move |args| {
            let text = format(args)?;
            let _ = formatted.borrow_mut().write_all(text.as_bytes());
            Ok(Value::Int(text.len() as i64))
        })
        .with("sleep", waiter(1_000_000_000))
        .with("msleep", waiter(1_000_000))
        .with("usleep", waiter(1_000))
        .with("abs", absolute)
        .with("min", |args| extreme(args, Ordering::Less))
        .with("max", |args| extreme(args, Ordering::Greater))
}

fn absolute(args: &mut [Value]) -> Result<Value, String> {
    match args {
        [Value::Int(value)] => {
            value.checked_abs().map(Value::Int).ok_or_else(|| "a number of more than 64 bits".to_owned())
        }
        [Value::Float(value)] => Ok(Value::Float(value.abs())),
        _ => Err("`abs` takes a number".to_owned()),
    }
}

/// The one of two numbers that stands so to the other.
fn extreme(args: &mut [Value], wanted: Ordering) -> Result<Value, String> {
    match args {
        [Value::Int(a), Value::Int(b)] => Ok(Value::Int(if a.cmp(&b) == wanted { *a } else { *b })),
        [Value::Float(a), Value::Float(b)] => Ok(Value::Float(if a.total_cmp(b) == wanted { *a } else { *b })),
        _ => Err("`min` and `max` take two numbers of one type".to_owned()),
    }
}

/// No field of `printf` is wider.
const MAX_WIDTH: usize = 1000;

/// What `printf` prints: `%d`, `%i`, `%u`, `%x`, `%f`, `%g`, `%s`, `%c` and `%%`, with width, precision, `-` and `0`.
fn format(args: &[Value]) -> Result<String, String> {
    let Some((Value::Text(pattern), mut rest)) = args.split_first() else {
        return Err("`printf` takes a text first".to_owned());
    };
    let mut out = String::new();
    let mut chars = pattern.chars().peekable();
    while let Some(c) = chars.next() {
        if c != '%' {
            out.push(c);
            continue;
        }
        let mut spec = String::new();
        while let Some(part) = chars.next_if(|c| c.is_ascii_digit() || "-+ .0lh".contains(*c)) {
            spec.push(part);
        }
        match chars.next() {
            Some('%') => out.push('%'),
            Some(kind) => {
                let Some((value, others)) = rest.split_first() else {
                    return Err("`printf` has fewer values than its text asks for".to_owned());
                };
                rest = others;
                out.push_str(&field(&spec, kind, value));
            }
            None => out.push('%'),
        }
    }
    Ok(out)
}

fn field(spec: &str, kind: char, value: &Value) -> String {
    let spec = spec.trim_end_matches(['l', 'h']);
    let (width, precision) = spec.split_once('.').map_or((spec, None), |(w, p)| (w, p.parse::<usize>().ok()));
    let precision = precision.map(|p| p.min(MAX_WIDTH));
    let is_left = width.contains('-');
    let has_zeros = width.trim_start_matches(['-', '+', ' ']).starts_with('0') && !is_left;
    let count = width.trim_start_matches(['-', '+', ' ', '0']).parse::<usize>().unwrap_or(0).min(MAX_WIDTH);
    let text = match (kind, value) {
        ('f' | 'F' | 'g' | 'G' | 'e', value) => match (value.as_float(), kind) {
            (Some(number), 'f' | 'F') => format!("{number:.*}", precision.unwrap_or(6)),
            (Some(number), _) => number.to_string(),
            (None, _) => value.to_string(),
        },
        ('x', Value::Int(number)) => format!("{number:x}"),
        ('d' | 'i' | 'u', Value::Bool(value)) => u8::from(*value).to_string(),
        ('c', Value::Int(number)) => {
            u32::try_from(*number).ok().and_then(char::from_u32).map_or(String::new(), String::from)
        }
        (_, value) => value.to_string(),
    };
    match (is_left, has_zeros) {
        (true, _) => format!("{text:<count$}"),
        (false, true) if !text.starts_with('-') => format!("{text:0>count$}"),
        (false, true) => format!("-{:0>1$}", text.trim_start_matches('-'), count.saturating_sub(1)),
        (false, false) => format!("{text:>count$}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printf_prints_as_in_c() {
        let print = |pattern: &str, args: &[Value]| {
            let mut all = vec![Value::Text(pattern.into())];
            all.extend_from_slice(args);
            format(&all)
        };
        assert_eq!(
            print("a %d, %5d|%-5d|%05d", &[1, 2, 3, -4].map(Value::Int)).as_deref(),
            Ok("a 1,     2|3    |-0004")
        );
        assert_eq!(print("%.2f %s %%", &[Value::Float(1.5), Value::Bool(true)]).as_deref(), Ok("1.50 true %"));
        assert!(print("%d", &[]).is_err());
        assert!(format(&[Value::Int(1)]).is_err());
        let wide = print("%99999d", &[Value::Int(1)]);
        assert!(wide.is_ok_and(|text| text.len() <= MAX_WIDTH));
    }
}
