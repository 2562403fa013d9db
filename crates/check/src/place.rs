//! A way to a value inside a message, a row or an event, before anyone has asked for it: only what an expression finally reads
//! becomes a signal, so that nothing else needs to be decoded.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::{Duration, Type, Value};
use lapwing_syntax::ast::{self, Ident};

use crate::checked::{EventField, EventSource, Expr, Input, InputSource, Kind, Path, Step, part};
use crate::context::{Cx, Env, poison};
use crate::messages::{self, Known};
use lapwing_diag::suggest;

/// A way to a value.
#[derive(Clone)]
pub(crate) struct Place {
    pub root: Root,
    /// The way from there.
    pub path: Path,
    /// How reports call it.
    pub label: String,
    pub ty: Type,
    pub known: Known,
    pub default: Option<Value>,
    pub stale: Option<Duration>,
    pub span: Span,
}

/// Where a way begins.
#[derive(Clone)]
pub(crate) enum Root {
    /// The messages of a topic.
    Topic(usize),
    /// A declared signal of a trace without schemas: a column, or a topic after all.
    Declared(ast::Topic, ast::TypePath),
    /// An undeclared column; the label is its name.
    Column,
    /// The fields of an event.
    Event(usize),
}

impl Place {
    /// The field of that name below it; `None`, and reported, where the type has none.
    pub fn field(&self, cx: &mut Cx, env: &Env, name: &Ident) -> Option<Place> {
        let ty = field_type(cx, env, &self.ty, name)?;
        let mut place = self.clone();
        place.path.push(Step::Field(name.name.clone()));
        place.label = match place.label.is_empty() {
            true => name.name.clone(),
            false => format!("{}.{}", place.label, name.name),
        };
        place.ty = ty;
        place.known = messages::field(self.known.message, self.known.dim, &name.name);
        place.default = None;
        Some(place)
    }

    /// The element of an array below it.
    fn element(&self, cx: &mut Cx, env: &Env, index: usize, span: Span) -> Option<Place> {
        let ty = match &self.ty {
            Type::Array(inner) => (**inner).clone(),
            Type::Any => Type::Any,
            other => {
                let message = format!("{} is no array and has no element {index}", describe(other));
                cx.report(env, Diagnostic::new(Code::TypeMismatch, span, message));
                return None;
            }
        };
        let mut place = self.clone();
        place.path.push(Step::Index(index));
        place.label = format!("{}[{index}]", place.label);
        place.ty = ty;
        Some(place)
    }

    /// The place at the end of a declared path.
    pub fn follow(self, cx: &mut Cx, env: &Env, path: &[ast::PathPart]) -> Option<Place> {
        path.iter().try_fold(self, |place, part| match part {
            ast::PathPart::Field(name) => place.field(cx, env, name),
            ast::PathPart::Index(index, span) => place.element(cx, env, *index, *span),
        })
    }

    /// The value as an expression: from here on it is read.
    pub fn read(&self, cx: &mut Cx, env: &Env) -> Expr {
        match &self.root {
            Root::Topic(topic) => self.read_topic(cx, *topic),
            Root::Event(event) => self.read_event(cx, *event),
            Root::Column => self.read_column(cx, &self.label),
            Root::Declared(topic, ty) => match declared_column(cx, self, topic) {
                Some(column) => self.read_column(cx, &column),
                None => self.read_open_topic(cx, env, topic, ty),
            },
        }
    }

    /// Whether a trace without schemas has a column for exactly this.
    pub fn has_column(&self, cx: &Cx) -> bool {
        match &self.root {
            Root::Column => cx.trace.is_some_and(|t| t.has_column(&self.label)),
            Root::Declared(topic, _) => {
                let trace = cx.trace.filter(|t| t.has_column(&self.label) || t.has_column(&long_name(self, topic)));
                trace.is_some()
            }
            Root::Topic(_) | Root::Event(_) => false,
        }
    }

    /// In a trace without schemas, a declared topic is read where the trace has it and no column comes before it.
    pub fn declare_topic(&self, cx: &mut Cx, topic: &ast::Topic) {
        let there = cx.trace.is_some_and(|t| t.topic(&topic.absolute()).is_some());
        if there && !self.has_column(cx) {
            cx.topic(&topic.absolute(), topic.span);
        }
    }

    fn read_topic(&self, cx: &mut Cx, topic: usize) -> Expr {
        let field = cx.field(topic, &self.path);
        cx.input(self.as_input(InputSource::Field { topic, field }), self.span)
    }

    fn read_column(&self, cx: &mut Cx, column: &str) -> Expr {
        let column = cx.column(column);
        cx.input(self.as_input(InputSource::Column(column)), self.span)
    }

