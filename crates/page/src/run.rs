//! What is to be read of a recording: what came of it at the top, then the properties, those that failed first.

use lapwing_react::history::History;
use lapwing_react::shown::{Origin, count, seconds};
use lapwing_react::{Property, Report, Standing, Warning};
use lapwing_stream::Verdict;

use crate::html::{json, name, text};
use crate::{data, index, property};

/// A recording on the page.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The recording, as it was named.
    pub(crate) trace: String,
    /// Its cells in the index: what came of it, and of each property.
    pub(crate) result: String,
    pub(crate) marks: String,
    /// The properties, by which the index has columns.
    pub(crate) names: Vec<String>,
    /// What came of it.
    pub(crate) standing: Standing,
    /// Its own part of the page, as HTML.
    pub(crate) article: String,
    /// What its charts draw.
    pub(crate) data: String,
    /// What the document is called where it is the only one.
    pub(crate) title: String,
}

/// A recording on the page: what was said of it, and how it went with each of its specifications.
pub fn entry(report: &Report, histories: &[History]) -> Entry {
    Entry {
        trace: report.trace.clone(),
        result: index::result(report),
        marks: index::marks(report),
        names: report.properties.iter().map(|p| p.name.clone()).collect(),
        standing: report.standing(),
        article: article(report, histories),
        data: json(&data::charts(report, histories)),
        title: format!("{}: {}", report.trace, headline(report)),
    }
}

fn article(report: &Report, histories: &[History]) -> String {
    let courses: Vec<_> = histories.iter().flat_map(|h| &h.courses).collect();
    let mut order: Vec<usize> = (0..report.properties.len()).collect();
    // Stable: those that came out alike stay in the order of the text.
    order.sort_by_key(|i| urgency(&report.properties[*i]));
    let card = |i: &usize| property::card(report, *i, &report.properties[*i], courses.get(*i).copied());
    let cards: String = order.iter().map(card).collect();
    format!(
        "<header class=\"verdict {standing}\">\n<h1>{headline}</h1>\n<p class=\"trace\">{trace}</p>\n<p class=\"meta\">{meta}</p>\n</header>\n\
         {remarks}<div class=\"bar\"><h2 id=\"timeline\">Timeline</h2>{tools}</div>\n<section class=\"timeline\" aria-labelledby=\"timeline\">\n\
         <figure class=\"chart\" data-chart=\"lanes\"></figure>\n</section>\n\
         <section class=\"properties\" aria-labelledby=\"properties\">\n<h2 id=\"properties\">Properties</h2>\n{cards}</section>\n\
         {topics}",
        standing = standing(report.standing()),
        headline = headline(report),
        trace = name(&report.trace),
        meta = meta(report),
        remarks = remarks(report),
        tools = TOOLS,
        topics = topics(report),
    )
}

/// The buttons that move through time; the scripts give them their work.
const TOOLS: &str = "<div class=\"tools\" role=\"toolbar\" aria-label=\"Time shown\" hidden>\
    <span class=\"shown\" role=\"status\"></span>\
    <button type=\"button\" data-do=\"earlier\" aria-label=\"Earlier\" title=\"Earlier (left arrow)\">←</button>\
    <button type=\"button\" data-do=\"later\" aria-label=\"Later\" title=\"Later (right arrow)\">→</button>\
    <button type=\"button\" data-do=\"in\" aria-label=\"Zoom in\" title=\"Zoom in (+)\">+</button>\
    <button type=\"button\" data-do=\"out\" aria-label=\"Zoom out\" title=\"Zoom out (-)\">−</button>\
    <button type=\"button\" data-do=\"all\" title=\"The whole recording (0)\">Whole recording</button></div>";

/// What matters most comes first.
fn urgency(property: &Property) -> u8 {
    match property.verdict {
        Verdict::Violated => 0,
        Verdict::Unmet => 1,
        Verdict::Inconclusive => 2,
        _ if property.vacuous => 3,
        Verdict::Satisfied | Verdict::Holds => 4,
    }
}

