//! JavaMOP's monitors: events by AspectJ's pointcuts, formulas over them, and what is done about violations.
//!
//! ```text
//! text ──lexer──▶ tokens ──parser──▶ ast ──event──▶ events ┐
//!                                      ├──ltl──▶ formula ──┼──▶ sheet
//!                                      ├──fsm, ere──▶ automaton ──begin──▶ state diagram
//!                                      └──handler──▶ reaction
//! ```
//!
//! What JavaMOP means is in D. Jin, P. Meredith, C. Lee, G. Roşu, *JavaMOP: Efficient Parametric Runtime Monitoring Framework*, ICSE 2012, and in the
//! pages of its syntax.

mod ast;
mod cursor;
mod lexer;
mod parser;

mod event;

mod ere;
mod fsm;
mod ltl;

mod automaton;
mod begin;
mod handler;

use std::collections::{BTreeMap, BTreeSet};

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{Expr, ExprKind};

use crate::names::{slug, snake};
use crate::sheet::{Item, Property, Reaction, Sheet};
use crate::{Options, Parameters, Report, expr};
use ast::{Block, Handler, Parameter, Spec};
use automaton::Automaton;
use cursor::{Cursor, Name};
use event::Meant;
use lexer::Kind;

/// Monitors of a file, and events of a monitor, beyond which nothing is read.
const MOST_MONITORS: usize = 64;
const MOST_EVENTS: usize = 64;

/// Reads a file of monitors.
pub(crate) fn read(text: &str, options: Options, sheet: &mut Sheet, report: &mut Report) {
    let tokens = lexer::tokens(text);
    let specs = parser::parse(Cursor::new(text, &tokens), report);
    if specs.is_empty() && report.diagnostics.is_empty() {
        let diagnostic = Diagnostic::new(Code::ImportSyntax, report.span(0, 0), "there is no monitor in this file");
        report.push(diagnostic.help("a monitor is written `Init(Kicker k) { event …  ltl: …  @violation { … } }`"));
    }
    for spec in specs.iter().take(MOST_MONITORS) {
        Monitor::read(spec, options, sheet, report);
    }
    if let Some(spec) = specs.get(MOST_MONITORS) {
        too_many(report, &spec.name, "monitors in a file", MOST_MONITORS);
    }
}

fn too_many(report: &mut Report, name: &Name, what: &str, most: usize) {
    let span = report.span(name.place.start, name.place.end);
    report.push(Diagnostic::new(Code::ImportRefused, span, format!("there are more than {most} {what}")));
}

/// A monitor whose events have been declared.
struct Monitor<'s, 't> {
    spec: &'s Spec<'t>,
    events: BTreeMap<&'s str, Meant>,
    /// The names of its events, in the order of the text.
    order: Vec<&'s str>,
    /// The parameters that its events bind.
    bound: Vec<&'s Parameter>,
    each: bool,
}

impl<'s, 't> Monitor<'s, 't> {
    fn read(spec: &'s Spec<'t>, options: Options, sheet: &mut Sheet, report: &mut Report) {
        if let Some(event) = spec.events.get(MOST_EVENTS) {
            return too_many(report, &event.name, "events in a monitor", MOST_EVENTS);
        }
        let mut events: BTreeMap<&str, Meant> = BTreeMap::new();
        let mut order = Vec::new();
        for event in &spec.events {
            let name = event.name.text.as_str();
            let meant = event::declare(&spec.name.text, event, sheet, report);
            match events.get_mut(name) {
                // JavaMOP lets several events share a name: each of them is it.
                Some(known) => {
                    let others = meant.names.into_iter().filter(|name| !known.names.contains(name));
                    known.names.extend(others.collect::<Vec<_>>());
                    known.binds.extend(meant.binds);
                }
                None => {
                    order.push(name);
                    events.insert(name, meant);
                }
            }
        }
        let binds = |p: &&Parameter| events.values().any(|m| m.binds.contains(&p.name.text));
        let bound: Vec<&Parameter> = spec.parameters.iter().filter(binds).collect();
        let each = match options.parameters {
            Parameters::Auto => bound.len() > 1,
            Parameters::Each => true,
            Parameters::One => false,
        };
        let monitor = Monitor { spec, events, order, bound, each };
        monitor.mention_code(report);
        monitor.mention_skips(report);
        monitor.mention_modifiers(report);
        monitor.mention_twins(sheet, report);
        for block in &spec.blocks {
            monitor.block(block, sheet, report);
        }
        if spec.blocks.is_empty() {
            let span = report.span(spec.name.place.start, spec.name.place.end);
            let message = format!("the monitor `{}` has events and no formula", spec.name.text);
            let diagnostic = Diagnostic::new(Code::ImportRefused, span, message).label("there is nothing to judge");
            let help = monitor.order.first().map(|e| format!("if `{e}` is never to occur, say `ltl: [] !{e}`"));
            report.push(help.into_iter().fold(diagnostic, Diagnostic::help));
        }
    }

