//! Codels.

use super::{Parser, Read};
use crate::ast::{Codel, CodelParameter, Event, Path, Source, Step};

impl Parser<'_> {
    /// A codel after its keyword. One that begins with `<` has states and says what it yields.
    pub(super) fn codel(&mut self, is_async: bool) -> Read<Codel> {
        let mut triggers = Vec::new();
        if self.eat("<") {
            triggers = self.list(Parser::event)?;
            self.want(">", "after the events of the codel")?;
        }
        let function = self.name("the name of the codel's function")?;
        self.want("(", "before what the codel is given")?;
        let mut parameters = Vec::new();
        if !self.eat(")") {
            parameters = self.list(Parser::codel_parameter)?;
            self.want(")", "after what the codel is given")?;
        }
        let mut yields = Vec::new();
        if !triggers.is_empty() {
            if !self.eat_word("yield") && !self.eat_word("yields") {
                return Err(self.expected("`yield` and the events that the codel may return"));
            }
            yields = self.list(Parser::event)?;
        }
        let wcet = if self.eat_word("wcet") { Some(self.quantity()?) } else { None };
        Ok(Codel { function, triggers, parameters, yields, wcet, is_async })
    }

    fn event(&mut self) -> Read<Event> {
        let name = self.name("an event")?;
        if name.name == "pause" && self.eat("::") {
            return Ok(Event { pause: true, name: self.name("an event")? });
        }
        Ok(Event { pause: false, name })
    }

    fn codel_parameter(&mut self) -> Read<CodelParameter> {
        let second = self.peek_second();
        let is_said = ["in", "out", "inout"].iter().any(|word| second.is_word(word));
        let source = match self.word() {
            _ if !is_said => None,
            "ids" => Some(Source::Ids),
            // Older files say `service` for what is now `local`.
            "local" | "service" => Some(Source::Local),
            "port" => Some(Source::Port),
            "remote" => Some(Source::Remote),
            _ => None,
        };
        if source.is_some() {
            self.bump();
        }
        let direction = self.direction()?;
        Ok(CodelParameter { source, direction, path: self.path()? })
    }

    /// `a.b[2]::name` or `::name`.
    pub(super) fn path(&mut self) -> Read<Path> {
        let start = self.peek().span;
        if self.eat("::") {
            let renamed = Some(self.name("a name for the internal data")?);
            return Ok(Path { base: None, steps: Vec::new(), renamed, span: self.until_here(start) });
        }
        let base = Some(self.name("what the parameter is")?);
        let mut steps = Vec::new();
        loop {
            if self.eat(".") {
                steps.push(Step::Member(self.name("a member")?));
            } else if self.eat("[") {
                steps.push(Step::Element(self.expr()?));
                self.want("]", "after the number of the element")?;
            } else {
                break;
            }
        }
        let renamed = if self.eat("::") { Some(self.name("another name for it")?) } else { None };
        Ok(Path { base, steps, renamed, span: self.until_here(start) })
    }
}
