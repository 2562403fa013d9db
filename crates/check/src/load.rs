//! A specification together with the files that it uses, read once and checked as often as there are traces.

use lapwing_diag::{Code, Diagnostic, SourceMap, Span};
use lapwing_syntax::ast;

use crate::suggest;

/// A specification and its libraries, ready to be checked.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The specification itself.
    pub(crate) file: ast::File,
    /// What it uses, directly or through others, each file once.
    pub(crate) libraries: Vec<ast::File>,
    /// What went wrong on the way.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

impl Loaded {
    /// Whether a property stands under `for each … in topics`: then a trace must tell all of its topics beforehand.
    pub fn runs_over_topics(&self) -> bool {
        let over_topics = |each: &[ast::ForEach]| each.iter().any(|e| matches!(e.set, ast::EachSet::Topics(_)));
        self.file.items.iter().any(|item| match &item.kind {
            ast::ItemKind::Property(property) => over_topics(&property.each),
            ast::ItemKind::Definition(definition) => over_topics(&definition.each),
            _ => false,
        })
    }
}

/// The libraries that come with Lapwing, by name, with their text.
const SHIPPED: &[(&str, &str)] = &[];

/// So many files a specification may use.
const MOST_FILES: usize = 256;

/// Reads the files that `file` uses. `resolve` gives the text of a file whose path is relative to the specification's own folder.
pub fn load(sources: &mut SourceMap, file: ast::File, resolve: &dyn Fn(&str) -> Option<String>) -> Loaded {
    let mut loader = Loader { sources, resolve, seen: Vec::new(), loaded: Loaded::default() };
    loader.follow(&file, "");
    loader.loaded.file = file;
    loader.loaded
}

struct Loader<'a> {
    sources: &'a mut SourceMap,
    resolve: &'a dyn Fn(&str) -> Option<String>,
    seen: Vec<String>,
    loaded: Loaded,
}

impl Loader<'_> {
    /// Loads what `file` uses; breadth first, so that no chain of files is too long for the stack.
    fn follow(&mut self, file: &ast::File, folder: &str) {
        let mut queue = self.uses(file, folder);
        while let Some(wanted) = queue.pop() {
            if self.seen.contains(&wanted.path) || self.seen.len() == MOST_FILES {
                continue;
            }
            self.seen.push(wanted.path.clone());
            let Some(text) = self.text(&wanted) else { continue };
            let id = self.sources.add(wanted.path.clone(), text.clone());
            let parsed = lapwing_syntax::parse(id, &text);
            self.loaded.diagnostics.extend(parsed.diagnostics);
            let folder = wanted.path.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
            queue.extend(self.uses(&parsed.file, &folder));
            self.loaded.libraries.push(parsed.file);
        }
    }

    /// The files that a file uses, the first last.
    fn uses(&self, file: &ast::File, folder: &str) -> Vec<Wanted> {
        let uses = file.items.iter().filter_map(|item| match &item.kind {
            ast::ItemKind::Use(used) => Some((used, item.span)),
            _ => None,
        });
        let mut wanted: Vec<Wanted> = uses.map(|(used, span)| Wanted::new(used, span, folder)).collect();
        wanted.reverse();
        wanted
    }

    fn text(&mut self, wanted: &Wanted) -> Option<String> {
        let shipped = SHIPPED.iter().find(|(name, _)| *name == wanted.path).map(|(_, text)| (*text).to_owned());
        let text = if wanted.shipped { shipped } else { (self.resolve)(&wanted.path) };
        if text.is_none() {
            self.loaded.diagnostics.push(wanted.unknown());
        }
        text
    }
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

    fn unknown(&self) -> Diagnostic {
        if !self.shipped {
            return Diagnostic::new(
                Code::UnknownLibrary,
                self.span,
                format!("the file `{}` cannot be read", self.path),
            )
            .label("no such file beside this one")
            .help("the path is relative to the file that uses it");
        }
        let names: Vec<&str> = SHIPPED.iter().map(|(name, _)| *name).collect();
        let guess = suggest::nearest(&self.path, names.iter().copied());
        let there = match names.is_empty() {
            true => "this version ships no library yet".to_owned(),
            false => format!("the libraries are {}", suggest::listed(names)),
        };
        let message = format!("there is no library `{}`{}", self.path, suggest::or_else(guess));
        Diagnostic::new(Code::UnknownLibrary, self.span, message)
            .label("unknown library")
            .help(there)
            .help("a pattern of your own can stand in a file beside this one: `use \"mine.rv\"`")
    }
}