    fn read_event(&self, cx: &mut Cx, event: usize) -> Expr {
        let wanted = match cx.spec.events[event].source {
            EventSource::Message { topic } => Some(cx.field(topic, &self.path)),
            _ => None,
        };
        let field = cx.event_field(event, EventField { path: self.path.clone(), wanted, ty: self.ty.clone() });
        Expr { kind: Kind::EventField { event, field }, ty: self.ty.clone(), dim: self.known.dim, span: self.span }
    }

    fn read_open_topic(&self, cx: &mut Cx, env: &Env, topic: &ast::Topic, ty: &ast::TypePath) -> Expr {
        let has_topic = cx.trace.is_some_and(|t| t.columns_open || t.topic(&topic.absolute()).is_some());
        if !has_topic && self.default.is_some() {
            return self.read_column(cx, &self.label);
        }
        if !has_topic {
            missing_column(cx, env, self, topic);
            return poison(self.span);
        }
        let opened = cx.open(env, topic, Some(ty));
        self.read_topic(cx, opened.topic)
    }

    fn as_input(&self, source: InputSource) -> Input {
        Input {
            label: self.label.clone(),
            source,
            ty: self.ty.clone(),
            dim: self.known.dim,
            default: self.default.clone(),
            stale: self.stale,
        }
    }
}

/// `/odom.pose.pose.position.x`, the other name that a column for a declared signal may have.
fn long_name(place: &Place, topic: &ast::Topic) -> String {
    part(&topic.absolute(), &place.path)
}

fn declared_column(cx: &Cx, place: &Place, topic: &ast::Topic) -> Option<String> {
    let trace = cx.trace?;
    let long = long_name(place, topic);
    if trace.has_column(&place.label) {
        return Some(place.label.clone());
    }
    if trace.has_column(&long) {
        return Some(long);
    }
    // Where columns may still turn up and there are no topics, it will be a column.
    let guess = trace.columns_open && trace.topics.is_empty() && !trace.columns.is_empty();
    (guess || trace.is_program()).then(|| place.label.clone())
}

fn missing_column(cx: &mut Cx, env: &Env, place: &Place, topic: &ast::Topic) {
    let Some(trace) = cx.trace else { return };
    let long = long_name(place, topic);
    let columns = || trace.columns.iter().map(String::as_str);
    let guess = suggest::nearest(&place.label, columns()).or_else(|| suggest::nearest(&long, columns()));
    let message = format!("no column `{}` in this recording, nor `{long}`{}", place.label, suggest::or_else(guess));
    cx.found.blame(message.clone());
    cx.found.failed = true;
    let diagnostic = Diagnostic::new(Code::MissingColumn, place.span, message)
        .label("what reads this signal is inconclusive")
        .help(format!("the recording has {}", suggest::listed(columns())));
    cx.report(env, diagnostic);
}

/// The type of a field of something of type `ty`; `None`, and reported, where there is none.
pub(crate) fn field_type(cx: &mut Cx, env: &Env, ty: &Type, name: &Ident) -> Option<Type> {
    let schema = match ty {
        Type::Any => return Some(Type::Any),
        Type::Message(schema) => schema,
        other => {
            let message = format!("{} has no field `{}`", describe(other), name.name);
            let mut diagnostic =
                Diagnostic::new(Code::UnknownField, name.span, message).label("there are no fields here");
            if matches!(other, Type::Array(_)) {
                diagnostic =
                    diagnostic.help("pick an element, `[0]`, or ask about all: `any(a, v => …)`, `all(a, v => …)`");
            }
            cx.report(env, diagnostic);
            return None;
        }
    };
    if let Some(field) = schema.field(&name.name) {
        return Some(field.ty.clone());
    }
    let fields = || schema.fields.iter().map(|f| &*f.name);
    let guess = suggest::nearest(&name.name, fields());
    let message = format!("{} has no field `{}`{}", schema.name, name.name, suggest::or_else(guess));
    let mut diagnostic = Diagnostic::new(Code::UnknownField, name.span, message)
        .label("not a field of this type")
        .help(match schema.fields.is_empty() {
            true => "it has no fields at all".to_owned(),
            false => format!("its fields are {}", suggest::listed(fields())),
        });
    // What stands there is a variable of `for each` where it is not the name: an edit for this instance would be wrong in others.
    if let Some(guess) = guess.filter(|_| cx.sources.slice(name.span).trim_matches('`') == name.name) {
        diagnostic = diagnostic.fix(name.span, guess);
    }
    cx.report(env, diagnostic);
    None
}

/// A type in words: `a number`, `a nav_msgs/Odometry`.
pub(crate) fn describe(ty: &Type) -> String {
    match ty {
        Type::Bool => "a condition (true or false)".to_owned(),
        Type::Num { .. } => "a number".to_owned(),
        Type::Str => "a text".to_owned(),
        Type::Array(_) => "an array".to_owned(),
        Type::Message(schema) => format!("a {}", schema.name),
        Type::Any => "a value of unknown type".to_owned(),
    }
}
