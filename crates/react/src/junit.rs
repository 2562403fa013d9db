//! Reports as JUnit's XML: what continuous integration shows as tests.

use std::io;

use lapwing_diag::Style;
use lapwing_stream::Verdict;
use quick_xml::Writer;
use quick_xml::events::{BytesEnd, BytesStart, BytesText, Event};

use crate::report::{Property, Report};
use crate::shown::Origin;
use crate::text;

/// A report as a suite: a property that failed is a failure, one that could not be judged an error.
pub(crate) fn suite(report: &Report) -> String {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    // Nothing can go wrong when writing to memory.
    let _ = write_suite(&mut writer, report);
    let text = String::from_utf8(writer.into_inner()).unwrap_or_default();
    format!("{text}\n")
}

type Xml = Writer<Vec<u8>>;

fn write_suite(xml: &mut Xml, report: &Report) -> io::Result<()> {
    let count = |of: fn(&Property) -> bool| report.properties.iter().filter(|p| of(p)).count().to_string();
    let mut suite = BytesStart::new("testsuite");
    attribute(&mut suite, "name", &report.trace);
    attribute(&mut suite, "tests", &report.properties.len().to_string());
    attribute(&mut suite, "failures", &count(Property::has_failed));
    attribute(&mut suite, "errors", &count(|p| p.verdict == Verdict::Inconclusive));
    if let Some((start, end)) = report.span {
        attribute(&mut suite, "time", &format!("{:.3}", end.since(start).seconds()));
    }
    xml.write_event(Event::Start(suite))?;
    for property in &report.properties {
        write_case(xml, report, property)?;
    }
    let remarks = text::remarks(report);
    if !remarks.is_empty() {
        element(xml, BytesStart::new("system-out"), &remarks)?;
    }
    xml.write_event(Event::End(BytesEnd::new("testsuite")))
}

fn write_case(xml: &mut Xml, report: &Report, property: &Property) -> io::Result<()> {
    let mut case = BytesStart::new("testcase");
    attribute(&mut case, "name", &property.name);
    attribute(&mut case, "classname", &property.file);
    attribute(&mut case, "file", &property.file);
    attribute(&mut case, "line", &property.line.to_string());
    let message = text::verdict_line(property, Origin::of(report));
    let problem = match property.verdict {
        Verdict::Violated | Verdict::Unmet => Some("failure"),
        Verdict::Inconclusive => Some("error"),
        Verdict::Holds | Verdict::Satisfied => None,
    };
    xml.write_event(Event::Start(case))?;
    match problem {
        Some(kind) => {
            let mut problem = BytesStart::new(kind);
            attribute(&mut problem, "message", &message);
            attribute(&mut problem, "type", property.verdict.word());
            element(xml, problem, &text::explanation(report, property, Style::Plain))?;
        }
        None => element(xml, BytesStart::new("system-out"), &message)?,
    }
    xml.write_event(Event::End(BytesEnd::new("testcase")))
}

fn element(xml: &mut Xml, start: BytesStart<'_>, text: &str) -> io::Result<()> {
    let end = start.to_end().into_owned();
    xml.write_event(Event::Start(start))?;
    xml.write_event(Event::Text(BytesText::new(&clean(text))))?;
    xml.write_event(Event::End(end))
}

fn attribute(element: &mut BytesStart<'_>, name: &str, value: &str) {
    element.push_attribute((name, clean(value).as_str()));
}

/// The text without the characters that XML cannot hold, however they are written.
fn clean(text: &str) -> String {
    let fits = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
    text.chars().map(|c| if fits(c) { c } else { char::REPLACEMENT_CHARACTER }).collect()
}
