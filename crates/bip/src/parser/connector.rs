//! Types of connectors.

use super::{Parse, Parser};
use crate::ast::{ConnectorType, Interaction, Port, PortExpr, PortExprKind};
use crate::lexer::TokenKind;

impl Parser<'_> {
    pub(super) fn connector_type(&mut self) -> Parse<ConnectorType> {
        self.require("connector")?;
        self.require("type")?;
        let name = self.name("the name of the type")?;
        let ports = self.bracketed(|p| Ok((p.path("a type of ports")?, p.name("the name of a port")?)))?;
        let mut data = Vec::new();
        // Remarks for compilers may stand in front of each part.
        self.annotations()?;
        while self.is("data") {
            data.extend(self.data(false)?);
            self.annotations()?;
        }
        let export = if self.take("export") { Some(self.connector_export()?) } else { None };
        self.require("define")?;
        let define = self.port_exprs()?;
        let resume = self.connector_resume()?;
        let mut connector = ConnectorType { name, ports, data, export, define, resume, interactions: Vec::new() };
        self.annotations()?;
        while self.is("on") {
            let interaction = self.interaction()?;
            connector.interactions.push(interaction);
            self.annotations()?;
        }
        let name = connector.name.clone();
        if !self.is("end") && !self.at_end() && !self.begins_type() {
            return self.missing("`on` or `end`");
        }
        self.close_type(&name)?;
        Ok(connector)
    }

    fn connector_export(&mut self) -> Parse<Port> {
        self.require("port")?;
        let ty = self.path("a type of ports")?;
        let name = self.name("the name of the port")?;
        let args = self.bracketed(|p| p.name("a variable of the connector"))?;
        Ok(Port { ty, name, args })
    }

    fn connector_resume(&mut self) -> Parse<Option<crate::ast::Name>> {
        if !self.take("resume") {
            return Ok(None);
        }
        if !self.is_any(&["sync", "async"]) {
            return self.missing("`sync` or `async`");
        }
        self.name("`sync` or `async`").map(Some)
    }

    /// One or more parts of `define`.
    fn port_exprs(&mut self) -> Parse<Vec<PortExpr>> {
        let mut parts = vec![self.nested(Self::port_expr)?];
        while self.is("(") || self.kind() == TokenKind::Name && !self.is_any(&["on", "end", "resume"]) {
            parts.push(self.nested(Self::port_expr)?);
        }
        Ok(parts)
    }

    fn port_expr(&mut self) -> Parse<PortExpr> {
        let open = self.span();
        let kind = if self.take("(") {
            let parts = self.port_exprs()?;
            self.close(open)?;
            PortExprKind::Group(parts)
        } else {
            PortExprKind::Port(self.name("a port")?)
        };
        Ok(PortExpr { kind, is_trigger: self.take("'") })
    }

    fn interaction(&mut self) -> Parse<Interaction> {
        let start = self.require("on")?;
        let mut ports = vec![self.name("a port")?];
        while self.kind() == TokenKind::Name && !self.is_any(&["provided", "when", "up", "down", "on", "end"]) {
            ports.push(self.name("a port")?);
        }
        let guard = self.optional_guard()?;
        let up = if self.take("up") { self.block()? } else { Vec::new() };
        let down = if self.take("down") { self.block()? } else { Vec::new() };
        Ok(Interaction { notes: Vec::new(), ports, guard, up, down, span: start.to(self.last_span()) })
    }
}
