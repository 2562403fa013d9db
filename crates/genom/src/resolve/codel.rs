//! Codels: what they are given, and where it comes from.

use lapwing_diag::{Code, Diagnostic};

use super::Resolver;
use super::draft::Draft;
use super::scope::ScopeId;
use super::service::name_of;
use crate::ast::{self, Direction, Source};
use crate::model::{Codel, CodelParameter, Component, Object, Owner, PortId, Role, Type};
use lapwing_diag::suggest::{listed, nearest};

/// Where a codel stands.
pub(super) struct Place<'d, 'a> {
    pub draft: &'d Draft<'a>,
    pub owner: Owner,
    /// Whether the control task runs it: such a codel has no ports.
    pub is_control: bool,
}

impl<'a> Resolver<'a> {
    /// A codel with its parameters resolved; what it yields is not looked up yet.
    pub(super) fn codel(
        &mut self,
        place: &Place<'_, 'a>,
        component: &Component,
        scope: ScopeId,
        codel: &ast::Codel,
        role: Role,
    ) -> Codel {
        let mut parameters: Vec<CodelParameter> = Vec::new();
        for parameter in &codel.parameters {
            let new = self.codel_parameter(place, component, scope, parameter);
            if let Some(before) = parameters.iter().find(|p| p.name == new.name) {
                let message = format!("`{}` is given two parameters called `{}`", codel.function.name, new.name);
                let help = "give one of them another name: `in a.b::other`";
                self.report(
                    Diagnostic::new(Code::DuplicateName, new.span, message)
                        .also(before.span, "the other one")
                        .help(help),
                );
                continue;
            }
            parameters.push(new);
        }
        let is_state = matches!(role, Role::State { .. });
        if codel.is_async && !is_state {
            let message = "`async` says nothing here: the control task runs this codel and waits for it";
            self.report(
                Diagnostic::new(Code::UnusualSyntax, codel.function.span, message)
                    .help("only the codels of tasks and activities run beside their task"),
            );
        }
        Codel {
            function: codel.function.name.clone(),
            span: codel.function.span,
            owner: place.owner,
            role,
            parameters,
            wcet_ns: codel.wcet.as_ref().and_then(|wcet| self.time(scope, wcet)),
            is_async: codel.is_async && is_state,
        }
    }

    fn codel_parameter(
        &mut self,
        place: &Place<'_, 'a>,
        component: &Component,
        scope: ScopeId,
        parameter: &ast::CodelParameter,
    ) -> CodelParameter {
        let path = &parameter.path;
        let object = match &path.base {
            // All internal data, under the name that follows `::`.
            None => Object::Ids(Vec::new()),
            Some(base) => match self.source(place, component, parameter, base) {
                Some(source) => self.object(place, component, scope, parameter, base, source),
                None => Object::Unknown,
            },
        };
        if let Object::Port(port) = &object {
            self.port_direction(component, *port, parameter);
        }
        CodelParameter { name: name_of(path), direction: parameter.direction, object, span: path.span }
    }

    /// Where a parameter comes from: as it says, or the only place where there is one of that name.
    fn source(
        &mut self,
        place: &Place<'_, 'a>,
        component: &Component,
        parameter: &ast::CodelParameter,
        base: &ast::Ident,
    ) -> Option<Source> {
        let places = self.places(place, component, &base.name);
        if let Some(source) = parameter.source {
            if !places.contains(&source) && !self.incomplete {
                self.absent(place, component, base, source);
                return None;
            }
            return Some(source);
        }
        match places.as_slice() {
            [one] => Some(*one),
            [] => {
                if !self.incomplete {
                    let candidates = self.candidates(place, component);
                    let message = format!(
                        "there is no `{}` in the internal data, among the ports, or among the parameters and locals of the service",
                        base.name
                    );
                    let mut diagnostic = Diagnostic::new(Code::MissingSource, base.span, message);
                    if let Some(near) = nearest(&base.name, candidates.iter().map(String::as_str)) {
                        diagnostic = diagnostic.help(format!("did you mean `{near}`?"));
                    }
                    self.report(diagnostic);
                }
                None
            }
            several => {
                let words: Vec<String> = several
                    .iter()
                    .map(|s| format!("`{} {} {}`", s.word(), parameter.direction.word(), base.name))
                    .collect();
                let message = format!("`{}` may be one of {}: the source is missing", base.name, several.len());
                self.report(
                    Diagnostic::new(Code::MissingSource, base.span, message)
                        .help(format!("write {}", words.join(" or "))),
                );
                None
            }
        }
    }

    /// All places that know a name.
    fn places(&self, place: &Place<'_, 'a>, component: &Component, name: &str) -> Vec<Source> {
        let mut places = Vec::new();
        if self.ids_fields(place.draft.ids).iter().any(|f| f.name == name) {
            places.push(Source::Ids);
        }
        if component
            .service_of(place.owner)
            .is_some_and(|s| s.parameters.iter().any(|p| p.name == name) || s.locals.iter().any(|l| l.name == name))
        {
            places.push(Source::Local);
        }
        if component.ports.iter().any(|p| p.name == name) {
            places.push(Source::Port);
        }
        if component.remotes.iter().any(|r| r.name == name) {
            places.push(Source::Remote);
        }
        places
    }

