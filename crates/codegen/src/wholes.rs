//! What is handed over as a whole and not kept: arrays and texts, of signals and of events. What is asked of one (how many elements there are, the
//! least, one by its number, whether something is true of any; whether a text begins with another) becomes an input of its own, and a function
//! that is handed the whole works them all out, so that texts and arrays of every length need the same memory.

use std::collections::BTreeSet;

use lapwing_check::checked::{self, Body, Connective, Event, EventField, Func, Input, Kind, Read, ReadOf, Spec, Step};
use lapwing_stream::{Type, Value};

use crate::code::Expr;
use crate::elements::{Column, by_extreme, path_from, said};
use crate::interface::{self, From, Names, identifier};
use crate::scene::Scene;

/// An array or a text that a function takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Whole {
    /// What the specification calls it.
    pub label: String,
    /// The input of the checked specification, or the field of an event, that it is.
    pub from: From,
    /// What it is.
    pub shape: Shape,
    /// The function that takes it; in C the prefix and `_` stand before that.
    pub setter: String,
    /// Of an array of anything but numbers: what is read of its elements.
    pub columns: Vec<Column>,
    pub(crate) parts: Vec<Part>,
}

/// What a whole is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// An array of numbers.
    Numbers,
    /// A text.
    Text,
    /// An array of messages, of texts or of truth values: an array for each part of its elements that is read.
    Columns,
    /// An array of numbers beside one of their names, which comes from there.
    Table(From),
}

/// Something that is asked of a whole.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// What stands for it.
    pub from: From,
    pub what: What,
}

/// What is asked. Elements that are NaN are none, but where they are asked for by their number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    Length,
    Least,
    Greatest,
    Element(usize),
    /// A number in an element.
    At(usize, Column),
    /// Of an element that is called `x`.
    Any(Expr),
    /// The number beside a name.
    Beside(String),
    /// The code of a text.
    Code,
    StartsWith(String),
    EndsWith(String),
    Contains(String),
}

/// Puts inputs and fields of their own in the place of what a specification asks of arrays and texts.
pub(crate) fn unfold(spec: &mut Spec, setters: &mut Names) -> Vec<Whole> {
    let Spec { inputs, properties, machines, events, .. } = spec;
    let mut unfolding = Unfolding { inputs, events, setters, wholes: Vec::new() };
    for property in properties.iter_mut() {
        if let Body::Formula(formula) = &mut property.body {
            unfolding.expression(formula);
        }
    }
    for machine in machines.iter_mut() {
        let states = machine.states.iter_mut().filter_map(|s| s.when.as_mut());
        let edges = machine.edges.iter_mut().filter_map(|e| e.when.as_mut());
        machine.sample.iter_mut().chain(states).chain(edges).for_each(|e| unfolding.expression(e));
    }
    for event in 0..unfolding.events.len() {
        if let Some(mut when) = unfolding.events[event].when.take() {
            unfolding.expression(&mut when);
            unfolding.events[event].when = Some(when);
        }
    }
    let wholes = unfolding.wholes;
    await_parts(spec, &wholes);
    wholes
}

/// What waited for a whole waits for its parts, which all come with it.
fn await_parts(spec: &mut Spec, wholes: &[Whole]) {
    let still_read = inputs_read(spec);
    let Spec { properties, machines, .. } = spec;
    let reads = properties.iter_mut().map(|p| &mut p.reads).chain(machines.iter_mut().map(|m| &mut m.reads));
    for reads in reads {
        for read in std::mem::take(reads) {
            let ReadOf::Input(input) = read.what else {
                reads.push(read);
                continue;
            };
            let parts =
                wholes.iter().filter(|whole| whole.is_made_of(From::Input(input))).flat_map(|whole| &whole.parts);
            let awaited = parts.filter_map(|part| match part.from {
                From::Input(part) => Some(part),
                _ => None,
            });
            let mut awaited: Vec<usize> = awaited.collect();
            if awaited.is_empty() || still_read.contains(&input) {
                awaited.push(input);
            }
            for read in awaited.into_iter().map(|input| Read { what: ReadOf::Input(input), ..read }) {
                if !reads.contains(&read) {
                    reads.push(read);
                }
            }
        }
    }
}

/// The inputs that formulas and machines still read.
fn inputs_read(spec: &Spec) -> BTreeSet<usize> {
    fn below(e: &checked::Expr, found: &mut BTreeSet<usize>) {
        if let Kind::Input(i) = e.kind {
            found.insert(i);
        }
        e.children().into_iter().for_each(|c| below(c, found));
    }
    let mut found = BTreeSet::new();
    for property in &spec.properties {
        if let Body::Formula(formula) = &property.body {
            below(formula, &mut found);
        }
    }
    spec.machines.iter().flat_map(|m| m.conditions()).for_each(|e| below(e, &mut found));
    found
}

