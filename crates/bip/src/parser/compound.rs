//! Types of compounds.

use super::{Parse, Parser};
use crate::ast::{Component, CompoundType, Connector, Export, Priority, Side};

/// The words that begin a member of a compound.
const STARTS: &[&str] = &["component", "connector", "priority", "export", "end"];

impl Parser<'_> {
    pub(super) fn compound_type(&mut self) -> Parse<CompoundType> {
        self.require("compound")?;
        self.require("type")?;
        let name = self.name("the name of the type")?;
        let mut compound = CompoundType { name, params: self.params()?, ..CompoundType::default() };
        while !self.is("end") && !self.at_end() && !self.begins_type() {
            let before = self.at;
            if self.compound_member(&mut compound).is_err() {
                if self.at == before {
                    self.advance();
                }
                self.skip_to(STARTS);
            }
        }
        let name = compound.name.clone();
        self.close_type(&name)?;
        Ok(compound)
    }

    fn compound_member(&mut self, compound: &mut CompoundType) -> Parse<()> {
        self.annotations()?;
        match self.peek(0) {
            "component" => compound.components.extend(self.components()?),
            "connector" => compound.connectors.extend(self.connectors()?),
            "priority" => compound.priorities.push(self.priority()?),
            "export" => compound.exports.push(self.export()?),
            _ => return self.missing("`component`, `connector`, `priority`, `export` or `end`"),
        }
        Ok(())
    }

    fn components(&mut self) -> Parse<Vec<Component>> {
        self.require("component")?;
        let ty = self.path("a type")?;
        self.separated(|p| {
            let name = p.name("the name of the component")?;
            let args = p.bracketed(Self::expr)?;
            Ok(Component { notes: Vec::new(), ty: ty.clone(), name, args })
        })
    }

    fn connectors(&mut self) -> Parse<Vec<Connector>> {
        self.require("connector")?;
        let ty = self.path("a type of connectors")?;
        self.separated(|p| {
            let name = p.name("the name of the connector")?;
            let ports = p.bracketed(|p| p.path("a port"))?;
            Ok(Connector { notes: Vec::new(), ty: ty.clone(), name, ports })
        })
    }

    fn priority(&mut self) -> Parse<Priority> {
        let start = self.require("priority")?;
        let name = self.name("the name of the priority")?;
        let left = self.side()?;
        let is_less = self.less()?;
        let right = self.side()?;
        let (low, high) = if is_less { (left, right) } else { (right, left) };
        let guard = self.optional_guard()?;
        Ok(Priority { notes: Vec::new(), name, low, high, guard, span: start.to(self.last_span()) })
    }

    fn side(&mut self) -> Parse<Side> {
        let start = self.span();
        if self.take("*") {
            self.require(":")?;
            self.require("*")?;
            return Ok(Side::Any(start.to(self.last_span())));
        }
        let connector = self.name("a connector")?;
        self.require(":")?;
        if self.take("*") {
            return Ok(Side::Connector(connector));
        }
        Ok(Side::Interaction(connector, self.paths("a port")?))
    }

    fn export(&mut self) -> Parse<Export> {
        self.require("export")?;
        let is_data = self.take("data");
        if !is_data {
            self.require("port")?;
        }
        let what = self.export_paths(is_data)?;
        self.require("as")?;
        let name = self.name("the name by which it is seen")?;
        Ok(Export { notes: Vec::new(), is_data, what, name })
    }

    /// What is exported. The type of a port may stand before it, as in atoms.
    fn export_paths(&mut self, is_data: bool) -> Parse<Vec<crate::ast::Path>> {
        let first = self.path("what is exported")?;
        if !is_data && self.kind() == crate::lexer::TokenKind::Name && !self.is("as") {
            return self.paths("a port");
        }
        let mut what = vec![first];
        while self.take(",") {
            what.push(self.path("what is exported")?);
        }
        Ok(what)
    }
}
