//! Times under other names and in other units than they are read in.

use crate::decimal::{self, DecimalError};

/// What the time is called elsewhere.
const NAMES: &[&str] =
    &["t", "t_ns", "time", "time_ns", "timestamp", "timestamp_ns", "stamp", "stamp_ns", "ts", "seconds", "sec"];

/// Beyond so many seconds a count of other units is likelier: in 64 bits of nanoseconds they have no place.
const UNITS: &[(&[u8], &str)] = &[(b"1e17", "nanoseconds"), (b"1e14", "microseconds"), (b"1e10", "milliseconds")];

/// The name that stands for the time most likely: as it is, or by its first word, as in `Time (s)` and `%time`.
pub(crate) fn like_time<'n>(names: impl Iterator<Item = &'n str> + Clone) -> Option<&'n str> {
    let is_time = |name: &str| NAMES.iter().any(|time| name.eq_ignore_ascii_case(time));
    let first = |name: &'n str| {
        name.split(|c: char| !c.is_alphanumeric() && c != '_').find(|word| !word.is_empty()).unwrap_or_default()
    };
    names.clone().find(|name| is_time(name)).or_else(|| names.clone().find(|name| is_time(first(name))))
}

/// The unit that a number of seconds is in, where it is too large for one.
pub(crate) fn unit_of(seconds: &[u8]) -> Option<&'static str> {
    let magnitude = seconds.strip_prefix(b"-").unwrap_or(seconds);
    let count = decimal::scaled(magnitude, decimal::NANOSECONDS).ok()?;
    let is_beyond = |least: &[u8]| decimal::scaled(least, decimal::NANOSECONDS).is_ok_and(|least| count >= least);
    UNITS.iter().find(|(least, _)| is_beyond(least)).map(|(_, unit)| *unit)
}

/// What is wrong with a number that was to be the time in a unit; `nanos` is the name under which nanoseconds are read.
pub(crate) fn wrong(digits: &[u8], unit: i64, nanos: &str, error: DecimalError) -> String {
    let meant = match (unit, error) {
        (decimal::SECONDS, DecimalError::OutOfRange) => unit_of(digits),
        _ => None,
    };
    match meant {
        Some("nanoseconds") => format!("is too large for seconds (name it `{nanos}` if it is in nanoseconds)"),
        Some(unit) => {
            format!("is too large for seconds, and seems to be in {unit} (write seconds, or nanoseconds as `{nanos}`)")
        }
        None => error.reason().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_known_by_what_others_call_it() {
        let found = |names: &[&'static str]| like_time(names.iter().copied());
        assert_eq!(found(&["speed", "Time"]), Some("Time"));
        assert_eq!(found(&["time to goal", "timestamp"]), Some("timestamp"));
        assert_eq!(found(&["x", "%time"]), Some("%time"));
        assert_eq!(found(&["x", "Time (s)"]), Some("Time (s)"));
        assert_eq!(found(&["timeout", "speed"]), None);
    }

    #[test]
    fn stamps_of_today_tell_their_unit() {
        let units = ["1700000000000000000", "1700000000000000.5", "1.7e12", "1700000000", "soon"];
        let told = [Some("nanoseconds"), Some("microseconds"), Some("milliseconds"), None, None];
        assert_eq!(units.map(|text| unit_of(text.as_bytes())), told);
    }
}