    /// Words before the monitor's name that change what it is about.
    fn mention_modifiers(&self, report: &mut Report) {
        for modifier in &self.spec.modifiers {
            let why = match modifier.text.as_str() {
                "perthread" => "JavaMOP judges each thread on its own; here all are judged together",
                "enforce" | "avoid" => "JavaMOP holds threads back before they violate the property; here it is judged",
                _ => continue,
            };
            let span = report.span(modifier.place.start, modifier.place.end);
            let message = format!("`{}` does not come along", modifier.text);
            report.push(Diagnostic::new(Code::ImportDiffers, span, message).label(why));
        }
    }

    /// Events that are at the same place: the types of arguments told them apart, or JavaMOP has them one after the other.
    fn mention_twins(&self, sheet: &Sheet, report: &mut Report) {
        let declared = |name: &String| sheet.events.iter().find(|e| e.name == *name && e.source.is_some());
        let places = |event: &&str| self.names(event).iter().filter_map(declared).collect::<Vec<_>>();
        for (number, event) in self.order.iter().enumerate() {
            let own = places(event);
            let is_twin = |other: &&&str| places(other).iter().any(|a| own.iter().any(|b| a.is_at_place_of(b)));
            let Some(twin) = self.order[..number].iter().find(is_twin) else { continue };
            let Some(name) = self.spec.events.iter().map(|e| &e.name).find(|n| n.text == *event) else { continue };
            let span = report.span(name.place.start, name.place.end);
            let message = format!("`{event}` and `{twin}` always occur at once");
            report.push(
                Diagnostic::new(Code::ImportDiffers, span, message)
                    .label("at the same place; in JavaMOP one of them, or one after the other")
                    .help("overloads of Java are functions with names of their own in Rust: give each event its own"),
            );
        }
    }

    fn modifier(&self, word: &str) -> Option<&Name> {
        self.spec.modifiers.iter().find(|m| m.text == word)
    }

    /// Java that does more than to remember an object for the handlers.
    fn mention_code(&self, report: &mut Report) {
        let acts = |advice: &Cursor<'_>| handler::read(*advice, "x").has_code || advice.rest().len() > 8;
        let advice = self.spec.events.iter().map(|e| e.advice).filter(acts).map(|a| a.span());
        let places: Vec<_> = advice.chain(self.spec.members.iter().filter(|m| m.len() > 80).cloned()).collect();
        let Some(first) = places.first() else { return };
        let message = format!("the code in the monitor `{}` does not come along", self.spec.name.text);
        let mut diagnostic = Diagnostic::new(Code::ImportCode, report.span(first.start, first.end), message);
        for place in places.iter().skip(1).take(3) {
            diagnostic = diagnostic.also(report.span(place.start, place.end), "nor this");
        }
        report.push(diagnostic.help("what a report says of each event it need not say; state belongs to the program"));
    }

    /// Events that keep what they are about from happening.
    fn mention_skips(&self, report: &mut Report) {
        for event in &self.spec.events {
            handler::read(event.advice, "x").beyond.into_iter().for_each(|place| skips(place, report));
        }
    }

    fn block(&self, block: &Block<'_>, sheet: &mut Sheet, report: &mut Report) {
        let written = &block.formalism;
        let span = report.span(written.place.start, written.place.end);
        match formalism(&written.text) {
            Some((formalism, exactly)) => {
                if !exactly {
                    let message = format!("`{}` is read as `{}`", written.text, formalism.word());
                    report.push(Diagnostic::new(Code::ImportDiffers, span, message).fix(span, formalism.word()));
                }
                match formalism {
                    Formalism::Ltl | Formalism::PtLtl => self.ltl(formalism, block, sheet, report),
                    Formalism::Fsm => self.fsm(block, sheet, report),
                    Formalism::Ere => self.ere(block, sheet, report),
                }
            }
            None => {
                let message = format!("formulas in `{}` are not carried over", written.text);
                let help = "`ltl`, `ptltl`, `fsm` and `ere` are";
                report.push(
                    Diagnostic::new(Code::ImportRefused, span, message).label("the property is left out").help(help),
                );
            }
        }
    }

