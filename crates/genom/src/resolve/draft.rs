//! Components and interfaces while they are being declared: all that is in them, own and imported.

use lapwing_diag::{Code, Diagnostic, Span};

use super::Resolver;
use super::scope::{GLOBAL, ScopeId};
use super::types::nameless;
use crate::ast::{self, AttributeParameter, Body, Export, Ident, Property, PropertyKind, Relation, ServiceKind};
use crate::model::{Parameter, Port, Remote, TypeDefKind, TypeId};
use lapwing_diag::suggest::{listed, nearest};

/// A property, and the scope in which its names are looked up first.
pub(super) type Said<'a> = (ScopeId, &'a Property);

/// A component or an interface.
#[derive(Clone)]
pub(super) struct Draft<'a> {
    pub name: String,
    pub span: Span,
    pub is_interface: bool,
    pub scope: ScopeId,
    pub ids: TypeId,
    pub ports: Vec<Port>,
    pub remotes: Vec<Remote>,
    pub tasks: Vec<TaskDraft<'a>>,
    pub services: Vec<ServiceDraft<'a>>,
    pub properties: Vec<Said<'a>>,
    pub requires: Vec<String>,
    /// Interfaces that have been imported already.
    imported: Vec<(Relation, String)>,
}

/// A task.
#[derive(Clone)]
pub(super) struct TaskDraft<'a> {
    pub name: String,
    pub span: Span,
    pub properties: Vec<Said<'a>>,
}

/// A service.
#[derive(Clone)]
pub(super) struct ServiceDraft<'a> {
    pub name: String,
    pub kind: ServiceKind,
    pub span: Span,
    pub scope: ScopeId,
    pub members: Vec<&'a AttributeParameter>,
    pub parameters: Vec<Parameter>,
    pub properties: Vec<Said<'a>>,
}

impl<'a> Resolver<'a> {
    /// Goes through a component or an interface, or a part of one.
    pub(super) fn body(&mut self, scope: ScopeId, body: &'a Body) {
        let Some(number) = self.opened(scope, body) else { return };
        // Taken out, so that the resolver can be asked while it is filled.
        let Some(mut draft) = self.drafts.get(number).cloned() else { return };
        for export in &body.exports {
            if let Export::Property(Property { kind: PropertyKind::Interfaces(relation, names), .. }) = export {
                names.iter().for_each(|name| self.import(&mut draft, *relation, name));
            }
        }
        for export in &body.exports {
            self.export(&mut draft, export);
        }
        if let Some(place) = self.drafts.get_mut(number) {
            *place = draft;
        }
    }

    /// The draft of that name, a new one where there is none.
    fn opened(&mut self, scope: ScopeId, body: &Body) -> Option<usize> {
        if let Some((number, known)) = self.drafts.iter().enumerate().find(|(_, d)| d.name == body.name.name) {
            if known.is_interface == body.is_interface {
                return Some(number);
            }
            let before = known.span;
            let message = format!("`{}` is a component here and an interface there", body.name.name);
            self.report(
                Diagnostic::new(Code::DuplicateName, body.name.span, message).also(before, "it is declared here"),
            );
            return None;
        }
        let inside = self.scopes.open(scope, &body.name.name, body.name.span);
        let ids = self.open_structure(inside, &nameless("ids", body.name.span));
        // What a structure in the internal data is called is found in `ids`.
        self.scopes.open(inside, "ids", body.name.span);
        self.drafts.push(Draft {
            name: body.name.name.clone(),
            span: body.name.span,
            is_interface: body.is_interface,
            scope: inside,
            ids,
            ports: Vec::new(),
            remotes: Vec::new(),
            tasks: Vec::new(),
            services: Vec::new(),
            properties: Vec::new(),
            requires: if body.is_interface { Vec::new() } else { self.required.clone() },
            imported: Vec::new(),
        });
        let number = self.drafts.len() - 1;
        if !body.is_interface {
            for name in self.provided.clone() {
                // The standard interface need not be there: every component has it.
                if self.drafts.iter().any(|d| d.is_interface && d.name == name)
                    && let Some(mut draft) = self.drafts.get(number).cloned()
                {
                    self.import(&mut draft, Relation::Provides, &nameless(&name, body.name.span));
                    self.drafts[number] = draft;
                }
            }
        }
        Some(number)
    }

