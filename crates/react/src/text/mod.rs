//! Reports for people: what failed and why first, then a line for every property, then what was read.

mod failure;
mod paint;
mod table;

use lapwing_diag::Style;
use lapwing_stream::Verdict;

use crate::report::{Property, Report, Topic};
use crate::shown::{Origin, count, margin, seconds};
use crate::tally::Tally;
pub(crate) use paint::Paint;

/// A share of messages that no instant saw, beyond which it is worth a word.
const UNSEEN: f64 = 0.1;

/// So many losses are told one by one: thousands of lines would hide the verdicts.
const MOST_GAPS: usize = 10;

/// The report of one recording.
pub(crate) fn report(report: &Report, style: Style) -> String {
    let paint = Paint(style);
    let mut out = String::new();
    for property in report.properties.iter().filter(|p| p.has_failed()) {
        out += &explanation(report, property, style);
        out.push('\n');
    }
    out += &paint.heading(&heading(report));
    out.push('\n');
    let width = report.properties.iter().map(|p| label(report, p).chars().count()).max().unwrap_or(0).min(40);
    for property in &report.properties {
        out += &verdict(report, property, width, paint);
    }
    out += &remarks(report);
    out
}

/// Everything about one property that is not well, as text.
pub fn explanation(report: &Report, property: &Property, style: Style) -> String {
    failure::explanation(report, property, Paint(style))
}

/// What there is to say at the end, after several recordings.
pub(crate) fn summary(tally: &Tally, style: Style) -> String {
    let paint = Paint(style);
    let counts = Tally::VERDICTS.iter().zip(tally.verdicts).filter(|(_, n)| *n > 0);
    let mut parts: Vec<String> = counts.map(|(v, n)| paint.verdict(*v, &format!("{n} {}", v.word()))).collect();
    if tally.vacuous > 0 {
        parts.push(paint.doubt(&format!("{} vacuous", tally.vacuous)));
    }
    if tally.gaps > 0 {
        let cut = match tally.is_live {
            true => format!("{} cut short", count(tally.gaps, "run", "runs")),
            false => format!("{} not read whole", count(tally.gaps, "recording", "recordings")),
        };
        parts.push(paint.doubt(&cut));
    }
    if parts.is_empty() {
        let why =
            if tally.traces == 0 { "there was no recording to check" } else { "the specification has no property" };
        parts.push(paint.doubt(&format!("nothing was checked: {why}")));
    }
    let traces = match tally.traces {
        0 | 1 => String::new(),
        n if tally.is_live => format!(" in {}", count(n, "run", "runs")),
        n => format!(" in {}", count(n, "recording", "recordings")),
    };
    format!("\n{}{traces}\n", parts.join(", "))
}

/// What is said of a property in one line.
pub(crate) fn verdict_line(property: &Property, origin: Origin) -> String {
    let details = details(property, origin);
    match details.is_empty() {
        true => property.verdict.word().to_owned(),
        false => format!("{}: {details}", property.verdict),
    }
}

/// The details of a property without what is said of the recording as a whole, in a line of its own: it may be long, and would stand at every
/// property.
fn said_once(report: &Report, details: String) -> String {
    let without = |gap: &String| details.strip_suffix(gap.as_str())?.strip_suffix(": ").map(str::to_owned);
    report.gaps.iter().find_map(without).unwrap_or(details)
}

/// What was read, what went unseen, and what else is to be known, each on a line.
pub(crate) fn remarks(report: &Report) -> String {
    let mut lines = Vec::new();
    lines.extend(report.topics.iter().filter_map(unseen));
    lines.extend(gaps(&report.gaps));
    let origin = Origin::of(report);
    lines.extend(report.warnings.iter().filter(|w| !w.is_shown).map(|w| match (w.code, w.at) {
        (Some(code), _) => format!("warning[{code}]: {}", w.message),
        (None, Some(at)) => format!("warning: at {}: {}", origin.time(at), w.message),
        (None, None) => format!("warning: {}", w.message),
    }));
    lines.iter().map(|line| format!("  {}\n", line.replace('\n', "\n    "))).collect()
}

