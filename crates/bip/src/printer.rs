//! A tree as text, laid out canonically, in the grammar that the original compiler reads.
//!
//! The parser reads it back to the same tree, places aside: a test holds this.

mod behaviour;
mod expr;
mod structure;

use crate::ast::{Annotation, AnnotationValue, Decl, DeclKind, Name, Package, Param, Path};
use expr::text_literal;

/// Lines are broken before this column, where they can be.
const WIDTH: usize = 100;

/// A package as text.
///
/// ```
/// use lapwing_bip::{FileId, parse, print};
///
/// let parsed = parse(FileId(0), "package p port type Go() /* of all */ port type Tick(int n) end");
/// assert_eq!(print(&parsed.package), "package p\n\nport type Go()\n\nport type Tick(int n)\n\nend\n");
/// ```
pub fn print(package: &Package) -> String {
    let mut printer = Printer::default();
    printer.package(package);
    printer.out
}

/// The text so far.
#[derive(Default)]
struct Printer {
    out: String,
    depth: usize,
}

impl Printer {
    fn package(&mut self, package: &Package) {
        self.notes(&package.notes);
        self.annotations(&package.annotations);
        self.line(&format!("package {}", package.name.text()));
        for used in &package.uses {
            self.line(&format!("use {}", used.text()));
        }
        for decl in &package.decls {
            self.blank();
            self.decl(decl);
        }
        self.blank();
        self.line("end");
    }

    fn decl(&mut self, decl: &Decl) {
        self.notes(&decl.notes);
        self.annotations(&decl.annotations);
        match &decl.kind {
            DeclKind::Const(c) => {
                self.line(&format!("const data {} {} = {}", c.ty.text(), c.name.text, expr::expr(&c.value)));
            }
            DeclKind::ExternType(t) => {
                let refines: Vec<String> = t.refines.iter().map(Path::text).collect();
                let refines =
                    if refines.is_empty() { String::new() } else { format!(" refine {}", refines.join(", ")) };
                let backend = t.backend.as_ref().map_or(String::new(), |b| format!(" as {}", text_literal(b)));
                self.line(&format!("extern data type {}{refines}{backend}", t.name.text));
            }
            DeclKind::ExternFunction(f) => {
                let result = f.result.as_ref().map_or(String::new(), |r| format!("{} ", r.text()));
                self.listed(&format!("extern function {result}{}(", f.name.text), &params(&f.params), ")");
            }
            DeclKind::ExternOperator(o) => {
                let head = format!("extern operator {} {}(", o.result.text(), o.operator);
                self.listed(&head, &params(&o.params), ")");
            }
            DeclKind::Port(p) => self.listed(&format!("port type {}(", p.name.text), &params(&p.params), ")"),
            DeclKind::Connector(c) => self.connector_type(c),
            DeclKind::Atom(a) => self.atom_type(a),
            DeclKind::Compound(c) => self.compound_type(c),
        }
    }

    fn annotations(&mut self, annotations: &[Annotation]) {
        for annotation in annotations {
            let value = |value: &AnnotationValue| match value {
                AnnotationValue::Word(word) => word.clone(),
                AnnotationValue::Text(text) => text_literal(text),
            };
            let entry = |(key, found): &(Name, Option<AnnotationValue>)| match found {
                Some(found) => format!("{}={}", key.text, value(found)),
                None => key.text.clone(),
            };
            let entries: Vec<String> = annotation.entries.iter().map(entry).collect();
            let entries = if entries.is_empty() { String::new() } else { format!("({})", entries.join(", ")) };
            self.line(&format!("@{}{entries}", annotation.name.text));
        }
    }

    /// Comments, each on a line of its own whatever they hold.
    fn notes(&mut self, notes: &[String]) {
        for line in notes.iter().flat_map(|n| n.split(['\n', '\r'])) {
            self.line(format!("// {line}").trim_end());
        }
    }

    fn line(&mut self, text: &str) {
        self.indent();
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn indent(&mut self) {
        self.out.extend(std::iter::repeat_n("  ", self.depth));
    }

    fn blank(&mut self) {
        self.out.push('\n');
    }

    /// Something one step further in.
    fn inside(&mut self, what: impl FnOnce(&mut Self)) {
        self.depth += 1;
        what(self);
        self.depth -= 1;
    }

    /// A list between its head and its tail, on as many lines as it needs.
    fn listed(&mut self, head: &str, items: &[String], tail: &str) {
        self.indent();
        self.out.push_str(head);
        let mut column = self.depth * 2 + head.len();
        for (place, item) in items.iter().enumerate() {
            let comma = if place + 1 < items.len() { "," } else { "" };
            let blank = if place == 0 { "" } else { " " };
            if place > 0 && column + blank.len() + item.len() + comma.len() > WIDTH {
                self.out.push('\n');
                self.inside(|p| p.inside(Printer::indent));
                column = (self.depth + 2) * 2;
            } else {
                self.out.push_str(blank);
                column += blank.len();
            }
            self.out.push_str(item);
            self.out.push_str(comma);
            column += item.len() + comma.len();
        }
        self.out.push_str(tail);
        self.out.push('\n');
    }
}

fn params(params: &[Param]) -> Vec<String> {
    let param = |param: &Param| {
        let constant = if param.is_const { "const " } else { "" };
        let name = param.name.as_ref().map_or(String::new(), |n| format!(" {}", n.text));
        format!("{constant}{}{name}", param.ty.text())
    };
    params.iter().map(param).collect()
}

fn names(names: &[Name]) -> Vec<String> {
    names.iter().map(|n| n.text.clone()).collect()
}

fn paths(paths: &[Path]) -> Vec<String> {
    paths.iter().map(Path::text).collect()
}
