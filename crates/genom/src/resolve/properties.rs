//! What is said of components, tasks and services: which may say what, and how often.

use lapwing_diag::{Code, Diagnostic, Span};

use super::Resolver;
use super::draft::Said;
use super::scope::ScopeId;
use crate::ast::{
    self, Codel, Declarator, Ident, Order, Property, PropertyKind, ScopedName, ServiceKind, TextProperty, TimeProperty,
};
use crate::model::{TypeDef, TypeDefKind, TypeId};

/// Whose properties they are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Whose {
    Component,
    Interface,
    Task,
    Service(ServiceKind),
}

impl Whose {
    fn name(self) -> &'static str {
        match self {
            Whose::Component => "a component",
            Whose::Interface => "an interface",
            Whose::Task => "a task",
            Whose::Service(ServiceKind::Attribute) => "an attribute",
            Whose::Service(ServiceKind::Function) => "a function",
            Whose::Service(ServiceKind::Activity) => "an activity",
        }
    }

    /// Whether it may have such a property.
    fn may_have(self, kind: &PropertyKind) -> bool {
        use PropertyKind as P;
        let is_service = matches!(self, Whose::Service(_));
        let is_body = matches!(self, Whose::Component | Whose::Interface);
        match kind {
            P::Text(TextProperty::Doc, _) | P::Throws(_) => true,
            P::Text(..) | P::Require(..) | P::Interfaces(..) | P::Time(TimeProperty::ClockRate, _) => is_body,
            P::Time(..) | P::Priority(_) | P::RealTime | P::Stack(..) => self == Whose::Task,
            P::Task(_) => self == Whose::Service(ServiceKind::Activity),
            P::Services(..) | P::Validate(_) => is_service,
            P::Local(..) => is_service && self != Whose::Service(ServiceKind::Attribute),
            P::Codel(codel) => match self {
                Whose::Task | Whose::Service(ServiceKind::Activity) => !codel.triggers.is_empty(),
                Whose::Service(_) => codel.triggers.is_empty(),
                Whose::Component | Whose::Interface => false,
            },
        }
    }
}

