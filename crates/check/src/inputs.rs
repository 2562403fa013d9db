//! The tables of a specification: each topic, field, column, signal, object and event gets its number when it is first read.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast;

use crate::checked::{Dim, Event, EventField, EventSource, Expr, Input, Kind, Object, ObjectSource, Path, Topic};
use crate::context::{Cx, Env};
use crate::messages::{Known, known_type};
use crate::reaction::type_name;
use crate::trace::{TraceShape, is_type, plain_type};
use crate::world::DEFAULT_TOPIC;
use lapwing_diag::suggest;

/// A topic that has been looked up in the trace.
pub(crate) struct Opened {
    pub topic: usize,
    /// The type of its messages.
    pub ty: Type,
    pub known: Known,
}

impl Cx<'_> {
    /// The number of a topic.
    pub fn topic(&mut self, name: &str, span: Span) -> usize {
        if let Some(index) = self.spec.topics.iter().position(|t| t.name == name) {
            return index;
        }
        let type_name =
            self.trace.and_then(|t| t.topic(name)).map(|t| plain_type(&t.type_name)).filter(|t| !t.is_empty());
        self.spec.topics.push(Topic { name: name.to_owned(), type_name, fields: Vec::new(), span });
        self.spec.topics.len() - 1
    }

    /// Looks a topic up. One that is not there, or is of another type, is a warning, and a cause for what reads it.
    pub fn open(&mut self, env: &Env, topic: &ast::Topic, ty: Option<&ast::TypePath>) -> Opened {
        let name = topic.absolute();
        let index = self.topic(&name, topic.span);
        let package = ty.and_then(|t| t.package.as_ref()).map(|p| p.name.as_str());
        let known = ty.and_then(|t| known_type(package, &t.name.name));
        let mut opened = Opened { topic: index, ty: Type::Any, known: Known { dim: Dim::UNKNOWN, message: known } };
        let Some(trace) = self.trace else {
            if let (Some(package), Some(ty)) = (package, ty) {
                self.spec.topics[index].type_name.get_or_insert_with(|| format!("{package}/{}", ty.name.name));
            }
            return opened;
        };
        let Some(found) = trace.topic(&name) else {
            if !trace.columns_open {
                self.missing_topic(env, &name, topic.span);
            }
            return opened;
        };
        match ty {
            Some(ty) if !found.type_name.is_empty() && !is_type(package, &ty.name.name, &found.type_name) => {
                self.other_type(env, &name, &plain_type(&found.type_name), ty);
            }
            _ => {
                opened.ty = found.schema.clone().map_or(Type::Any, Type::Message);
                if opened.known.message.is_none() {
                    let plain = plain_type(&found.type_name);
                    opened.known.message =
                        plain.split_once('/').and_then(|(package, short)| known_type(Some(package), short));
                }
            }
        }
        opened
    }

    fn missing_topic(&mut self, env: &Env, name: &str, span: Span) {
        let Some(trace) = self.trace else { return };
        let guess = suggest::nearest(name, trace.names());
        let question = guess.map(|g| format!("; did you mean {g}?")).unwrap_or_default();
        let message = format!("no message on {name} {}{question}", trace.here());
        let what = if trace.live { "the graph" } else { "the recording" };
        let help = match trace.names().next() {
            None => format!("{what} has no topics at all"),
            Some(_) => format!("{what} has {}", suggest::listed(trace.names())),
        };
        self.found.blame(message.clone());
        let mut diagnostic = Diagnostic::new(Code::MissingTopic, span, message)
            .label("what reads this topic is inconclusive")
            .help(help);
        if name == DEFAULT_TOPIC {
            diagnostic = diagnostic.help(
                "ground truth comes from there unless the file names another source: `world robot /gt/robot Odometry`",
            );
        }
        let written = self.sources.slice(span);
        if let Some(guess) = guess.filter(|_| written.trim_start_matches('/') == name.trim_start_matches('/')) {
            diagnostic =
                diagnostic.fix(span, if written.starts_with('/') { guess } else { guess.trim_start_matches('/') });
        }
        self.report(env, diagnostic);
    }

    fn other_type(&mut self, env: &Env, name: &str, full: &str, ty: &ast::TypePath) {
        let here = self.trace.map_or("", TraceShape::here);
        let message = format!("{name} is a {full} {here}, not a {}", type_name(ty));
        self.found.blame(message.clone());
        let span = ty.package.as_ref().map_or(ty.name.span, |p| p.span.to(ty.name.span));
        let diagnostic = Diagnostic::new(Code::TopicType, span, message)
            .label("what reads this topic is inconclusive")
            .help(format!("write `{full}`, and the fields that this type has"));
        self.report(env, diagnostic);
    }

    /// The number of a wanted field of a topic.
    pub fn field(&mut self, topic: usize, path: &Path) -> usize {
        let fields = &mut self.spec.topics[topic].fields;
        fields.iter().position(|f| f == path).unwrap_or_else(|| {
            fields.push(path.clone());
            fields.len() - 1
        })
    }

    /// The number of a wanted column.
    pub fn column(&mut self, name: &str) -> usize {
        let columns = &mut self.spec.columns;
        columns.iter().position(|c| c == name).unwrap_or_else(|| {
            columns.push(name.to_owned());
            columns.len() - 1
        })
    }

    /// A signal as an expression.
    pub fn input(&mut self, input: Input, span: Span) -> Expr {
        let (ty, dim) = (input.ty.clone(), input.dim);
        let inputs = &mut self.spec.inputs;
        let index = inputs.iter().position(|i| *i == input).unwrap_or_else(|| {
            inputs.push(input);
            inputs.len() - 1
        });
        Expr { kind: Kind::Input(index), ty, dim, span }
    }

    /// The number of an object of the ground truth.
    pub fn object(&mut self, name: &str, source: ObjectSource) -> usize {
        if let Some(index) = self.spec.objects.iter().position(|o| o.name == name) {
            return index;
        }
        self.spec.objects.push(Object { name: name.to_owned(), source });
        self.spec.objects.len() - 1
    }

    /// The number of a wanted field of an event.
    pub fn event_field(&mut self, event: usize, field: EventField) -> usize {
        let fields = &mut self.spec.events[event].fields;
        fields.iter().position(|f| f.path == field.path).unwrap_or_else(|| {
            fields.push(field);
            fields.len() - 1
        })
    }

    /// The event of a machine that enters or leaves a state.
    pub fn state_event(&mut self, source: EventSource, name: String) -> usize {
        let events = &mut self.spec.events;
        events.iter().position(|e| e.source == source).unwrap_or_else(|| {
            events.push(Event { name, source, fields: Vec::new(), when: None });
            events.len() - 1
        })
    }
}
