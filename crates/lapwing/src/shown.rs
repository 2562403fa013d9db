//! What a report shows of a property: the signals that it reads, as it writes them, what it computes of them, and its conditions.

use std::collections::BTreeMap;

use lapwing_check::checked::{self, Body, Expr, InputSource, Kind, Property};
use lapwing_diag::Span;
use lapwing_react::{Reading, Role};
use lapwing_stream::{Type, Value};

use crate::eval;
use crate::explain::Printer;
use crate::moment::{Kept, Moment};
use crate::spec::Spec;

/// The longest expression that is shown, in characters.
const LONGEST: usize = 80;

/// The most that is shown of a property.
const MOST: usize = 60;

/// The longest array whose value is shown.
const ELEMENTS: usize = 1000;

/// Something of which a report gives the value.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    /// What it is called.
    pub name: String,
    /// What it is to the reader.
    pub role: Role,
    what: What,
}

#[derive(Clone, Debug)]
enum What {
    Value(Expr),
    /// The state of a machine, with the names of all.
    State(usize, Vec<String>),
}

impl Shown {
    /// Its value at a moment, [`Value::Missing`] where it has none or it is not known.
    pub fn value(&self, at: &dyn Moment) -> Value {
        match &self.what {
            What::Value(e) => match eval::eval(e, at).unwrap_or_default() {
                Value::Nums(xs) if xs.len() > ELEMENTS => Value::Str(format!("an array of {}", xs.len())),
                Value::List(xs) if xs.len() > ELEMENTS => Value::Str(format!("an array of {}", xs.len())),
                other => other,
            },
            What::State(machine, names) => {
                let name = at.state(*machine).and_then(|state| names.get(state));
                Value::Str(name.map_or("undefined", String::as_str).to_owned())
            }
        }
    }

    /// Its value with its name.
    pub fn reading(&self, at: &dyn Moment) -> Reading {
        Reading { name: self.name.clone(), value: self.value(at), role: self.role }
    }

    /// Whether what was before says what it is worth.
    pub fn has_memory(&self) -> bool {
        matches!(&self.what, What::Value(e) if has_memory(e))
    }

    /// Adds what has to be kept of every instant to know its value later.
    pub fn keep(&self, kept: &mut Kept) {
        match &self.what {
            What::Value(e) => kept.add(e),
            What::State(machine, _) => kept.add_machine(*machine),
        }
    }
}

/// A signal, or a number that is computed from signals, under its name.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    /// What it is called.
    pub name: String,
    /// How to compute it.
    pub expr: Expr,
}

/// The signals of a property and what it computes from their present values, in the order of the text.
pub(crate) fn of(spec: &Spec, meaning: &checked::Spec, property: &Property) -> Vec<Named> {
    let named = |shown: Shown| match (shown.role, shown.what) {
        (Role::Value, What::Value(expr)) if is_of_signals(&expr) => Some(Named { name: shown.name, expr }),
        _ => None,
    };
    everything(spec, meaning, property).into_iter().filter_map(named).collect()
}

/// Whether the present values of signals say what an expression is worth.
fn is_of_signals(e: &Expr) -> bool {
    let is_more = matches!(
        e.kind,
        Kind::Event(_)
            | Kind::EventField { .. }
            | Kind::InState { .. }
            | Kind::Param(_)
            | Kind::Updated(_)
            | Kind::Age(_)
            | Kind::Frequency(..)
            | Kind::Fresh(_)
    );
    !is_more && !is_memory(e) && e.children().into_iter().all(is_of_signals)
}

/// Whether an operator over the past is in an expression.
fn has_memory(e: &Expr) -> bool {
    is_memory(e) || e.children().into_iter().any(has_memory)
}

fn is_memory(e: &Expr) -> bool {
    matches!(
        e.kind,
        Kind::Lookback(..)
            | Kind::Delta(_)
            | Kind::Rate(_)
            | Kind::Window(..)
            | Kind::Previously(_)
            | Kind::Becomes(_)
            | Kind::Once(..)
            | Kind::Historically(..)
            | Kind::Since(..)
            | Kind::Held(..)
    )
}

