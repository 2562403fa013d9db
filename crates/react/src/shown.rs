//! How values, times and counts are shown to people.

use lapwing_stream::{Time, Value};

use crate::report::Report;

/// A recording whose first stamp is later than this counts in some calendar: its times are shown from its beginning.
const CALENDAR: i64 = 1_000_000_000_000_000;

/// The most elements of an array that are shown.
const ELEMENTS: usize = 4;

/// From when times are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin(pub Time);

impl Origin {
    /// Zero, or the beginning of a recording that counts in some calendar.
    pub fn of(report: &Report) -> Origin {
        report.span.map_or(Origin(Time(0)), |(start, _)| Origin::of_start(start))
    }

    /// The same, of what begins at that time.
    pub fn of_start(start: Time) -> Origin {
        if start.0.unsigned_abs() >= CALENDAR as u64 { Origin(start) } else { Origin(Time(0)) }
    }

    /// A stamp in seconds, to the microsecond: `12.5 s`.
    pub fn time(self, time: Time) -> String {
        seconds(i128::from(time.0) - i128::from(self.0.0))
    }
}

/// Nanoseconds as seconds, to the microsecond: `12.5 s`.
pub fn seconds(nanos: i128) -> String {
    let sign = if nanos < 0 { "-" } else { "" };
    let micros = (nanos.unsigned_abs() + 500) / 1000;
    let text = format!("{sign}{}.{:06}", micros / 1_000_000, micros % 1_000_000);
    format!("{} s", text.trim_end_matches('0').trim_end_matches('.'))
}

/// A value on one line, every digit of it.
pub fn value(of: &Value) -> String {
    match of {
        Value::Missing => "undefined".to_owned(),
        Value::Bool(b) => b.to_string(),
        Value::Num(x) => number(*x),
        Value::Str(s) => format!("{s:?}"),
        Value::Nums(xs) => list(xs.len(), xs.iter().map(|x| number(*x))),
        Value::List(xs) => list(xs.len(), xs.iter().map(value)),
        Value::Record(fields) => {
            let fields: Vec<_> = fields.iter().map(|(n, v)| format!("{n}: {}", value(v))).collect();
            format!("{{ {} }}", fields.join(", "))
        }
    }
}

/// A value in a cell of a table: numbers to five digits.
pub fn cell(of: &Value) -> String {
    match of {
        Value::Missing => "-".to_owned(),
        Value::Num(x) => rounded(*x),
        other => value(other),
    }
}

/// A margin: rounded, and infinite where nothing that was compared decides.
pub fn margin(margin: f64) -> String {
    match margin {
        f64::INFINITY => "margin ∞".to_owned(),
        f64::NEG_INFINITY => "margin -∞".to_owned(),
        x => format!("margin {}", rounded(x)),
    }
}

/// `1 failure`, `2 failures`.
pub fn count(n: u64, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn number(x: f64) -> String {
    match x {
        x if x != 0.0 && x.is_finite() && !(1e-5..1e16).contains(&x.abs()) => format!("{x:e}"),
        x => x.to_string(),
    }
}

fn rounded(x: f64) -> String {
    match x {
        x if x == 0.0 || !x.is_finite() => number(x),
        x if (1e-3..1e6).contains(&x.abs()) => {
            let digits = (4 - x.abs().log10().floor() as i32).clamp(0, 8) as usize;
            let text = format!("{x:.digits$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        x => format!("{x:.3e}"),
    }
}

fn list(length: usize, elements: impl Iterator<Item = String>) -> String {
    let shown: Vec<_> = elements.take(ELEMENTS).collect();
    match length > ELEMENTS {
        true => format!("[{}, … {length} in all]", shown.join(", ")),
        false => format!("[{}]", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_exact_in_lists_of_values_and_short_in_tables() {
        let shown = |x: f64| (value(&Value::Num(x)), cell(&Value::Num(x)));
        assert_eq!(shown(1.000545118597548), ("1.000545118597548".into(), "1.0005".into()));
        assert_eq!(shown(3.59827874925e-5), ("0.0000359827874925".into(), "3.598e-5".into()));
        assert_eq!(shown(-0.25), ("-0.25".into(), "-0.25".into()));
        assert_eq!(shown(12.0), ("12".into(), "12".into()));
        assert_eq!(shown(1e300), ("1e300".into(), "1.000e300".into()));
        assert_eq!(shown(f64::NAN), ("NaN".into(), "NaN".into()));
    }

    #[test]
    fn times_are_rounded_to_the_microsecond() {
        let shown = [0, 499, 1500, 3_433_333_333, -50_000_000].map(seconds);
        assert_eq!(shown, ["0 s", "0 s", "0.000002 s", "3.433333 s", "-0.05 s"]);
    }

    #[test]
    fn long_arrays_are_cut() {
        assert_eq!(value(&Value::Nums(vec![1.0, 2.0])), "[1, 2]");
        assert_eq!(value(&Value::Nums(vec![0.0; 360])), "[0, 0, 0, 0, … 360 in all]");
    }
}
