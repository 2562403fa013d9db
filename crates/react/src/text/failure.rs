//! What failed: the property, the values when it failed, when, what led to it, how often, and what to look at.

use lapwing_stream::{Time, Value, Verdict};

use super::paint::Paint;
use super::table::table;
use crate::report::{Property, Reading, Report, Role, Violation};
use crate::shown::{Origin, count, seconds, value};

/// So many further episodes are listed.
const LISTED: usize = 5;

/// Everything about one property that is not well. It begins with the line, the property and the values.
pub(crate) fn explanation(report: &Report, property: &Property, paint: Paint) -> String {
    let origin = Origin::of(report);
    let heading = match property.has_failed() {
        true => paint.alarm(&format!("Error at line {}:", property.line)),
        false => paint.doubt(&format!("Not judged, line {}:", property.line)),
    };
    let mut out = format!("{heading}\n{}", indented(&property.text));
    match property.violations.first() {
        Some(first) => out += &violated(property, first, origin, paint),
        None if property.verdict == Verdict::Unmet => out += &unmet(report, property, origin, paint),
        None => out += &format!("{}\n", paint.doubt(&property.cause.clone().unwrap_or_default())),
    }
    for reaction in &property.reactions {
        let when = if reaction.starts_with("would ") { "On a live robot" } else { "On violation" };
        out += &format!("{when}: {reaction}\n");
    }
    for hint in &property.hints {
        out += &format!("{} {}\n", paint.doubt("Look at:"), hint.replace('\n', "\n  "));
    }
    out += &format!(
        "Where: {}:{}:{} ({}), {}\n",
        property.file, property.line, property.column, property.name, report.trace
    );
    out
}

fn violated(property: &Property, first: &Violation, origin: Origin, paint: Paint) -> String {
    let mut out = String::new();
    if let Some(why) = &first.why {
        out += &format!("{}\n", paint.alarm(why));
    }
    if let Some(values) = first.values.as_ref().filter(|v| !v.is_empty()) {
        out += &format!("{}\n{}", paint.heading("Failing state:"), readings(values));
    }
    out += &format!("{}\n", when(first, origin));
    let history = table(first, origin);
    if !history.is_empty() {
        out += &format!("{}\n{history}", paint.heading("What led to it:"));
    }
    out + &how_often(property, origin)
}

fn unmet(report: &Report, property: &Property, origin: Origin, paint: Paint) -> String {
    let mut out = String::new();
    if !property.at_end.is_empty() {
        out += &format!("{}\n{}", paint.heading("State at the end:"), readings(&property.at_end));
    }
    let end = report.span.map(|(_, end)| format!(" at {}", origin.time(end))).unwrap_or_default();
    let since = property.unmet_since.map(|t| format!(" It was due since {}.", origin.time(t))).unwrap_or_default();
    out + &format!("What had to happen did not happen before the recording ended{end}.{since}\n")
}

fn when(violation: &Violation, origin: Origin) -> String {
    let Violation { began, failed, .. } = *violation;
    match began == failed {
        true => format!("Failed at {}.", origin.time(failed)),
        false => {
            let later = seconds(i128::from(failed.0) - i128::from(began.0));
            format!("Failed at {}; what failed began at {}, {later} earlier.", origin.time(failed), origin.time(began))
        }
    }
}

fn how_often(property: &Property, origin: Origin) -> String {
    let obligations = property.obligations;
    let failures = count(obligations.failed, "failure", "failures");
    let open = if obligations.open > 0 { format!(", {} open", obligations.open) } else { String::new() };
    let met = format!("{} met{open}", obligations.met);
    let episodes = &property.violations;
    let mut out = match episodes.as_slice() {
        [only] if only.count > 1 => format!("{failures} {}; {met}.\n", stretch(only.failed, only.until, origin)),
        [_] => format!("1 failure; {met}.\n"),
        _ => format!("{failures} in {}; {met}.\n", count(episodes.len() as u64, "episode", "episodes")),
    };
    let more = episodes.iter().skip(1);
    for violation in more.clone().take(LISTED) {
        let failures = count(violation.count, "failure", "failures");
        out += &format!("  again {} ({failures})\n", stretch(violation.failed, violation.until, origin));
    }
    match more.count().saturating_sub(LISTED) {
        0 => out,
        rest => out + &format!("  and {} more\n", count(rest as u64, "episode", "episodes")),
    }
}

fn stretch(from: Time, until: Time, origin: Origin) -> String {
    match from == until {
        true => format!("at {}", origin.time(from)),
        false => format!("from {} to {}", origin.time(from), origin.time(until)),
    }
}

/// Values, each on a line, then the conditions that are known.
fn readings(values: &[Reading]) -> String {
    let is_told = |r: &&Reading| match r.role {
        Role::Value => true,
        Role::Part => false,
        Role::Condition => r.value != Value::Missing,
    };
    values.iter().filter(is_told).map(|r| format!("  {}: {}\n", r.name, value(&r.value))).collect()
}

fn indented(text: &str) -> String {
    text.lines().map(|line| format!("  {}\n", line.trim_end())).collect()
}