    /// The concrete events of an event.
    fn names(&self, event: &str) -> &[String] {
        self.events.get(event).map_or(&[], |m| &m.names)
    }

    fn letters(&self) -> Vec<Vec<String>> {
        self.order.iter().map(|e| self.names(e).to_vec()).collect()
    }

    fn ltl(&self, formalism: Formalism, block: &Block<'_>, sheet: &mut Sheet, report: &mut Report) {
        let event = |name: &str| expr::any(self.names(name));
        let alphabet = ltl::Alphabet { event: &event, names: self.order.clone() };
        let place = block.formula.span();
        let Some(formula) = ltl::read(block.formula, &alphabet, report) else { return };
        let of_past = matches!(formalism, Formalism::PtLtl);
        if of_past && ltl::has_future(&formula) {
            let message = "a formula in `ptltl` is about the past: `[]`, `<>`, `o` and `U` have no place in it";
            let wrong = Diagnostic::new(Code::ImportSyntax, report.span(place.start, place.end), message);
            return report.push(wrong.label("the property is left out").help("in `ltl` they have"));
        }
        self.mention_begin(report);
        let judged = ltl::everywhere(formula);
        if judged.differs && !of_past {
            let message = "the formula has no `[]`: it is checked at every event";
            report.push(
                Diagnostic::new(Code::ImportFirstPosition, report.span(place.start, place.end), message)
                    .label("JavaMOP judges the first event alone")
                    .help("if that is meant, it is seldom violated: `lapwing explain import-first-position`"),
            );
        }
        let each = self.each_of(&judged.formula, report);
        let mut named = BTreeSet::new();
        names_in(&judged.formula, &mut named);
        let over = self.letters().concat().into_iter().filter(|e| !named.contains(e)).collect();
        let name = sheet.taken.take(&snake(&self.spec.name.text));
        sheet.items.push(Item::Property(Property { name: name.clone(), over, each, body: expr::ltl(judged.formula) }));
        for handler in &block.handlers {
            match handler.name.text.as_str() {
                "violation" | "fail" => self.reaction(&name, handler, sheet, report),
                _ => no_counterpart(handler, "a reaction answers violations alone", report),
            }
        }
    }

    /// Where a formula is judged from another event on than in JavaMOP.
    fn mention_begin(&self, report: &mut Report) {
        let late = self.spec.events.iter().find(|e| e.creates);
        let late = late.filter(|_| self.spec.events.iter().any(|e| !e.creates)).map(|e| &e.name);
        let (name, message, why) = match (self.modifier("suffix"), late) {
            (Some(suffix), _) => {
                (suffix, "`suffix` does not come along", "JavaMOP judges from every event on".to_owned())
            }
            (None, Some(event)) => {
                let why = format!("JavaMOP sees nothing before the first `{}`", event.text);
                (event, "the formula is judged from the beginning of the run", why)
            }
            (None, None) => return,
        };
        let span = report.span(name.place.start, name.place.end);
        report.push(Diagnostic::new(Code::ImportDiffers, span, message).label(why));
    }

    /// The quantifiers of a formula, where there are to be any.
    fn each_of(&self, formula: &Expr, report: &mut Report) -> Vec<(String, String, String)> {
        let mut each = Vec::new();
        for parameter in &self.bound {
            let name = &parameter.name.text;
            let span = report.span(parameter.name.place.start, parameter.name.place.end);
            if !self.each {
                report.push(self.taken_for_one(parameter, span));
                continue;
            }
            let binding = || self.order.iter().filter(|e| self.events.get(*e).is_some_and(|m| m.binds.contains(name)));
            let enough = binding().find(|e| self.names(e).len() == 1 && ltl::holds_without(formula, self.names(e)));
            let Some(event) = enough.or_else(|| binding().next()) else { continue };
            let Some(source) = self.names(event).first() else { continue };
            let mut diagnostic = Diagnostic::new(
                Code::ImportParameter,
                span,
                format!("`{name}` is the field `{}` of events", slug(name)),
            );
            diagnostic = match enough {
                Some(_) => {
                    diagnostic.severity = lapwing_diag::Severity::Note;
                    diagnostic
                        .label(format!("each `{}` for which `{source}` occurs is judged on its own", parameter.class))
                }
                None => {
                    diagnostic.label(format!("a `{}` for which `{source}` never occurs is not judged", parameter.class))
                }
            };
            report.push(
                diagnostic.help(format!(
                    "let the program record it where these events happen, under the name `{}`",
                    slug(name)
                )),
            );
            each.push((self.variable(name), source.clone(), slug(name)));
        }
        each
    }