    /// Takes in what is in an interface: as it is, or, where it is used, from the other side.
    fn import(&mut self, draft: &mut Draft<'a>, relation: Relation, name: &Ident) {
        if draft.imported.iter().any(|(r, n)| *r == relation && *n == name.name) {
            return;
        }
        draft.imported.push((relation, name.name.clone()));
        let Some(other) =
            self.drafts.iter().find(|d| d.is_interface && d.name == name.name && d.name != draft.name).cloned()
        else {
            self.no_interface(draft, name);
            return;
        };
        self.scopes.see(draft.scope, other.scope);
        match relation {
            Relation::Uses => {
                for port in &other.ports {
                    self.add_port(draft, Port { is_out: !port.is_out, ..port.clone() });
                }
                for service in &other.services {
                    let remote =
                        Remote { name: service.name.clone(), interface: other.name.clone(), span: service.span };
                    self.is_new(draft, &remote.name, remote.span);
                    draft.remotes.push(remote);
                }
            }
            Relation::Provides | Relation::Extends => {
                other.ports.iter().for_each(|port| self.add_port(draft, port.clone()));
                other.services.iter().for_each(|service| self.add_service(draft, service.clone()));
            }
        }
        // All else is the same from either side.
        let fields = self.ids_fields(other.ids).to_vec();
        let mut own = self.ids_fields(draft.ids).to_vec();
        fields.into_iter().for_each(|field| self.add_field(&mut own, field));
        self.set_ids(draft.ids, own);
        for remote in &other.remotes {
            if !draft.remotes.iter().any(|r| r.name == remote.name && r.span == remote.span) {
                draft.remotes.push(remote.clone());
            }
        }
        other.tasks.iter().for_each(|task| self.add_task(draft, task.clone()));
        also(&mut draft.properties, &other.properties);
    }

    /// Says that there is no such interface. A module of that name has at least its types.
    fn no_interface(&mut self, draft: &Draft<'a>, name: &Ident) {
        if self.incomplete {
            return;
        }
        let path = ast::ScopedName { absolute: true, parts: vec![name.clone()] };
        let module = self.scopes.find(GLOBAL, &path, |symbol| symbol.scope.filter(|_| symbol.ty.is_none()));
        if let Some(module) = module.filter(|module| *module != draft.scope) {
            self.scopes.see(draft.scope, module);
            let message = format!("`{}` is a module and no interface: it has no ports and no services", name.name);
            let help = "write `interface` in place of `module` where it is declared";
            return self.report(Diagnostic::new(Code::UnusualSyntax, name.span, message).help(help));
        }
        let known = self.drafts.iter().filter(|d| d.is_interface).map(|d| d.name.as_str());
        let help = match nearest(&name.name, known.clone()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("the interfaces before this place are {}; an #include may be missing", listed(known)),
        };
        let message = format!("no interface is called `{}`", name.name);
        self.report(Diagnostic::new(Code::UnknownName, name.span, message).help(help));
    }

    pub(super) fn ids_fields(&self, ids: TypeId) -> &[crate::model::Field] {
        match self.types.get(ids.0).map(|t| &t.kind) {
            Some(TypeDefKind::Struct(fields)) => fields,
            _ => &[],
        }
    }

    fn set_ids(&mut self, ids: TypeId, fields: Vec<crate::model::Field>) {
        if let Some(ty) = self.types.get_mut(ids.0) {
            ty.kind = TypeDefKind::Struct(fields);
        }
    }

    fn export(&mut self, draft: &mut Draft<'a>, export: &'a Export) {
        match export {
            Export::Decl(declaration) => self.declare(draft.scope, declaration),
            Export::Property(property) => draft.properties.push((draft.scope, property)),
            Export::Ids(name, members) => {
                let inside = self.scopes.open(draft.scope, "ids", name.span);
                let new = self.fields(inside, members);
                let mut fields = self.ids_fields(draft.ids).to_vec();
                new.into_iter().for_each(|field| self.add_field(&mut fields, field));
                self.set_ids(draft.ids, fields);
            }
            Export::Task(task) => {
                let properties = task.properties.iter().map(|p| (draft.scope, p)).collect();
                self.add_task(draft, TaskDraft { name: task.name.name.clone(), span: task.name.span, properties });
            }
            Export::Port(port) => self.port(draft, port),
            Export::Service(service) => self.service(draft, service),
        }
    }

    fn port(&mut self, draft: &mut Draft<'a>, port: &'a ast::Port) {
        let doc = self.port_doc(&port.properties);
        let Some(ty) = self.ty(draft.scope, &port.ty) else {
            // Known all the same, so that what names it is not unknown as well.
            let ty = crate::model::Type::Basic(ast::Basic::Any);
            let port = Port {
                name: port.name.name.clone(),
                multiple: port.multiple,
                is_out: port.is_out,
                ty,
                doc,
                span: port.name.span,
            };
            return self.add_port(draft, port);
        };
        let is_native = matches!(self.final_kind(&ty), Some(TypeDefKind::Native));
        let is_anonymous = !matches!(ty, crate::model::Type::Named(_) | crate::model::Type::Basic(_));
        if is_native || is_anonymous {
            let what = if is_native { "a native type, which only codels know" } else { "a type without a name" };
            let message = format!("the port `{}` has {what}", port.name.name);
            let help = if is_native {
                "what flows through a port needs a type that others can read"
            } else {
                "give the type a name with `typedef`"
            };
            // GenoM3 refuses both. `string` and `sequence` are common enough in files that work to be only frowned upon.
            let mut diagnostic = Diagnostic::new(Code::BadProperty, port.ty.span, message).help(help);
            if !is_native {
                diagnostic.code = Code::UnusualSyntax;
                diagnostic.severity = Code::UnusualSyntax.severity();
            }
            self.report(diagnostic);
        }
        let port = Port {
            name: port.name.name.clone(),
            multiple: port.multiple,
            is_out: port.is_out,
            ty,
            doc,
            span: port.name.span,
        };
        self.add_port(draft, port);
    }

