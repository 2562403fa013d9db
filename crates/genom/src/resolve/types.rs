//! Declarations of types and constants, and types as they are used.

use lapwing_diag::{Code, Diagnostic, Span};

use super::Resolver;
use super::constant::Const;
use super::scope::{ScopeId, Symbol};
use crate::ast;
use crate::ast::{Case, Decl, Declarator, Expr, Ident, Member, TypeKind};
use crate::model::{Constant, Field, Label, Type, TypeDef, TypeDefKind, TypeId};

impl Resolver<'_> {
    /// Declares something in a scope.
    pub(super) fn declare(&mut self, scope: ScopeId, declaration: &Decl) {
        match declaration {
            Decl::Module(name, inside) => {
                let module = self.module(scope, name);
                inside.iter().for_each(|declaration| self.declare(module, declaration));
            }
            Decl::Const(ty, name, value) => {
                let ty = self.ty(scope, ty);
                let place = value.span;
                let value = self.constant(scope, value).map(|value| self.converted(ty.as_ref(), value, place));
                self.claim(scope, name, |symbol| symbol.ty.is_some() || symbol.value.is_some());
                let symbol = self.scopes.own(scope, &name.name);
                (symbol.value, symbol.span) = (value.clone().map(|(value, _)| value), name.span);
                if let (Some(ty), Some((_, Some(value)))) = (ty, value) {
                    let path = self.scopes.path(scope).iter().cloned().chain([name.name.clone()]).collect();
                    self.constants.push(Constant { path, ty, value });
                }
            }
            Decl::Typedef(ty, declarators) => {
                let ty = self.ty(scope, ty);
                for declarator in declarators {
                    let alias = self.array(scope, ty.clone(), &declarator.lengths);
                    self.define(scope, &declarator.name, alias.map_or(TypeDefKind::Forward, TypeDefKind::Alias));
                }
            }
            Decl::Type(ty) => drop(self.ty(scope, ty)),
            Decl::Native(name) => drop(self.define(scope, name, TypeDefKind::Native)),
            Decl::Exception(exceptions) => {
                for (name, members) in exceptions {
                    let id = self.define(scope, name, TypeDefKind::Exception(Vec::new()));
                    let inside = self.scopes.open(scope, &name.name, name.span);
                    let fields = self.fields(inside, members);
                    self.set(id, TypeDefKind::Exception(fields));
                }
            }
        }
    }

    /// Opens a module, which must not be called like the one around it.
    pub(super) fn module(&mut self, scope: ScopeId, name: &Ident) -> ScopeId {
        if self.scopes.path(scope).last() == Some(&name.name) {
            let message = format!("`{}` has the name of what it is declared in", name.name);
            self.report(Diagnostic::new(Code::DuplicateName, name.span, message));
        }
        self.scopes.open(scope, &name.name, name.span)
    }

    /// Says where a name is taken already.
    fn claim(&mut self, scope: ScopeId, name: &Ident, is_taken: impl Fn(&Symbol) -> bool) {
        let symbol = self.scopes.own(scope, &name.name);
        if is_taken(symbol) {
            let before = symbol.span;
            self.report(
                Diagnostic::new(Code::DuplicateName, name.span, format!("`{}` is declared twice", name.name))
                    .also(before, "it is declared here"),
            );
        }
    }

    /// Adds a type. What was only announced before is what it is now.
    fn define(&mut self, scope: ScopeId, name: &Ident, kind: TypeDefKind) -> TypeId {
        let (known, before) = {
            let symbol = self.scopes.own(scope, &name.name);
            (symbol.ty, symbol.span)
        };
        let announced = known.filter(|id| self.types.get(id.0).is_some_and(|t| matches!(t.kind, TypeDefKind::Forward)));
        if let Some(id) = announced {
            self.set(id, kind);
            return id;
        }
        if known.is_some() {
            let message = format!("`{}` is declared twice", name.name);
            self.report(Diagnostic::new(Code::DuplicateName, name.span, message).also(before, "it is declared here"));
        }
        let path = self.scopes.path(scope).iter().cloned().chain([name.name.clone()]).collect();
        let id = TypeId(self.types.len());
        self.types.push(TypeDef { path, kind, span: name.span });
        let symbol = self.scopes.own(scope, &name.name);
        (symbol.ty, symbol.span) = (Some(id), name.span);
        id
    }

    fn set(&mut self, id: TypeId, kind: TypeDefKind) {
        if let Some(ty) = self.types.get_mut(id.0) {
            ty.kind = kind;
        }
    }

    /// A structure that is filled as it goes: the internal data of a component.
    pub(super) fn open_structure(&mut self, scope: ScopeId, name: &Ident) -> TypeId {
        self.define(scope, name, TypeDefKind::Struct(Vec::new()))
    }

    /// The members of a structure.
    pub(super) fn fields(&mut self, inside: ScopeId, members: &[Member]) -> Vec<Field> {
        let mut fields: Vec<Field> = Vec::new();
        for member in members {
            let ty = self.ty(inside, &member.ty);
            for declarator in &member.declarators {
                let Some(ty) = self.array(inside, ty.clone(), &declarator.lengths) else { continue };
                self.add_field(
                    &mut fields,
                    Field { name: declarator.name.name.clone(), ty, span: declarator.name.span },
                );
            }
        }
        fields
    }

    /// Adds a member whose name must be new.
    pub(super) fn add_field(&mut self, fields: &mut Vec<Field>, field: Field) {
        if let Some(before) = fields.iter().find(|f| f.name == field.name) {
            let message = format!("`{}` is declared twice", field.name);
            self.report(
                Diagnostic::new(Code::DuplicateName, field.span, message).also(before.span, "it is declared here"),
            );
            return;
        }
        fields.push(field);
    }

    /// A declared name's type: an array where it has lengths.
    pub(super) fn declared(&mut self, scope: ScopeId, ty: &ast::Type, declarator: &Declarator) -> Option<Type> {
        let ty = self.ty(scope, ty);
        self.array(scope, ty, &declarator.lengths)
    }

    fn array(&mut self, scope: ScopeId, ty: Option<Type>, lengths: &[Expr]) -> Option<Type> {
        let lengths: Vec<Option<u64>> = lengths.iter().map(|length| self.size(scope, length)).collect();
        lengths.into_iter().rev().try_fold(ty?, |ty, length| Some(Type::Array(Box::new(ty), length?)))
    }

    /// A type as it is used; `None` where it is unknown, which has been said. One that is defined where it is used is declared as well.
    pub(super) fn ty(&mut self, scope: ScopeId, ty: &ast::Type) -> Option<Type> {
        Some(match &ty.kind {
            TypeKind::Basic(basic) => Type::Basic(*basic),
            TypeKind::Text(length) => Type::Text(self.bound(scope, length.as_deref())?),
            TypeKind::Sequence(element, length) => {
                let element = self.ty(scope, element);
                let length = self.bound(scope, length.as_deref());
                Type::Sequence(Box::new(element?), length?)
            }
            TypeKind::Optional(inside) => Type::Optional(Box::new(self.ty(scope, inside)?)),
            TypeKind::Fixed(None) => Type::Fixed(None),
            TypeKind::Fixed(Some(sizes)) => {
                let (digits, scale) = (self.size(scope, &sizes.0), self.size(scope, &sizes.1));
                Type::Fixed(Some((digits?, scale?)))
            }
            TypeKind::Named(name) => {
                let Some(found) = self.scopes.find(scope, name, |symbol| symbol.ty) else {
                    self.unknown(scope, name, "type");
                    return None;
                };
                Type::Named(found)
            }
            TypeKind::Struct(name, members) => {
                let id = self.define(scope, name, TypeDefKind::Forward);
                let inside = self.scopes.open(scope, &name.name, name.span);
                let fields = self.fields(inside, members);
                self.set(id, TypeDefKind::Struct(fields));
                Type::Named(id)
            }
            TypeKind::Union(name, switch, cases) => Type::Named(self.union(scope, name, switch, cases)),
            TypeKind::Enum(name, values) => {
                for value in values {
                    self.claim(scope, value, |symbol| symbol.ty.is_some() || symbol.value.is_some());
                    let symbol = self.scopes.own(scope, &value.name);
                    (symbol.value, symbol.span) = (Some(Const::Enumerator(value.name.clone())), value.span);
                }
                let kind = TypeDefKind::Enum(values.iter().map(|v| v.name.clone()).collect());
                Type::Named(self.define(scope, name, kind))
            }
            TypeKind::Forward(name, _) => {
                let known = self.scopes.own(scope, &name.name).ty;
                Type::Named(known.unwrap_or_else(|| self.define(scope, name, TypeDefKind::Forward)))
            }
        })
    }

    /// A greatest length; `None` outside where it cannot be read, inside where there is none.
    #[allow(clippy::option_option)]
    fn bound(&mut self, scope: ScopeId, length: Option<&Expr>) -> Option<Option<u64>> {
        match length {
            None => Some(None),
            Some(length) => self.size(scope, length).map(Some),
        }
    }

    fn union(&mut self, scope: ScopeId, name: &Ident, switch: &ast::Type, cases: &[Case]) -> TypeId {
        let id = self.define(scope, name, TypeDefKind::Forward);
        let inside = self.scopes.open(scope, &name.name, name.span);
        let switch = self.ty(scope, switch);
        let mut branches = Vec::new();
        for case in cases {
            let labels: Vec<Label> =
                case.labels.iter().filter_map(|label| self.label(inside, switch.as_ref(), label.as_ref())).collect();
            let Some(ty) = self.declared(inside, &case.ty, &case.declarator) else { continue };
            branches
                .push((labels, Field { name: case.declarator.name.name.clone(), ty, span: case.declarator.name.span }));
        }
        if let Some(switch) = switch {
            self.set(id, TypeDefKind::Union(switch, branches));
        }
        id
    }

    fn label(&mut self, scope: ScopeId, switch: Option<&Type>, label: Option<&Expr>) -> Option<Label> {
        let Some(expr) = label else { return Some(Label::Default) };
        // A value of the enumeration that chooses needs no scope before it.
        if let ast::ExprKind::Name(name) = &expr.kind
            && let Some(last) = name.parts.last().filter(|_| name.parts.len() == 1)
            && self.enumerators(switch?).is_some_and(|values| values.contains(&last.name))
        {
            return Some(Label::Name(last.name.clone()));
        }
        Some(match self.constant(scope, expr)? {
            Const::Int(value) => Label::Int(value),
            Const::Bool(value) => Label::Int(i128::from(value)),
            Const::Char(value) => Label::Int(i128::from(u32::from(value))),
            Const::Enumerator(name) => Label::Name(name),
            Const::Float(_) | Const::Text(_) => {
                self.report(Diagnostic::new(
                    Code::TypeMismatch,
                    expr.span,
                    "a case is a whole number, a character, a truth value or a value of an enumeration",
                ));
                return None;
            }
        })
    }

    fn enumerators(&self, ty: &Type) -> Option<&[String]> {
        match self.final_kind(ty)? {
            TypeDefKind::Enum(values) => Some(values),
            _ => None,
        }
    }

    /// Whether two types are one behind all their names.
    pub(super) fn same_type(&self, a: &Type, b: &Type) -> bool {
        match (a.behind(&self.types), b.behind(&self.types)) {
            (Type::Sequence(a, n), Type::Sequence(b, m)) => n == m && self.same_type(a, b),
            (Type::Array(a, n), Type::Array(b, m)) => n == m && self.same_type(a, b),
            (Type::Optional(a), Type::Optional(b)) => self.same_type(a, b),
            (a, b) => a == b,
        }
    }

    pub(super) fn final_kind(&self, ty: &Type) -> Option<&TypeDefKind> {
        match ty.behind(&self.types) {
            Type::Named(id) => self.types.get(id.0).map(|t| &t.kind),
            _ => None,
        }
    }

    /// The members of a type; `None` where it has none.
    pub(super) fn members_of(&self, ty: &Type) -> Option<Vec<&Field>> {
        match self.final_kind(ty)? {
            TypeDefKind::Struct(fields) | TypeDefKind::Exception(fields) => Some(fields.iter().collect()),
            TypeDefKind::Union(_, branches) => Some(branches.iter().map(|(_, field)| field).collect()),
            _ => None,
        }
    }

    /// A type as messages name it.
    pub(super) fn type_name(&self, ty: &Type) -> String {
        match ty {
            Type::Named(id) => self.types.get(id.0).map(TypeDef::name).unwrap_or_default(),
            Type::Array(inner, length) => format!("{}[{length}]", self.type_name(inner)),
            Type::Sequence(inner, _) => format!("sequence<{}>", self.type_name(inner)),
            Type::Optional(inner) => format!("optional<{}>", self.type_name(inner)),
            Type::Text(_) => "string".to_owned(),
            Type::Fixed(_) => "fixed".to_owned(),
            Type::Basic(basic) => format!("{basic:?}").to_lowercase(),
        }
    }

    /// Says that a name is unknown, unless a missing file may have declared it.
    pub(super) fn unknown(&mut self, scope: ScopeId, name: &ast::ScopedName, what: &str) {
        if self.incomplete {
            return;
        }
        let text = name.text();
        let near = lapwing_diag::suggest::nearest(&text, self.scopes.names(scope)).map(str::to_owned);
        let mut diagnostic = Diagnostic::new(Code::UnknownName, name.span(), format!("no {what} is called `{text}`"));
        if let Some(near) = near {
            diagnostic = diagnostic.help(format!("did you mean `{near}`?"));
        }
        self.report(diagnostic);
    }

    /// Says that a place is wrong, once.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        let is_known = |d: &Diagnostic| {
            d.code == diagnostic.code && d.primary.span == diagnostic.primary.span && d.message == diagnostic.message
        };
        // An interface that several components provide is gone through for each.
        if self.diagnostics.len() < super::MOST_DIAGNOSTICS && !self.diagnostics.iter().any(is_known) {
            self.diagnostics.push(diagnostic);
        }
    }
}

/// A name that no text has.
pub(super) fn nameless(name: &str, span: Span) -> Ident {
    Ident { name: name.to_owned(), span }
}