/// What is said of all elements of a field of an event is not so where the event does not occur.
fn where_it_occurs(said: &mut checked::Expr, from: From) {
    if let From::EventField(event, _) = from {
        let occurs = checked::Expr { kind: Kind::Event(event), ..said.clone() };
        said.kind = Kind::Connective(Connective::And, Box::new(occurs), Box::new(said.clone()));
    }
}

/// What an expression asks, of what, and how many instants ago.
struct Asked {
    from: From,
    shape: Shape,
    what: What,
    /// What of the elements that reads, where the shape is one of columns.
    columns: Vec<Column>,
    back: usize,
}

impl Asked {
    fn new((from, back): (From, usize), shape: Shape, what: What) -> Asked {
        Asked { from, shape, what, columns: Vec::new(), back }
    }
}

struct Unfolding<'s> {
    inputs: &'s mut Vec<Input>,
    events: &'s mut Vec<Event>,
    setters: &'s mut Names,
    wholes: Vec<Whole>,
}

impl Unfolding<'_> {
    fn expression(&mut self, e: &mut checked::Expr) {
        let (asked, is_all) = match &e.kind {
            // What is true of all is not untrue of any.
            Kind::Quantified { all, array, body } => {
                (said(body).and_then(|(body, columns)| self.any(array, if *all { !body } else { body }, columns)), *all)
            }
            _ => (self.asked(e), false),
        };
        let Some(asked) = asked else {
            if let Kind::Quantified { all, array, body } = &e.kind
                && let Some((from, back)) = source(array).filter(|(from, _)| self.is_array(*from))
                && let Some(kind) = by_extreme(*all, array, body)
            {
                let is_all = *all && back == 0;
                e.kind = kind;
                if is_all {
                    where_it_occurs(e, from);
                }
            }
            e.children_mut().into_iter().for_each(|c| self.expression(c));
            return;
        };
        let (from, back) = (asked.from, asked.back);
        let part = match self.part(e, asked) {
            From::EventField(event, field) => Kind::EventField { event, field },
            From::Input(input) => Kind::Input(input),
            _ => return,
        };
        e.kind = part;
        if back > 0 {
            e.kind = Kind::Lookback(Box::new(e.clone()), back);
        }
        if is_all {
            e.kind = Kind::Not(Box::new(e.clone()));
        }
        if is_all && back == 0 {
            where_it_occurs(e, from);
        }
    }

    /// What an expression asks of which whole, if it is no more than that.
    fn asked(&self, e: &checked::Expr) -> Option<Asked> {
        match &e.kind {
            Kind::Call(Func::Len, args) => self.of_array(args.first()?, What::Length),
            Kind::Call(Func::MinOf, args) => self.of_array(args.first()?, What::Least),
            Kind::Call(Func::MaxOf, args) => self.of_array(args.first()?, What::Greatest),
            Kind::Index(of, n) => self.of_array(of, What::Element(*n)),
            Kind::Field(..) => self.in_element(e),
            Kind::Call(Func::StartsWith, args) => self.of_text(args, What::StartsWith),
            Kind::Call(Func::EndsWith, args) => self.of_text(args, What::EndsWith),
            Kind::Call(Func::Contains, args) => self.of_text(args, What::Contains),
            Kind::Call(Func::Lookup, args) => {
                let [names, values, name] = args.as_slice() else { return None };
                let Kind::Str(name) = &name.kind else { return None };
                let ((names, back), (values, other)) = (source(names)?, source(values)?);
                let is_table = back == other && self.is_array_of(names, &Type::Str) && self.is_array(values);
                let (shape, what) = (Shape::Table(names), What::Beside(name.clone()));
                is_table.then(|| Asked::new((values, back), shape, what))
            }
            _ => None,
        }
    }

    fn of_array(&self, of: &checked::Expr, what: What) -> Option<Asked> {
        let source = source(of)?;
        match what {
            _ if self.is_array(source.0) => Some(Asked::new(source, Shape::Numbers, what)),
            What::Length if self.has_columns(source.0) => Some(Asked::new(source, Shape::Columns, what)),
            _ => None,
        }
    }

    /// Whether something is true of any element.
    fn any(&self, of: &checked::Expr, body: Expr, columns: Vec<Column>) -> Option<Asked> {
        let source = source(of)?;
        let are_numbers = columns.iter().all(|c| c.path.is_empty() && c.kind == interface::Kind::Number);
        if are_numbers && self.is_array(source.0) {
            return Some(Asked::new(source, Shape::Numbers, What::Any(body)));
        }
        let asked = Asked { columns, ..Asked::new(source, Shape::Columns, What::Any(body)) };
        (self.has_columns(source.0) && self.fit(&asked)).then_some(asked)
    }

    /// A number in an element of an array of messages: `obstacles[0].distance`.
    fn in_element(&self, e: &checked::Expr) -> Option<Asked> {
        if !matches!(e.ty, Type::Num { .. } | Type::Any) {
            return None;
        }
        let path = path_from(e, &|kind| matches!(kind, Kind::Index(..)))?;
        let (source, n) = element(e)?;
        let column = Column { path, kind: interface::Kind::Number };
        let asked = Asked { columns: vec![column.clone()], ..Asked::new(source, Shape::Columns, What::At(n, column)) };
        (self.has_columns(source.0) && self.fit(&asked)).then_some(asked)
    }

    /// Whether something is an array of which parts of elements can be handed over.
    fn has_columns(&self, from: From) -> bool {
        let has_default = matches!(from, From::Input(i) if self.inputs.get(i).is_some_and(|i| i.default.is_some()));
        let is_array = match self.ty(from) {
            Some(Type::Array(of)) => matches!(**of, Type::Message(_) | Type::Str | Type::Bool | Type::Any),
            ty => ty == Some(&Type::Any),
        };
        is_array && !has_default
    }

    /// Whether nothing that is read of the elements is taken for something else elsewhere.
    fn fit(&self, asked: &Asked) -> bool {
        let same = |whole: &&Whole| whole.from == asked.from && whole.shape == asked.shape;
        let mut known = self.wholes.iter().filter(same).flat_map(|whole| &whole.columns);
        known.all(|known| asked.columns.iter().all(|column| known == column || known.name() != column.name()))
    }

    fn of_text(&self, args: &[checked::Expr], what: impl Fn(String) -> What) -> Option<Asked> {
        let [of, other] = args else { return None };
        let Kind::Str(other) = &other.kind else { return None };
        let (from, back) = source(of)?;
        let is_text = matches!(self.ty(from)?, Type::Str | Type::Any);
        is_text.then(|| Asked::new((from, back), Shape::Text, what(other.clone())))
    }

    fn ty(&self, from: From) -> Option<&Type> {
        match from {
            From::Input(i) => Some(&self.inputs.get(i)?.ty),
            From::EventField(e, f) => Some(&self.events.get(e)?.fields.get(f)?.ty),
            _ => None,
        }
    }

    /// An array of numbers. What no type tells of is one, as long as it is only asked what arrays are asked; where its elements are compared with
    /// texts that is refused as a comparison of values of two kinds.
    fn is_array(&self, from: From) -> bool {
        let has_default = matches!(from, From::Input(i) if self.inputs.get(i).is_some_and(|i| i.default.is_some()));
        let is_numbers = match self.ty(from) {
            Some(Type::Array(of)) => matches!(**of, Type::Num { .. }),
            ty => ty == Some(&Type::Any),
        };
        is_numbers && !has_default
    }

    fn is_array_of(&self, from: From, element: &Type) -> bool {
        match self.ty(from) {
            Some(Type::Array(of)) => **of == *element,
            ty => ty == Some(&Type::Any),
        }
    }

    /// What stands for something that is asked, made where it is asked for the first time.
    fn part(&mut self, e: &checked::Expr, asked: Asked) -> From {
        let whole = self.whole(asked.from, asked.shape);
        let known = &mut self.wholes[whole].columns;
        for column in &asked.columns {
            if !known.contains(column) {
                known.push(column.clone());
            }
        }
        if let Some(part) = self.wholes[whole].parts.iter().find(|part| part.what == asked.what) {
            return part.from;
        }
        let label = asked.what.label(&self.wholes[whole].label);
        let ty = asked.what.ty();
        let from = match asked.from {
            From::Input(of) => {
                let default = self.inputs[of].default.as_ref().and_then(|of| asked.what.of_default(of));
                self.inputs.push(Input { label, ty, dim: e.dim, default, ..self.inputs[of].clone() });
                From::Input(self.inputs.len() - 1)
            }
            From::EventField(event, _) => {
                let fields = &mut self.events[event].fields;
                fields.push(EventField { path: vec![Step::Field(identifier(&label))], wanted: None, ty });
                From::EventField(event, fields.len() - 1)
            }
            other => other,
        };
        self.wholes[whole].parts.push(Part { from, what: asked.what });
        from
    }

    fn whole(&mut self, from: From, shape: Shape) -> usize {
        if let Some(at) = self.wholes.iter().position(|known| known.from == from && known.shape == shape) {
            return at;
        }
        let label = match from {
            From::Input(i) => self.inputs[i].label.clone(),
            From::EventField(e, f) => checked::part(&self.events[e].name, &self.events[e].fields[f].path),
            _ => String::new(),
        };
        let names = match shape {
            Shape::Table(From::Input(names)) => format!("_by_{}", self.inputs[names].label),
            Shape::Table(_) => "_by_name".to_owned(),
            _ => String::new(),
        };
        let setter = self.setters.give(&identifier(&format!("set_{label}{names}")));
        self.wholes.push(Whole { label, from, shape, setter, columns: Vec::new(), parts: Vec::new() });
        self.wholes.len() - 1
    }
}