/// What came of a recording, in one sentence without a full stop.
pub(crate) fn headline(report: &Report) -> String {
    let all = report.properties.len() as u64;
    let of = |n: usize| match (n as u64, all) {
        (1, 1) => "The property".to_owned(),
        (n, all) if n == all => format!("All {all} properties"),
        (n, all) => format!("{n} of {}", count(all, "property", "properties")),
    };
    let failed = report.properties.iter().filter(|p| p.has_failed()).count();
    let open = report.properties.iter().filter(|p| p.verdict == Verdict::Inconclusive).count();
    match (failed, open) {
        _ if all == 0 => "No property was checked".to_owned(),
        (0, 0) => format!("{} held", of(all as usize)),
        (0, open) => format!("{} could not be judged", of(open)),
        (failed, 0) => format!("{} failed", of(failed)),
        (failed, open) => format!("{} failed, {open} could not be judged", of(failed)),
    }
}

/// What styles call it.
pub(crate) fn standing(standing: Standing) -> &'static str {
    match standing {
        Standing::Failed => "failed",
        Standing::Open => "open",
        Standing::Good => "good",
    }
}

fn meta(report: &Report) -> String {
    let mut parts: Vec<String> = report.specs.iter().map(|spec| name(spec)).collect();
    parts.push(match report.span {
        Some((start, end)) => seconds(i128::from(end.0) - i128::from(start.0)),
        None => "no message".to_owned(),
    });
    parts.push(count(report.instants, "instant", "instants"));
    let origin = Origin::of(report);
    if origin.0.0 != 0 {
        parts.push(format!("times count from {}", origin.0));
    }
    parts.join(" <span aria-hidden=\"true\">·</span> ")
}

/// What else its reader should know.
fn remarks(report: &Report) -> String {
    let gaps = report.gaps.iter().map(|gap| format!("<li>Not everything was looked at: {}</li>\n", text(gap)));
    let warnings = report.warnings.iter().map(|w| format!("<li>{}</li>\n", warning(w)));
    let all: String = gaps.chain(warnings).collect();
    match all.as_str() {
        "" => String::new(),
        all => format!("<section class=\"remarks\" aria-label=\"Remarks\"><ul>\n{all}</ul></section>\n"),
    }
}

fn warning(warning: &Warning) -> String {
    let place = warning.place.as_ref().map(|(file, line, column)| format!(" ({file}:{line}:{column})"));
    let code = warning.code.map(|code| format!(" <code>{code}</code>")).unwrap_or_default();
    text(&warning.message) + &text(&place.unwrap_or_default()) + &code
}

/// What was read.
fn topics(report: &Report) -> String {
    if report.topics.is_empty() {
        return String::new();
    }
    let row = |topic: &lapwing_react::Topic| {
        let unseen = if topic.unseen > 0 { topic.unseen.to_string() } else { "-".to_owned() };
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{unseen}</td></tr>\n",
            name(&topic.name),
            text(topic.type_name.as_deref().unwrap_or("-")),
            topic.messages
        )
    };
    let rows: String = report.topics.iter().map(row).collect();
    format!(
        "<details class=\"topics\"><summary><h2>What was read</h2></summary>\n<table>\n<thead><tr><th scope=\"col\">topic</th>\
         <th scope=\"col\">type</th><th scope=\"col\">messages</th><th scope=\"col\">unseen</th></tr></thead>\n<tbody>\n{rows}</tbody></table></details>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(verdicts: &[Verdict]) -> Report {
        let property =
            |verdict: &Verdict| Property { verdict: *verdict, ..Property::new("p", "a.rv", (1, 1), "never x") };
        Report { properties: verdicts.iter().map(property).collect(), ..Report::default() }
    }

    #[test]
    fn the_headline_says_what_came_of_it() {
        use Verdict::*;
        let of = |verdicts: &[Verdict]| headline(&report(verdicts));
        assert_eq!(of(&[]), "No property was checked");
        assert_eq!(of(&[Holds]), "The property held");
        assert_eq!(of(&[Holds, Satisfied]), "All 2 properties held");
        assert_eq!(of(&[Violated, Unmet, Holds]), "2 of 3 properties failed");
        assert_eq!(of(&[Violated, Inconclusive, Holds]), "1 of 3 properties failed, 1 could not be judged");
        assert_eq!(of(&[Holds, Inconclusive]), "1 of 2 properties could not be judged");
    }

    #[test]
    fn what_failed_comes_first() {
        let mut report = report(&[Verdict::Holds, Verdict::Violated, Verdict::Inconclusive]);
        report.properties.iter_mut().zip(["a", "b", "c"]).for_each(|(p, name)| p.name = name.into());
        let article = article(&report, &[]);
        let at = |name: &str| article.find(&format!("<bdi>{name}</bdi>")).unwrap();
        assert!(at("b") < at("c") && at("c") < at("a"));
    }
}
