//! From the intermediate form to text. What the languages share stands here; what they spell differently is a [`Syntax`].

mod c;
mod objects;
mod prelude;
mod rust;
mod wholes;

pub(crate) use c::{c, needs_math};
pub(crate) use rust::{needs_libm, rust};

use std::collections::BTreeSet;

use crate::Interface;
use crate::code::{Bin, Expr, Function, Helper, Stmt, Ty, Unit};
use crate::prune::{below, locals_of, reads_inputs};

/// The widest line, in characters, that comments are broken at.
const WIDTH: usize = 110;

/// What a language spells in its own way.
pub(crate) trait Syntax {
    fn ty(&self, ty: Ty) -> &'static str;
    fn float(&self, x: f64) -> String;
    fn field(&self, name: &str) -> String;
    fn element(&self, name: &str, at: &str) -> String;
    fn input(&self, name: &str) -> String;
    /// The parameter that inputs are members of.
    fn inputs(&self) -> &'static str;
    fn choose(&self, condition: &str, then: &str, other: &str) -> String;
    /// Whether the parts of a choice want brackets.
    fn brackets_choices(&self) -> bool;
    fn cast(&self, ty: Ty, of: &str) -> String;
    fn call(&self, helper: Helper, args: &str) -> String;
    /// Whether a text is that one.
    fn same(&self, of: &str, text: &str) -> String;
    fn variable(&self, name: &str, ty: Ty, value: &str, is_set: bool) -> String;
    /// A condition or value behind a keyword, with what that language puts around it.
    fn head(&self, keyword: &str, of: &str) -> String;
    fn count_up(&self, name: &str, below: &str) -> String;
    /// The line that begins an arm of a choice by number.
    fn arm(&self, number: u8) -> String;
    /// The lines that end an arm.
    fn arm_end(&self) -> &'static [&'static str];
    /// What stands behind the last arm.
    fn otherwise(&self) -> &'static str;
    fn choice(&self, of: &str) -> String;
    /// Lines that fill an array.
    fn fill(&self, name: &str, value: &str, len: usize) -> Vec<String>;
    fn call_own(&self, function: &Function, args: &[String]) -> String;
    /// A line that says that nothing reads a parameter, and that this is meant.
    fn unread(&self, name: &str) -> String;
}

/// Text, line by line.
pub(crate) struct Writer<'u, S> {
    pub syntax: S,
    pub unit: &'u Unit,
    pub text: String,
    depth: usize,
}

