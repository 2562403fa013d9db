//! State charts in SCXML (W3C Recommendation *State Chart XML*, 2015).
//!
//! States, transitions, guards and final states are read. What is done on the way, data and invoked services do not come along.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use lapwing_diag::{Code, Diagnostic};

use crate::Report;
use crate::chart::{self, Arrow, Chart, Kind, MOST_ARROWS, MOST_NODES, Trigger};
use crate::names::slug;
use crate::sheet::Sheet;
use crate::xml::{self, Element};
use lapwing_diag::suggest::{nearest, or_else};

/// Elements that do something or hold data.
const CODE: &[&str] = &["onentry", "onexit", "datamodel", "script", "invoke", "donedata"];

/// Reads a chart; `name` is what it is called where it does not say so.
pub(crate) fn read(text: &str, name: &str, sheet: &mut Sheet, report: &mut Report) {
    let Some(root) = xml::read(text, report) else { return };
    if root.name != "scxml" {
        let message = format!("expected `<scxml>`, found `<{}>`", root.name);
        return wrong(report, &root.place, message);
    }
    let mut events = BTreeSet::new();
    named_events(&root, &mut events);
    let chart = Chart::new(root.get("name").unwrap_or(name), true);
    let mut reader = Reader { chart, known: BTreeMap::new(), events, code: Vec::new(), report, failed: false };
    let mut states = Vec::new();
    reader.states(&root, 0, &mut states);
    for (element, node) in &states {
        reader.transitions(element, *node);
    }
    reader.initial(&root, 0);
    for (element, node) in &states {
        reader.initial(element, *node);
    }
    reader.mention_code();
    let too_many = reader.chart.nodes.len() > MOST_NODES || reader.chart.arrows.len() > MOST_ARROWS;
    let (chart, failed) = (reader.chart, reader.failed);
    if too_many {
        let message = format!("the chart has more than {MOST_NODES} states or {MOST_ARROWS} transitions");
        let span = report.span(root.place.start, root.place.end);
        report.push(Diagnostic::new(Code::ImportRefused, span, message));
    } else if chart.nodes.len() == 1 {
        wrong(report, &root.place, "the chart has no states".to_owned());
    } else if !failed {
        chart::write(&chart, sheet, report);
    }
}

fn wrong(report: &mut Report, place: &Range<usize>, message: String) {
    let span = report.span(place.start, place.end);
    report.push(Diagnostic::new(Code::ImportSyntax, span, message));
}

/// The events that transitions name in full.
fn named_events(element: &Element, events: &mut BTreeSet<String>) {
    let names = element.get("event").filter(|_| element.name == "transition").unwrap_or("");
    let whole = |e: &&str| !e.contains('*') && !e.starts_with("done.state.");
    events.extend(names.split_whitespace().filter(whole).map(|e| e.trim_end_matches('.').to_owned()));
    element.children.iter().for_each(|child| named_events(child, events));
}

struct Reader<'r> {
    chart: Chart,
    known: BTreeMap<String, usize>,
    events: BTreeSet<String>,
    code: Vec<Range<usize>>,
    report: &'r mut Report,
    failed: bool,
}