/// The signal, or the field of an event, that an expression is, and how many instants ago.
fn source(e: &checked::Expr) -> Option<(From, usize)> {
    match &e.kind {
        Kind::Input(i) => Some((From::Input(*i), 0)),
        Kind::EventField { event, field } => Some((From::EventField(*event, *field), 0)),
        Kind::Lookback(of, n) => source(of).map(|(from, back)| (from, back + n)),
        _ => None,
    }
}

/// The array of whose element an expression is a part, and the number of the element.
fn element(e: &checked::Expr) -> Option<((From, usize), usize)> {
    match &e.kind {
        Kind::Field(of, _) => element(of),
        Kind::Index(of, n) => Some((source(of)?, *n)),
        _ => None,
    }
}

impl Whole {
    /// Whether something from outside is, or is part of, what the function takes.
    fn is_made_of(&self, from: From) -> bool {
        self.from == from || self.shape == Shape::Table(from)
    }
}

impl What {
    fn label(&self, whole: &str) -> String {
        match self {
            What::Length => format!("len({whole})"),
            What::Least => format!("min({whole})"),
            What::Greatest => format!("max({whole})"),
            What::Element(n) => format!("{whole}[{n}]"),
            What::At(n, column) => format!("{whole}[{n}].{}", column.path.join(".")),
            What::Any(_) => format!("any({whole})"),
            What::Beside(name) => format!("{whole}[{name:?}]"),
            What::Code => whole.to_owned(),
            What::StartsWith(other) => format!("starts_with({whole}, {other:?})"),
            What::EndsWith(other) => format!("ends_with({whole}, {other:?})"),
            What::Contains(other) => format!("contains({whole}, {other:?})"),
        }
    }