/// What a report shows of a property: what it reads and computes in the order of the text, then its conditions.
pub(crate) fn everything(spec: &Spec, meaning: &checked::Spec, property: &Property) -> Vec<Shown> {
    let mut gather = Gather {
        printer: Printer { spec, meaning },
        renamed: instance(spec, property),
        values: Vec::new(),
        conditions: Vec::new(),
    };
    let place = Place { span: property.span, ..Place::default() };
    match &property.body {
        Body::Formula(formula) => {
            gather.walk(judged(formula), Place { is_judged: true, ..place });
        }
        Body::Machine(machine) => gather.machine(*machine, place),
        Body::None => {}
    }
    gather.all()
}

/// What is judged where a formula is: of `always φ` and `not φ` it is φ.
fn judged(formula: &Expr) -> &Expr {
    match &formula.kind {
        Kind::Always(_, of) | Kind::Not(of) => judged(of),
        _ => formula,
    }
}

/// The variables of `for each`, with what stands for them in this instance.
fn instance(spec: &Spec, property: &Property) -> BTreeMap<String, String> {
    let parts = property.name.split('[').skip(1).filter_map(|p| p.strip_suffix(']'));
    let words: Vec<&str> = spec.slice(property.span).split_whitespace().collect();
    let variables = words.windows(3).filter(|w| w[0] == "for" && w[1] == "each").map(|w| w[2]);
    variables.zip(parts).map(|(var, value)| (var.to_owned(), value.to_owned())).collect()
}

/// Where an expression stands.
#[derive(Clone, Copy, Default)]
struct Place {
    /// The place of what is around it.
    span: Span,
    /// Whether it is a part of a number that is shown.
    in_number: bool,
    /// Whether a name stands for what is around it: then only what it reads is of interest.
    in_name: bool,
    /// Whether it is the whole of what is judged, so that a failure says what it is worth.
    is_judged: bool,
}

struct Gather<'s> {
    printer: Printer<'s>,
    renamed: BTreeMap<String, String>,
    values: Vec<Shown>,
    conditions: Vec<Shown>,
}

