//! Priorities of compounds: which interactions they speak of, when they hold, and circles among them.

use super::names::{Access, Names};
use super::{Check, Checker};
use crate::ast::{self, Name};
use crate::template::{Compound, Connection, Priority, PriorityGuard, Side, Var};
use lapwing_diag::{Code, Diagnostic, Severity, Span};

impl Checker<'_> {
    pub(super) fn priority(
        &mut self,
        tree: &ast::CompoundType,
        names: &Names,
        compound: &Compound,
        rule: &ast::Priority,
    ) -> Check<Priority> {
        let (low, high) = (self.side(tree, compound, &rule.low)?, self.side(tree, compound, &rule.high)?);
        let same = match (&low, &high) {
            (Side::Any, Side::Any) => true,
            (Side::Connector(a), Side::Connector(b)) => a == b,
            (Side::Interaction(a, one), Side::Interaction(b, other)) => a == b && one == other,
            _ => false,
        };
        if same {
            return self.above_itself(&rule.name, rule.span);
        }
        let guard = match &rule.guard {
            Some(guard) => Some(self.priority_guard(names, compound, guard)?),
            None => None,
        };
        Ok(Priority { low, high, guard })
    }

    fn priority_guard(&mut self, names: &Names, compound: &Compound, guard: &ast::Expr) -> Check<PriorityGuard> {
        let (mut names, mut frame) = (names.clone(), compound.frame.clone());
        let mut seen = Vec::new();
        for (index, component) in compound.components.iter().enumerate() {
            for (name, ty) in self.data_of(compound, index) {
                let slot = frame.add(&name, ty);
                names.var(format!("{}.{name}", component.name), ty, slot, Access::Here);
                seen.push((Var { name: name.clone(), ty, slot }, index as u32, name));
            }
        }
        Ok(PriorityGuard { condition: self.bool(&names, guard)?, seen })
    }

    fn side(&mut self, tree: &ast::CompoundType, compound: &Compound, side: &ast::Side) -> Check<Side> {
        match side {
            ast::Side::Any(_) => Ok(Side::Any),
            ast::Side::Connector(name) => self.top(compound, name).map(|(index, _)| Side::Connector(index)),
            ast::Side::Interaction(name, paths) => {
                let (index, connection) = self.top(compound, name)?;
                let mut ports = Vec::new();
                for path in paths {
                    let (_, source) = self.source(tree, compound, path)?;
                    let Some(port) = connection.ports.iter().position(|(s, _)| *s == source) else {
                        let known: Vec<&str> = connection.ports.iter().map(|(_, text)| text.as_str()).collect();
                        let what = format!("port of the connector `{}`", name.text);
                        return self.unknown(&what, &path.text(), path.span(), known);
                    };
                    ports.push(port as u32);
                }
                ports.sort_unstable();
                ports.dedup();
                let sets = self.connectors.get(connection.ty).map_or(&[][..], |c| c.sets.as_slice());
                if !sets.iter().any(|(set, _)| **set == *ports) {
                    let message = format!("the connector `{}` does not let just these ports interact", name.text);
                    return self.fail(Code::BipInteraction, name.span, message);
                }
                Ok(Side::Interaction(index, ports.into()))
            }
        }
    }

    /// A connector of which a priority may speak: one that is not a part of another.
    fn top(&mut self, compound: &Compound, name: &Name) -> Check<(u32, Connection)> {
        let Some(index) = compound.connectors.iter().position(|c| c.name == name.text) else {
            let names: Vec<&str> = compound.connectors.iter().map(|c| c.name.as_str()).collect();
            return self.unknown("connector", &name.text, name.span, names);
        };
        let Some(connection) = compound.connectors.get(index).cloned() else { return Err(super::Reported(())) };
        if self.connectors.get(connection.ty).is_some_and(|c| c.export.is_some()) {
            let message =
                format!("the connector `{}` is only a part of others: it has no priority of its own", name.text);
            let diagnostic = Diagnostic::new(Code::BipInteraction, name.span, message);
            return Err(
                self.report(diagnostic.help("priorities order what happens: name the connectors that it is a part of"))
            );
        }
        Ok((index as u32, connection))
    }

    /// Says where connectors go before one another in a circle. Only a state in which they all could interact is an error.
    pub(super) fn cycles(&mut self, tree: &ast::CompoundType, compound: &Compound) {
        let edges: Vec<(u32, u32, Span)> = compound
            .priorities
            .iter()
            .zip(&tree.priorities)
            .filter(|(rule, _)| rule.guard.is_none())
            .filter_map(|(rule, tree)| match (&rule.low, &rule.high) {
                (Side::Connector(low), Side::Connector(high)) => Some((*low, *high, tree.span)),
                _ => None,
            })
            .collect();
        let reaches = |from: u32, to: u32| {
            let (mut seen, mut left) = (vec![from], vec![from]);
            while let Some(at) = left.pop() {
                for (_, next, _) in edges.iter().filter(|(low, ..)| *low == at) {
                    if *next == to {
                        return true;
                    }
                    if !seen.contains(next) {
                        seen.push(*next);
                        left.push(*next);
                    }
                }
            }
            false
        };
        let Some((low, high, span)) = edges.iter().find(|(low, high, _)| reaches(*high, *low)).copied() else { return };
        let name = |index: u32| compound.connectors.get(index as usize).map_or("?", |c| c.name.as_str());
        let message =
            format!("the priorities of `{}` put `{}` above `{}` and below it", tree.name.text, name(high), name(low));
        let mut diagnostic = Diagnostic::new(Code::BipPriorityCycle, span, message);
        diagnostic.severity = Severity::Warning;
        self.report(diagnostic.help("a run stops with an error in a state in which both are possible"));
    }
}
