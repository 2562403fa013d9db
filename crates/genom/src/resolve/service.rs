//! Services and their parameters, as they are declared.

use lapwing_diag::{Code, Diagnostic};

use super::Resolver;
use super::draft::{Draft, ServiceDraft};
use super::scope::ScopeId;
use crate::ast::{self, AttributeParameter};
use crate::model::{Parameter, Step, Type};
use lapwing_diag::suggest::{listed, nearest};

impl<'a> Resolver<'a> {
    pub(super) fn service(&mut self, draft: &mut Draft<'a>, service: &'a ast::Service) {
        if service.name.name == "all" {
            let message = "no service can be called `all`, which stands for every service";
            return self.report(Diagnostic::new(Code::ReservedWord, service.name.span, message));
        }
        let scope = self.scopes.hidden(draft.scope, &service.name.name);
        let mut parameters: Vec<Parameter> = Vec::new();
        for parameter in &service.parameters {
            let ty = self.declared(scope, &parameter.ty, &parameter.declarator);
            let default = parameter.init.as_ref().and_then(|init| self.default(scope, ty.as_ref(), init));
            let name = &parameter.declarator.name;
            let new =
                Parameter { name: name.name.clone(), direction: parameter.direction, ty, default, span: name.span };
            self.add_parameter(&mut parameters, new);
        }
        let properties = service.properties.iter().map(|p| (draft.scope, p)).collect();
        let new = ServiceDraft {
            name: service.name.name.clone(),
            kind: service.kind,
            span: service.name.span,
            scope,
            members: service.members.iter().collect(),
            parameters,
            properties,
        };
        self.add_service(draft, new);
    }

    /// Adds a parameter whose name must be new.
    pub(super) fn add_parameter(&mut self, parameters: &mut Vec<Parameter>, new: Parameter) {
        match parameters.iter().find(|p| p.name == new.name) {
            Some(before) => {
                let message = format!("two parameters are called `{}`", new.name);
                self.report(Diagnostic::new(Code::DuplicateName, new.span, message).also(before.span, "the other one"));
            }
            None => parameters.push(new),
        }
    }

    /// The parameter of an attribute, and the way to it in the internal data.
    pub(super) fn attribute_parameter(
        &mut self,
        draft: &Draft<'a>,
        parameter: &AttributeParameter,
    ) -> Option<(Parameter, Vec<Step>)> {
        let path = &parameter.path;
        let whole = Type::Named(draft.ids);
        let (ty, steps, name) = match &path.base {
            None => (Some(whole), Vec::new(), path.renamed.as_ref()?.name.clone()),
            Some(base) => {
                let first = std::iter::once(ast::Step::Member(base.clone()));
                let steps: Vec<ast::Step> = first.chain(path.steps.iter().cloned()).collect();
                let (ty, steps) = self.walk(draft.scope, &whole, &steps, "the internal data has")?;
                (ty, steps, name_of(path))
            }
        };
        let default = parameter.init.as_ref().and_then(|init| self.default(draft.scope, ty.as_ref(), init));
        Some((Parameter { name, direction: parameter.direction, ty, default, span: path.span }, steps))
    }

    /// Walks into a type. `None` where the way leads nowhere, which has been said; the type is `None` where nothing is known of it.
    #[allow(clippy::type_complexity)]
    pub(super) fn walk(
        &mut self,
        scope: ScopeId,
        from: &Type,
        steps: &[ast::Step],
        what: &str,
    ) -> Option<(Option<Type>, Vec<Step>)> {
        let (mut ty, mut walked) = (from.clone(), Vec::new());
        for step in steps {
            match step {
                ast::Step::Member(member) => {
                    let Some(members) = self.members_of(&ty) else {
                        if self.incomplete {
                            return None;
                        }
                        let message = format!("`{}` has no members, and so no `{}`", self.type_name(&ty), member.name);
                        self.report(Diagnostic::new(Code::UnknownField, member.span, message));
                        return None;
                    };
                    let Some(found) = members.iter().find(|f| f.name == member.name).map(|f| f.ty.clone()) else {
                        if !self.incomplete {
                            let names: Vec<String> = members.iter().map(|f| f.name.clone()).collect();
                            let names = || names.iter().map(String::as_str);
                            let help = match nearest(&member.name, names()) {
                                Some(near) => format!("did you mean `{near}`?"),
                                None => format!("there are {}", listed(names())),
                            };
                            let message = if walked.is_empty() {
                                format!("{what} no `{}`", member.name)
                            } else {
                                format!("`{}` has no `{}`", self.type_name(&ty), member.name)
                            };
                            self.report(Diagnostic::new(Code::UnknownField, member.span, message).help(help));
                        }
                        return None;
                    };
                    (ty, _) = (found, walked.push(Step::Member(member.name.clone())));
                }
                ast::Step::Element(expr) => {
                    let number = self.size(scope, expr)?;
                    let (inner, length) = match ty.behind(&self.types) {
                        Type::Array(inner, length) => ((**inner).clone(), Some(*length)),
                        Type::Sequence(inner, length) => ((**inner).clone(), *length),
                        _ => {
                            let message = format!("`{}` has no elements", self.type_name(&ty));
                            self.report(Diagnostic::new(Code::TypeMismatch, expr.span, message));
                            return None;
                        }
                    };
                    if let Some(length) = length.filter(|length| number >= *length) {
                        let message =
                            format!("there are {length} elements, from 0; there is none with the number {number}");
                        self.report(Diagnostic::new(Code::TypeMismatch, expr.span, message));
                    }
                    (ty, _) = (inner, walked.push(Step::Element(number)));
                }
            }
        }
        Some((Some(ty), walked))
    }
}

/// What a path is known by: the name it is given, or its last member.
pub(super) fn name_of(path: &ast::Path) -> String {
    let last = path.steps.iter().rev().find_map(|step| match step {
        ast::Step::Member(member) => Some(member),
        ast::Step::Element(_) => None,
    });
    path.renamed.as_ref().or(last).or(path.base.as_ref()).map(|i| i.name.clone()).unwrap_or_default()
}
