//! Types of connectors: which sets of ports interact, and what they do then.

use super::names::{Access, Names};
use super::{Check, Checker};
use crate::ast::{self, PortExpr, PortExprKind};
use crate::code::{Base, Context, Expr, Memory};
use crate::template::{Action, Connector, Frame, Var};
use crate::value::Value;
use lapwing_diag::{Code, Diagnostic};
use std::collections::{BTreeMap, BTreeSet};

/// How many sets of ports a connector may define: a trigger with thirteen others that may join.
const MAX_SETS: usize = 1 << 13;

impl Checker<'_> {
    pub(super) fn connector_type(&mut self, index: usize) {
        let Some(tree) = self.connectors.trees.get(index).copied() else { return };
        let before = self.diagnostics.len();
        if let Ok(connector) = self.connector(tree)
            && self.diagnostics.len() == before
        {
            self.connectors.set(index, connector);
        }
    }

    fn connector(&mut self, tree: &ast::ConnectorType) -> Check<Connector> {
        self.unique("ports", tree.ports.iter().map(|(_, name)| name));
        self.unique("variables", tree.data.iter().map(|d| &d.name));
        let mut frame = Frame::default();
        let own = self.own_data(tree, &mut frame)?;
        let export = match &tree.export {
            Some(port) => {
                let (ty, port) = self.port(port, &frame)?;
                Some((port.name, ty, port.vars))
            }
            None => None,
        };
        let mut ports = Vec::new();
        let mut seen: Vec<Vec<Var>> = Vec::new();
        for (ty, name) in &tree.ports {
            let index = self.port_type(ty)?;
            let params = self.library.port_types.get(index as usize).map(|t| t.params.clone()).unwrap_or_default();
            let add = |p: &crate::template::Shown| {
                let slot = frame.add(&format!("{}.{}", name.text, p.name), p.ty);
                Var { name: p.name.clone(), ty: p.ty, slot }
            };
            seen.push(params.iter().map(add).collect());
            ports.push((name.text.clone(), index));
        }
        let sets = self.sets(tree)?;
        let span = tree.name.span;
        let mut connector = Connector {
            span,
            ports,
            frame,
            own,
            seen,
            export,
            sets: sets.into_iter().map(|set| (set, None)).collect(),
            actions: Vec::new(),
        };
        for interaction in &tree.interactions {
            // Each has been reported; the others are looked at all the same.
            let _ = self.interaction(&mut connector, interaction);
        }
        Ok(connector)
    }

    fn own_data(&mut self, tree: &ast::ConnectorType, frame: &mut Frame) -> Check<Vec<(Var, Value)>> {
        let mut own = Vec::new();
        for data in &tree.data {
            let ty = self.data_type(&data.ty)?;
            let value = match &data.value {
                Some(value) => self.first_value(value, ty)?,
                None => ty.zero(),
            };
            let slot = frame.add(&data.name.text, ty);
            own.push((Var { name: data.name.text.clone(), ty, slot }, value));
        }
        Ok(own)
    }

    fn first_value(&mut self, value: &ast::Expr, ty: crate::value::Type) -> Check<Value> {
        let code: Expr = self.expr_as(&Names::default(), value, ty)?;
        let mut memory = Memory::default();
        let mut cx = Context { memory: &mut memory, host: &mut super::constant::Nobody, atom: None, now: 0 };
        match code.eval(Base::default(), &mut cx) {
            Ok(value) => Ok(value),
            Err(trap) => self.fail(Code::BipConst, value.span, format!("this is not constant: {}", trap.what)),
        }
    }

    /// All sets of ports that `define` allows, the smaller ones first where one begins like another.
    fn sets(&mut self, tree: &ast::ConnectorType) -> Check<Vec<Box<[u32]>>> {
        let mut used = BTreeMap::new();
        self.port_names(tree, &tree.define, &mut used)?;
        if let Some((_, name)) = tree.ports.iter().find(|(_, name)| !used.contains_key(name.text.as_str())) {
            let message = format!("the port `{}` takes part in nothing", name.text);
            return self.fail(Code::BipInteraction, name.span, message);
        }
        match group(tree, &tree.define) {
            Some(sets) => Ok(sets.into_iter().map(|set| set.into_iter().collect()).collect()),
            None => {
                let message =
                    format!("the connector type `{}` defines more than {MAX_SETS} interactions", tree.name.text);
                let diagnostic = Diagnostic::new(Code::TooLarge, tree.name.span, message);
                Err(self
                    .report(diagnostic.help("let fewer ports join a trigger: divide them among several connectors")))
            }
        }
    }

    /// Whether every name in `define` is a port, and none is there twice.
    fn port_names<'t>(
        &mut self,
        tree: &'t ast::ConnectorType,
        parts: &'t [PortExpr],
        used: &mut BTreeMap<&'t str, lapwing_diag::Span>,
    ) -> Check<()> {
        for part in parts {
            match &part.kind {
                PortExprKind::Group(inner) => self.port_names(tree, inner, used)?,
                PortExprKind::Port(name) => {
                    if !tree.ports.iter().any(|(_, port)| port.text == name.text) {
                        let known = tree.ports.iter().map(|(_, port)| port.text.as_str());
                        return self.unknown("port", &name.text, name.span, known);
                    }
                    if let Some(first) = used.insert(&name.text, name.span) {
                        let message = format!("the port `{}` is there twice", name.text);
                        let diagnostic = Diagnostic::new(Code::BipInteraction, name.span, message);
                        return Err(self.report(diagnostic.also(first, "the first time")));
                    }
                }
            }
        }
        Ok(())
    }

    fn interaction(&mut self, connector: &mut Connector, tree: &ast::Interaction) -> Check<()> {
        let mut set = BTreeSet::new();
        for name in &tree.ports {
            let Some(port) = connector.ports.iter().position(|(port, _)| *port == name.text) else {
                let known: Vec<&str> = connector.ports.iter().map(|(port, _)| port.as_str()).collect();
                return self.unknown("port", &name.text, name.span, known);
            };
            set.insert(port as u32);
        }
        let set: Box<[u32]> = set.into_iter().collect();
        let span = tree.ports.iter().map(|p| p.span).reduce(|a, b| a.to(b)).unwrap_or(tree.span);
        let Some(place) = connector.sets.iter().position(|(known, _)| *known == set) else {
            let names: Vec<&str> = tree.ports.iter().map(|p| p.text.as_str()).collect();
            let message = format!("`define` does not let just {} interact", names.join(", "));
            return self.fail(Code::BipInteraction, span, message);
        };
        if connector.sets.get(place).is_some_and(|(_, action)| action.is_some()) {
            return self.fail(Code::BipInteraction, span, "what these ports do together has been said before");
        }
        let guard = tree.guard.as_ref().map(|g| self.bool(&self.seen(connector, &set, Phase::Guard), g)).transpose();
        let up = self.body(&self.seen(connector, &set, Phase::Up), &tree.up);
        let down = self.body(&self.seen(connector, &set, Phase::Down), &tree.down);
        connector.actions.push(Action { guard: guard?, up: up?, down: down? });
        if let Some((_, action)) = connector.sets.get_mut(place) {
            *action = Some(connector.actions.len() as u32 - 1);
        }
        Ok(())
    }

    /// What a part of an interaction can name: the connector's own variables, and those of the ports that take part.
    fn seen(&self, connector: &Connector, set: &[u32], phase: Phase) -> Names {
        let mut names = Names::default();
        let own = if phase == Phase::Guard { Access::Here } else { Access::Write };
        for (var, _) in &connector.own {
            names.var(&var.name, var.ty, var.slot, own);
        }
        for port in set {
            let Some((name, ty)) = connector.ports.get(*port as usize) else { continue };
            let params = self.library.port_types.get(*ty as usize).map_or(&[][..], |t| t.params.as_slice());
            let vars = connector.seen.get(*port as usize).map_or(&[][..], Vec::as_slice);
            for (var, param) in vars.iter().zip(params) {
                let access = match phase {
                    Phase::Down if param.is_const => Access::Const,
                    Phase::Down => Access::Write,
                    _ => Access::Here,
                };
                names.var(format!("{name}.{}", var.name), var.ty, var.slot, access);
            }
        }
        names
    }
}

