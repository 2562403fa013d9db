//! Connectors and compounds as text.

use super::expr::{expr, exprs};
use super::{Printer, behaviour::args, names, params, paths};
use crate::ast::{CompoundType, ConnectorType, Export, Interaction, Path, PortExpr, PortExprKind, Priority, Side};

impl Printer {
    pub(super) fn connector_type(&mut self, connector: &ConnectorType) {
        let ports: Vec<String> = connector.ports.iter().map(|(ty, n)| format!("{} {}", ty.text(), n.text)).collect();
        self.listed(&format!("connector type {}(", connector.name.text), &ports, ")");
        self.inside(|p| {
            connector.data.iter().for_each(|d| p.data(d));
            if let Some(port) = &connector.export {
                p.line(&format!("export port {} {}({})", port.ty.text(), port.name.text, args(port)));
            }
            let resume = connector.resume.as_ref().map_or(String::new(), |r| format!(" resume {}", r.text));
            p.line(&format!("define {}{resume}", port_exprs(&connector.define)));
            connector.interactions.iter().for_each(|i| p.interaction(i));
        });
        self.line("end");
    }

    fn interaction(&mut self, interaction: &Interaction) {
        self.notes(&interaction.notes);
        self.line(&format!("on {}", names(&interaction.ports).join(" ")));
        self.inside(|p| {
            if let Some(guard) = &interaction.guard {
                p.line(&format!("provided ({})", expr(guard)));
            }
            if !interaction.up.is_empty() {
                p.block("up", &interaction.up);
            }
            if !interaction.down.is_empty() {
                p.block("down", &interaction.down);
            }
        });
    }

    pub(super) fn compound_type(&mut self, compound: &CompoundType) {
        self.listed(&format!("compound type {}(", compound.name.text), &params(&compound.params), ")");
        self.inside(|p| {
            for component in &compound.components {
                p.notes(&component.notes);
                let head = format!("component {} {}(", component.ty.text(), component.name.text);
                p.listed(&head, &exprs(&component.args), ")");
            }
            for connector in &compound.connectors {
                p.notes(&connector.notes);
                let head = format!("connector {} {}(", connector.ty.text(), connector.name.text);
                p.listed(&head, &paths(&connector.ports), ")");
            }
            compound.priorities.iter().for_each(|r| p.priority(r));
            compound.exports.iter().for_each(|e| p.export(e));
        });
        self.line("end");
    }

    fn priority(&mut self, rule: &Priority) {
        self.notes(&rule.notes);
        let guard = rule.guard.as_ref().map_or(String::new(), |g| format!(" provided ({})", expr(g)));
        self.line(&format!("priority {} {} < {}{guard}", rule.name.text, side(&rule.low), side(&rule.high)));
    }

    fn export(&mut self, export: &Export) {
        self.notes(&export.notes);
        let kind = if export.is_data { "data" } else { "port" };
        let what: Vec<String> = export.what.iter().map(Path::text).collect();
        self.listed(&format!("export {kind} "), &what, &format!(" as {}", export.name.text));
    }
}

fn side(side: &Side) -> String {
    match side {
        Side::Any(_) => "*:*".to_owned(),
        Side::Connector(connector) => format!("{}:*", connector.text),
        Side::Interaction(connector, ports) => format!("{}:{}", connector.text, paths(ports).join(", ")),
    }
}

fn port_exprs(parts: &[PortExpr]) -> String {
    let part = |part: &PortExpr| {
        let trigger = if part.is_trigger { "'" } else { "" };
        match &part.kind {
            PortExprKind::Port(name) => format!("{}{trigger}", name.text),
            PortExprKind::Group(inner) => format!("({}){trigger}", port_exprs(inner)),
        }
    };
    let parts: Vec<String> = parts.iter().map(part).collect();
    parts.join(" ")
}
