//! Services and their parameters.

use super::{Parser, Read};
use crate::ast::{AttributeParameter, Direction, Parameter, Service, ServiceKind};

impl Parser<'_> {
    /// A service, without its semicolon.
    pub(super) fn service(&mut self, kind: ServiceKind) -> Read<Service> {
        self.bump();
        let name = self.name(&format!("the name of the {}", kind.word()))?;
        let mut service = Service { kind, name, members: Vec::new(), parameters: Vec::new(), properties: Vec::new() };
        self.want("(", "before the parameters")?;
        if !self.eat(")") {
            match kind {
                ServiceKind::Attribute => service.members = self.list(Parser::attribute_parameter)?,
                _ => service.parameters = self.list(Parser::parameter)?,
            }
            self.want(")", "after the parameters")?;
        }
        service.properties = self.properties(kind.word())?;
        Ok(service)
    }

    fn attribute_parameter(&mut self) -> Read<AttributeParameter> {
        let direction = self.direction()?;
        let path = self.path()?;
        let init = if self.eat("=") { Some(self.init()?) } else { None };
        Ok(AttributeParameter { direction, path, init })
    }

    fn parameter(&mut self) -> Read<Parameter> {
        let direction = self.direction()?;
        let ty = self.ty()?;
        let declarator = self.declarator()?;
        let init = if self.eat("=") { Some(self.init()?) } else { None };
        Ok(Parameter { direction, ty, declarator, init })
    }

    /// `in`, `out` or `inout`.
    pub(super) fn direction(&mut self) -> Read<Direction> {
        let direction = match self.word() {
            "in" => Direction::In,
            "out" => Direction::Out,
            "inout" => Direction::InOut,
            _ => return Err(self.expected("`in`, `out` or `inout`")),
        };
        self.bump();
        Ok(direction)
    }
}
