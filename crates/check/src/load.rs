//! A specification together with the files that it uses, read once and checked as often as there are traces.

use std::collections::BTreeSet;

use lapwing_diag::{Code, Diagnostic, SourceMap, Span};
use lapwing_syntax::ast;

use crate::call::is_function;
use crate::definitions::Definitions;
use crate::graph::{exprs, quantifiers};
use crate::library::LIBRARIES;
use crate::walk;
use lapwing_diag::suggest;

/// A specification and its libraries, ready to be checked.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The specification itself.
    pub(crate) file: ast::File,
    /// What it uses, directly or through others, each file once.
    pub(crate) used: Vec<Used>,
    /// The definitions of the messages that its reactions write, as far as they are known.
    pub(crate) definitions: Definitions,
    /// What went wrong on the way.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// A used file.
#[derive(Clone, Debug)]
pub(crate) struct Used {
    /// What is in it.
    pub file: ast::File,
    /// Whether it comes with Lapwing: then its names give way to those of others.
    pub shipped: bool,
}

impl Loaded {
    /// Whether a property stands under `for each … in topics`: then a trace must tell all of its topics beforehand.
    pub fn runs_over_topics(&self) -> bool {
        let mut each = self.file.items.iter().flat_map(|item| quantifiers(&item.kind));
        each.any(|each| matches!(each.set, ast::EachSet::Topics(_)))
    }

    /// Leaves out the shipped patterns that are not called: a library costs only what is used of it. Where a call means nothing that is
    /// known they all stay, for one of them may have been meant.
    fn leave_out_what_nobody_calls(&mut self) {
        let own = self.used.iter().filter(|used| !used.shipped).map(|used| &used.file).chain([&self.file]);
        let called: BTreeSet<String> = own.flat_map(|file| &file.items).flat_map(calls).collect();
        let patterns: BTreeSet<&str> = self
            .used
            .iter()
            .map(|used| &used.file)
            .chain([&self.file])
            .flat_map(|file| &file.items)
            .filter_map(pattern)
            .collect();
        if called.iter().all(|name| is_function(name) || patterns.contains(name.as_str())) {
            for used in self.used.iter_mut().filter(|used| used.shipped) {
                used.file.items.retain(|item| pattern(item).is_some_and(|name| called.contains(name)));
            }
        }
    }
}

/// The name of a pattern.
fn pattern(item: &ast::Item) -> Option<&str> {
    match &item.kind {
        ast::ItemKind::Pattern(pattern) => Some(&pattern.name.name),
        _ => None,
    }
}

/// The functions and patterns that a statement calls.
fn calls(item: &ast::Item) -> Vec<String> {
    let mut called = Vec::new();
    for expr in exprs(&item.kind) {
        walk::every(expr, |e| {
            if let ast::ExprKind::Call(name, _) = &e.kind {
                called.push(name.name.clone());
            }
        });
    }
    called
}

/// So many files a specification may use.
const MOST_FILES: usize = 256;

/// Reads the files that `file` uses. `resolve` gives the text of a file whose path is relative to the specification's own folder.
pub fn load(sources: &mut SourceMap, file: ast::File, resolve: &dyn Fn(&str) -> Option<String>) -> Loaded {
    let root = file.items.first().map(|item| sources.name(item.span.file).to_owned()).unwrap_or_default();
    let folder = root.rsplit_once('/').map_or("", |(folder, _)| folder);
    // A file that uses the specification itself brings in nothing new.
    let seen = vec![joined("", &root)];
    let mut loader = Loader { sources, resolve, folder, seen, loaded: Loaded::default() };
    loader.follow(&file);
    loader.loaded.file = file;
    loader.loaded.leave_out_what_nobody_calls();
    loader.loaded
}

struct Loader<'a> {
    sources: &'a mut SourceMap,
    resolve: &'a dyn Fn(&str) -> Option<String>,
    /// Where the specification stands.
    folder: &'a str,
    /// The files that need not be read any more, by the names that reports have for them.
    seen: Vec<String>,
    loaded: Loaded,
}

