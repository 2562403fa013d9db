//! The halves of a service as events. Nobody else hears a call of a service, but a node of ROS 2 whose service introspection is on publishes an event
//! for each step of it on `SERVICE/_service_event` (REP 2012): `request /dock` is the one by which the server has received a request, `reply /dock`
//! the one by which it has sent the answer. Each is there once for a call, also where the client tells of its side as well.

use lapwing_diag::Span;
use lapwing_stream::Type;
use lapwing_syntax::ast;

use crate::checked::{Compare, Connective, Dim, EventField, EventSource, Expr, Kind, Path, Step};
use crate::context::{Cx, Env};

/// A half of a service.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ServiceHalf {
    /// What is asked.
    Request,
    /// What is answered.
    Reply,
}

impl ServiceHalf {
    /// `service_msgs/ServiceEventInfo.event_type`, as the server sets it.
    fn step(self) -> f64 {
        match self {
            ServiceHalf::Request => 1.0,
            ServiceHalf::Reply => 2.0,
        }
    }

    /// Where the half itself is, an array of at most one: it is empty where the node tells of calls, but not of what is in them.
    fn place(self) -> &'static str {
        match self {
            ServiceHalf::Request => "request",
            ServiceHalf::Reply => "response",
        }
    }

    /// The way to it.
    pub fn path(self) -> Path {
        vec![Step::Field(self.place().to_owned()), Step::Index(0)]
    }

    /// Its type, in a message of that type.
    pub fn ty(self, whole: &Type) -> Type {
        let Type::Message(schema) = whole else { return Type::Any };
        match schema.field(self.place()).map(|field| &field.ty) {
            Some(Type::Array(half)) => (**half).clone(),
            _ => Type::Any,
        }
    }
}

impl Cx<'_> {
    /// The messages by which a half is told, where a trace has them or a live graph may come to have them.
    pub fn service_events(&mut self, service: &ast::Topic) -> Option<EventSource> {
        let topic = ast::Topic { name: format!("{}/_service_event", service.absolute()), span: service.span };
        let trace = self.trace.filter(|trace| !trace.is_program())?;
        let topic = match trace.topic(&topic.name) {
            Some(_) => self.open(&Env::default(), &topic, None).topic,
            None if !trace.live => return None,
            None => {
                let service = service.absolute();
                self.found.blame(format!(
                    "nobody tells of calls of {service}: its node does where service introspection is on"
                ));
                self.topic(&topic.name, topic.span)
            }
        };
        Some(EventSource::Message { topic })
    }

    /// The condition under which a message of [`Cx::service_events`] is this half, and what else is asked of it.
    pub fn is_half(&mut self, event: usize, half: ServiceHalf, when: Option<Expr>, span: Span) -> Option<Expr> {
        let EventSource::Message { topic } = self.spec.events.get(event)?.source else { return when };
        let path: Path = ["info", "event_type"].map(|name| Step::Field(name.to_owned())).to_vec();
        let ty = Type::Num { float: false };
        let wanted = Some(self.field(topic, &path));
        let field = self.event_field(event, EventField { path, wanted, ty: ty.clone() });
        let of = |kind, ty: &Type| Box::new(Expr { kind, ty: ty.clone(), dim: Dim::UNKNOWN, span });
        let (left, right) = (of(Kind::EventField { event, field }, &ty), of(Kind::Num(half.step()), &ty));
        let is_half = of(Kind::Compare { op: Compare::Eq, margin: None, left, right }, &Type::Bool);
        Some(match when {
            None => *is_half,
            Some(when) => *of(Kind::Connective(Connective::And, is_half, Box::new(when)), &Type::Bool),
        })
    }
}
