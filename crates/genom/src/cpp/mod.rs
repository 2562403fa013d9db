//! The preprocessor: includes, macros, conditions, pragmas.
//!
//! It gives tokens and not text, so that every one of them knows the file and the line that it was written in, whatever included it.

mod condition;
mod files;
mod macros;
mod markers;

use std::path::{Path, PathBuf};
use std::rc::Rc;

use lapwing_diag::{Code, Diagnostic, SourceMap, Span};

pub use files::{Disk, Files};

use crate::lexer::lex;
use crate::token::{Kind, Token};
use macros::{Failed, Macro, Macros};

/// What `__GENOM__` stands for: the version of GenoM3 whose language this is.
pub const GENOM_VERSION: &str = "2.99.41";

/// A file that includes itself without end is noticed here.
const DEEPEST: usize = 64;
/// A text of more tokens is no specification.
const MOST_TOKENS: usize = 500_000;
/// Nor is one of more bytes, or of more files: a file that includes itself twice would be read for ever.
const MOST_BYTES: usize = 16 << 20;
const MOST_FILES: usize = 2_000;
/// Nobody reads more.
const MOST_DIAGNOSTICS: usize = 100;

/// What the preprocessor made of the files.
pub(crate) struct Preprocessed {
    pub tokens: Vec<Token>,
    /// Whether a file was missing: what it would have declared is then unknown.
    pub incomplete: bool,
}

/// Reads files as one text.
pub(crate) struct Cpp<'a> {
    pub files: &'a dyn Files,
    pub folders: &'a [PathBuf],
    pub sources: &'a mut SourceMap,
    pub diagnostics: &'a mut Vec<Diagnostic>,
    macros: Macros,
    out: Vec<Token>,
    /// The folders of the files that the command line names.
    roots: Vec<PathBuf>,
    /// Files that asked to be read once only.
    once: Vec<PathBuf>,
    depth: usize,
    /// Files and bytes that have been read.
    read: (usize, usize),
    incomplete: bool,
}

/// A condition that is open.
struct Open {
    span: Span,
    /// Whether the lines that come now count.
    active: bool,
    /// Whether a branch of it has been taken already.
    taken: bool,
    /// Whether the lines around it count.
    around: bool,
    has_else: bool,
}

