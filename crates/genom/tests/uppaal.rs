//! UPPAAL's XML: well formed, in the order of its document type, and read back to the automata that it was written from.

mod common;

use std::collections::BTreeMap;

use common::{IMU, sound};
use lapwing_genom::automata::{Settings, System, build};
use lapwing_genom::emit::{Input, uppaal};
use quick_xml::Reader;
use quick_xml::events::Event;

/// An element: its name, attributes, children, and the text in it.
#[derive(Debug, Default)]
struct Element {
    name: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Element>,
    text: String,
}

impl Element {
    fn all<'e, 'n>(&'e self, name: &'n str) -> impl Iterator<Item = &'e Element> + use<'e, 'n> {
        self.children.iter().filter(move |c| c.name == name)
    }

    fn one(&self, name: &str) -> &Element {
        let mut all = self.all(name);
        let found = all.next().unwrap_or_else(|| panic!("no {name} in {}", self.name));
        assert!(all.next().is_none(), "two {name} in {}", self.name);
        found
    }

    fn label(&self, kind: &str) -> &str {
        self.all("label").find(|l| l.attributes["kind"] == kind).map_or("", |l| l.text.as_str())
    }
}

fn parsed(text: &str) -> Element {
    let mut reader = Reader::from_str(text);
    let mut stack = vec![Element::default()];
    let open = |start: &quick_xml::events::BytesStart<'_>| {
        let attribute =
            |a: quick_xml::events::attributes::Attribute<'_>| (a.key.as_ref().to_owned(), a.value.to_string());
        let name = start.name().as_ref().to_owned();
        Element { name, attributes: start.attributes().map(|a| attribute(a.unwrap())).collect(), ..Element::default() }
    };
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) => stack.push(open(&start)),
            Event::Empty(start) => stack.last_mut().unwrap().children.push(open(&start)),
            Event::End(_) => {
                let element = stack.pop().unwrap();
                stack.last_mut().unwrap().children.push(element);
            }
            Event::Text(text) => stack.last_mut().unwrap().text += &text,
            Event::GeneralRef(name) => {
                let sign = match &*name {
                    "lt" => "<",
                    "gt" => ">",
                    "amp" => "&",
                    other => panic!("&{other};"),
                };
                stack.last_mut().unwrap().text += sign;
            }
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(stack.len(), 1);
    stack.remove(0).children.remove(0)
}

/// What may be in each element, in this order: the document type `flat-1_6`, as far as it is used.
const ORDER: &[(&str, &[&str])] = &[
    ("nta", &["imports", "declaration", "template", "instantiation", "system", "queries"]),
    ("template", &["name", "parameter", "declaration", "location", "branchpoint", "init", "transition"]),
    ("location", &["name", "label", "urgent", "committed"]),
    ("transition", &["source", "target", "label", "nail"]),
    ("queries", &["option", "query"]),
    ("query", &["formula", "comment", "option", "expect", "result"]),
];
const LABELS: &[&str] = &[
    "invariant",
    "exponentialrate",
    "testcodeEnter",
    "testcodeExit",
    "select",
    "guard",
    "synchronisation",
    "assignment",
    "probability",
    "comments",
];

fn assert_ordered(element: &Element) {
    let allowed = ORDER.iter().find(|(name, _)| *name == element.name).map_or(&[][..], |(_, allowed)| allowed);
    let places: Vec<usize> = element
        .children
        .iter()
        .map(|c| allowed.iter().position(|a| *a == c.name).unwrap_or_else(|| panic!("{} in {}", c.name, element.name)))
        .collect();
    assert!(places.is_sorted(), "{}: {places:?}", element.name);
    assert!(element.name != "label" || LABELS.contains(&element.attributes["kind"].as_str()));
    element.children.iter().for_each(assert_ordered);
}

fn document(source: &str) -> (System, Element) {
    let loaded = sound(source);
    let system = build(&loaded.model, Settings::default()).unwrap();
    let text = uppaal(Input { system: &system, sources: &loaded.sources });
    assert!(text.starts_with(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.6//EN'"
    ));
    assert_eq!(text, uppaal(Input { system: &system, sources: &loaded.sources }), "the same system, the same text");
    (system, parsed(&text))
}

#[test]
fn the_structure_is_that_of_the_document_type() {
    let (_, nta) = document(IMU);
    assert_eq!(nta.name, "nta");
    assert_ordered(&nta);
    let mut ids = Vec::new();
    for template in nta.all("template") {
        let own: Vec<&String> = template.all("location").map(|l| &l.attributes["id"]).collect();
        assert!(own.contains(&&template.one("init").attributes["ref"]));
        for transition in template.all("transition") {
            assert!(
                own.contains(&&transition.one("source").attributes["ref"])
                    && own.contains(&&transition.one("target").attributes["ref"])
            );
        }
        ids.extend(own);
    }
    let count = ids.len();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), count, "every id is there once");
}

#[test]
fn what_was_written_is_read_back() {
    let (system, nta) = document(IMU);
    let templates: Vec<&Element> = nta.all("template").collect();
    assert_eq!(templates.len(), system.automata.len());
    let unit = 500_000;
    assert!(nta.one("declaration").text.contains("One unit of time is 500 us"));
    for (template, automaton) in templates.iter().zip(&system.automata) {
        assert_eq!(template.one("name").text, automaton.name);
        for (location, expected) in template.all("location").zip(&automaton.locations) {
            assert_eq!(location.one("name").text, expected.name);
            let limit = expected.invariant_ns.map_or(String::new(), |ns| format!("x <= {}", ns / unit));
            assert_eq!(location.label("invariant"), limit);
        }
        assert_eq!(template.all("location").count(), automaton.locations.len());
        let names: Vec<&str> = template.all("location").map(|l| l.attributes["id"].as_str()).collect();
        assert_eq!(template.all("transition").count(), automaton.edges.len());
        for (transition, edge) in template.all("transition").zip(&automaton.edges) {
            assert_eq!(transition.one("source").attributes["ref"], names[edge.from.0]);
            assert_eq!(transition.one("target").attributes["ref"], names[edge.to.0]);
            assert_eq!(transition.label("synchronisation") == "hurry!", edge.eager);
            assert_eq!(transition.label("assignment").ends_with("x = 0"), edge.resets);
            // An urgent channel and a guard on a clock exclude each other in UPPAAL.
            assert!(!(edge.eager && transition.label("guard").contains("x ")), "{}", edge.name);
            assert_eq!(
                transition.label("guard").contains("x > 0"),
                edge.clock == Some(lapwing_genom::automata::ClockGuard::Positive)
            );
        }
    }
    let listed: Vec<String> = system.automata.iter().map(|a| a.name.clone()).collect();
    assert_eq!(nta.one("system").text, format!("system {};", listed.join(", ")));
    assert_eq!(nta.one("queries").all("query").count(), 3, "no deadlock, and a question for each task");
}

#[test]
fn names_that_are_words_of_uppaal_are_told_apart() {
    let (_, nta) = document(
        "component C { task t { period 1 ms; }; activity A() { task t; codel<start> f() yield guard; codel<guard> g() yield ether; }; };",
    );
    let template = nta.all("template").find(|t| t.one("name").text == "C_A_1").unwrap();
    let names: Vec<&str> = template.all("location").map(|l| l.one("name").text.as_str()).collect();
    assert_eq!(names, ["ether", "start", "guard_"]);
}