impl Gather<'_> {
    fn walk(&mut self, e: &Expr, place: Place) {
        let mut inside = Place { span: e.span, is_judged: false, ..place };
        match &e.kind {
            Kind::Num(_) | Kind::Bool(_) | Kind::Str(_) | Kind::Var(_) | Kind::Param(_) | Kind::Updated(_) => return,
            Kind::Input(input) => return self.input(*input, e, place),
            // `never q` has the place of its q, and the name there is that of q.
            Kind::Not(of) if of.span == e.span => return self.walk(of, place),
            // A number that is used as a condition is shown as the number.
            Kind::Truth(of) => return self.walk(of, place),
            Kind::Event(_) | Kind::EventField { .. } | Kind::Age(_) | Kind::Frequency(..) | Kind::Fresh(_) => {
                let name = self.printer.print(e);
                return self.value(self.rename(&name), Role::Value, e);
            }
            Kind::InState { machine, .. } => return self.state(*machine),
            Kind::Quantified { array, .. } => {
                self.condition(e, place);
                return self.walk(array, inside);
            }
            _ if place.in_name || e.has_future() || !reads(e) => {}
            _ if self.is_name(e, place) => {
                self.named(e);
                inside.in_name = true;
            }
            _ if is_quantity(e) => {
                let text = self.text(e, place);
                if text.chars().count() <= LONGEST {
                    self.value(text, if place.in_number { Role::Part } else { Role::Value }, e);
                    inside.in_number = true;
                }
            }
            _ => self.condition(e, place),
        }
        e.children().into_iter().for_each(|c| self.walk(c, inside));
    }

    /// A signal, under the name that stands there, else under its own. What a world signal is computed from is no signal of the text.
    fn input(&mut self, input: usize, e: &Expr, place: Place) {
        let Some(input) = self.printer.meaning.inputs.get(input) else { return };
        let is_world = matches!(input.source, InputSource::World { .. });
        match self.is_name(e, place) {
            true => self.value(self.text(e, place), Role::Value, e),
            false if is_world && place.in_name => {}
            false => self.value(input.label.clone(), Role::Value, e),
        }
    }

    /// What has a name of its own: a number or a condition with that name.
    fn named(&mut self, e: &Expr) {
        let text = self.rename(self.printer.spec.slice(e.span));
        self.value(text, Role::Value, e);
    }

    fn is_name(&self, e: &Expr, place: Place) -> bool {
        e.span != place.span && is_name(self.printer.spec.slice(e.span))
    }

    fn state(&mut self, number: usize) {
        let Some(machine) = self.printer.meaning.machines.get(number) else { return };
        let names = machine.states.iter().map(|s| s.name.clone()).collect();
        add(
            &mut self.values,
            Shown { name: machine.name.clone(), role: Role::Value, what: What::State(number, names) },
        );
    }

    /// A condition; whatever is judged as a whole, and `not`, say nothing that is not known.
    fn condition(&mut self, e: &Expr, place: Place) {
        if place.is_judged || place.in_name || e.has_future() || e.ty != Type::Bool || matches!(e.kind, Kind::Not(_)) {
            return;
        }
        let name = self.text(e, place);
        if name.chars().count() <= LONGEST {
            add(&mut self.conditions, Shown { name, role: Role::Condition, what: What::Value(e.clone()) });
        }
    }

    fn value(&mut self, name: String, role: Role, e: &Expr) {
        add(&mut self.values, Shown { name, role, what: What::Value(e.clone()) });
    }

    fn machine(&mut self, number: usize, place: Place) {
        let Some(machine) = self.printer.meaning.machines.get(number) else { return };
        self.state(number);
        let events = machine.states.iter().filter_map(|s| s.on).chain(machine.edges.iter().filter_map(|e| e.on));
        for event in events {
            let kind = Kind::Event(event);
            let e = Expr { kind, ty: Type::Bool, dim: Default::default(), span: place.span };
            self.walk(&e, place);
        }
        machine.conditions().for_each(|e| self.walk(e, place));
    }

    /// The text of an expression on one line, as written; what a pattern brought has none of its own there.
    fn text(&self, e: &Expr, place: Place) -> String {
        match e.span == place.span {
            true => self.printer.print(e),
            false => self.rename(self.printer.spec.slice(e.span)),
        }
    }

    /// The text on one line, with what stands for the variables of `for each`.
    fn rename(&self, text: &str) -> String {
        let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let mut out = String::new();
        let mut rest = line.as_str();
        while let Some(first) = rest.chars().next() {
            let end = rest.find(|c| is_part(c) != is_part(first)).unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            out += self.renamed.get(word).map_or(word, String::as_str);
            rest = after;
        }
        out
    }

    /// Everything. A single condition says to people what the failure says.
    fn all(mut self) -> Vec<Shown> {
        if let [only] = self.conditions.as_mut_slice() {
            only.role = Role::Part;
        }
        self.values.into_iter().chain(self.conditions).take(MOST).collect()
    }
}

fn add(list: &mut Vec<Shown>, shown: Shown) {
    match list.iter_mut().find(|s| s.name == shown.name) {
        Some(known) if known.role == Role::Part => *known = shown,
        Some(_) => {}
        None => list.push(shown),
    }
}

/// Whether a text is a name, perhaps with fields and indices: `scan.ranges[3]`.
pub(crate) fn is_name(text: &str) -> bool {
    let starts = text.starts_with(|c: char| c.is_alphabetic() || c == '_' || c == '`');
    starts && text.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']' | '`'))
}

/// Whether an expression is a computed value. What a table has no type for may be one that is looked back at.
fn is_quantity(e: &Expr) -> bool {
    match (&e.kind, &e.ty) {
        (Kind::Neg(_), _) => false,
        (_, Type::Num { .. }) => true,
        (Kind::Lookback(..), ty) => matches!(ty, Type::Any | Type::Str),
        _ => false,
    }
}

/// Whether an expression depends on the moment.
fn reads(e: &Expr) -> bool {
    let reads_itself = matches!(
        e.kind,
        Kind::Input(_)
            | Kind::Event(_)
            | Kind::EventField { .. }
            | Kind::InState { .. }
            | Kind::Age(_)
            | Kind::Frequency(..)
            | Kind::Fresh(_)
    );
    reads_itself || e.children().into_iter().any(reads)
}
