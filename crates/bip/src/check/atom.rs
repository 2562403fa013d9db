//! Types of atoms.

use super::names::{Access, Names};
use super::stmt::store;
use super::{Check, Checker};
use crate::ast::{self, Name};
use crate::template::{Atom, AtomPriority, Exported, Frame, Invariant, Port, Transition, Var};
use lapwing_diag::{Code, Diagnostic, Span};

impl Checker<'_> {
    pub(super) fn atom_type(&mut self, index: usize) {
        let Some(tree) = self.atoms.trees.get(index).copied() else { return };
        let before = self.diagnostics.len();
        self.atom_names(tree);
        let mut atom = Atom {
            span: tree.name.span,
            params: Vec::new(),
            frame: Frame::default(),
            clocks: tree.clocks.iter().map(|c| c.name.text.clone()).collect(),
            init: Vec::new(),
            ports: Vec::new(),
            exports: Vec::new(),
            exported_data: Vec::new(),
            places: tree.places.iter().map(|p| p.text.clone()).collect(),
            initial: Box::default(),
            begin: Vec::new(),
            begin_resume: None,
            transitions: Vec::new(),
            invariants: Vec::new(),
            priorities: Vec::new(),
        };
        let names = self.atom_frame(tree, &mut atom);
        self.atom_ports(tree, &mut atom);
        self.behaviour(tree, &names, &mut atom);
        if self.diagnostics.len() == before {
            self.atoms.set(index, atom);
        }
    }

    fn atom_names(&mut self, tree: &ast::AtomType) {
        let data = tree.data.iter().map(|d| &d.name);
        let clocks = tree.clocks.iter().map(|c| &c.name);
        self.unique("variables", tree.params.iter().filter_map(|p| p.name.as_ref()).chain(data).chain(clocks));
        self.unique("places", &tree.places);
        let inner = tree.ports.iter().flat_map(|p| p.ports.iter().map(|q| &q.name));
        self.unique("ports", inner.chain(tree.externals.iter().map(|e| &e.port.name)));
        let outer = tree.ports.iter().filter(|p| p.is_exported);
        self.unique("exported ports", outer.filter_map(|p| p.merged.as_ref().or(p.ports.first().map(|q| &q.name))));
        if tree.places.is_empty() {
            let message = format!("the atom `{}` has no place to be in", tree.name.text);
            let help = "add `place NAME` before `initial to NAME`";
            self.report(Diagnostic::new(Code::BipUnknownName, tree.name.span, message).help(help));
        }
    }

    /// Parameters, variables and clocks: what the atom's code can name.
    fn atom_frame(&mut self, tree: &ast::AtomType, atom: &mut Atom) -> Names {
        let mut names = Names::default();
        for param in &tree.params {
            let (Ok(ty), Some(name)) = (self.data_type(&param.ty), &param.name) else { continue };
            let slot = atom.frame.add(&name.text, ty);
            names.var(&name.text, ty, slot, Access::Const);
            atom.params.push(Var { name: name.text.clone(), ty, slot });
        }
        for (slot, clock) in tree.clocks.iter().enumerate() {
            names.clock(&clock.name.text, slot as u32, clock.unit.nanoseconds());
        }
        for data in &tree.data {
            let Ok(ty) = self.data_type(&data.ty) else { continue };
            // A first value may name what is declared before.
            if let Some(value) = &data.value
                && let Ok(value) = self.expr_as(&names, value, ty)
            {
                // Slots are counted in the order of the declarations, so this is the one that is added next.
                let slot = if ty.is_plain() { atom.frame.cells } else { atom.frame.objects };
                atom.init.push(store(ty, slot, value));
            }
            let slot = atom.frame.add(&data.name.text, ty);
            names.var(&data.name.text, ty, slot, Access::Write);
            if data.is_exported {
                atom.exported_data.push(Var { name: data.name.text.clone(), ty, slot });
            }
        }
        names
    }

    fn atom_ports(&mut self, tree: &ast::AtomType, atom: &mut Atom) {
        for group in &tree.ports {
            let first = atom.ports.len() as u32;
            let mut port_type = None;
            for port in &group.ports {
                let Ok((ty, mut found)) = self.port(port, &atom.frame) else { continue };
                found.is_exported = group.is_exported;
                port_type = Some(ty);
                atom.ports.push(found);
            }
            let Some(port_type) = port_type.filter(|_| group.is_exported) else { continue };
            let Some(name) = group.merged.as_ref().or(group.ports.first().map(|p| &p.name)) else { continue };
            let ports = (first..atom.ports.len() as u32).collect();
            atom.exports.push(Exported { name: name.text.clone(), port_type, ports });
        }
        for external in &tree.externals {
            let Ok((_, mut found)) = self.port(&external.port, &atom.frame) else { continue };
            found.external = Some(external.policy);
            atom.ports.push(found);
        }
    }

    /// A port with the variables that it shows, one for each parameter of its type.
    pub(super) fn port(&mut self, port: &ast::Port, frame: &Frame) -> Check<(u32, Port)> {
        let index = self.port_type(&port.ty)?;
        let shown = self.library.port_types.get(index as usize).map(|t| t.params.clone()).unwrap_or_default();
        let whose = format!("the port type `{}`", port.ty.text());
        self.counts(&whose, shown.len(), port.args.len(), port.name.span, port.ty.span())?;
        let mut vars = Vec::new();
        for (arg, param) in port.args.iter().zip(&shown) {
            let Some(var) = frame.vars.iter().find(|v| v.name == arg.text) else {
                let known: Vec<&str> = frame.vars.iter().map(|v| v.name.as_str()).collect();
                return self.unknown("variable", &arg.text, arg.span, known);
            };
            if var.ty != param.ty {
                let (is, wanted) = (self.shown(var.ty), self.shown(param.ty));
                let message = format!("`{}` is of type {is}, and the port shows a {wanted}", arg.text);
                return self.fail(Code::BipType, arg.span, message);
            }
            vars.push(Var { name: param.name.clone(), ty: var.ty, slot: var.slot });
        }
        Ok((index, Port { name: port.name.text.clone(), vars, is_exported: false, external: None }))
    }

    fn behaviour(&mut self, tree: &ast::AtomType, names: &Names, atom: &mut Atom) {
        if let Ok(initial) = self.places(tree, &tree.initial.places) {
            atom.initial = initial;
        }
        if let Ok(body) = self.body(names, &tree.initial.body) {
            atom.begin = body;
        }
        atom.begin_resume = self.resume(names, tree.initial.resume.as_ref()).unwrap_or(None);
        for transition in &tree.transitions {
            if let Ok(transition) = self.transition(tree, names, atom, transition) {
                atom.transitions.push(transition);
            }
        }
        self.unique("invariants", tree.invariants.iter().map(|i| &i.name));
        for invariant in &tree.invariants {
            let (places, guard) = (self.places(tree, &invariant.places), self.guard(names, &invariant.guard));
            if let (Ok(places), Ok(guard)) = (places, guard) {
                atom.invariants.push(Invariant { name: invariant.name.text.clone(), places, guard });
            }
        }
        for priority in &tree.priorities {
            if let Ok(priority) = self.atom_priority(names, atom, priority) {
                atom.priorities.push(priority);
            }
        }
    }

    fn places(&mut self, tree: &ast::AtomType, names: &[Name]) -> Check<Box<[u32]>> {
        let mut places = Vec::new();
        for name in names {
            match tree.places.iter().position(|p| p.text == name.text) {
                Some(place) => places.push(place as u32),
                None => {
                    let known: Vec<&str> = tree.places.iter().map(|p| p.text.as_str()).collect();
                    return self.unknown("place", &name.text, name.span, known);
                }
            }
        }
        places.sort_unstable();
        places.dedup();
        Ok(places.into())
    }

    fn resume(&mut self, names: &Names, resume: Option<&ast::Resume>) -> Check<Option<crate::code::Guard>> {
        let always = crate::code::Guard::Data(crate::code::Bool::Const(true));
        match resume {
            None => Ok(None),
            Some(ast::Resume { guard: None, .. }) => Ok(Some(always)),
            Some(ast::Resume { guard: Some(guard), .. }) => self.guard(names, guard).map(Some),
        }
    }

    fn transition(
        &mut self,
        tree: &ast::AtomType,
        names: &Names,
        atom: &Atom,
        transition: &ast::Transition,
    ) -> Check<Transition> {
        let port = match &transition.port {
            Some(name) => Some(self.own_port(atom, name)?),
            None => None,
        };
        let (from, to) = (self.places(tree, &transition.from), self.places(tree, &transition.to));
        let guard = transition.guard.as_ref().map(|g| self.guard(names, g)).transpose();
        let body = self.body(names, &transition.body);
        let resume = self.resume(names, transition.resume.as_ref());
        let internal_clause = port.is_none() && (transition.urgency.is_some() || transition.resume.is_some());
        if internal_clause {
            let message = "an internal transition is taken at once: it has neither an urgency nor `resume`";
            return self.fail(Code::BipClauseOrder, transition.span, message);
        }
        Ok(Transition {
            port,
            from: from?,
            to: to?,
            guard: guard?,
            urgency: transition.urgency.unwrap_or_default(),
            body: body?,
            resume: resume?,
        })
    }

    fn own_port(&mut self, atom: &Atom, name: &Name) -> Check<u32> {
        match atom.ports.iter().position(|p| p.name == name.text) {
            Some(port) => Ok(port as u32),
            None => {
                let known: Vec<&str> = atom.ports.iter().map(|p| p.name.as_str()).collect();
                self.unknown("port", &name.text, name.span, known)
            }
        }
    }

    fn atom_priority(&mut self, names: &Names, atom: &Atom, rule: &ast::AtomPriority) -> Check<AtomPriority> {
        let low = rule.low.as_ref().map(|n| self.own_port(atom, n)).transpose()?;
        let high = rule.high.as_ref().map(|n| self.own_port(atom, n)).transpose()?;
        if low == high {
            return self.above_itself(&rule.name, rule.span);
        }
        let guard = rule.guard.as_ref().map(|g| self.bool(names, g)).transpose()?;
        Ok(AtomPriority { low, high, guard })
    }

    /// Of a priority whose two sides are the same.
    pub(super) fn above_itself<T>(&mut self, name: &Name, span: Span) -> Check<T> {
        let message = format!("the priority `{}` puts something above itself", name.text);
        self.fail(Code::BipPriorityCycle, span, message)
    }
}