    /// A name for the variable that no event has.
    fn variable(&self, parameter: &str) -> String {
        let name = slug(parameter);
        let is_event = self.events.values().any(|m| m.names.contains(&name));
        if is_event { format!("{name}_value") } else { name }
    }

    fn taken_for_one(&self, parameter: &Parameter, span: lapwing_diag::Span) -> Diagnostic {
        let (class, name) = (&parameter.class, &parameter.name.text);
        Diagnostic::new(Code::ImportParameter, span, format!("there is taken to be one `{class}`"))
            .label("JavaMOP judges each on its own")
            .help(format!("`--parameters each` tells several apart, by a field `{}` of their events", slug(name)))
    }

    fn fsm(&self, block: &Block<'_>, sheet: &mut Sheet, report: &mut Report) {
        let Some(fsm) = fsm::read(block.formula, &self.order, report) else { return };
        let targets = |handler: &str| Some(fsm.named.get(handler)?.iter().copied().collect());
        self.automaton(block, &fsm.automaton, &targets, BTreeSet::from([fsm.fail]), sheet, report);
    }

    fn ere(&self, block: &Block<'_>, sheet: &mut Sheet, report: &mut Report) {
        let Some(ere) = ere::read(block.formula, &self.order, report) else { return };
        let targets = |handler: &str| match handler {
            "match" | "validation" => Some(ere.matching.clone()),
            "fail" | "violation" => Some(ere.failing.clone()),
            _ => None,
        };
        self.automaton(block, &ere.automaton, &targets, ere.failing.clone(), sheet, report);
    }

    /// A state diagram for each handler; one for the failures where there is none.
    fn automaton(
        &self,
        block: &Block<'_>,
        automaton: &Automaton,
        targets: &dyn Fn(&str) -> Option<BTreeSet<usize>>,
        failing: BTreeSet<usize>,
        sheet: &mut Sheet,
        report: &mut Report,
    ) {
        if self.each || !self.bound.is_empty() {
            for parameter in &self.bound {
                let span = report.span(parameter.name.place.start, parameter.name.place.end);
                let mut diagnostic = self.taken_for_one(parameter, span);
                diagnostic.help =
                    vec!["a state diagram has no instances; say it in `ltl` to tell several apart".to_owned()];
                report.push(diagnostic);
            }
        }
        let base = snake(&self.spec.name.text);
        let letters = self.letters();
        let several = block.handlers.len() > 1;
        if block.handlers.is_empty()
            && let Some((automaton, failing)) = self.begun(block, automaton, failing, report)
        {
            let name = sheet.taken.take(&base);
            sheet.items.push(Item::Machine(automaton.machine(name, &failing, "fail", &letters)));
        }
        for handler in &block.handlers {
            let word = slug(&handler.name.text);
            let Some(targets) = targets(&handler.name.text) else {
                no_counterpart(handler, "there is no such state", report);
                continue;
            };
            let Some((automaton, targets)) = self.begun(block, automaton, targets, report) else { return };
            let name = sheet.taken.take(&if several { format!("{base}_{word}") } else { base.clone() });
            sheet.items.push(Item::Machine(automaton.machine(name.clone(), &targets, &word, &letters)));
            if !self.resets(handler) && !automaton.keeps(&targets) {
                let span = report.span(handler.name.place.start, handler.name.place.end);
                let message = format!("the state diagram stays in `{word}` once it is there");
                let help = "with `__RESET` in the handler both begin anew";
                report.push(
                    Diagnostic::new(Code::ImportDiffers, span, message).label("JavaMOP goes on from there").help(help),
                );
            }
            self.reaction(&name, handler, sheet, report);
        }
    }

    /// The automaton of a monitor that begins when the original does, and its targets; `None` where it has too many states, which is reported.
    fn begun(
        &self,
        block: &Block<'_>,
        automaton: &Automaton,
        targets: BTreeSet<usize>,
        report: &mut Report,
    ) -> Option<(Automaton, BTreeSet<usize>)> {
        let mut begun = (automaton.clone(), targets);
        if let Some(suffix) = self.modifier("suffix") {
            let Some(anew) = begin::at_every_event(&begun.0, &begun.1) else {
                let span = report.span(suffix.place.start, suffix.place.end);
                let message = format!("the `suffix` monitor has more than {} states", automaton::MOST_STATES);
                report.push(Diagnostic::new(Code::ImportRefused, span, message).label("the property is left out"));
                return None;
            };
            begun = anew;
        }
        let begins = |name: &&&str| self.spec.events.iter().any(|e| e.creates && e.name.text == ***name);
        let creating: Vec<bool> = self.order.iter().map(|name| begins(&name)).collect();
        let Some(late) = begin::at_creation(&begun.0, &begun.1, &creating) else { return Some(begun) };
        let resets = block.handlers.iter().any(|h| self.resets(h));
        if let Some(event) = self.spec.events.iter().find(|e| e.creates).filter(|_| resets) {
            let span = report.span(event.name.place.start, event.name.place.end);
            let message = format!("after `reset` the state diagram waits for `{}` again", event.name.text);
            let why = "JavaMOP's monitor has begun once and for all";
            report.push(Diagnostic::new(Code::ImportDiffers, span, message).label(why));
        }
        Some(late)
    }