impl<'u, S: Syntax> Writer<'u, S> {
    pub fn new(syntax: S, unit: &'u Unit) -> Writer<'u, S> {
        Writer { syntax, unit, text: String::new(), depth: 0 }
    }

    pub fn line(&mut self, line: &str) {
        if !line.is_empty() {
            self.text.push_str(&"    ".repeat(self.depth));
            self.text.push_str(line);
        }
        self.text.push('\n');
    }

    pub fn lines(&mut self, lines: &str) {
        lines.lines().for_each(|line| self.line(line));
    }

    pub fn inside(&mut self, write: impl FnOnce(&mut Self)) {
        self.depth += 1;
        write(self);
        self.depth -= 1;
    }

    /// Text behind a mark of comments, broken into lines.
    pub fn comment(&mut self, mark: &str, text: &str) {
        let mut line = mark.to_owned();
        // A backslash, or what C takes for one, at the end of a line would make the next line a comment.
        for word in text.split_whitespace().map(|word| without_trigraphs(word).replace('\\', "\\.")) {
            if line.chars().count() + word.chars().count() >= WIDTH && line != mark {
                self.line(&line);
                line = mark.to_owned();
            }
            line.push(' ');
            line.push_str(&word);
        }
        self.line(&line);
    }

    /// The statements of a function, behind those that excuse parameters that nothing reads.
    pub fn body(&mut self, function: &Function) {
        let read = locals_of(&function.body);
        for (name, _) in function.params.iter().filter(|(name, _)| !read.contains(name)) {
            let line = self.syntax.unread(name);
            self.line(&line);
        }
        if function.takes_inputs && !reads_inputs(&function.body) {
            let line = self.syntax.unread(self.syntax.inputs());
            self.line(&line);
        }
        self.block(&function.body);
    }

    pub fn block(&mut self, body: &[Stmt]) {
        body.iter().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, statement: &Stmt) {
        match statement {
            Stmt::Comment(text) => self.comment("//", text),
            Stmt::Let { name, ty, value, is_set } => {
                let line = self.syntax.variable(name, *ty, &self.expr(value), *is_set);
                self.line(&line);
            }
            Stmt::Set(place, value) => self.set(place, value),
            Stmt::If(condition, then, other) => self.branch("", condition, then, other),
            Stmt::While(condition, body) => {
                let head = self.syntax.head("while", &self.expr(condition));
                self.braced(&head, body);
            }
            Stmt::For(name, below, body) => {
                let head = self.syntax.count_up(name, &self.expr(below));
                self.braced(&head, body);
            }
            Stmt::Match(of, arms) => self.choice(of, arms),
            Stmt::Fill(name, value) => {
                let len = self.unit.fields.iter().find(|f| f.name == *name).and_then(|f| f.len).unwrap_or(1);
                let lines = self.syntax.fill(name, &self.expr(value), len);
                lines.iter().for_each(|line| self.line(line));
            }
            Stmt::Do(name, args) => {
                let Some(function) = self.unit.functions.iter().find(|f| f.name == *name) else { return };
                let args: Vec<String> = args.iter().map(|a| self.expr(a)).collect();
                let line = self.syntax.call_own(function, &args);
                self.line(&line);
            }
            Stmt::Return => self.line("return;"),
        }
    }

    /// `x += e` where it is that.
    fn set(&mut self, place: &Expr, value: &Expr) {
        let (to, value) = match value {
            Expr::Bin(op @ (Bin::Add | Bin::Sub), left, right) if **left == *place => {
                (format!("{} {}=", self.expr(place), sign(*op)), self.expr(right))
            }
            _ => (format!("{} =", self.expr(place)), self.expr(value)),
        };
        self.line(&format!("{to} {value};"));
    }

    fn branch(&mut self, before: &str, condition: &Expr, then: &[Stmt], other: &[Stmt]) {
        let head = format!("{before}{}", self.syntax.head("if", &self.expr(condition)));
        self.line(&format!("{head} {{"));
        self.inside(|w| w.block(then));
        match other {
            [] => self.line("}"),
            [Stmt::If(condition, then, other)] => self.branch("} else ", condition, then, other),
            _ => {
                self.line("} else {");
                self.inside(|w| w.block(other));
                self.line("}");
            }
        }
    }

    fn braced(&mut self, head: &str, body: &[Stmt]) {
        self.line(&format!("{head} {{"));
        self.inside(|w| w.block(body));
        self.line("}");
    }

    fn choice(&mut self, of: &Expr, arms: &[(u8, Vec<Stmt>)]) {
        let head = self.syntax.choice(&self.expr(of));
        self.line(&format!("{head} {{"));
        self.inside(|w| {
            for (number, body) in arms {
                let (arm, end) = (w.syntax.arm(*number), w.syntax.arm_end());
                w.line(&arm);
                w.inside(|w| w.block(body));
                end.iter().for_each(|line| w.line(line));
            }
            let otherwise = w.syntax.otherwise();
            w.line(otherwise);
        });
        self.line("}");
    }

    /// An expression as text.
    pub fn expr(&self, e: &Expr) -> String {
        match e {
            Expr::Bool(b) => b.to_string(),
            Expr::Int(i) => i.to_string(),
            Expr::Float(x) => self.syntax.float(*x),
            Expr::Local(name) => name.clone(),
            Expr::Field(name) => self.syntax.field(name),
            Expr::Elem(name, at) => self.syntax.element(name, &self.expr(at)),
            Expr::Input(name) => self.syntax.input(name),
            Expr::Not(of) => match &**of {
                Expr::Bin(Bin::Eq, a, b) => self.expr(&(**a).clone().ne(&**b)),
                Expr::Bin(Bin::Ne, a, b) => self.expr(&(**a).clone().eq(&**b)),
                of => format!("!{}", self.operand(of, None)),
            },
            Expr::Neg(of) => format!("-{}", self.operand(of, None)),
            Expr::Bin(op, a, b) => {
                // Floating-point sums and products are not associative: only what stands on the left goes without brackets.
                format!("{} {} {}", self.operand(a, Some(*op)), sign(*op), self.operand(b, None))
            }
            Expr::Choose(c, a, b) => {
                let text = |e: &Expr| if self.syntax.brackets_choices() { self.operand(e, None) } else { self.expr(e) };
                self.syntax.choose(&text(c), &text(a), &text(b))
            }
            Expr::As(ty, of) => self.syntax.cast(*ty, &self.operand(of, None)),
            Expr::Same(of, text) => self.syntax.same(&self.expr(of), text),
            Expr::Call(helper, args) => {
                let args: Vec<String> = args.iter().map(|a| self.expr(a)).collect();
                self.syntax.call(*helper, &args.join(", "))
            }
        }
    }

    /// An operand, in brackets where it is not simple.
    pub fn operand(&self, e: &Expr, under: Option<Bin>) -> String {
        let text = self.expr(e);
        let is_chain = matches!((e, under), (Expr::Bin(a, ..), Some(b)) if *a == b && chains(b));
        let is_negative = matches!(e, Expr::Int(i) if *i < 0) || matches!(e, Expr::Float(x) if x.is_sign_negative());
        let is_compound = is_negative
            || matches!(e, Expr::Bin(..) | Expr::Choose(..) | Expr::Neg(_) | Expr::As(..) | Expr::Same(..))
            || matches!(e, Expr::Not(of) if matches!(**of, Expr::Bin(Bin::Eq | Bin::Ne, ..)));
        if is_compound && !is_chain { format!("({text})") } else { text }
    }
}

/// A text without what C takes for a backslash.
fn without_trigraphs(text: &str) -> String {
    text.replace("??/", "? ?/")
}

/// Operators that group to the left, so that a chain of them needs no brackets.
fn chains(op: Bin) -> bool {
    matches!(op, Bin::Add | Bin::Mul | Bin::And | Bin::Or)
}

fn sign(op: Bin) -> &'static str {
    match op {
        Bin::Add => "+",
        Bin::Sub => "-",
        Bin::Mul => "*",
        Bin::Div => "/",
        Bin::Rem => "%",
        Bin::And => "&&",
        Bin::Or => "||",
        Bin::Eq => "==",
        Bin::Ne => "!=",
        Bin::Lt => "<",
        Bin::Le => "<=",
        Bin::Gt => ">",
        Bin::Ge => ">=",
    }
}

/// The functions of the prelude that are called, those included that they call.
fn helpers(unit: &Unit, interface: &Interface) -> BTreeSet<Helper> {
    let mut found = BTreeSet::new();
    wholes::expressions(unit, interface, &mut |e| {
        below(e, &mut |e| {
            if let Expr::Call(helper, _) = e {
                found.insert(*helper);
                if matches!(helper, Helper::Least | Helper::Greatest) {
                    found.insert(Helper::IsNan);
                }
            }
        })
    });
    found
}
