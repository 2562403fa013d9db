//! Elements of XML with their places.

use std::ops::Range;

use lapwing_diag::{Code, Diagnostic};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use crate::Report;

/// Elements nest no deeper, and there are no more.
const MOST_DEPTH: usize = 64;
const MOST_ELEMENTS: usize = 10_000;

/// An element.
#[derive(Debug, Default)]
pub(crate) struct Element {
    /// Its name, without the prefix of its namespace.
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    /// The tag that begins it.
    pub place: Range<usize>,
}

impl Element {
    /// The value of an attribute; `None` where it is not there or blank.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, v)| v.trim()).filter(|v| !v.is_empty())
    }
}

/// Reads a document; `None` where it is none, which is reported.
pub(crate) fn read(text: &str, report: &mut Report) -> Option<Element> {
    let mut reader = Reader::from_str(text);
    let mut open = vec![Element::default()];
    let mut elements = 0;
    loop {
        let start = reader.buffer_position() as usize;
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(error) => {
                let at = reader.error_position() as usize;
                return wrong(report, at..at, error.to_string());
            }
        };
        let place = start..reader.buffer_position() as usize;
        elements += usize::from(matches!(event, Event::Start(_) | Event::Empty(_)));
        if elements > MOST_ELEMENTS || open.len() > MOST_DEPTH {
            return wrong(report, place, format!("more than {MOST_ELEMENTS} elements, or {MOST_DEPTH} in each other"));
        }
        match event {
            Event::Start(tag) => open.push(element(&tag, place, report)?),
            Event::Empty(tag) => {
                let element = element(&tag, place, report)?;
                open.last_mut()?.children.push(element);
            }
            Event::End(_) => {
                let closed = open.pop()?;
                open.last_mut()?.children.push(closed);
            }
            Event::Eof => break,
            _ => {}
        }
    }
    if open.len() > 1 {
        let last = open.pop()?;
        return wrong(report, last.place, format!("`<{}>` is not closed", last.name));
    }
    let root = open.pop()?.children.into_iter().next();
    if root.is_none() {
        return wrong(report, 0..0, "there is no element".to_owned());
    }
    root
}

fn wrong<T>(report: &mut Report, place: Range<usize>, why: String) -> Option<T> {
    let span = report.span(place.start, place.end);
    report.push(Diagnostic::new(Code::ImportSyntax, span, format!("this is no XML that can be read: {why}")));
    None
}

fn element(tag: &BytesStart<'_>, place: Range<usize>, report: &mut Report) -> Option<Element> {
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        let pair = attribute.map_err(|e| e.to_string()).and_then(|a| {
            let value = a.normalized_value(XmlVersion::Implicit1_0).map_err(|e| e.to_string())?;
            Ok((a.key.local_name().as_ref().to_owned(), value.into_owned()))
        });
        match pair {
            Ok(pair) => attributes.push(pair),
            Err(why) => return wrong(report, place, why),
        }
    }
    Some(Element { name: tag.local_name().as_ref().to_owned(), attributes, children: Vec::new(), place })
}
