//! What is to be read of a property: verdict, source, meaning, and its violations with the values at each.

use lapwing_react::history::Course;
use lapwing_react::shown::{Origin, cell, count, seconds, value};
use lapwing_react::{Property, Reading, Report, Role, Violation, details};
use lapwing_stream::{Time, Verdict};

use crate::diagram;
use crate::html::{name, text};

/// So many violations of a property are listed.
pub(crate) const LISTED: usize = 200;

/// The card of a property; `course` says what it means, and how it went.
pub(crate) fn card(report: &Report, number: usize, property: &Property, course: Option<&Course>) -> String {
    let origin = Origin::of(report);
    let is_open = if property.has_failed() || property.verdict == Verdict::Inconclusive { " open" } else { "" };
    let key = key(property);
    format!(
        "<details class=\"property {key}\" data-property=\"{number}\"{is_open}>\n\
         <summary><h3>{badge}<span class=\"name\">{name}</span></h3>\
         {said}<span class=\"gist\">{gist}</span></summary>\n\
         <div class=\"body\">\n<div class=\"text\">\n\
         <pre class=\"source\"><code>{source}</code></pre>\n\
         <p class=\"place\">{file}:{line}:{column}</p>\n{meaning}{scopes}{found}{remarks}</div>\n\
         <figure class=\"chart\" data-chart=\"property\" data-property=\"{number}\"></figure>\n{diagram}\
         </div>\n</details>\n",
        badge = badge(property),
        name = self::name(&property.name),
        said = said(property),
        gist = text(&details(property, origin)),
        source = text(&property.text),
        file = text(&property.file),
        line = property.line,
        column = property.column,
        meaning = meaning(course.map_or("", |course| course.words.as_str())),
        diagram = course
            .and_then(|course| course.diagram.as_ref())
            .map(|graph| diagram::figure(graph, number))
            .unwrap_or_default(),
        scopes = scopes(property),
        found = found(report, property, origin),
        remarks = remarks(property),
    )
}

/// The first line of a property that has no name of its own.
fn said(property: &Property) -> String {
    let line = property.text.lines().next().unwrap_or_default();
    match property.name.starts_with("line ") {
        true => format!("<code class=\"said\">{}</code>", text(line)),
        false => String::new(),
    }
}

/// The verdict, with a sign, so that it does not hang on a colour.
pub(crate) fn badge(property: &Property) -> String {
    let (sign, word) = sign(property);
    let vacuous = if property.vacuous { "<span class=\"badge vacuous\">vacuous</span> " } else { "" };
    format!(
        "<span class=\"badge {}\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span>{word}</span> {vacuous}",
        key(property)
    )
}

/// The sign and the word of a verdict.
pub(crate) fn sign(property: &Property) -> (&'static str, &'static str) {
    let sign = match property.verdict {
        Verdict::Violated | Verdict::Unmet => "✕",
        Verdict::Inconclusive => "?",
        _ if property.vacuous => "○",
        Verdict::Satisfied | Verdict::Holds => "✓",
    };
    (sign, property.verdict.word())
}

/// What styles call the verdict.
pub(crate) fn key(property: &Property) -> &'static str {
    match property.verdict {
        Verdict::Violated | Verdict::Unmet => "failed",
        Verdict::Inconclusive => "open",
        Verdict::Satisfied | Verdict::Holds => "good",
    }
}

fn meaning(words: &str) -> String {
    match words {
        "" => String::new(),
        words => format!("<p class=\"words\"><span class=\"label\">Means:</span> {}.</p>\n", text(words)),
    }
}

/// How often each scope was entered.
fn scopes(property: &Property) -> String {
    let item = |scope: &lapwing_react::Scope| {
        let often = match scope.entered {
            0 => "never".to_owned(),
            n => count(n, "time", "times"),
        };
        format!("<li><code>{}</code> entered {often}</li>\n", text(&scope.text))
    };
    let items: String = property.scopes.iter().map(item).collect();
    if items.is_empty() { items } else { format!("<ul class=\"scopes\">\n{items}</ul>\n") }
}