    fn port_doc(&mut self, properties: &[Property]) -> String {
        let mut doc = Vec::new();
        for property in properties {
            match &property.kind {
                PropertyKind::Text(ast::TextProperty::Doc, text) => doc.push(text.clone()),
                _ => self.report(Diagnostic::new(
                    Code::BadProperty,
                    property.word.span,
                    format!("a port has no `{}`, only `doc`", property.word.name),
                )),
            }
        }
        doc.join("\n")
    }

    /// Adds a port. One that an interface brings along may be declared once more, and is one port all the same.
    fn add_port(&mut self, draft: &mut Draft<'a>, port: Port) {
        match draft.ports.iter().find(|p| p.name == port.name && p.ty == port.ty) {
            Some(known) if known.is_out == port.is_out && known.multiple == port.multiple => {}
            Some(known) if !draft.imported.is_empty() => {
                let message = format!(
                    "the port `{}` is declared in an interface as well, and not the same way; the first one counts",
                    port.name
                );
                let diagnostic =
                    Diagnostic::new(Code::UnusualSyntax, port.span, message).also(known.span, "the first one");
                self.report(diagnostic);
            }
            _ if self.is_new(draft, &port.name, port.span) => draft.ports.push(port),
            _ => {}
        }
    }

    /// Whether a name is free among ports, services and remotes, which share their names.
    fn is_new(&mut self, draft: &Draft<'a>, name: &str, span: Span) -> bool {
        let ports = draft.ports.iter().map(|p| (&p.name, p.span));
        let services = draft.services.iter().map(|s| (&s.name, s.span));
        let remotes = draft.remotes.iter().map(|r| (&r.name, r.span));
        let before = ports.chain(services).chain(remotes).find(|(other, _)| *other == name).map(|(_, span)| span);
        if let Some(before) = before {
            let message =
                format!("`{name}` is declared twice: ports, services and services of others share their names");
            self.report(Diagnostic::new(Code::DuplicateName, span, message).also(before, "it is declared here"));
        }
        before.is_none()
    }

    fn add_task(&mut self, draft: &mut Draft<'a>, task: TaskDraft<'a>) {
        match draft.tasks.iter_mut().find(|t| t.name == task.name) {
            Some(known) => also(&mut known.properties, &task.properties),
            None => draft.tasks.push(task),
        }
    }

    fn same_parameters(&self, a: &[Parameter], b: &[Parameter]) -> bool {
        let same_type = |a: &Parameter, b: &Parameter| match (&a.ty, &b.ty) {
            (Some(a), Some(b)) => self.same_type(a, b),
            // What could not be found has been said.
            _ => true,
        };
        let same = |(a, b): (&Parameter, &Parameter)| a.name == b.name && a.direction == b.direction && same_type(a, b);
        a.len() == b.len() && a.iter().zip(b).all(same)
    }

    /// Adds a service, or what is said of a known one.
    pub(super) fn add_service(&mut self, draft: &mut Draft<'a>, service: ServiceDraft<'a>) {
        if let Some(known) = draft.services.iter_mut().find(|s| s.name == service.name) {
            let same = known.kind == service.kind
                && self.same_parameters(&known.parameters, &service.parameters)
                && known.members.len() == service.members.len();
            let before = known.span;
            if same {
                also(&mut known.properties, &service.properties);
                // The defaults of the one that says more.
                for (known, new) in known.parameters.iter_mut().zip(service.parameters) {
                    known.default = known.default.take().or(new.default);
                }
                return;
            }
            let message =
                format!("`{}` is opened again as another kind of service, or with other parameters", service.name);
            return self.report(
                Diagnostic::new(Code::DuplicateName, service.span, message).also(before, "it is declared here"),
            );
        }
        if self.is_new(draft, &service.name, service.span) {
            draft.services.push(service);
        }
    }
}

/// Adds what is not there: an interface may be imported in more than one way.
fn also<'a>(all: &mut Vec<Said<'a>>, more: &[Said<'a>]) {
    for said in more {
        if !all.iter().any(|(_, known)| std::ptr::eq(*known, said.1)) {
            all.push(*said);
        }
    }
}
