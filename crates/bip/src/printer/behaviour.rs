//! Atoms as text.

use super::{Printer, expr::expr, names, params};
use crate::ast::{AtomPort, AtomPriority, AtomType, Data, ExternPort, Invariant, Name, Port, Resume, Transition};

impl Printer {
    pub(super) fn atom_type(&mut self, atom: &AtomType) {
        self.listed(&format!("atom type {}(", atom.name.text), &params(&atom.params), ")");
        self.inside(|p| {
            atom.data.iter().for_each(|d| p.data(d));
            for clock in &atom.clocks {
                p.line(&format!("clock {} unit {}", clock.name.text, clock.unit.word()));
            }
            atom.ports.iter().for_each(|port| p.atom_port(port));
            atom.externals.iter().for_each(|port| p.extern_port(port));
            if !atom.places.is_empty() {
                p.listed("place ", &names(&atom.places), "");
            }
            p.blank();
            p.listed("initial to ", &names(&atom.initial.places), "");
            p.inside(|p| {
                if !atom.initial.body.is_empty() {
                    p.block("do", &atom.initial.body);
                }
                p.resume(atom.initial.resume.as_ref());
            });
            for transition in &atom.transitions {
                p.blank();
                p.transition(transition);
            }
            if !atom.invariants.is_empty() || !atom.priorities.is_empty() {
                p.blank();
            }
            atom.invariants.iter().for_each(|i| p.invariant(i));
            atom.priorities.iter().for_each(|r| p.atom_priority(r));
        });
        self.line("end");
    }

    pub(super) fn data(&mut self, data: &Data) {
        self.notes(&data.notes);
        let export = if data.is_exported { "export " } else { "" };
        let value = data.value.as_ref().map_or(String::new(), |v| format!(" = {}", expr(v)));
        self.line(&format!("{export}data {} {}{value}", data.ty.text(), data.name.text));
    }

    fn atom_port(&mut self, port: &AtomPort) {
        self.notes(&port.notes);
        let Some(first) = port.ports.first() else { return };
        let export = if port.is_exported { "export " } else { "" };
        let merged = port.merged.as_ref().map_or(String::new(), |m| format!(" as {}", m.text));
        let ports: Vec<String> = port.ports.iter().map(|p| format!("{}({})", p.name.text, args(p))).collect();
        self.listed(&format!("{export}port {} ", first.ty.text()), &ports, &merged);
    }

    fn extern_port(&mut self, external: &ExternPort) {
        self.notes(&external.notes);
        let (port, policy) = (&external.port, external.policy.word());
        let backend = external.backend.as_ref().map_or(String::new(), |b| format!(" as {}", super::text_literal(b)));
        self.line(&format!("extern port {} {}({}){backend} {policy}", port.ty.text(), port.name.text, args(port)));
    }

    fn transition(&mut self, transition: &Transition) {
        self.notes(&transition.notes);
        match &transition.port {
            Some(port) => self.line(&format!("on {}", port.text)),
            None => self.line("internal"),
        }
        self.inside(|p| {
            let (from, to) = (names(&transition.from).join(", "), names(&transition.to).join(", "));
            p.line(&format!("from {from} to {to}"));
            if let Some(guard) = &transition.guard {
                p.line(&format!("provided ({})", expr(guard)));
            }
            if let Some(urgency) = transition.urgency {
                p.line(urgency.word());
            }
            if !transition.body.is_empty() {
                p.block("do", &transition.body);
            }
            p.resume(transition.resume.as_ref());
        });
    }

    fn resume(&mut self, resume: Option<&Resume>) {
        match resume.map(|r| &r.guard) {
            Some(Some(guard)) => self.line(&format!("resume ({})", expr(guard))),
            Some(None) => self.line("resume"),
            None => {}
        }
    }

    fn invariant(&mut self, invariant: &Invariant) {
        self.notes(&invariant.notes);
        let places = names(&invariant.places).join(", ");
        let at = if places.is_empty() { String::new() } else { format!(" at {places}") };
        self.line(&format!("invariant {}{at} provided ({})", invariant.name.text, expr(&invariant.guard)));
    }

    fn atom_priority(&mut self, rule: &AtomPriority) {
        self.notes(&rule.notes);
        let side = |name: &Option<Name>| name.as_ref().map_or("*", |n| n.text.as_str()).to_owned();
        let guard = rule.guard.as_ref().map_or(String::new(), |g| format!(" provided ({})", expr(g)));
        self.line(&format!("priority {} {} < {}{guard}", rule.name.text, side(&rule.low), side(&rule.high)));
    }
}

pub(super) fn args(port: &Port) -> String {
    names(&port.args).join(", ")
}