impl<'a> Cpp<'a> {
    /// With macros as `-D` gives them: `NAME` or `NAME=VALUE`.
    pub(crate) fn new(
        files: &'a dyn Files,
        folders: &'a [PathBuf],
        defines: &[String],
        sources: &'a mut SourceMap,
        diagnostics: &'a mut Vec<Diagnostic>,
    ) -> Cpp<'a> {
        let mut cpp = Cpp {
            files,
            folders,
            sources,
            diagnostics,
            macros: Macros::default(),
            out: Vec::new(),
            roots: Vec::new(),
            once: Vec::new(),
            depth: 0,
            read: (0, 0),
            incomplete: false,
        };
        cpp.define_outside("the built-in macros", "__GENOM__", GENOM_VERSION);
        for define in defines {
            let (name, value) = define.split_once('=').unwrap_or((define, "1"));
            cpp.define_outside("the command line", name, value);
        }
        cpp
    }

    /// A macro that no file defines.
    fn define_outside(&mut self, place: &str, name: &str, value: &str) {
        let file = self.sources.add(place, format!("#define {name} {value}\n"));
        let tokens = lex(file, self.sources.text(file));
        self.lines(Path::new(""), tokens);
    }

    /// Reads a file that the command line names.
    pub(crate) fn file(&mut self, path: &Path) -> std::io::Result<()> {
        let bytes = self.files.read(path)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        if !self.roots.contains(&folder) {
            self.roots.push(folder);
        }
        self.text(path, &bytes);
        Ok(())
    }

    /// All that was read.
    pub(crate) fn finish(self) -> Preprocessed {
        Preprocessed { tokens: self.out, incomplete: self.incomplete }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < MOST_DIAGNOSTICS {
            self.diagnostics.push(diagnostic);
        }
    }

    fn text(&mut self, path: &Path, bytes: &[u8]) {
        self.read = (self.read.0 + 1, self.read.1 + bytes.len());
        let text = String::from_utf8_lossy(bytes);
        let name = path.display().to_string();
        let mut tokens = Vec::new();
        for part in markers::parts(&name, &text) {
            let file = self.sources.add(part.name, part.text);
            tokens.extend(lex(file, self.sources.text(file)));
        }
        self.lines(path, tokens);
    }

    /// Goes through the lines of one file.
    fn lines(&mut self, path: &Path, tokens: Vec<Token>) {
        let mut open: Vec<Open> = Vec::new();
        let mut plain: Vec<Token> = Vec::new();
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            let is_active = open.last().is_none_or(|o| o.active);
            if !(token.starts_line && token.is("#")) {
                if is_active {
                    plain.push(token);
                }
                continue;
            }
            let mut line = Vec::new();
            while let Some(next) = tokens.next_if(|t| !t.starts_line) {
                line.push(next);
            }
            self.flush(&mut plain);
            if let Err(diagnostic) = self.directive(path, &token, &line, &mut open) {
                self.report(*diagnostic);
            }
        }
        self.flush(&mut plain);
        for condition in open {
            let message = "this condition has no `#endif` in its file";
            self.report(Diagnostic::new(Code::BadDirective, condition.span, message));
        }
    }

    /// Expands what has been gathered between two directives.
    fn flush(&mut self, plain: &mut Vec<Token>) {
        if plain.is_empty() {
            return;
        }
        let last = plain.last().map(|t| t.span).unwrap_or_default();
        match self.macros.expand(std::mem::take(plain)) {
            Ok(tokens) if self.out.len() + tokens.len() <= MOST_TOKENS => self.out.extend(tokens),
            Ok(_) => {
                let message = format!("the text has more than {MOST_TOKENS} words and signs");
                self.report(Diagnostic::new(Code::TooLarge, last, message));
            }
            Err(diagnostic) => self.report(*diagnostic),
        }
    }

    fn directive(&mut self, path: &Path, hash: &Token, line: &[Token], open: &mut Vec<Open>) -> Result<(), Failed> {
        // An empty directive, and what is left of a marker, say nothing.
        let Some((word, rest)) = line.split_first().filter(|(first, _)| first.kind == Kind::Word) else {
            return Ok(());
        };
        let span = hash.span.to(word.span);
        if self.condition(&word.text, rest, span, open)? || !open.last().is_none_or(|o| o.active) {
            return Ok(());
        }
        match &*word.text {
            "include" => self.include(path, rest, span),
            "define" => self.define(rest, span),
            "undef" => {
                let name = rest.first().filter(|t| t.kind == Kind::Word);
                name.map(|t| self.macros.defined.remove(&t.text))
                    .map(drop)
                    .ok_or_else(|| wrong(span, "`#undef` needs a name"))
            }
            "pragma" => {
                self.pragma(path, rest, span);
                Ok(())
            }
            "error" => Err(wrong(span, &format!("the text says: {}", joined(rest)))),
            // What compilers add for themselves, and what they would only say.
            _ => Ok(()),
        }
    }

    /// The directives that choose lines; false where it is none of them.
    fn condition(&mut self, word: &str, rest: &[Token], span: Span, open: &mut Vec<Open>) -> Result<bool, Failed> {
        let around = open.last().is_none_or(|o| o.active);
        match word {
            "if" | "ifdef" | "ifndef" => {
                // A condition that cannot be read leaves its lines out.
                let mut condition = Open { span, active: false, taken: true, around, has_else: false };
                let value = if around { self.value(word, rest, span) } else { Ok(false) };
                if let Ok(value) = value {
                    (condition.active, condition.taken) = (around && value, value);
                }
                open.push(condition);
                value?;
            }
            "elif" => {
                let missing = || wrong(span, "`#elif` without `#if`");
                let condition = open.last().ok_or_else(missing)?;
                let asks = condition.around && !condition.taken;
                let value = asks && condition::holds(&mut self.macros, rest, span)?;
                if let Some(condition) = open.last_mut() {
                    condition.active = value;
                    condition.taken |= value;
                }
            }
            "else" => {
                let condition =
                    open.last_mut().filter(|o| !o.has_else).ok_or_else(|| wrong(span, "`#else` without `#if`"))?;
                condition.active = condition.around && !condition.taken;
                (condition.taken, condition.has_else) = (true, true);
            }
            "endif" => {
                open.pop().ok_or_else(|| wrong(span, "`#endif` without `#if`"))?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn value(&mut self, word: &str, rest: &[Token], span: Span) -> Result<bool, Failed> {
        if word == "if" {
            return condition::holds(&mut self.macros, rest, span);
        }
        let name = rest
            .first()
            .filter(|t| t.kind == Kind::Word)
            .ok_or_else(|| wrong(span, &format!("`#{word}` needs a name")))?;
        Ok(self.macros.defined.contains_key(&name.text) == (word == "ifdef"))
    }

    fn define(&mut self, rest: &[Token], span: Span) -> Result<(), Failed> {
        let Some((name, rest)) = rest.split_first().filter(|(name, _)| name.kind == Kind::Word) else {
            return Err(wrong(span, "`#define` needs a name"));
        };
        if &*name.text == "defined" {
            return Err(wrong(name.span, "`defined` is no name for a macro"));
        }
        let (mut parameters, mut variadic, mut body) = (None, false, rest);
        // Only a bracket that touches the name opens parameters.
        if rest.first().is_some_and(|t| t.is("(") && !t.spaced) {
            let close = rest
                .iter()
                .position(|t| t.is(")"))
                .ok_or_else(|| wrong(span, "the parameters of the macro have no closing bracket"))?;
            let (mut names, inside) = (Vec::<Rc<str>>::new(), rest.get(1..close).unwrap_or_default());
            let dots = inside.len().saturating_sub(3);
            let (inside, last) = match inside.get(dots..) {
                Some([a, b, c]) if [a, b, c].iter().all(|t| t.is(".")) => {
                    (inside.get(..dots).unwrap_or_default(), true)
                }
                _ => (inside, false),
            };
            for parameter in inside.iter().filter(|t| !t.is(",")) {
                if parameter.kind != Kind::Word || names.contains(&parameter.text) {
                    return Err(wrong(parameter.span, &format!("`{}` is no parameter of a macro", parameter.text)));
                }
                names.push(parameter.text.clone());
            }
            if last {
                names.push("__VA_ARGS__".into());
            }
            (parameters, variadic) = (Some(names), last);
            body = rest.get(close + 1..).unwrap_or_default();
        }
        self.macros.defined.insert(name.text.clone(), Macro { parameters, variadic, body: body.to_vec() });
        Ok(())
    }

    fn include(&mut self, path: &Path, rest: &[Token], span: Span) -> Result<(), Failed> {
        let rest = match rest.first() {
            Some(first) if first.kind == Kind::Word => self.macros.expand(rest.to_vec())?,
            _ => rest.to_vec(),
        };
        let end = rest.last().map_or(span, |t| t.span);
        let (wanted, quoted) = match rest.first() {
            Some(text) if text.kind == Kind::Text => (text.text.trim_matches('"').to_owned(), true),
            Some(sign) if sign.is("<") => {
                let close =
                    rest.iter().position(|t| t.is(">")).ok_or_else(|| wrong(span, "`<` of this include has no `>`"))?;
                (self.between(&rest, close), false)
            }
            _ => return Err(wrong(span, "`#include` needs a file: write \"FILE\" or <FILE>")),
        };
        let place = rest.first().map_or(span, |t| t.span.to(end));
        if self.depth >= DEEPEST {
            let message = format!("{DEEPEST} files include each other");
            let help = "a file that may be included twice begins with `#ifndef NAME` and `#define NAME`, and ends with `#endif`";
            return Err(Box::new(Diagnostic::new(Code::TooDeep, place, message).help(help)));
        }
        match files::find(self.files, &wanted, quoted, path, (self.folders, &self.roots)) {
            Ok((_, bytes)) if self.read.0 >= MOST_FILES || self.read.1 + bytes.len() > MOST_BYTES => {
                self.incomplete = true;
                let message = format!("this is more than {MOST_FILES} files, or than {} MiB", MOST_BYTES >> 20);
                Err(Box::new(Diagnostic::new(Code::TooLarge, place, message)))
            }
            Ok((found, bytes)) if !self.once.contains(&found) => {
                self.depth += 1;
                self.text(&found, &bytes);
                self.depth -= 1;
                Ok(())
            }
            Ok(_) => Ok(()),
            Err(tried) => {
                self.incomplete = true;
                let tried: Vec<String> = tried.iter().map(|p| format!("`{}`", p.display())).collect();
                Err(Box::new(
                    Diagnostic::new(Code::MissingInclude, place, format!("`{wanted}` cannot be found"))
                        .label("this file is missing")
                        .help(format!("name the folder that has `{wanted}` in it by -I DIR"))
                        .help(format!("it was looked for as {}", tried.join(", "))),
                ))
            }
        }
    }

    /// What stands between `<` and `>`, as it was written.
    fn between(&self, tokens: &[Token], close: usize) -> String {
        let (Some(first), Some(last)) = (tokens.first(), tokens.get(close)) else { return String::new() };
        let inside = Span { file: first.span.file, start: first.span.end, end: last.span.start };
        self.sources.slice(inside).to_owned()
    }

    /// Hands a pragma on; the parser knows what it means.
    fn pragma(&mut self, path: &Path, rest: &[Token], span: Span) {
        if rest.first().is_some_and(|t| t.is_word("once")) {
            return self.once.push(path.to_owned());
        }
        let end = rest.last().map_or(span, |t| t.span);
        let span = if end.file == span.file { span.to(end) } else { span };
        let text = joined(rest).into();
        self.out.push(Token { kind: Kind::Pragma, text, span, starts_line: true, spaced: false });
    }
}

/// Tokens as text, with a blank where there was one.
fn joined(tokens: &[Token]) -> String {
    let mut text = String::new();
    for (number, token) in tokens.iter().enumerate() {
        if number > 0 && token.spaced {
            text.push(' ');
        }
        text += &token.text;
    }
    text
}

fn wrong(span: Span, message: &str) -> Failed {
    Box::new(Diagnostic::new(Code::BadDirective, span, message))
}
