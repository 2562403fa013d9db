//! What the names of declarations stand for.

use super::{Check, Checker, constant::Constant};
use crate::ast::{self, DeclKind, Package, Path};
use crate::host::Signature;
use crate::template::{ExternType, PortType, Shown};
use crate::value::Type;
use lapwing_diag::{Code, Diagnostic, Span};
use std::collections::BTreeMap;

/// A declared name.
#[derive(Clone, Debug)]
pub(super) enum Item {
    Const(Constant),
    ExternType(u32),
    PortType(u32),
    Connector(u32),
    Atom(u32),
    Compound(u32),
}

impl Item {
    fn what(&self) -> &'static str {
        match self {
            Item::Const(_) => "a constant",
            Item::ExternType(_) => "a type of data",
            Item::PortType(_) => "a type of ports",
            Item::Connector(_) => "a type of connectors",
            Item::Atom(_) => "a type of atoms",
            Item::Compound(_) => "a type of compounds",
        }
    }
}

/// All declarations, by their plain names and with the names of their packages.
#[derive(Debug, Default)]
pub(super) struct Scope {
    items: BTreeMap<String, Item>,
    /// Functions and operators by name: there may be several of a name, for different types.
    functions: BTreeMap<String, Vec<u32>>,
}

impl Scope {
    pub fn item(&self, path: &Path) -> Option<&Item> {
        self.items.get(&path.text())
    }

    pub fn constant(&self, name: &str) -> Option<&Constant> {
        match self.items.get(name) {
            Some(Item::Const(constant)) => Some(constant),
            _ => None,
        }
    }

    pub fn constants(&self) -> impl Iterator<Item = &str> {
        self.items.iter().filter(|(_, i)| matches!(i, Item::Const(_))).map(|(n, _)| n.as_str())
    }

    pub fn functions(&self, name: &str) -> &[u32] {
        self.functions.get(name).map_or(&[], Vec::as_slice)
    }

    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        self.functions.keys().map(String::as_str)
    }
}

/// The types that are there without a declaration.
const NATIVE: [(&str, Type); 4] =
    [("bool", Type::Bool), ("int", Type::Int), ("float", Type::Float), ("string", Type::Text)];

impl<'p> Checker<'p> {
    /// Declares all names: types of data first, since everything else speaks of them.
    pub(super) fn declare(&mut self, used: &'p [Package], main: &'p Package) {
        // What is declared later hides what was declared before: the main package comes last.
        for package in used.iter().chain([main]) {
            self.unique("declarations of the name", package.decls.iter().filter_map(|d| name_of(&d.kind)));
        }
        let all: Vec<(&'p Package, &'p DeclKind)> =
            used.iter().chain([main]).flat_map(|p| p.decls.iter().map(move |d| (p, &d.kind))).collect();
        for (package, kind) in &all {
            if let DeclKind::ExternType(ty) = kind {
                self.extern_type(package, ty);
            }
        }
        self.refinements(&all);
        for (package, kind) in all {
            self.declare_one(package, kind);
        }
    }

    fn declare_one(&mut self, package: &Package, kind: &'p DeclKind) {
        match kind {
            DeclKind::ExternType(_) => {}
            DeclKind::ExternFunction(function) => {
                let params = self.param_types(&function.params);
                let result = function.result.as_ref().and_then(|ty| self.data_type(ty).ok());
                self.function(package, &function.name.text, params, result, function.name.span);
            }
            DeclKind::ExternOperator(operator) => {
                let params = self.param_types(&operator.params);
                let result = self.data_type(&operator.result).ok();
                self.function(package, &operator.operator, params, result, operator.span);
            }
            DeclKind::Const(constant) => {
                if let Ok(value) = self.constant(constant) {
                    self.insert(package, &constant.name.text, Item::Const(value));
                }
            }
            DeclKind::Port(port) => {
                self.unique("parameters", port.params.iter().filter_map(|p| p.name.as_ref()));
                let params = port.params.iter().filter_map(|p| {
                    let name = p.name.as_ref().map(|n| n.text.clone()).unwrap_or_default();
                    Some(Shown { name, ty: self.data_type(&p.ty).ok()?, is_const: p.is_const })
                });
                let params = params.collect();
                self.library.port_types.push(PortType { name: port.name.text.clone(), params });
                let index = self.library.port_types.len() as u32 - 1;
                self.insert(package, &port.name.text, Item::PortType(index));
            }
            DeclKind::Connector(connector) => {
                let item = Item::Connector(self.connectors.add(connector));
                self.insert(package, &connector.name.text, item);
            }
            DeclKind::Atom(atom) => {
                let item = Item::Atom(self.atoms.add(atom));
                self.insert(package, &atom.name.text, item);
            }
            DeclKind::Compound(compound) => {
                let item = Item::Compound(self.compounds.add(compound));
                self.insert(package, &compound.name.text, item);
            }
        }
    }

    fn insert(&mut self, package: &Package, name: &str, item: Item) {
        self.scope.items.insert(format!("{}.{name}", package.name.text()), item.clone());
        self.scope.items.insert(name.to_owned(), item);
    }

    fn extern_type(&mut self, package: &Package, ty: &ast::ExternType) {
        self.library.extern_types.push(ExternType { name: ty.name.text.clone(), refines: Vec::new() });
        let index = self.library.extern_types.len() as u32 - 1;
        self.insert(package, &ty.name.text, Item::ExternType(index));
    }