    fn ty(&self) -> Type {
        match self {
            What::Any(_) | What::StartsWith(_) | What::EndsWith(_) | What::Contains(_) => Type::Bool,
            What::Code => Type::Str,
            What::Length | What::Least | What::Greatest | What::Element(_) | What::At(..) | What::Beside(_) => {
                Type::Num { float: true }
            }
        }
    }

    /// What it is of the text that a signal is at first.
    fn of_default(&self, whole: &Value) -> Option<Value> {
        let Value::Str(whole) = whole else { return None };
        match self {
            What::StartsWith(other) => Some(Value::Bool(whole.starts_with(other.as_str()))),
            What::EndsWith(other) => Some(Value::Bool(whole.ends_with(other.as_str()))),
            What::Contains(other) => Some(Value::Bool(whole.contains(other.as_str()))),
            _ => None,
        }
    }

    /// What is said of each element.
    pub fn body(&self) -> Option<&Expr> {
        match self {
            What::Any(body) => Some(body),
            _ => None,
        }
    }
}

/// Functions that take texts work out their codes as well.
pub(crate) fn add_codes(wholes: &mut Vec<Whole>, scene: &Scene<'_>, setters: &mut Names) {
    for member in scene.members.values().filter(|member| member.kind == interface::Kind::Text) {
        let part = Part { from: member.from, what: What::Code };
        match wholes.iter_mut().find(|whole| whole.from == member.from && whole.shape == Shape::Text) {
            Some(whole) => whole.parts.insert(0, part),
            None => {
                let label = match member.from {
                    From::Input(i) => scene.spec.inputs[i].label.clone(),
                    _ => member.name.clone(),
                };
                let setter = setters.give(&identifier(&format!("set_{label}")));
                wholes.push(Whole {
                    label,
                    from: member.from,
                    shape: Shape::Text,
                    setter,
                    columns: Vec::new(),
                    parts: vec![part],
                });
            }
        }
    }
}
