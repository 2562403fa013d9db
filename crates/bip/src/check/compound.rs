//! Types of compounds: what components there are, what connects them, and what is seen from outside.

use super::names::{Access, Names};
use super::scope::Item;
use super::{Check, Checker};
use crate::ast::{self, Name, Path};
use crate::template::{Component, Compound, Connection, Frame, Kind, Source};
use crate::value::Type;
use lapwing_diag::{Code, Diagnostic, Severity, Span};
use std::collections::BTreeMap;

impl Checker<'_> {
    /// Checks a compound, and those that it is made of before it.
    pub(super) fn compound_type(&mut self, index: usize) {
        let Some(tree) = self.compounds.trees.get(index).copied() else { return };
        if self.compounds.get(index as u32).is_some() || self.done.contains(&index) {
            return;
        }
        if self.open.contains(&index) || self.open.len() > MAX_DEPTH {
            let message = format!("the compound `{}` holds itself, or is nested too deeply", tree.name.text);
            self.report(Diagnostic::new(Code::BipRecursive, tree.name.span, message));
            return;
        }
        self.open.push(index);
        for component in &tree.components {
            if let Some(Item::Compound(inner)) = self.scope.item(&component.ty) {
                let inner = *inner as usize;
                self.compound_type(inner);
            }
        }
        self.open.pop();
        self.done.insert(index);
        let before = self.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        if let Ok(compound) = self.compound(tree)
            && self.diagnostics.iter().filter(|d| d.severity == Severity::Error).count() == before
        {
            self.compounds.set(index, compound);
        }
    }

    fn compound(&mut self, tree: &ast::CompoundType) -> Check<Compound> {
        let components = tree.components.iter().map(|c| &c.name);
        self.unique("components or connectors", components.chain(tree.connectors.iter().map(|c| &c.name)));
        self.unique("exported ports", tree.exports.iter().filter(|e| !e.is_data).map(|e| &e.name));
        self.unique("exported variables", tree.exports.iter().filter(|e| e.is_data).map(|e| &e.name));
        let mut names = Names::default();
        let mut compound = Compound {
            name: tree.name.text.clone(),
            span: tree.name.span,
            frame: Frame::default(),
            components: Vec::new(),
            connectors: Vec::new(),
            priorities: Vec::new(),
            exports: Vec::new(),
            exported_data: Vec::new(),
        };
        for param in &tree.params {
            let (Ok(ty), Some(name)) = (self.data_type(&param.ty), &param.name) else { continue };
            let slot = compound.frame.add(&name.text, ty);
            names.var(&name.text, ty, slot, Access::Const);
        }
        for component in &tree.components {
            let component = self.component(&names, component)?;
            compound.components.push(component);
        }
        for connector in &tree.connectors {
            // Connectors are numbered as they are written, so a fault of one makes the others of no use.
            let connection = self.connection(tree, &compound, connector)?;
            compound.connectors.push(connection);
        }
        for export in &tree.exports {
            self.export(tree, &mut compound, export)?;
        }
        self.connected(tree, &compound);
        for priority in &tree.priorities {
            let priority = self.priority(tree, &names, &compound, priority)?;
            compound.priorities.push(priority);
        }
        self.cycles(tree, &compound);
        Ok(compound)
    }

    fn component(&mut self, names: &Names, component: &ast::Component) -> Check<Component> {
        let (kind, params, declared) = match self.scope.item(&component.ty) {
            Some(Item::Atom(index)) => {
                let atom = self.atoms.get(*index).ok_or(super::Reported(()))?;
                (Kind::Atom(*index), atom.params.iter().map(|p| p.ty).collect::<Vec<_>>(), atom.span)
            }
            Some(Item::Compound(index)) => {
                let compound = self.compounds.get(*index).ok_or(super::Reported(()))?;
                (Kind::Compound(*index), compound.frame.vars.iter().map(|p| p.ty).collect(), compound.span)
            }
            _ => {
                let found = self.what(&component.ty);
                let is_component = |i: &Item| matches!(i, Item::Atom(_) | Item::Compound(_));
                return self.not_a("type of components", &component.ty, found, is_component);
            }
        };
        let whose = format!("`{}`", component.ty.text());
        self.counts(&whose, params.len(), component.args.len(), component.name.span, declared)?;
        let mut args = Vec::new();
        for (arg, ty) in component.args.iter().zip(params) {
            args.push(self.expr_as(names, arg, ty)?);
        }
        Ok(Component { name: component.name.text.clone(), kind, args, span: component.name.span })
    }

    fn connection(
        &mut self,
        tree: &ast::CompoundType,
        compound: &Compound,
        tree_of: &ast::Connector,
    ) -> Check<Connection> {
        let Some(Item::Connector(ty)) = self.scope.item(&tree_of.ty) else {
            let found = self.what(&tree_of.ty);
            return self.not_a("type of connectors", &tree_of.ty, found, |i| matches!(i, Item::Connector(_)));
        };
        let ty = *ty;
        let (wanted, declared) = match self.connectors.get(ty) {
            Some(connector) => (connector.ports.clone(), connector.span),
            None => return Err(super::Reported(())),
        };
        let whose = format!("the connector type `{}`", tree_of.ty.text());
        self.counts(&whose, wanted.len(), tree_of.ports.len(), tree_of.name.span, declared)?;
        let mut ports = Vec::new();
        let mut taken: BTreeMap<&str, Span> = BTreeMap::new();
        for (path, (_, port_type)) in tree_of.ports.iter().zip(&wanted) {
            let (found, source) = self.source(tree, compound, path)?;
            if found != *port_type {
                let name = |t: u32| self.library.port_types.get(t as usize).map_or("?", |t| t.name.as_str()).to_owned();
                let message = format!(
                    "`{}` is a port of type {}, and {} is expected",
                    path.text(),
                    name(found),
                    name(*port_type)
                );
                return self.fail(Code::BipType, path.span(), message);
            }
            if let (Some(first), Source::Component(..)) = (path.parts.first(), &source)
                && let Some(other) = taken.insert(&first.text, path.span())
            {
                let message = format!("the component `{}` is connected with itself", first.text);
                let diagnostic = Diagnostic::new(Code::BipComponentTwice, path.span(), message);
                let help = "a component takes part in an interaction through one port";
                return Err(self.report(diagnostic.also(other, "the first time").help(help)));
            }
            ports.push((source, self.label(path, compound)));
        }
        Ok(Connection { name: tree_of.name.text.clone(), ty, span: tree_of.name.span, ports })
    }

    /// A port of a connector as the log shows it: a connector that is named alone stands for the port that it exports.
    fn label(&self, path: &Path, compound: &Compound) -> String {
        let text = path.text();
        let connection = compound.connectors.iter().find(|c| c.name == text);
        let export = connection.and_then(|c| self.connectors.get(c.ty)?.export.as_ref());
        export.map_or(text.clone(), |(port, ..)| format!("{text}.{port}"))
    }

    /// What a path such as `A.p` names, and the type of the port there.
    pub(super) fn source(
        &mut self,
        tree: &ast::CompoundType,
        compound: &Compound,
        path: &Path,
    ) -> Check<(u32, Source)> {
        let Some(first) = path.parts.first() else { return Err(super::Reported(())) };
        if let Some(index) = compound.components.iter().position(|c| c.name == first.text) {
            let Some(port) = path.parts.get(1).filter(|_| path.parts.len() == 2) else {
                let message = "a port of a component is expected here, as in `A.p`";
                return self.fail(Code::BipUnknownName, path.span(), message);
            };
            return self.component_port(compound, index, port);
        }
        if let Some(index) = tree.connectors.iter().position(|c| c.name.text == first.text) {
            return self.connector_port(compound, index, path);
        }
        let components = compound.components.iter().map(|c| c.name.as_str());
        let names: Vec<&str> = components.chain(tree.connectors.iter().map(|c| c.name.text.as_str())).collect();
        self.unknown("component or connector", &first.text, first.span, names)
    }

    fn component_port(&mut self, compound: &Compound, index: usize, port: &Name) -> Check<(u32, Source)> {
        let Some(component) = compound.components.get(index) else { return Err(super::Reported(())) };
        let exports: Vec<(&str, u32)> = match component.kind {
            Kind::Atom(atom) => self
                .atoms
                .get(atom)
                .into_iter()
                .flat_map(|a| &a.exports)
                .map(|e| (e.name.as_str(), e.port_type))
                .collect(),
            Kind::Compound(inner) => {
                self.compounds.get(inner).into_iter().flat_map(|c| &c.exports).map(|e| (e.0.as_str(), e.1)).collect()
            }
        };
        if let Some((name, ty)) = exports.iter().find(|(name, _)| *name == port.text) {
            return Ok((*ty, Source::Component(index as u32, (*name).to_owned())));
        }
        let hidden = match component.kind {
            Kind::Atom(atom) => self.atoms.get(atom).is_some_and(|a| a.ports.iter().any(|p| p.name == port.text)),
            Kind::Compound(_) => false,
        };
        if hidden {
            let message = format!("the port `{}` of `{}` is not exported", port.text, component.name);
            let diagnostic = Diagnostic::new(Code::BipUnknownName, port.span, message);
            return Err(self.report(diagnostic.help("declare it as `export port …`")));
        }
        let names: Vec<String> = exports.iter().map(|(name, _)| (*name).to_owned()).collect();
        let what = format!("exported port of `{}`", component.name);
        self.unknown(&what, &port.text, port.span, names.iter().map(String::as_str))
    }

    /// `c.p`, the exported port of a connector that is declared before; just `c` names it too.
    fn connector_port(&mut self, compound: &Compound, index: usize, path: &Path) -> Check<(u32, Source)> {
        let Some(connection) = compound.connectors.get(index) else {
            let message =
                format!("the connector `{}` is connected with itself, or is declared only later", path.text());
            return self.fail(Code::BipRecursive, path.span(), message);
        };
        let export = self.connectors.get(connection.ty).and_then(|c| c.export.clone());
        let Some((name, ty, _)) = export else {
            let message = format!("the connector `{}` exports no port", connection.name);
            return self.fail(Code::BipUnknownName, path.span(), message);
        };
        match path.parts.get(1) {
            Some(port) if port.text != name || path.parts.len() > 2 => {
                let what = format!("exported port of `{}`", connection.name);
                self.unknown(&what, &port.text, port.span, [name.as_str()])
            }
            _ => Ok((ty, Source::Connector(index as u32))),
        }
    }

    fn export(&mut self, tree: &ast::CompoundType, compound: &mut Compound, export: &ast::Export) -> Check<()> {
        if export.is_data {
            let Some(path) = export.what.first() else { return Ok(()) };
            let (ty, component, name) = self.exported_data(compound, path)?;
            compound.exported_data.push((export.name.text.clone(), ty, component, name));
            return Ok(());
        }
        let mut sources = Vec::new();
        let mut port_type = None;
        for path in &export.what {
            let (ty, source) = self.source(tree, compound, path)?;
            if port_type.is_some_and(|known| known != ty) {
                let message = "ports that are seen as one are of one type";
                return self.fail(Code::BipType, path.span(), message);
            }
            port_type = Some(ty);
            sources.push(source);
        }
        compound.exports.extend(port_type.map(|ty| (export.name.text.clone(), ty, sources)));
        Ok(())
    }

    /// The variable of a component that a path such as `A.x` names.
    fn exported_data(&mut self, compound: &Compound, path: &Path) -> Check<(Type, u32, String)> {
        let [component, name] = path.parts.as_slice() else {
            return self.fail(
                Code::BipUnknownName,
                path.span(),
                "a variable of a component is expected here, as in `A.x`",
            );
        };
        let Some(index) = compound.components.iter().position(|c| c.name == component.text) else {
            let names: Vec<&str> = compound.components.iter().map(|c| c.name.as_str()).collect();
            return self.unknown("component", &component.text, component.span, names);
        };
        let all = self.data_of(compound, index);
        match all.iter().find(|(n, _)| *n == name.text) {
            Some((_, ty)) => Ok((*ty, index as u32, name.text.clone())),
            None => {
                let what = format!("exported variable of `{}`", component.text);
                self.unknown(&what, &name.text, name.span, all.iter().map(|(n, _)| n.as_str()))
            }
        }
    }

    /// The variables that a component exports.
    pub(super) fn data_of(&self, compound: &Compound, index: usize) -> Vec<(String, Type)> {
        match compound.components.get(index).map(|c| c.kind) {
            Some(Kind::Atom(atom)) => {
                let vars = self.atoms.get(atom).into_iter().flat_map(|a| &a.exported_data);
                vars.map(|v| (v.name.clone(), v.ty)).collect()
            }
            Some(Kind::Compound(inner)) => {
                let vars = self.compounds.get(inner).into_iter().flat_map(|c| &c.exported_data);
                vars.map(|(name, ty, ..)| (name.clone(), *ty)).collect()
            }
            None => Vec::new(),
        }
    }

    /// Says which exporting connectors nobody uses: they never interact.
    fn connected(&mut self, tree: &ast::CompoundType, compound: &Compound) {
        let ports = compound.connectors.iter().flat_map(|c| c.ports.iter().map(|(source, _)| source));
        let exported = compound.exports.iter().flat_map(|(_, _, sources)| sources);
        let used: Vec<u32> = ports
            .chain(exported)
            .filter_map(|s| if let Source::Connector(index) = s { Some(*index) } else { None })
            .collect();
        for (index, connection) in compound.connectors.iter().enumerate() {
            let exports = self.connectors.get(connection.ty).is_some_and(|c| c.export.is_some());
            if exports && !used.contains(&(index as u32)) {
                let message =
                    format!("the connector `{}` exports a port, and nothing is connected to it", connection.name);
                let diagnostic = Diagnostic::new(Code::BipNotConnected, connection.span, message);
                let help =
                    format!("it takes part in nothing: connect its port, or export it from `{}`", tree.name.text);
                self.report(diagnostic.help(help));
            }
        }
    }
}

/// How deep compounds may lie in one another.
const MAX_DEPTH: usize = 60;
