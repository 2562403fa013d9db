//! Scopes: modules, components, interfaces, structures. A name is looked for in the scope where it stands and then in those around it.

use std::collections::BTreeMap;

use lapwing_diag::Span;

use super::constant::Const;
use crate::ast::ScopedName;
use crate::model::TypeId;

/// The number of a scope.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ScopeId(pub usize);

/// The scope around everything.
pub(super) const GLOBAL: ScopeId = ScopeId(0);

/// What a name stands for; it may be a type and a scope at once.
#[derive(Clone, Debug, Default)]
pub(super) struct Symbol {
    pub ty: Option<TypeId>,
    pub value: Option<Const>,
    pub scope: Option<ScopeId>,
    pub span: Span,
}

#[derive(Debug, Default)]
struct Scope {
    path: Vec<String>,
    parent: Option<ScopeId>,
    names: BTreeMap<String, Symbol>,
    /// Interfaces whose names are seen as if they were its own.
    seen: Vec<ScopeId>,
}

/// All scopes.
#[derive(Debug)]
pub(super) struct Scopes {
    all: Vec<Scope>,
}

impl Scopes {
    pub(super) fn new() -> Scopes {
        Scopes { all: vec![Scope::default()] }
    }

    /// The scope of that name in another, which is made where there is none.
    pub(super) fn open(&mut self, parent: ScopeId, name: &str, span: Span) -> ScopeId {
        let next = ScopeId(self.all.len());
        let Some(outer) = self.all.get_mut(parent.0) else { return GLOBAL };
        let symbol = outer.names.entry(name.to_owned()).or_insert_with(|| Symbol { span, ..Symbol::default() });
        if let Some(scope) = symbol.scope {
            return scope;
        }
        symbol.scope = Some(next);
        let path = outer.path.iter().cloned().chain([name.to_owned()]).collect();
        self.all.push(Scope { path, parent: Some(parent), ..Scope::default() });
        next
    }

    /// A scope that no name leads to.
    pub(super) fn hidden(&mut self, parent: ScopeId, name: &str) -> ScopeId {
        let path = self.path(parent).iter().cloned().chain([name.to_owned()]).collect();
        self.all.push(Scope { path, parent: Some(parent), ..Scope::default() });
        ScopeId(self.all.len() - 1)
    }

    /// The names that lead to a scope.
    pub(super) fn path(&self, scope: ScopeId) -> &[String] {
        self.all.get(scope.0).map_or(&[], |s| &s.path)
    }

    /// Lets the names of another scope be seen in one, and those that are seen in that.
    pub(super) fn see(&mut self, scope: ScopeId, other: ScopeId) {
        let further = self.all.get(other.0).map(|s| s.seen.clone()).unwrap_or_default();
        let Some(scope) = self.all.get_mut(scope.0) else { return };
        for other in [other].into_iter().chain(further) {
            if !scope.seen.contains(&other) {
                scope.seen.push(other);
            }
        }
    }

    /// What a scope itself knows by a name.
    pub(super) fn own(&mut self, scope: ScopeId, name: &str) -> &mut Symbol {
        // Scopes are only ever made by `open` and `hidden`, so that every number has one; the global one stands in for none.
        let number = if scope.0 < self.all.len() { scope.0 } else { 0 };
        self.all[number].names.entry(name.to_owned()).or_default()
    }

    /// The innermost thing of a name that is of the wanted kind.
    pub(super) fn find<T>(&self, from: ScopeId, name: &ScopedName, wanted: impl Fn(&Symbol) -> Option<T>) -> Option<T> {
        let mut next = Some(if name.absolute { GLOBAL } else { from });
        while let Some(scope) = next {
            if let Some(found) = self.descend(scope, name).and_then(&wanted) {
                return Some(found);
            }
            next = self.all.get(scope.0)?.parent;
        }
        None
    }

    /// What a path leads to from a scope.
    fn descend(&self, scope: ScopeId, name: &ScopedName) -> Option<&Symbol> {
        let (last, path) = name.parts.split_last()?;
        let mut at = scope;
        for part in path {
            at = self.known(at, &part.name, |symbol| symbol.scope.is_some())?.scope?;
        }
        self.known(at, &last.name, |_| true)
    }

    fn known(&self, scope: ScopeId, name: &str, wanted: impl Fn(&Symbol) -> bool) -> Option<&Symbol> {
        let inside = self.all.get(scope.0)?;
        let mut places = std::iter::once(scope).chain(inside.seen.iter().copied());
        places.find_map(|place| self.all.get(place.0)?.names.get(name).filter(|s| wanted(s)))
    }

    /// Names that are seen from a scope, for proposals.
    pub(super) fn names(&self, from: ScopeId) -> Vec<&str> {
        let mut all = Vec::new();
        let mut next = Some(from);
        while let Some(scope) = next.and_then(|s| self.all.get(s.0)) {
            all.extend(scope.names.keys().map(String::as_str));
            next = scope.parent;
        }
        all
    }
}