impl Loader<'_> {
    /// Loads what `file` uses; with a list of what is left to do, so that no chain of files is too long for the stack.
    fn follow(&mut self, file: &ast::File) {
        let mut queue = uses(file, "");
        while let Some(wanted) = queue.pop() {
            let name = wanted.name(self.folder);
            if self.seen.contains(&name) {
                continue;
            }
            if self.seen.len() > MOST_FILES {
                self.loaded.diagnostics.push(wanted.one_too_many());
                return;
            }
            self.seen.push(name.clone());
            let Some(text) = self.text(&wanted) else { continue };
            let id = self.sources.add(name, text.clone());
            let parsed = lapwing_syntax::parse(id, &text);
            self.loaded.diagnostics.extend(parsed.diagnostics);
            let folder = wanted.path.rsplit_once('/').map_or("", |(folder, _)| folder);
            queue.extend(uses(&parsed.file, folder));
            self.loaded.used.push(Used { file: parsed.file, shipped: wanted.shipped });
        }
    }

    fn text(&mut self, wanted: &Wanted) -> Option<String> {
        let text = match wanted.shipped {
            true => LIBRARIES.iter().find(|library| library.name == wanted.path).map(|l| l.text.to_owned()),
            false => (self.resolve)(&wanted.path),
        };
        if text.is_none() {
            self.loaded.diagnostics.push(wanted.unknown());
        }
        text
    }
}

/// The files that a file uses, the first last.
fn uses(file: &ast::File, folder: &str) -> Vec<Wanted> {
    let uses = file.items.iter().rev().filter_map(|item| match &item.kind {
        ast::ItemKind::Use(used) => Some(Wanted::new(used, item.span, folder)),
        _ => None,
    });
    uses.collect()
}

/// A path beside another file, without detours: `deeper` and `../mine.rv` give `mine.rv`.
fn joined(folder: &str, path: &str) -> String {
    if path.starts_with('/') {
        return path.to_owned();
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(path.split('/')).filter(|p| !p.is_empty() && *p != ".") {
        match (part, parts.last()) {
            ("..", Some(last)) if *last != ".." => _ = parts.pop(),
            _ => parts.push(part),
        }
    }
    let root = if folder.starts_with('/') { "/" } else { "" };
    format!("{root}{}", parts.join("/"))
}

/// A file to be loaded.
struct Wanted {
    path: String,
    shipped: bool,
    span: Span,
}

impl Wanted {
    fn new(used: &ast::Use, span: Span, folder: &str) -> Wanted {
        match used {
            ast::Use::Library(names) => {
                let path = names.iter().map(|n| n.name.as_str()).collect::<Vec<_>>().join(".");
                Wanted { path, shipped: true, span }
            }
            ast::Use::File(path, span) => Wanted { path: joined(folder, path), shipped: false, span: *span },
        }
    }

    /// What reports call it: the path as seen from where the specification was named.
    fn name(&self, folder: &str) -> String {
        if self.shipped { self.path.clone() } else { joined(folder, &self.path) }
    }

    fn unknown(&self) -> Diagnostic {
        if !self.shipped {
            let message = format!("the file `{}` cannot be read", self.path);
            return Diagnostic::new(Code::UnknownLibrary, self.span, message)
                .label("no such file, or none that is a text")
                .help("the path is relative to the file that uses it")
                .help("a library that comes with Lapwing is named without quotes: `use std.robot`");
        }
        let names = || LIBRARIES.iter().map(|library| library.name);
        let guess = suggest::nearest(&self.path, names());
        let message = format!("there is no library `{}`{}", self.path, suggest::or_else(guess));
        let mut diagnostic = Diagnostic::new(Code::UnknownLibrary, self.span, message)
            .label("unknown library")
            .help(format!("the libraries are {}", suggest::listed(names())))
            .help("a pattern of your own can stand in a file beside this one: `use \"mine.rv\"`");
        if let Some(guess) = guess {
            diagnostic = diagnostic.fix(self.span, format!("use {guess}"));
        }
        diagnostic
    }

    fn one_too_many(&self) -> Diagnostic {
        let message = format!("a specification uses {MOST_FILES} files at most");
        Diagnostic::new(Code::TooLarge, self.span, message).label("one too many")
    }
}
