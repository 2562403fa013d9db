//! Defaults of parameters, held against their types.

use lapwing_diag::{Code, Diagnostic, Span};

use super::Resolver;
use super::constant::Const;
use super::scope::ScopeId;
use crate::ast;
use crate::ast::{Basic, Init, InitValue};
use crate::model::{Step, Type, TypeDefKind, Value};
use lapwing_diag::suggest::listed;

impl Resolver<'_> {
    /// The default that an initialiser gives to something of a type; `None` where it gives none.
    pub(super) fn default(&mut self, scope: ScopeId, ty: Option<&Type>, init: &Init) -> Option<Value> {
        match &init.value {
            InitValue::None => None,
            InitValue::Value(expr) => {
                let value = self.constant(scope, expr)?;
                match ty {
                    Some(ty) => self.fitting(ty, value, expr.span),
                    None => None,
                }
            }
            InitValue::List(inits) => self.parts(scope, ty?, inits, init.span),
        }
    }

    /// The value of a constant of a type, for further expressions and as one of the type: a whole number is a fraction where the type has them, so
    /// that half of 1 is 0.5. One that is no value of the type is complained of, and taken as it is.
    pub(super) fn converted(&mut self, ty: Option<&Type>, value: Const, place: Span) -> (Const, Option<Value>) {
        let Some(ty) = ty else { return (value, None) };
        let value = match (ty.behind(&self.types), value) {
            (Type::Basic(Basic::Float | Basic::Double), Const::Int(value)) => Const::Float(value as f64),
            (_, value) => value,
        };
        let own = self.fitting(ty, value.clone(), place);
        (value, own)
    }

    /// A value as one of a type.
    fn fitting(&mut self, ty: &Type, value: Const, span: Span) -> Option<Value> {
        let fits = match (ty.behind(&self.types), &value) {
            (Type::Basic(Basic::Boolean), Const::Bool(_) | Const::Int(_)) => true,
            (Type::Basic(Basic::Boolean), _) => false,
            (Type::Basic(Basic::Char | Basic::WideChar), value) => matches!(value, Const::Char(_) | Const::Int(_)),
            (Type::Basic(Basic::Any), _) => true,
            (Type::Basic(Basic::Float | Basic::Double) | Type::Fixed(_), value) => {
                matches!(value, Const::Int(_) | Const::Float(_))
            }
            (Type::Basic(_), value) => {
                matches!(value, Const::Int(_) | Const::Char(_) | Const::Bool(_) | Const::Float(_))
            }
            (Type::Text(_), value) => matches!(value, Const::Text(_)),
            (Type::Optional(_), _) => true,
            (Type::Named(id), value) => match (self.types.get(id.0).map(|t| &t.kind), value) {
                (Some(TypeDefKind::Enum(values)), Const::Enumerator(name)) => values.contains(name),
                (Some(TypeDefKind::Enum(_)), Const::Int(_)) => true,
                _ => false,
            },
            (Type::Sequence(..) | Type::Array(..), _) => false,
        };
        if !fits {
            let message = format!("this is no value of the type `{}`", self.type_name(ty));
            self.report(Diagnostic::new(Code::TypeMismatch, span, message));
            return None;
        }
        Some(match value {
            Const::Int(value) => Value::Int(value),
            Const::Float(value) => Value::Float(value),
            Const::Bool(value) => Value::Bool(value),
            Const::Text(value) => Value::Text(value),
            Const::Char(value) => Value::Int(i128::from(u32::from(value))),
            Const::Enumerator(name) => Value::Name(name),
        })
    }

    /// Values in braces: of the members or elements in their order, except where they say of which.
    fn parts(&mut self, scope: ScopeId, ty: &Type, inits: &[Init], span: Span) -> Option<Value> {
        let (members, element): (Vec<(String, Type)>, Option<(Type, Option<u64>)>) = match ty.behind(&self.types) {
            Type::Array(inner, length) => (Vec::new(), Some(((**inner).clone(), Some(*length)))),
            Type::Sequence(inner, length) => (Vec::new(), Some(((**inner).clone(), *length))),
            Type::Optional(inner) => {
                let inner = (**inner).clone();
                return self.parts(scope, &inner, inits, span);
            }
            _ => match self.members_of(ty) {
                Some(members) => (members.iter().map(|f| (f.name.clone(), f.ty.clone())).collect(), None),
                None => {
                    if !self.incomplete {
                        let message =
                            format!("`{}` has no parts that could be given values in braces", self.type_name(ty));
                        self.report(Diagnostic::new(Code::TypeMismatch, span, message));
                    }
                    return None;
                }
            },
        };
        let mut values: Vec<(Step, Value)> = Vec::new();
        let mut next: u64 = 0;
        for init in inits {
            let found = match &element {
                Some((inner, length)) => self.element(scope, init, inner, *length, &mut next),
                None => self.member(init, &members, &mut next),
            };
            let Some((step, part)) = found else { continue };
            if values.iter().any(|(known, _)| *known == step) {
                let diagnostic = Diagnostic::new(
                    Code::UnusualSyntax,
                    init.span,
                    "this part is given a value twice; the last one counts",
                );
                self.report(diagnostic);
            }
            if let Some(value) = self.default(scope, Some(&part), init) {
                values.retain(|(known, _)| *known != step);
                values.push((step, value));
            }
        }
        (!values.is_empty()).then_some(Value::Parts(values))
    }

    fn element(
        &mut self,
        scope: ScopeId,
        init: &Init,
        inner: &Type,
        length: Option<u64>,
        next: &mut u64,
    ) -> Option<(Step, Type)> {
        match &init.target {
            Some(ast::Step::Element(expr)) => *next = self.size(scope, expr)?,
            Some(ast::Step::Member(member)) => {
                let message = format!("this has elements and no member `{}`", member.name);
                self.report(Diagnostic::new(Code::UnknownField, member.span, message));
                return None;
            }
            None => {}
        }
        let number = *next;
        *next = next.saturating_add(1);
        if let Some(length) = length.filter(|length| number >= *length) {
            let message = format!("there are only {length} elements");
            self.report(Diagnostic::new(Code::TypeMismatch, init.span, message));
            return None;
        }
        Some((Step::Element(number), inner.clone()))
    }

    fn member(&mut self, init: &Init, members: &[(String, Type)], next: &mut u64) -> Option<(Step, Type)> {
        let number = match &init.target {
            None => *next as usize,
            Some(ast::Step::Member(member)) => {
                let found = members.iter().position(|(name, _)| *name == member.name);
                if found.is_none() {
                    let names = listed(members.iter().map(|(name, _)| name.as_str()));
                    let message = format!("there is no member `{}`", member.name);
                    self.report(
                        Diagnostic::new(Code::UnknownField, member.span, message).help(format!("there are {names}")),
                    );
                }
                found?
            }
            Some(ast::Step::Element(expr)) => {
                self.report(Diagnostic::new(Code::TypeMismatch, expr.span, "this has members and no elements"));
                return None;
            }
        };
        *next = number as u64 + 1;
        let Some((name, ty)) = members.get(number) else {
            let message = format!("there are only {} members", members.len());
            self.report(Diagnostic::new(Code::TypeMismatch, init.span, message));
            return None;
        };
        Some((Step::Member(name.clone()), ty.clone()))
    }
}
