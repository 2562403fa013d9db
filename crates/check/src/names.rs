//! What a specification declares: one table of names, and which statement uses which.

use std::collections::BTreeMap;

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast::{self, Item, ItemKind};

use crate::load::{Loaded, Used};

/// A statement and where it comes from.
#[derive(Clone, Copy)]
pub(crate) struct Entry<'a> {
    /// The statement.
    pub item: &'a Item,
    /// Whether it stands in a used file: then it declares, but is not judged.
    pub library: bool,
    /// Whether that file comes with Lapwing.
    pub shipped: bool,
}

/// All that is declared. The numbers are those of `items`.
#[derive(Default)]
pub(crate) struct Names<'a> {
    /// Every statement, those of libraries first.
    pub items: Vec<Entry<'a>>,
    /// Signals, named expressions and formulas, events, machines.
    pub values: BTreeMap<&'a str, usize>,
    /// Patterns live apart: only a call can mean one.
    pub patterns: BTreeMap<&'a str, usize>,
    /// The number of each event, in the order of the text.
    pub events: BTreeMap<&'a str, usize>,
    /// What robots believe of themselves.
    pub beliefs: BTreeMap<(&'a str, &'a str), &'a ast::Belief>,
    /// Where ground truth comes from; the first that fits counts.
    pub worlds: Vec<&'a ast::World>,
}

/// What a name stands for.
#[derive(Clone, Copy)]
pub(crate) enum Named<'a> {
    Decl(&'a ast::Decl),
    Formula(Formula<'a>),
    Event(usize),
    Machine(&'a ast::Machine),
}

/// A named expression or formula.
#[derive(Clone, Copy)]
pub(crate) struct Formula<'a> {
    pub item: usize,
    pub body: &'a ast::Expr,
    pub each: &'a [ast::ForEach],
}

impl<'a> Names<'a> {
    /// Collects all declarations; what is declared twice is reported, and the first counts.
    pub fn collect(loaded: &'a Loaded, diagnostics: &mut Vec<Diagnostic>) -> Names<'a> {
        let mut names = Names::default();
        let entries =
            |used: &'a Used| used.file.items.iter().map(|item| Entry { item, library: true, shipped: used.shipped });
        let own = loaded.file.items.iter().map(|item| Entry { item, library: false, shipped: false });
        for entry in loaded.used.iter().flat_map(entries).chain(own) {
            names.add(entry, diagnostics);
        }
        names
    }

    fn add(&mut self, entry: Entry<'a>, diagnostics: &mut Vec<Diagnostic>) {
        let index = self.items.len();
        self.items.push(entry);
        match &entry.item.kind {
            ItemKind::World(world) => self.worlds.push(world),
            ItemKind::Model(model) => self.add_model(model, diagnostics),
            ItemKind::Pattern(p) => match self.patterns.get(p.name.name.as_str()) {
                // The names of a shipped library are nobody's business: they give way.
                Some(_) if entry.shipped => {}
                Some(&first) if !self.items[first].shipped => diagnostics.push(self.duplicate(first, &p.name)),
                _ => _ = self.patterns.insert(&p.name.name, index),
            },
            kind => {
                let Some(name) = declared(kind) else { return };
                if let Some(&first) = self.values.get(name.name.as_str()) {
                    diagnostics.push(self.duplicate(first, name));
                    return;
                }
                self.values.insert(&name.name, index);
                if matches!(kind, ItemKind::Event(_)) {
                    self.events.insert(&name.name, self.events.len());
                }
            }
        }
    }

    fn add_model(&mut self, model: &'a ast::Model, diagnostics: &mut Vec<Diagnostic>) {
        for belief in &model.beliefs {
            let key = (model.object.name.as_str(), belief.quantity.name.as_str());
            match self.beliefs.get(&key) {
                None => _ = self.beliefs.insert(key, belief),
                Some(first) => diagnostics.push(twice(
                    &format!("{} of {}", key.1, key.0),
                    first.quantity.span,
                    belief.quantity.span,
                )),
            }
        }
    }

    fn duplicate(&self, first: usize, name: &ast::Ident) -> Diagnostic {
        let before = declared(&self.items[first].item.kind).map_or(self.items[first].item.span, |n| n.span);
        twice(&name.name, before, name.span)
    }

    /// What a name stands for.
    pub fn get(&self, name: &str) -> Option<Named<'a>> {
        let &index = self.values.get(name)?;
        Some(match &self.items[index].item.kind {
            ItemKind::Decl(decl) => Named::Decl(decl),
            ItemKind::Event(_) => Named::Event(*self.events.get(name)?),
            ItemKind::Machine(machine) => Named::Machine(machine),
            ItemKind::Definition(d) => Named::Formula(Formula { item: index, body: &d.body, each: &d.each }),
            ItemKind::Property(p) => Named::Formula(Formula { item: index, body: &p.body, each: &p.each }),
            _ => return None,
        })
    }

    /// The pattern of that name.
    pub fn pattern(&self, name: &str) -> Option<&'a ast::Pattern> {
        match &self.items[*self.patterns.get(name)?].item.kind {
            ItemKind::Pattern(pattern) => Some(pattern),
            _ => None,
        }
    }

    /// The machine of that name.
    pub fn machine(&self, name: &str) -> Option<&'a ast::Machine> {
        match self.get(name)? {
            Named::Machine(machine) => Some(machine),
            _ => None,
        }
    }

    /// The declared events, in order.
    pub fn event_decls(&self) -> Vec<&'a ast::EventDecl> {
        let events = self.items.iter().filter_map(|entry| match &entry.item.kind {
            ItemKind::Event(event) => Some((event, entry.item)),
            _ => None,
        });
        // A second event of a name has been reported and has no number.
        let counts = |(event, item): &(&'a ast::EventDecl, &'a Item)| {
            self.values.get(event.name.name.as_str()).is_some_and(|&i| std::ptr::eq(self.items[i].item, *item))
        };
        events.filter(counts).map(|(event, _)| event).collect()
    }
}

/// The name that a statement declares, patterns included.
pub(crate) fn declared(kind: &ItemKind) -> Option<&ast::Ident> {
    match kind {
        ItemKind::Decl(d) => Some(&d.name),
        ItemKind::Event(e) => Some(&e.name),
        ItemKind::Machine(m) => Some(&m.name),
        ItemKind::Definition(d) => Some(&d.name),
        ItemKind::Property(p) => p.name.as_ref(),
        ItemKind::Pattern(p) => Some(&p.name),
        _ => None,
    }
}

fn twice(name: &str, first: Span, second: Span) -> Diagnostic {
    Diagnostic::new(Code::DuplicateName, second, format!("`{name}` is declared twice"))
        .label("declared again here")
        .also(first, "first declared here")
        .help("give one of them another name")
}