/// Properties, sorted.
#[derive(Default)]
pub(super) struct Properties<'a> {
    pub doc: Vec<String>,
    pub version: Option<String>,
    pub lang: Option<String>,
    pub email: Option<String>,
    pub requires: Vec<String>,
    pub codels_requires: Vec<String>,
    pub times: Vec<(TimeProperty, u64, Span)>,
    pub priority: Option<u64>,
    pub real_time: bool,
    pub stack: Option<u64>,
    pub throws: Vec<TypeId>,
    pub task: Option<&'a Ident>,
    pub services: Vec<(Order, &'a Ident)>,
    pub validate: Option<(ScopeId, &'a Codel)>,
    pub locals: Vec<(ScopeId, &'a ast::Type, &'a [Declarator])>,
    pub codels: Vec<(ScopeId, &'a Codel)>,
}

/// Exceptions that every component knows without declaring them.
const STANDARD_EXCEPTIONS: &[&str] = &[
    "incompatible_digest",
    "bad_transition",
    "interrupted",
    "serialization",
    "too_many_activities",
    "disallowed",
    "no_such_activity",
    "no_such_inport",
    "no_such_outport",
    "port_io",
    "no_such_remote",
    "no_such_service",
    "remote_io",
    "no_such_exception",
];

impl<'a> Resolver<'a> {
    /// Sorts properties, and says which of them do not belong there.
    pub(super) fn properties(&mut self, own: ScopeId, said: &[Said<'a>], whose: Whose) -> Properties<'a> {
        let mut sorted = Properties::default();
        let mut single: Vec<(&str, Span)> = Vec::new();
        // What a component says of itself counts more than what the interfaces say that it imports.
        let is_body = matches!(whose, Whose::Component | Whose::Interface);
        let says_itself = |name: &str| said.iter().any(|(scope, p)| *scope == own && p.word.name == name);
        for (scope, property) in said {
            if !whose.may_have(&property.kind) {
                self.misplaced(property, whose);
                continue;
            }
            if is_single(&property.kind) {
                let name = property.word.name.as_str();
                let is_known = says_itself(name) || single.iter().any(|(known, _)| *known == name);
                if is_body && *scope != own && is_known {
                    if !says_itself(name) {
                        self.one_clock(&sorted, *scope, property);
                    }
                    continue;
                }
                // An interface that is imported twice says the same twice.
                if let Some((_, before)) = single.iter().find(|(n, span)| *n == name && *span != property.word.span) {
                    let message = format!("`{name}` is said twice");
                    let diagnostic = Diagnostic::new(Code::BadProperty, property.word.span, message)
                        .also(*before, "it is said here");
                    self.report(diagnostic);
                    continue;
                }
                single.push((name, property.word.span));
            }
            self.sort(&mut sorted, own, *scope, property);
        }
        sorted
    }

    /// Interfaces may differ in who wrote them, but not in the clock that drives what is in them.
    fn one_clock(&mut self, sorted: &Properties<'a>, scope: ScopeId, property: &Property) {
        let PropertyKind::Time(TimeProperty::ClockRate, quantity) = &property.kind else { return };
        let known = sorted.times.iter().find(|(which, ..)| *which == TimeProperty::ClockRate);
        let Some((_, known, before)) = known.filter(|(.., span)| *span != quantity.span) else { return };
        if self.time(scope, quantity).is_some_and(|ns| ns != *known) {
            let message = "two interfaces that are imported have different clock rates";
            self.report(
                Diagnostic::new(Code::BadProperty, quantity.span, message)
                    .also(*before, "the other one")
                    .help("say which counts: write `clock-rate …;` in what imports both"),
            );
        }
    }

    fn sort(&mut self, sorted: &mut Properties<'a>, own: ScopeId, scope: ScopeId, property: &'a Property) {
        match &property.kind {
            PropertyKind::Text(TextProperty::Doc, text) => sorted.doc.push(text.clone()),
            PropertyKind::Text(TextProperty::Version, text) => sorted.version = Some(text.clone()),
            PropertyKind::Text(TextProperty::Lang, text) => sorted.lang = Some(text.clone()),
            PropertyKind::Text(TextProperty::Email, text) => sorted.email = Some(text.clone()),
            PropertyKind::Require(false, texts) => sorted.requires.extend(texts.iter().cloned()),
            PropertyKind::Require(true, texts) => sorted.codels_requires.extend(texts.iter().cloned()),
            PropertyKind::Time(which, quantity) => {
                let ns = self.time(scope, quantity);
                sorted.times.extend(ns.map(|ns| (*which, ns, quantity.span)));
            }
            PropertyKind::Interfaces(..) => {}
            PropertyKind::Priority(value) => sorted.priority = self.size(scope, value),
            PropertyKind::RealTime => sorted.real_time = true,
            PropertyKind::Stack(size, unit) => {
                sorted.stack = self.size(scope, size).map(|size| size.saturating_mul(*unit))
            }
            PropertyKind::Throws(names) => {
                for name in names {
                    let found = self.exception(scope, name).or_else(|| self.exception(own, name));
                    if let Some(id) = found.filter(|id| !sorted.throws.contains(id)) {
                        sorted.throws.push(id);
                    } else if found.is_none() {
                        self.undeclared(name);
                    }
                }
            }
            PropertyKind::Task(name) => sorted.task = Some(name),
            PropertyKind::Services(order, names) => sorted.services.extend(names.iter().map(|name| (*order, name))),
            PropertyKind::Validate(codel) => sorted.validate = Some((scope, codel)),
            PropertyKind::Local(ty, declarators) => sorted.locals.push((scope, ty, declarators)),
            PropertyKind::Codel(codel) => sorted.codels.push((scope, codel)),
        }
    }

    fn misplaced(&mut self, property: &Property, whose: Whose) {
        let word = &property.word.name;
        let (what, help) = match &property.kind {
            PropertyKind::Codel(codel)
                if codel.triggers.is_empty()
                    && matches!(whose, Whose::Task | Whose::Service(ServiceKind::Activity)) =>
            {
                (format!("the codels of {} are states", whose.name()), "write `codel<start> …(…) yield ether;`")
            }
            PropertyKind::Codel(_) if matches!(whose, Whose::Service(_)) => (
                format!("the codels of {} are no states", whose.name()),
                "write `codel …(…);`, without events and `yield`",
            ),
            _ => (format!("{} has no `{word}`", whose.name()), ""),
        };
        let diagnostic = Diagnostic::new(Code::BadProperty, property.word.span, what);
        self.report(if help.is_empty() { diagnostic } else { diagnostic.help(help) });
    }

    fn exception(&self, scope: ScopeId, name: &ScopedName) -> Option<TypeId> {
        let is_exception =
            |id: TypeId| self.types.get(id.0).is_some_and(|t| matches!(t.kind, TypeDefKind::Exception(_)));
        self.scopes.find(scope, name, |symbol| symbol.ty.filter(|id| is_exception(*id)))
    }

    fn undeclared(&mut self, name: &ScopedName) {
        let is_standard = name.parts.last().is_some_and(|last| STANDARD_EXCEPTIONS.contains(&last.name.as_str()));
        if self.incomplete || is_standard {
            return;
        }
        let text = name.text();
        let is_exception = |t: &&TypeDef| matches!(t.kind, TypeDefKind::Exception(_));
        let names: Vec<String> =
            self.types.iter().filter(is_exception).filter_map(|t| t.path.last().cloned()).collect();
        let near = lapwing_diag::suggest::nearest(&text, names.iter().map(String::as_str));
        let help = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("declare it: `exception {text};`"),
        };
        self.report(
            Diagnostic::new(Code::UndeclaredException, name.span(), format!("no exception is called `{text}`"))
                .help(help),
        );
    }
}

/// Whether it is said once at most. The others add up.
fn is_single(kind: &PropertyKind) -> bool {
    use PropertyKind as P;
    match kind {
        P::Text(which, _) => *which != TextProperty::Doc,
        P::Time(..) | P::Priority(_) | P::RealTime | P::Stack(..) | P::Task(_) | P::Validate(_) => true,
        P::Require(..) | P::Interfaces(..) | P::Throws(_) | P::Services(..) | P::Local(..) | P::Codel(_) => false,
    }
}
