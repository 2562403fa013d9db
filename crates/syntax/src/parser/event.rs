//! `event NAME = …`

use super::{Parse, Parser};
use crate::ast::{ActivityPhase, EventDecl, EventSource, Ident, PathPart, TypePath};
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic};

/// The words that say where an event comes from.
const SOURCES: &[&str] = &["call", "return", "set", "message", "request", "reply", "write", "start", "end", "report"];

impl Parser<'_> {
    /// What follows the word `event`.
    pub(super) fn event(&mut self) -> Parse<EventDecl> {
        self.clauses = &["when", "below"];
        let name = self.ident("the event's name")?;
        let source = if self.eat(TokenKind::Equals) { Some(self.event_source()?) } else { None };
        let mut event = EventDecl { name, source, when: None, below: None };
        loop {
            if event.when.is_none() && self.eat_word("when") {
                event.when = Some(*self.formula()?);
            } else if event.below.is_none() && self.eat_word("below") {
                event.below = Some(self.call_path()?);
            } else {
                return Ok(event);
            }
        }
    }

    fn event_source(&mut self) -> Parse<EventSource> {
        let word = self.cursor.word().unwrap_or("");
        if !SOURCES.contains(&word) {
            let help = format!("an event comes from {}", words::listed(SOURCES.iter().copied()));
            return self.unknown_choice("where the event comes from", SOURCES, &help);
        }
        self.cursor.bump(Role::Keyword);
        match word {
            "call" => self.call_path().map(EventSource::Call),
            "return" => self.call_path().map(EventSource::Return),
            "set" => self.dotted("a field, as in `SensorController.sonar`").map(EventSource::Set),
            "message" => self.message(),
            "request" => self.request(),
            "reply" => self.topic("a service, as in `/set_mode`").map(EventSource::Reply),
            "write" => self.component_member("a port, as in `LaserDriver.Laser`").map(EventSource::Write),
            "start" => self.activity(ActivityPhase::Start),
            "end" => self.activity(ActivityPhase::End),
            _ => self.activity(ActivityPhase::Report),
        }
    }

    /// `message /kick std_msgs/Bool`; the type may be left out.
    fn message(&mut self) -> Parse<EventSource> {
        let topic = self.topic("a topic, as in `/scan`")?;
        let clause = matches!(self.cursor.word(), Some("when" | "below"));
        let ty = if self.at_name() && !clause { Some(self.event_type()?) } else { None };
        Ok(EventSource::Message(topic, ty))
    }

    fn event_type(&mut self) -> Parse<TypePath> {
        let name = |path: &[PathPart]| {
            let parts = path.iter().map(|part| match part {
                PathPart::Field(name) => format!(".{}", name.name),
                PathPart::Index(index, _) => format!("[{index}]"),
            });
            parts.collect::<String>().trim_start_matches('.').to_owned()
        };
        self.whole_type("an event is a whole message, not a field of one", |path| {
            format!("a condition on its fields follows the type: `when {}`", name(path))
        })
    }

    /// `request /set_mode` is one half of a service, `request Component.Activity` asks a GenoM3 component for something.
    fn request(&mut self) -> Parse<EventSource> {
        if self.cursor.ahead(1) == TokenKind::Dot {
            return self.activity(ActivityPhase::Request);
        }
        self.topic("a service, as in `/set_mode`, or an activity, as in `Pilot.Stop`").map(EventSource::Request)
    }

    fn activity(&mut self, phase: ActivityPhase) -> Parse<EventSource> {
        let activity = self.component_member("an activity, as in `Pilot.Stop`")?;
        Ok(EventSource::Activity(phase, activity))
    }

    /// `Component.Member`
    pub(super) fn component_member(&mut self, what: &str) -> Parse<Vec<Ident>> {
        let start = self.cursor.position();
        let names = self.dotted(what)?;
        if names.len() < 2 {
            let span = self.cursor.span_since(start);
            return self.fail(Diagnostic::new(Code::Syntax, span, format!("expected {what}, found only one name")));
        }
        Ok(names)
    }
}
