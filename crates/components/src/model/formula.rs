//! From formulas to what an atom can do: conditions over events, `running` and the past, judged at every position, and clocks.

use lapwing_bip::ast::{BinaryOp, Expr as Code, Stmt, UnaryOp};
use lapwing_check::checked::{self, Bound, Compare, Connective, Event, EventSource, Expr, InputSource, Kind, Scope};
use lapwing_diag::Span;
use lapwing_genom::Model;
use lapwing_genom::model::ServiceKind;
use lapwing_stream::Duration;

use super::past::Past;
use super::ring::Ring;

/// What an atom cannot watch for, and where that is said.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Beyond {
    pub span: Span,
    pub what: String,
}

/// What a property comes to.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Shape {
    /// It holds at every position.
    Always(Code),
    /// Whenever the first holds, the second does within a time: how long, whether the end is in, and whether the moment itself counts.
    Responds { asked: Code, answer: Code, within: Duration, closed: bool, at_once: bool },
    /// Whenever something is asked, something else comes within a bound, or does not: each request by itself.
    Each(Ring),
    /// The last message of a topic is never older.
    Fresh { topic: String, within: Duration, closed: bool },
}

/// What a formula reads, and what an atom has to keep for it.
#[derive(Default)]
pub(super) struct Reader<'s> {
    pub spec: Option<&'s checked::Spec>,
    /// The topics of which a message is an event, with the names of the variables that say so.
    pub events: Vec<(String, String)>,
    /// The topics `running`, with the names of the variables that count.
    pub running: Vec<(String, String)>,
    /// What is to be known of the position before: variables and conditions.
    pub before: Vec<(String, Code)>,
    /// What is to be known of the past, those first that others are made of.
    pub pasts: Vec<Past>,
    /// The components.
    pub model: Option<&'s Model>,
}