    fn candidates(&self, place: &Place<'_, 'a>, component: &Component) -> Vec<String> {
        let mut all: Vec<String> = self.ids_fields(place.draft.ids).iter().map(|f| f.name.clone()).collect();
        if let Some(service) = component.service_of(place.owner) {
            all.extend(service.parameters.iter().map(|p| p.name.clone()));
            all.extend(service.locals.iter().map(|l| l.name.clone()));
        }
        all.extend(component.ports.iter().map(|p| p.name.clone()));
        all.extend(component.remotes.iter().map(|r| r.name.clone()));
        all
    }

    /// Says that a source has no such thing.
    fn absent(&mut self, place: &Place<'_, 'a>, component: &Component, base: &ast::Ident, source: Source) {
        let (code, what) = match source {
            Source::Port => (Code::UnknownPort, "port"),
            Source::Ids => (Code::UnknownField, "member of the internal data"),
            Source::Local => (Code::UnknownName, "parameter or local of the service"),
            Source::Remote => (Code::UnknownService, "service of another component"),
        };
        let names: Vec<String> = match source {
            Source::Port => component.ports.iter().map(|p| p.name.clone()).collect(),
            _ => self.candidates(place, component),
        };
        let names = || names.iter().map(String::as_str);
        let help = match nearest(&base.name, names()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if source == Source::Port => format!("the ports of `{}` are {}", component.name, listed(names())),
            None => format!("there are {}", listed(names())),
        };
        self.report(Diagnostic::new(code, base.span, format!("no {what} is called `{}`", base.name)).help(help));
    }

    fn object(
        &mut self,
        place: &Place<'_, 'a>,
        component: &Component,
        scope: ScopeId,
        parameter: &ast::CodelParameter,
        base: &ast::Ident,
        source: Source,
    ) -> Object {
        let path = &parameter.path;
        if place.is_control && matches!(source, Source::Port | Source::Remote) {
            let message =
                format!("the control task runs this codel, and it cannot have the {} `{}`", source.word(), base.name);
            let help = "only the codels of tasks and activities read and write ports";
            self.report(Diagnostic::new(Code::MissingSource, base.span, message).help(help));
        }
        match source {
            Source::Ids => {
                let first = std::iter::once(ast::Step::Member(base.clone()));
                let steps: Vec<ast::Step> = first.chain(path.steps.iter().cloned()).collect();
                let whole = Type::Named(place.draft.ids);
                self.walk(scope, &whole, &steps, "the internal data has")
                    .map_or(Object::Unknown, |(_, steps)| Object::Ids(steps))
            }
            Source::Local => {
                let service = component.service_of(place.owner);
                let parameter =
                    service.and_then(|s| s.parameters.iter().find(|p| p.name == base.name)).map(|p| p.ty.clone());
                let local =
                    service.and_then(|s| s.locals.iter().find(|l| l.name == base.name)).map(|l| Some(l.ty.clone()));
                let steps = match parameter.or(local).flatten() {
                    Some(ty) => self.walk(scope, &ty, &path.steps, "this has").map(|(_, steps)| steps),
                    None => Some(Vec::new()),
                };
                steps.map_or(Object::Unknown, |steps| Object::Local(base.name.clone(), steps))
            }
            Source::Port | Source::Remote => {
                if let Some(step) = path.steps.first() {
                    let span = match step {
                        ast::Step::Member(member) => member.span,
                        ast::Step::Element(expr) => expr.span,
                    };
                    let message =
                        format!("a codel is given the whole {} `{}`, and no part of it", source.word(), base.name);
                    self.report(Diagnostic::new(Code::UnknownField, span, message));
                }
                let port = component.ports.iter().position(|p| p.name == base.name).map(|n| Object::Port(PortId(n)));
                let remote = || component.remotes.iter().position(|r| r.name == base.name).map(Object::Remote);
                let found = if source == Source::Port { port } else { remote() };
                if source == Source::Remote && parameter.direction != Direction::In {
                    let message = format!("the service `{}` of another component can only be `in`", base.name);
                    self.report(Diagnostic::new(Code::MissingSource, base.span, message));
                }
                found.unwrap_or(Object::Unknown)
            }
        }
    }

    /// What is read from outside cannot be written; a port that is written can also be read back.
    fn port_direction(&mut self, component: &Component, port: PortId, parameter: &ast::CodelParameter) {
        let Some(port) = component.ports.get(port.0) else { return };
        if !port.is_out && parameter.direction == Direction::Out {
            let message = format!("`{}` is a port in: another component writes it", port.name);
            self.report(
                Diagnostic::new(Code::UnknownPort, parameter.path.span, message).also(port.span, "it is declared here"),
            );
        }
    }
}
