//! Defaults of parameters, and the texts that explain them.

use super::{Parser, Read};
use crate::ast::{Init, InitValue, Step};

impl Parser<'_> {
    /// `value`, `: "text"` or `value : "text"`.
    pub(super) fn init(&mut self) -> Read<Init> {
        let start = self.peek().span;
        self.nested(start, |parser| {
            let target = parser.target()?;
            let is_value = target.is_none() || parser.eat("=");
            let value = match () {
                () if !is_value || parser.is(":") => InitValue::None,
                () if parser.is("{") => InitValue::List(parser.inits()?),
                // `.member = , …` gives it no value.
                () if parser.is(",") || parser.is("}") => InitValue::None,
                () => InitValue::Value(parser.expr()?),
            };
            let doc = if parser.eat(":") { Some(parser.strings()?.0) } else { None };
            Ok(Init { target, value, doc, span: parser.until_here(start) })
        })
    }

    fn inits(&mut self) -> Read<Vec<Init>> {
        self.want("{", "before the values")?;
        let mut all = Vec::new();
        while !self.is("}") {
            all.push(self.init()?);
            if !self.eat(",") {
                break;
            }
        }
        self.want("}", "after the values")?;
        Ok(all)
    }

    /// `.member` or `[2]`.
    fn target(&mut self) -> Read<Option<Step>> {
        if self.eat(".") {
            return Ok(Some(Step::Member(self.name("a member")?)));
        }
        if self.eat("[") {
            let element = self.expr()?;
            self.want("]", "after the number of the element")?;
            return Ok(Some(Step::Element(element)));
        }
        Ok(None)
    }
}
