//! The tree to the model: names, types, constants, imports, state machines.
//!
//! It goes twice through a specification. The first time it declares, in the order of the text, as in C: types, constants, internal data,
//! ports, parameters. The second time it reads what may name things that come later: properties and codels.

mod codel;
mod component;
mod constant;
mod draft;
mod initial;
mod machine;
mod properties;
mod scope;
mod service;
mod types;

use lapwing_diag::Diagnostic;

use crate::ast::Item;
use crate::model::{Constant, Model, TypeDef};
use draft::Draft;
use scope::{GLOBAL, ScopeId, Scopes};

/// Nobody reads more.
const MOST_DIAGNOSTICS: usize = 200;

/// Gives the specification's meaning. Where a file is missing (`incomplete`), names that it may have declared are not complained of.
pub(crate) fn resolve(items: &[Item], incomplete: bool, diagnostics: &mut Vec<Diagnostic>) -> Model {
    let mut resolver = Resolver {
        scopes: Scopes::new(),
        types: Vec::new(),
        constants: Vec::new(),
        drafts: Vec::new(),
        provided: Vec::new(),
        required: Vec::new(),
        incomplete,
        diagnostics,
    };
    resolver.items(GLOBAL, items);
    resolver.finish()
}

struct Resolver<'a> {
    scopes: Scopes,
    types: Vec<TypeDef>,
    constants: Vec<Constant>,
    /// Components and interfaces.
    drafts: Vec<Draft<'a>>,
    /// Interfaces that every component provides, by `#pragma provide`.
    provided: Vec<String>,
    /// Packages that every component needs, by `#pragma require`.
    required: Vec<String>,
    incomplete: bool,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl<'a> Resolver<'a> {
    fn items(&mut self, scope: ScopeId, items: &'a [Item]) {
        for item in items {
            match item {
                Item::Module { name, items } => {
                    let module = self.module(scope, name);
                    self.items(module, items);
                }
                Item::Decl(declaration) => self.declare(scope, declaration),
                Item::Body(body) => self.body(scope, body),
                Item::Pragma(pragma) => self.pragma(&pragma.name),
            }
        }
    }

    /// `require "package"` and `provide interface …`; what other tools say to each other is not ours to judge.
    fn pragma(&mut self, text: &str) {
        let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        match word {
            "require" | "requires" => {
                let texts = rest.split('"').skip(1).step_by(2);
                self.required.extend(texts.map(str::to_owned));
            }
            "provide" | "provides" => {
                let names = rest.split(|c: char| c.is_whitespace() || c == ',').filter(|n| !n.is_empty());
                self.provided.extend(names.map(str::to_owned));
            }
            _ => {}
        }
    }

    fn finish(mut self) -> Model {
        let drafts = std::mem::take(&mut self.drafts);
        let mut components = Vec::new();
        for draft in &drafts {
            // An interface is looked at as closely as a component, and then left: what provides it has what is in it.
            let component = self.component(draft);
            if !draft.is_interface {
                components.push(component);
            }
        }
        Model { types: self.types, constants: self.constants, components, links: Vec::new() }
    }
}
