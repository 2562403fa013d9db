//! Reactions and guards, and the messages that they publish.

use super::{Parse, Parser, Reported};
use crate::ast::{Action, Guard, Ident, Literal, Reaction, Topic, TypePath};
use crate::token::{Role, TokenKind};
use crate::words;

/// The words that begin an action.
const ACTIONS: &[&str] = &["publish", "call", "request", "run", "reset", "stop"];

impl Parser<'_> {
    /// What follows the word `on`: `violation of p at most every 1 s { … }`
    pub(super) fn reaction(&mut self) -> Parse<Reaction> {
        self.word("violation")?;
        if !self.eat_word("of") {
            let diagnostic = self.expectation("`of` and the name of a property");
            return self.complain(diagnostic.help("write `on violation of NAME { … }`"));
        }
        let property = self.ident("the name of a property")?;
        let at_most_every = self.at_most_every()?;
        if self.cursor.kind() != TokenKind::OpenCurly {
            return self.expected("`{` and what to do");
        }
        self.cursor.mark_block();
        let Some(inside) = self.cursor.enter() else { return self.unclosed_block() };
        let mut actions = Vec::new();
        while !self.cursor.at_close(&inside) {
            self.cursor.begin_inside();
            match self.action() {
                Ok(action) => actions.push(action),
                Err(_) => self.skip_to_action(&inside),
            }
        }
        self.cursor.leave(inside);
        Ok(Reaction { property, at_most_every, actions })
    }

    fn at_most_every(&mut self) -> Parse<Option<crate::ast::Dur>> {
        if !self.eat_word("at") {
            return Ok(None);
        }
        self.word("most")?;
        self.word("every")?;
        self.duration().map(Some)
    }

    /// After a fault: goes to the next line that begins an action.
    fn skip_to_action(&mut self, inside: &super::cursor::Inside) {
        self.cursor.leave_inner(inside);
        let begins = |p: &Self| p.cursor.begins_line() && p.cursor.word().is_some_and(|word| ACTIONS.contains(&word));
        while !self.cursor.at_close(inside) && !begins(self) {
            self.cursor.skip_token();
        }
    }

    fn action(&mut self) -> Parse<Action> {
        let word = self.cursor.word().unwrap_or("");
        if !ACTIONS.contains(&word) {
            let help = format!("what can be done is {}", words::listed(ACTIONS.iter().copied()));
            return self.unknown_choice("something to do", ACTIONS, &help);
        }
        let span = self.cursor.bump(Role::Keyword);
        match word {
            "publish" => self.topic_message("a topic, as in `/cmd_vel`").map(|(t, ty, m)| Action::Publish(t, ty, m)),
            "call" => self.topic_message("a service, as in `/safety/stop`").map(|(t, ty, m)| Action::Call(t, ty, m)),
            "request" => self.component_member("an activity, as in `SafetyPilot.Stop`").map(Action::Request),
            "run" => self.ident("the name of a handler").map(Action::Run),
            "reset" => Ok(Action::Reset(span)),
            _ => Ok(Action::Stop(span)),
        }
    }

    /// `/topic pkg/Type { … }`
    fn topic_message(&mut self, what: &str) -> Parse<(Topic, TypePath, Literal)> {
        let topic = self.topic(what)?;
        let (ty, message) = self.typed_message()?;
        Ok((topic, ty, message))
    }

    /// `pkg/Type { … }`
    fn typed_message(&mut self) -> Parse<(TypePath, Literal)> {
        let whole = "a whole message is written out, not a field of one";
        let ty = self.whole_type(whole, |_| "name the field inside the curly brackets: `{ field: … }`".to_owned())?;
        if self.cursor.kind() != TokenKind::OpenCurly {
            return self.expected("the message in curly brackets; `{}` is one with all fields zero");
        }
        let message = self.nested(Self::literal)?;
        // What has been said of the type would be said again of the fields.
        if ty.path.is_empty() { Ok((ty, message)) } else { Err(Reported(())) }
    }

    /// A message written out, or a value in it.
    fn literal(&mut self) -> Parse<Literal> {
        let start = self.cursor.position();
        match self.cursor.kind() {
            TokenKind::OpenCurly => {
                let fields = self.bracketed(TokenKind::OpenCurly, "a comma or `}`", Self::fields)?;
                Ok(Literal::Record(fields.unwrap_or_default(), self.cursor.span_since(start)))
            }
            TokenKind::OpenSquare => {
                let values = self.bracketed(TokenKind::OpenSquare, "a comma or `]`", Self::entries)?;
                Ok(Literal::List(values.unwrap_or_default(), self.cursor.span_since(start)))
            }
            _ => Ok(Literal::Value(self.sum()?)),
        }
    }

    fn fields(&mut self) -> Parse<Vec<(Ident, Literal)>> {
        self.list(|p| {
            let name = p.ident("the name of a field")?;
            p.token(TokenKind::Colon, "`:` after the field's name")?;
            Ok((name, p.nested(Self::literal)?))
        })
    }

    fn entries(&mut self) -> Parse<Vec<Literal>> {
        self.list(|p| p.nested(Self::literal))
    }

    /// Any number of entries up to the closing bracket, with commas between; one more comma may end them.
    fn list<T>(&mut self, mut entry: impl FnMut(&mut Self) -> Parse<T>) -> Parse<Vec<T>> {
        let mut all = Vec::new();
        while !self.cursor.kind().closes() {
            all.push(entry(self)?);
            if !self.eat(TokenKind::Comma) {
                break;
            }
        }
        Ok(all)
    }

    /// What follows the word `guard`: `/a from /b by NAME else drop fail closed`
    pub(super) fn guard(&mut self) -> Parse<Guard> {
        let to = self.topic("the topic that is guarded")?;
        self.word("from")?;
        let from = self.topic("the topic on which the messages come in")?;
        self.word("by")?;
        let property = self.ident("the name of a property")?;
        self.word("else")?;
        let instead = self.instead()?;
        Ok(Guard { to, from, property, instead, fail_open: self.fail_mode()? })
    }

    /// `drop`, or `publish pkg/Type { … }`
    fn instead(&mut self) -> Parse<Option<(TypePath, Literal)>> {
        if self.eat_word("drop") {
            return Ok(None);
        }
        if self.eat_word("publish") {
            return self.typed_message().map(Some);
        }
        self.expected("`drop`, or `publish` and a message")
    }

    /// `fail open`, `fail closed`
    fn fail_mode(&mut self) -> Parse<bool> {
        if !self.eat_word("fail") {
            return Ok(false);
        }
        if self.eat_word("closed") {
            return Ok(false);
        }
        self.word("open").map(|()| true)
    }
}