/// What was found: the violations, or what did not happen.
fn found(report: &Report, property: &Property, origin: Origin) -> String {
    if property.verdict == Verdict::Unmet {
        return unmet(report, property, origin);
    }
    if property.violations.is_empty() {
        return String::new();
    }
    let shown = property.violations.iter().take(LISTED).enumerate();
    let items: String = shown.map(|(i, v)| violation(i, v, origin)).collect();
    let rest = property.violations.len().saturating_sub(LISTED);
    let more = match rest {
        0 => String::new(),
        n => format!("<p class=\"more\">and {} more</p>\n", count(n as u64, "violation", "violations")),
    };
    format!("<h4>Violations</h4>\n<ol class=\"violations\">\n{items}</ol>\n{more}")
}

/// A violation: a button that leads to it in the charts, and what is known of it.
fn violation(number: usize, violation: &Violation, origin: Origin) -> String {
    // The first is to be read without a click.
    let hidden = if number == 0 { "" } else { " hidden" };
    let why = violation.why.as_ref().map(|why| format!("<p class=\"why\">{}</p>\n", text(why))).unwrap_or_default();
    format!(
        "<li><button type=\"button\" class=\"violation\" data-violation=\"{number}\" aria-expanded=\"{}\">\
         <span class=\"when\">{}</span><span class=\"what\">{}</span></button>\n\
         <div class=\"evidence\"{hidden}>{why}{}{}</div></li>\n",
        number == 0,
        text(&stretch(violation.failed, violation.until, origin)),
        text(&how_many(violation)),
        sentence(violation, origin),
        values(violation),
    )
}

fn how_many(violation: &Violation) -> String {
    match violation.count {
        1 => violation.why.clone().unwrap_or_default(),
        n => count(n, "failure", "failures"),
    }
}

fn stretch(from: Time, until: Time, origin: Origin) -> String {
    match from == until {
        true => origin.time(from),
        false => format!("{} – {}", origin.time(from), origin.time(until)),
    }
}

fn sentence(violation: &Violation, origin: Origin) -> String {
    let Violation { began, failed, .. } = *violation;
    if began == failed {
        return String::new();
    }
    let later = seconds(i128::from(failed.0) - i128::from(began.0));
    format!("<p>What failed began at {}, {later} before.</p>\n", origin.time(began))
}

/// The values when it began and when it failed, side by side.
fn values(violation: &Violation) -> String {
    let Some(failed) = violation.values.as_ref().filter(|values| !values.is_empty()) else { return String::new() };
    let began = violation.began_values.as_ref().filter(|_| violation.began != violation.failed);
    match began {
        None => table(&["", "when it failed"], failed, |_| Vec::new()),
        Some(began) => table(&["", "when it began", "when it failed"], failed, |name| {
            vec![began.iter().find(|r| r.name == name).map_or_else(|| "-".to_owned(), |r| cell(&r.value))]
        }),
    }
}

fn table(head: &[&str], readings: &[Reading], before: impl Fn(&str) -> Vec<String>) -> String {
    let head: String = head.iter().map(|h| format!("<th scope=\"col\">{h}</th>")).collect();
    let row = |reading: &Reading| {
        let cells: String = before(&reading.name).iter().map(|c| format!("<td>{}</td>", text(c))).collect();
        let last = format!("<td title=\"{}\">{}</td>", text(&value(&reading.value)), text(&cell(&reading.value)));
        format!("<tr><th scope=\"row\">{}</th>{cells}{last}</tr>\n", name(&reading.name))
    };
    // Parts of numbers are for programs: people see the numbers and the signals.
    let rows: String = readings.iter().filter(|r| r.role != Role::Part).map(row).collect();
    format!("<table class=\"values\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table>\n")
}

fn unmet(report: &Report, property: &Property, origin: Origin) -> String {
    let end = report.span.map(|(_, end)| format!(" at {}", origin.time(end))).unwrap_or_default();
    let since = property.unmet_since.map(|t| format!(" It was due since {}.", origin.time(t))).unwrap_or_default();
    let table = match property.at_end.as_slice() {
        [] => String::new(),
        at_end => table(&["", "at the end"], at_end, |_| Vec::new()),
    };
    format!("<p>What had to happen did not happen before the recording ended{end}.{since}</p>\n{table}")
}

/// Reactions and hints.
fn remarks(property: &Property) -> String {
    let reactions =
        property.reactions.iter().map(|r| format!("<p class=\"remark\">On a live robot: {}</p>\n", text(r)));
    let hints = property.hints.iter().map(|h| format!("<p class=\"remark hint\">{}</p>\n", text(h)));
    reactions.chain(hints).collect()
}