/// What was not looked at. Of much the first and the last are told: the last may say that there is more than anyone has listed.
fn gaps(gaps: &[String]) -> Vec<String> {
    let told = |gap: &String| format!("not everything was looked at: {gap}");
    match gaps {
        [first @ .., last] if gaps.len() > MOST_GAPS => {
            let (told_ones, more) = first.split_at(MOST_GAPS - 1);
            let and_so_on =
                format!("not everything was looked at: {} more like these, which `--format json` lists", more.len());
            told_ones.iter().map(told).chain([and_so_on, told(last)]).collect()
        }
        _ => gaps.iter().map(told).collect(),
    }
}

/// A word about a topic of which a part went unseen. Much of it is a warning, which the report has anyway.
fn unseen(topic: &Topic) -> Option<String> {
    let some = topic.unseen > 0 && (topic.unseen as f64) <= UNSEEN * topic.messages as f64;
    some.then(|| {
        format!(
            "{}: {} of {} messages came between two instants and went unseen",
            topic.name, topic.unseen, topic.messages
        )
    })
}

fn heading(report: &Report) -> String {
    let messages = report.topics.iter().map(|t| t.messages).sum::<u64>();
    let mut parts = Vec::new();
    match report.span {
        Some((start, end)) => parts.push(seconds(i128::from(end.0) - i128::from(start.0))),
        None => parts.push("no message".to_owned()),
    }
    if !report.topics.is_empty() {
        let of = count(report.topics.len() as u64, "topic", "topics");
        parts.push(format!("{} of {of}", count(messages, "message", "messages")));
    }
    parts.push(count(report.instants, "instant", "instants"));
    let origin = Origin::of(report);
    if origin != Origin(Default::default()) {
        parts.push(format!("times count from {}", origin.0));
    }
    format!("{}: {}", report.trace, parts.join(", "))
}

/// What a property is called beside others: of several specifications, with its file.
fn label(report: &Report, property: &Property) -> String {
    match report.specs.len() {
        0 | 1 => property.name.clone(),
        _ => format!("{}: {}", property.file, property.name),
    }
}

/// The line of a property, and those that belong to it.
fn verdict(report: &Report, property: &Property, width: usize, paint: Paint) -> String {
    let word = paint.verdict(property.verdict, &format!("{:<12}", property.verdict.word()));
    let name = format!("{:<width$}", label(report, property));
    let details = said_once(report, details(property, Origin::of(report)));
    let mut out = format!("  {word}  {name}  {details}").trim_end().to_owned() + "\n";
    if !property.has_failed() {
        out.extend(property.hints.iter().map(|hint| format!("      {}\n", hint.replace('\n', "\n      "))));
    }
    out
}

/// What a verdict rests on, in a few words.
pub fn details(property: &Property, origin: Origin) -> String {
    let obligations = property.obligations;
    let mut parts = match property.verdict {
        Verdict::Violated => {
            let failures = count(obligations.failed, "failure", "failures");
            let episodes = count(property.violations.len() as u64, "episode", "episodes");
            let first = property.violations.first().map(|v| format!(", first at {}", origin.time(v.failed)));
            vec![format!("{failures} in {episodes}{}", first.unwrap_or_default())]
        }
        Verdict::Unmet => vec!["what had to happen did not happen before the recording ended".to_owned()],
        Verdict::Inconclusive => vec![property.cause.clone().unwrap_or_else(|| "no cause is known".to_owned())],
        Verdict::Holds | Verdict::Satisfied => Vec::new(),
    };
    if property.verdict.is_success() {
        let open = if obligations.open > 0 { format!(", {} open", obligations.open) } else { String::new() };
        match obligations.met {
            0 if property.scopes.is_empty() && obligations.open == 0 => {
                parts.push("nothing was put to the test".to_owned())
            }
            met => parts.push(format!("met {}{open}", count(met, "time", "times"))),
        }
    }
    parts.extend(property.margin.map(margin));
    if property.vacuous {
        let idle = property.scopes.iter().filter(|s| s.entered == 0).map(|s| format!("`{}`", s.text));
        parts.push(format!("vacuous, never triggered: {}", idle.collect::<Vec<_>>().join(", ")));
    }
    if property.nans > 0 {
        parts.push(format!("{} met NaN, which is never true", count(property.nans, "comparison", "comparisons")));
    }
    parts.join("; ")
}