    /// Whether a handler puts its monitor back to the beginning.
    fn resets(&self, handler: &Handler<'_>) -> bool {
        handler.body.rest().iter().any(|t| self.spec_text(t.range()) == "__RESET")
    }

    fn spec_text(&self, place: std::ops::Range<usize>) -> &'t str {
        self.spec.blocks.first().and_then(|b| b.formula.text.get(place)).unwrap_or("")
    }

    fn reaction(&self, property: &str, handler: &Handler<'_>, sheet: &mut Sheet, report: &mut Report) {
        let own = format!("{property}_{}", slug(&handler.name.text));
        let read = handler::read(handler.body, &own);
        read.beyond.into_iter().for_each(|place| skips(place, report));
        if read.has_code {
            let span = report.span(handler.name.place.start, handler.name.place.end);
            let message = format!("the code of `@{}` does not come along", handler.name.text);
            let runs: Vec<String> = read
                .actions
                .iter()
                .filter_map(|a| match a {
                    crate::sheet::Action::Run(name) => Some(format!("`{name}`")),
                    _ => None,
                })
                .collect();
            let help = format!("register it in the program under the name {}", runs.join(", "));
            report.push(Diagnostic::new(Code::ImportCode, span, message).help(help));
        } else if handler.body.rest().iter().any(|token| token.kind == Kind::Text) {
            let span = report.span(handler.name.place.start, handler.name.place.end);
            let message = format!("what `@{}` prints does not come along", handler.name.text);
            let help = "a report says of each violation what it was and where";
            report.push(Diagnostic::new(Code::ImportCode, span, message).help(help));
        }
        if !read.actions.is_empty() {
            let line = handler.body.line();
            let short = read.has_code && line.chars().count() <= 140;
            let remark = short.then(|| format!("In JavaMOP: {line}"));
            sheet.reactions.push(Reaction { property: property.to_owned(), remark, actions: read.actions });
        }
    }
}

fn skips(place: std::ops::Range<usize>, report: &mut Report) {
    let message = "`__SKIP` has no counterpart: what was called goes on";
    let span = report.span(place.start, place.end);
    report.push(Diagnostic::new(Code::ImportDiffers, span, message).help("on ROS a `guard` holds messages back"));
}

fn no_counterpart(handler: &Handler<'_>, why: &str, report: &mut Report) {
    let span = report.span(handler.name.place.start, handler.name.place.end);
    let message = format!("the handler `@{}` is not carried over", handler.name.text);
    report.push(Diagnostic::new(Code::ImportDiffers, span, message).label(why));
}

/// The events that a formula names.
fn names_in(e: &Expr, names: &mut BTreeSet<String>) {
    if let ExprKind::Path(path) = &e.kind {
        names.extend(path.first().map(|n| n.name.clone()));
    }
    e.children().into_iter().for_each(|child| names_in(child, names));
}

#[derive(Clone, Copy)]
enum Formalism {
    Ltl,
    /// The past alone, judged at every event.
    PtLtl,
    Fsm,
    Ere,
}

impl Formalism {
    fn word(self) -> &'static str {
        match self {
            Formalism::Ltl => "ltl",
            Formalism::PtLtl => "ptltl",
            Formalism::Fsm => "fsm",
            Formalism::Ere => "ere",
        }
    }
}

/// The formalism of that name, and whether the name is spelt as it should be: what was scanned has `Itl` for `ltl`.
fn formalism(word: &str) -> Option<(Formalism, bool)> {
    let all = [Formalism::Ltl, Formalism::PtLtl, Formalism::Fsm, Formalism::Ere];
    let exact = all.into_iter().find(|f| f.word() == word).map(|f| (f, true));
    let scanned = word.to_lowercase().replace(['i', '1', '|'], "l");
    exact.or_else(|| all.into_iter().find(|f| f.word() == scanned).map(|f| (f, false)))
}