impl Reader<'_> {
    /// Adds the states inside of an element.
    fn states<'e>(&mut self, element: &'e Element, parent: usize, states: &mut Vec<(&'e Element, usize)>) {
        for child in &element.children {
            let kind = match child.name.as_str() {
                "state" => Kind::State,
                "parallel" => Kind::Parallel,
                "final" => Kind::Final,
                "history" => Kind::History,
                name if CODE.contains(&name) => {
                    self.code.push(child.place.clone());
                    continue;
                }
                _ => continue,
            };
            if self.chart.nodes.len() > MOST_NODES {
                return;
            }
            let id = child.get("id").map_or_else(|| format!("state_{}", self.chart.nodes.len()), str::to_owned);
            let node = self.chart.add(&id, kind, parent, child.place.clone());
            self.mention_name("state", &id, &child.place);
            if self.known.insert(id.clone(), node).is_some() {
                self.failed = true;
                wrong(self.report, &child.place, format!("two states have the id `{id}`"));
            }
            states.push((child, node));
            if kind != Kind::History {
                self.states(child, node, states);
            }
        }
    }

    /// The states that an attribute names.
    fn targets(&mut self, ids: &str, place: &Range<usize>) -> Vec<usize> {
        let mut found = Vec::new();
        for id in ids.split_whitespace() {
            match self.known.get(id) {
                Some(node) => found.push(*node),
                None => {
                    self.failed = true;
                    let guess = nearest(id, self.known.keys().map(String::as_str));
                    let or_else = or_else(guess);
                    wrong(self.report, place, format!("there is no state `{id}`{or_else}"));
                }
            }
        }
        if found.len() > 1 {
            self.failed = true;
            let span = self.report.span(place.start, place.end);
            let message = "a transition to several states at once cannot be carried over";
            let why = "a machine is in one state at a time";
            self.report.push(Diagnostic::new(Code::ImportRefused, span, message).label(why));
        }
        found
    }

    fn initial(&mut self, element: &Element, node: usize) {
        let inner = element.children.iter().find(|c| c.name == "initial");
        let inner = inner.and_then(|i| i.children.iter().find(|c| c.name == "transition"));
        let found = match (element.get("initial"), inner) {
            (Some(ids), _) => self.targets(ids, &element.place),
            (None, Some(transition)) => self.targets(transition.get("target").unwrap_or(""), &transition.place),
            // The first in the order of the document, as SCXML has it.
            (None, None) => self.chart.nodes.get(node).and_then(|n| n.children.first().copied()).into_iter().collect(),
        };
        let first = found.first().copied().filter(|first| *first != node && self.chart.is_in(*first, node));
        if first.is_none() && !found.is_empty() && !self.failed {
            self.failed = true;
            wrong(
                self.report,
                &element.place,
                "the initial state is not inside of the state that begins in it".to_owned(),
            );
        }
        if let Some(node) = self.chart.nodes.get_mut(node) {
            node.initial = first;
        }
    }

    fn transitions(&mut self, element: &Element, node: usize) {
        for transition in element.children.iter().filter(|c| c.name == "transition") {
            // What an editor notes of its drawing is no code.
            if let Some(first) = transition.children.iter().find(|c| c.name != "editorinfo") {
                self.code.push(first.place.clone());
            }
            if self.chart.nodes.get(node).is_some_and(|n| n.kind == Kind::History) {
                continue;
            }
            let place = transition.place.clone();
            let target = transition.get("target").map(|ids| self.targets(ids, &place));
            let to = target.as_ref().map_or(Some(node), |t| t.first().copied());
            let Some(to) = to else { continue };
            for (number, (from, trigger)) in self.triggers(transition, node).into_iter().enumerate() {
                let cond = transition.get("cond").map(|cond| of_event(cond, &trigger));
                let when = cond.and_then(|cond| self.condition(&cond, (number == 0).then_some(&place)));
                let stays = target.is_none();
                // With neither target nor event it is a place for code.
                if !(stays && trigger == Trigger::Eventless) {
                    let place = place.clone();
                    self.chart.arrows.push(Arrow { from, to, trigger, when, otherwise: false, stays, place });
                }
            }
            if self.chart.arrows.len() > MOST_ARROWS {
                return;
            }
        }
    }

    /// A condition, at a place where something is said about it.
    fn condition(&mut self, cond: &str, place: Option<&Range<usize>>) -> Option<lapwing_syntax::ast::Expr> {
        let (when, is_prose) = chart::guard(cond);
        // What is not seen of an event is no condition either.
        if let Some(place) = place.filter(|_| is_prose || cond.contains("_event")) {
            let what = when.as_ref().map(lapwing_syntax::print_expr).unwrap_or_default();
            let message = format!("the condition cannot be read: it has become the signal `{what}`");
            let span = self.report.span(place.start, place.end);
            let help = "write a condition in its place, or declare what it stands for";
            self.report.push(Diagnostic::new(Code::ImportTrigger, span, message).help(help));
        }
        when
    }

    /// When a transition is taken, and from which state.
    fn triggers(&mut self, transition: &Element, node: usize) -> Vec<(usize, Trigger)> {
        let Some(descriptors) = transition.get("event") else { return vec![(node, Trigger::Eventless)] };
        let mut found = Vec::new();
        for descriptor in descriptors.split_whitespace() {
            if let Some(done) = descriptor.strip_prefix("done.state.") {
                match self.known.get(done) {
                    Some(state) => found.push((*state, Trigger::Done)),
                    None => _ = self.targets(done, &transition.place),
                }
                continue;
            }
            let wanted = descriptor.trim_end_matches('*').trim_end_matches('.');
            // `error` is `error.io` too, and `*` is everything.
            let fits = |e: &&String| {
                wanted.is_empty() || *e == wanted || e.strip_prefix(wanted).is_some_and(|r| r.starts_with('.'))
            };
            let fitting: Vec<&String> = self.events.iter().filter(fits).collect();
            if descriptor.ends_with('*') {
                let span = self.report.span(transition.place.start, transition.place.end);
                let message = format!("`{descriptor}` is read as the events that the chart names");
                self.report.push(Diagnostic::new(Code::ImportDiffers, span, message).label("others are not seen"));
            }
            let fitting: Vec<String> = fitting.into_iter().cloned().collect();
            fitting.iter().for_each(|e| self.mention_name("event", e, &transition.place));
            found.extend(fitting.iter().map(|e| (node, Trigger::Event(slug(e)))));
        }
        found
    }

    /// Says once that something has another name here.
    fn mention_name(&mut self, what: &str, written: &str, place: &Range<usize>) {
        let name = slug(written);
        let message = chart::renamed(what, written, &name, self.report.span(place.start, place.end));
        let is_said = |known: &Diagnostic| known.code == message.code && known.message == message.message;
        if name != written && !self.report.diagnostics.iter().any(is_said) {
            self.report.push(message);
        }
    }

    fn mention_code(&mut self) {
        let Some(first) = self.code.first() else { return };
        let message = "what the chart does, and its data, do not come along";
        let mut diagnostic = Diagnostic::new(Code::ImportCode, self.report.span(first.start, first.end), message);
        for place in self.code.iter().skip(1).take(3) {
            diagnostic = diagnostic.also(self.report.span(place.start, place.end), "nor this");
        }
        self.report.push(diagnostic.help("a specification watches: it sends and computes nothing"));
    }
}

/// A condition at an event: what that carries are its fields.
fn of_event(cond: &str, trigger: &Trigger) -> String {
    match trigger {
        Trigger::Event(event) => cond.replace("_event.data.", &format!("{event}.")),
        _ => cond.to_owned(),
    }
}