    /// Which types can be used as which: known only when all types have names.
    fn refinements(&mut self, all: &[(&Package, &DeclKind)]) {
        let types: Vec<&ast::ExternType> = all
            .iter()
            .filter_map(|(_, kind)| if let DeclKind::ExternType(ty) = kind { Some(ty) } else { None })
            .collect();
        for (index, ty) in types.into_iter().enumerate() {
            let refines = ty.refines.iter().filter_map(|path| self.data_type(path).ok()).collect();
            if let Some(known) = self.library.extern_types.get_mut(index) {
                known.refines = refines;
            }
        }
    }

    fn param_types(&mut self, params: &[ast::Param]) -> Vec<(Type, bool)> {
        params.iter().filter_map(|p| Some((self.data_type(&p.ty).ok()?, p.is_const))).collect()
    }

    fn function(&mut self, package: &Package, name: &str, params: Vec<(Type, bool)>, result: Option<Type>, span: Span) {
        let (params, is_const): (Vec<Type>, Vec<bool>) = params.into_iter().unzip();
        let same = |s: &Signature| s.name == name && s.params == params;
        let index = match self.library.functions.iter().position(same) {
            Some(index) => index as u32,
            None => {
                self.library.functions.push(Signature { name: name.to_owned(), params, is_const, result, span });
                self.library.functions.len() as u32 - 1
            }
        };
        for name in [name.to_owned(), format!("{}.{name}", package.name.text())] {
            let known = self.scope.functions.entry(name).or_default();
            if !known.contains(&index) {
                known.push(index);
            }
        }
    }

    /// The type of data that a path names.
    pub(super) fn data_type(&mut self, path: &Path) -> Check<Type> {
        let text = path.text();
        if let Some((_, ty)) = NATIVE.iter().find(|(name, _)| *name == text) {
            return Ok(*ty);
        }
        match self.scope.item(path) {
            Some(Item::ExternType(index)) => Ok(Type::Extern(*index)),
            Some(other) => {
                let message = format!("`{text}` is {}, and a type of data is expected here", other.what());
                self.fail(Code::BipType, path.span(), message)
            }
            None => {
                let own = self.library.extern_types.iter().map(|t| t.name.clone()).collect::<Vec<_>>();
                let names = NATIVE.iter().map(|(n, _)| *n).chain(own.iter().map(String::as_str));
                self.unknown("type of data", &text, path.span(), names)
            }
        }
    }

    /// The type of ports that a path names.
    pub(super) fn port_type(&mut self, path: &Path) -> Check<u32> {
        match self.scope.item(path) {
            Some(Item::PortType(index)) => Ok(*index),
            other => {
                let found = other.map(Item::what);
                self.not_a("type of ports", path, found, |i| matches!(i, Item::PortType(_)))
            }
        }
    }

    /// Says that a path does not name what is expected.
    pub(super) fn not_a<T>(
        &mut self,
        what: &str,
        path: &Path,
        found: Option<&str>,
        wanted: impl Fn(&Item) -> bool,
    ) -> Check<T> {
        let text = path.text();
        if let Some(found) = found {
            let message = format!("`{text}` is {found}, and a {what} is expected here");
            return self.fail(Code::BipType, path.span(), message);
        }
        let names: Vec<String> =
            self.scope.items.iter().filter(|(_, i)| wanted(i)).map(|(name, _)| name.clone()).collect();
        self.unknown(what, &text, path.span(), names.iter().map(String::as_str))
    }

    /// What a type of components or connectors is called in a complaint.
    pub(super) fn what(&self, path: &Path) -> Option<&'static str> {
        self.scope.item(path).map(Item::what)
    }

    /// Whether a value of one type can be used as one of the other.
    pub(super) fn fits(&self, from: Type, to: Type) -> bool {
        let mut seen = Vec::new();
        let mut left = vec![from];
        while let Some(ty) = left.pop() {
            if ty == to || (ty == Type::Int && to == Type::Float) {
                return true;
            }
            if let Type::Extern(index) = ty
                && !seen.contains(&index)
            {
                seen.push(index);
                left.extend(self.library.extern_types.get(index as usize).into_iter().flat_map(|t| &t.refines));
            }
        }
        false
    }

    /// A type as written.
    pub(super) fn shown(&self, ty: Type) -> &str {
        match ty {
            Type::Extern(index) => self.library.extern_types.get(index as usize).map_or("?", |t| &t.name),
            ty => NATIVE.iter().find(|(_, t)| *t == ty).map_or("?", |(name, _)| name),
        }
    }

    /// Whether so many values were given as are taken.
    pub(super) fn counts(&mut self, whose: &str, wanted: usize, given: usize, span: Span, declared: Span) -> Check<()> {
        if wanted == given {
            return Ok(());
        }
        let message = format!("{whose} takes {wanted}, and {given} are given");
        let diagnostic = Diagnostic::new(Code::BipArguments, span, message).also(declared, "declared here");
        Err(self.report(diagnostic))
    }
}

/// The name that a declaration declares for itself alone: functions may share theirs.
fn name_of(kind: &DeclKind) -> Option<&ast::Name> {
    match kind {
        DeclKind::Const(c) => Some(&c.name),
        DeclKind::ExternType(t) => Some(&t.name),
        DeclKind::ExternFunction(_) | DeclKind::ExternOperator(_) => None,
        DeclKind::Port(p) => Some(&p.name),
        DeclKind::Connector(c) => Some(&c.name),
        DeclKind::Atom(a) => Some(&a.name),
        DeclKind::Compound(c) => Some(&c.name),
    }
}
