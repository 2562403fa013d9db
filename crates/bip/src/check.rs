//! From trees to checked types: names, types, what may be written, clocks.
//!
//! All faults are reported, each once; what has a fault is left out, and a model is made only of what has none.

mod atom;
mod compound;
mod connector;
pub(crate) mod constant;
mod expr;
mod guard;
mod names;
mod priority;
mod scope;
mod stmt;

use crate::ast::{self, DeclKind, Package};
use crate::template::{self, Library};
pub(crate) use constant::Nobody;
use lapwing_diag::{Code, Diagnostic, Span};
use scope::Scope;
use std::collections::BTreeSet;

/// A package whose names and types have been looked at.
#[derive(Clone, Debug)]
pub struct Checked {
    pub(crate) library: Library,
    /// Names of the compounds of the main package, in the order of their declaration.
    pub(crate) roots: Vec<(String, u32)>,
    /// What is wrong with the packages.
    pub diagnostics: Vec<Diagnostic>,
}

/// Checks a package together with those that it uses.
pub fn check(main: &Package, used: &[Package]) -> Checked {
    let mut checker = Checker::default();
    checker.packages(main, used);
    checker.declare(used, main);
    for index in 0..checker.connectors.trees.len() {
        checker.connector_type(index);
    }
    for index in 0..checker.atoms.trees.len() {
        checker.atom_type(index);
    }
    for index in 0..checker.compounds.trees.len() {
        checker.compound_type(index);
    }
    checker.finish(main)
}

/// The types of one kind: their trees, and what they mean as far as it is known. Where a type has a fault nothing is known of it.
#[derive(Debug)]
struct Types<'p, Tree, Meaning> {
    trees: Vec<&'p Tree>,
    meanings: Vec<Option<Meaning>>,
}

impl<'p, Tree, Meaning> Types<'p, Tree, Meaning> {
    fn add(&mut self, tree: &'p Tree) -> u32 {
        self.trees.push(tree);
        self.meanings.push(None);
        self.trees.len() as u32 - 1
    }

    fn set(&mut self, index: usize, meaning: Meaning) {
        if let Some(place) = self.meanings.get_mut(index) {
            *place = Some(meaning);
        }
    }

    fn get(&self, index: u32) -> Option<&Meaning> {
        self.meanings.get(index as usize)?.as_ref()
    }
}

impl<Tree, Meaning> Default for Types<'_, Tree, Meaning> {
    fn default() -> Self {
        Types { trees: Vec::new(), meanings: Vec::new() }
    }
}

/// The state of the check.
#[derive(Default)]
struct Checker<'p> {
    scope: Scope,
    library: Library,
    connectors: Types<'p, ast::ConnectorType, template::Connector>,
    atoms: Types<'p, ast::AtomType, template::Atom>,
    compounds: Types<'p, ast::CompoundType, template::Compound>,
    /// Compounds that are being checked: a compound that is met again holds itself.
    open: Vec<usize>,
    /// Compounds that have been checked, with or without success.
    done: BTreeSet<usize>,
    diagnostics: Vec<Diagnostic>,
}

/// The proof that a diagnostic says what is wrong.
#[derive(Clone, Copy, Debug)]
struct Reported(());

type Check<T> = Result<T, Reported>;

impl Checker<'_> {
    fn report(&mut self, diagnostic: Diagnostic) -> Reported {
        self.diagnostics.push(diagnostic);
        Reported(())
    }

    fn fail<T>(&mut self, code: Code, span: Span, message: impl Into<String>) -> Check<T> {
        Err(self.report(Diagnostic::new(code, span, message)))
    }

    /// A name that means nothing here, with what it was probably meant to be.
    fn unknown<'n, T>(
        &mut self,
        what: &str,
        name: &str,
        span: Span,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Check<T> {
        let mut diagnostic = Diagnostic::new(Code::BipUnknownName, span, format!("there is no {what} `{name}`"));
        if let Some(near) = lapwing_diag::suggest::nearest(name, names) {
            diagnostic = diagnostic.help(format!("did you mean `{near}`?"));
        }
        Err(self.report(diagnostic))
    }

    /// Whether each name is there once; the second of two equal ones is reported.
    fn unique<'n>(&mut self, what: &str, names: impl IntoIterator<Item = &'n crate::ast::Name>) {
        let mut seen = std::collections::BTreeMap::new();
        for name in names {
            if let Some(first) = seen.insert(name.text.as_str(), name.span) {
                let message = format!("there are two {what} `{}`", name.text);
                let diagnostic = Diagnostic::new(Code::DuplicateName, name.span, message);
                self.report(diagnostic.also(first, "the other one"));
            }
        }
    }

    fn finish(mut self, main: &Package) -> Checked {
        let own = main.decls.iter().filter_map(|d| match &d.kind {
            DeclKind::Compound(compound) => Some(compound),
            _ => None,
        });
        let place = |tree: &ast::CompoundType| self.compounds.trees.iter().position(|t| std::ptr::eq(*t, tree));
        let roots = own.filter_map(|c| Some((c.name.text.clone(), place(c)? as u32))).collect();
        // Where one is missing there is an error, and the numbers of the others are of no use.
        self.library.connectors = self.connectors.meanings.into_iter().flatten().collect();
        self.library.atoms = self.atoms.meanings.into_iter().flatten().collect();
        self.library.compounds = self.compounds.meanings.into_iter().flatten().collect();
        let mut diagnostics = self.diagnostics;
        diagnostics.sort_by_key(|d| (d.primary.span, d.code));
        diagnostics.dedup();
        Checked { library: self.library, roots, diagnostics }
    }

    fn packages(&mut self, main: &Package, used: &[Package]) {
        for package in used.iter().chain([main]) {
            for name in &package.uses {
                if !used.iter().any(|p| p.name.text() == name.text()) {
                    let text = name.text();
                    let message = format!("the package `{text}` is not there");
                    let help = format!("it is looked for in `{}.bip`", text.replace('.', "/"));
                    self.report(Diagnostic::new(Code::BipUnknownPackage, name.span(), message).help(help));
                }
            }
        }
    }
}