/// The parts of an interaction.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    Guard,
    Up,
    Down,
}

type Sets = BTreeSet<Vec<u32>>;

/// The sets of ports that several parts allow: some of them with a trigger among them, or all. `None` where there are too many.
fn group(tree: &ast::ConnectorType, parts: &[PortExpr]) -> Option<Sets> {
    let has_trigger = parts.iter().any(|p| p.is_trigger);
    // Each with whether a trigger is in it.
    let mut sets: BTreeSet<(Vec<u32>, bool)> = BTreeSet::from([(Vec::new(), !has_trigger)]);
    for part in parts {
        let own = match &part.kind {
            PortExprKind::Group(inner) => group(tree, inner)?,
            PortExprKind::Port(name) => {
                let place = tree.ports.iter().position(|(_, port)| port.text == name.text)?;
                Sets::from([vec![place as u32]])
            }
        };
        let mut next = if has_trigger { sets.clone() } else { BTreeSet::new() };
        for (set, triggered) in &sets {
            for addition in &own {
                let mut union = [set.as_slice(), addition].concat();
                union.sort_unstable();
                next.insert((union, *triggered || part.is_trigger));
                if next.len() > 2 * MAX_SETS {
                    return None;
                }
            }
        }
        sets = next;
    }
    let sets: Sets =
        sets.into_iter().filter(|(set, triggered)| *triggered && !set.is_empty()).map(|(s, _)| s).collect();
    (sets.len() <= MAX_SETS).then_some(sets)
}