impl Reader<'_> {
    /// What a property comes to.
    pub fn shape(&mut self, formula: &Expr) -> Result<Shape, Beyond> {
        let body: &Expr = match &formula.kind {
            Kind::Always(Bound::ALL, body) => body,
            _ => formula,
        };
        if let Some(fresh) = self.fresh(body)? {
            return Ok(fresh);
        }
        let (asked, rest): (Option<&Expr>, &Expr) = match &body.kind {
            Kind::Scope(Scope::Whenever, asked, rest) => (Some(asked), rest),
            Kind::Connective(Connective::Implies, asked, rest) => (Some(asked), rest),
            _ => (None, body),
        };
        match &rest.kind {
            Kind::Eventually(bound, answer) => self.responds(asked, *bound, answer, rest),
            Kind::Always(bound, body) if *bound != Bound::ALL => {
                let asked = self.asked(asked)?;
                let fails = not(self.condition(body)?);
                let ring = Ring::new(asked, fails, *bound, true);
                ring.map(Shape::Each).ok_or_else(|| beyond(rest, "an `always` whose bound has a beginning and no end"))
            }
            _ => {
                let condition = self.condition(rest)?;
                Ok(Shape::Always(match asked {
                    Some(asked) => Code::binary(BinaryOp::Or, not(self.condition(asked)?), condition),
                    None => condition,
                }))
            }
        }
    }

    /// What asks for something: every position, where nothing is said.
    fn asked(&mut self, asked: Option<&Expr>) -> Result<Code, Beyond> {
        asked.map_or(Ok(Code::bool(true)), |asked| self.condition(asked))
    }

    /// `whenever asked, eventually within … answer`
    fn responds(&mut self, asked: Option<&Expr>, bound: Bound, answer: &Expr, e: &Expr) -> Result<Shape, Beyond> {
        let asked = self.asked(asked)?;
        let answer = self.condition(answer)?;
        let Some(hi) = bound.hi else { return Err(beyond(e, "an `eventually` without an end")) };
        if bound.lo == Duration::ZERO {
            let at_once = bound.lo_closed;
            return Ok(Shape::Responds { asked, answer, within: hi, closed: bound.hi_closed, at_once });
        }
        let ring = Ring::new(asked, answer, bound, false);
        ring.map(Shape::Each).ok_or_else(|| beyond(e, "an `eventually` without an end"))
    }

    /// `age(/topic) <= d`
    fn fresh(&mut self, e: &Expr) -> Result<Option<Shape>, Beyond> {
        let Kind::Compare { op, margin: None, left, right } = &e.kind else { return Ok(None) };
        let (Kind::Age(topic), Kind::Num(seconds)) = (&left.kind, &right.kind) else { return Ok(None) };
        let closed = match op {
            Compare::Le => true,
            Compare::Lt => false,
            _ => return Err(beyond(e, "an age that is compared otherwise than by `<=` or `<`")),
        };
        let topic = self.spec.and_then(|s| s.topics.get(*topic)).map(|t| t.name.clone()).unwrap_or_default();
        let within = Duration::from_nanos((seconds * 1e9).round() as i64);
        Ok(Some(Shape::Fresh { topic, within, closed }))
    }

    /// A condition on a position, on events and on what runs.
    fn condition(&mut self, e: &Expr) -> Result<Code, Beyond> {
        Ok(match &e.kind {
            Kind::Bool(value) => Code::bool(*value),
            Kind::Truth(inner) => self.condition(inner)?,
            Kind::Not(inner) => not(self.condition(inner)?),
            Kind::Connective(connective, left, right) => {
                let (left, right) = (self.condition(left)?, self.condition(right)?);
                match connective {
                    Connective::And => and(left, right),
                    Connective::Or => Code::binary(BinaryOp::Or, left, right),
                    Connective::Implies => Code::binary(BinaryOp::Or, not(left), right),
                    Connective::Iff => Code::binary(BinaryOp::Equal, left, right),
                }
            }
            Kind::Becomes(inner) => {
                let now = self.condition(inner)?;
                let before = self.kept(now.clone());
                and(now, not(before))
            }
            Kind::Previously(inner) => {
                let now = self.condition(inner)?;
                self.kept(now)
            }
            Kind::Event(event) => self.event(*event, e)?,
            Kind::Fresh(topic) => {
                let name = self.spec.and_then(|s| s.topics.get(*topic)).map(|t| t.name.clone()).unwrap_or_default();
                Code::path(self.flag(&name))
            }
            Kind::Input(input) => self.running(*input, e)?,
            Kind::Once(bound, inner) => {
                let witness = self.condition(inner)?;
                self.past(None, witness, *bound, e)?
            }
            Kind::Historically(bound, inner) => {
                let witness = not(self.condition(inner)?);
                not(self.past(None, witness, *bound, e)?)
            }
            Kind::Since(bound, left, right) => {
                let (chain, witness) = (self.condition(left)?, self.condition(right)?);
                self.past(Some(chain), witness, *bound, e)?
            }
            // It has held since a position that is so long ago.
            Kind::Held(duration, inner) => {
                let holds = self.condition(inner)?;
                let bound = Bound { lo: *duration, ..Bound::ALL };
                self.past(Some(holds.clone()), holds, bound, e)?
            }
            Kind::Compare { left, right, .. } if [left, right].iter().any(|side| matches!(side.kind, Kind::Age(_))) => {
                return Err(beyond(
                    e,
                    "ages inside other conditions: `once within d` of what is written says the same",
                ));
            }
            Kind::Compare { .. } | Kind::EventField { .. } => return Err(values(e)),
            _ if e.has_future() => {
                return Err(beyond(
                    e,
                    "operators over the future but a bounded `eventually` or `always` under a `whenever`",
                ));
            }
            _ => return Err(beyond(e, "expressions of this kind")),
        })
    }

    /// The condition that something has been so, and that something else has held since: it has been so within a bound before this position.
    fn past(&mut self, chain: Option<Code>, witness: Code, bound: Bound, e: &Expr) -> Result<Code, Beyond> {
        let past = Past::new(self.pasts.len() + 1, chain, witness, bound).ok_or_else(|| {
            beyond(e, "clocks for so narrow a bound so long ago: each position in between would need one; let it begin earlier or end later")
        })?;
        let value = past.value();
        self.pasts.push(past);
        Ok(value)
    }

    /// The variable that has the value that a condition had at the position before.
    fn kept(&mut self, now: Code) -> Code {
        let name = format!("before_{}", self.before.len() + 1);
        self.before.push((name.clone(), now));
        Code::path(name)
    }

    fn event(&mut self, number: usize, e: &Expr) -> Result<Code, Beyond> {
        let spec = self.spec;
        let found = spec.and_then(|s| s.events.get(number));
        let Some(Event { source: EventSource::Message { topic }, when: None, .. }) = found else {
            return Err(beyond(e, "an event that is no message of a component, or has a condition of its own"));
        };
        let name = spec.and_then(|s| s.topics.get(*topic)).map(|t| t.name.clone()).unwrap_or_default();
        if name.ends_with("/report") && !self.is_of_function(&name) {
            return Err(beyond(e, "reports of activities: the control task makes several at once; `end` is of one"));
        }
        Ok(Code::path(self.flag(&name)))
    }

    /// Whether a topic `/C/S/report` is of a function or an attribute.
    fn is_of_function(&self, topic: &str) -> bool {
        let mut parts = topic.split('/').skip(1);
        let (component, service) = (parts.next(), parts.next());
        let component = self.model.and_then(|m| m.components.iter().find(|c| Some(c.name.as_str()) == component));
        let service = component.and_then(|c| c.services.iter().find(|s| Some(s.name.as_str()) == service));
        service.is_some_and(|s| s.kind != ServiceKind::Activity)
    }

    /// The variable that says whether there is a message of a topic at this position.
    fn flag(&mut self, topic: &str) -> String {
        if let Some((_, name)) = self.events.iter().find(|(t, _)| t == topic) {
            return name.clone();
        }
        let name = format!("on{}", topic.replace('/', "_"));
        self.events.push((topic.to_owned(), name.clone()));
        name
    }

    fn running(&mut self, input: usize, e: &Expr) -> Result<Code, Beyond> {
        let found = self.spec.and_then(|s| Some((s, s.inputs.get(input)?)));
        let topic = match found {
            Some((spec, input)) => match input.source {
                InputSource::Field { topic, .. } => spec.topics.get(topic).map(|t| t.name.clone()),
                _ => None,
            },
            None => None,
        };
        let Some(topic) = topic.filter(|t| t.ends_with("/running")) else {
            return Err(values(e));
        };
        let known = self.running.iter().find(|(t, _)| *t == topic).map(|(_, name)| name.clone());
        let name = known.unwrap_or_else(|| {
            let name = format!("count{}", topic.trim_end_matches("/running").replace('/', "_"));
            self.running.push((topic, name.clone()));
            name
        });
        Ok(Code::binary(BinaryOp::Greater, Code::path(name), Code::int(0)))
    }
}

fn values(e: &Expr) -> Beyond {
    beyond(e, "values: codels make them, and a model has events and what runs, but no codels")
}

fn beyond(e: &Expr, what: &str) -> Beyond {
    Beyond { span: e.span, what: what.to_owned() }
}

/// The contrary.
pub(super) fn not(code: Code) -> Code {
    Code::unary(UnaryOp::Not, code)
}

/// Both of them.
pub(super) fn and(left: Code, right: Code) -> Code {
    Code::binary(BinaryOp::And, left, right)
}

/// Whether a clock shows so many nanoseconds, or more.
pub(super) fn is_at(clock: &str, ns: i64) -> Code {
    Code::binary(BinaryOp::GreaterEqual, Code::path(clock), Code::int(ns))
}

/// `name = value;` for a truth value.
pub(super) fn set(name: &str, value: bool) -> Stmt {
    Stmt::assign(name, Code::bool(value))
}
