//! Rust: a module for `no_std` crates, without `unsafe` and without dependencies, but for `libm` where a formula has trigonometry.

use super::prelude::spelling;
use super::{Syntax, Writer, helpers, objects, wholes};
use crate::Interface;
use crate::code::{Expr, Function, Helper, Ty, Unit};
use crate::interface::{CAUSES, VERDICTS};
use crate::prune::PUBLIC;

pub(super) struct Rust;

impl Syntax for Rust {
    fn ty(&self, ty: Ty) -> &'static str {
        match ty {
            Ty::Bool => "bool",
            Ty::U8 => "u8",
            Ty::U32 => "u32",
            Ty::U64 => "u64",
            Ty::I64 => "i64",
            Ty::F64 => "f64",
        }
    }

    fn float(&self, x: f64) -> String {
        match x {
            _ if x.is_nan() => "f64::NAN".to_owned(),
            f64::INFINITY => "f64::INFINITY".to_owned(),
            f64::NEG_INFINITY => "f64::NEG_INFINITY".to_owned(),
            _ => format!("{x:?}"),
        }
    }

    fn field(&self, name: &str) -> String {
        format!("self.{name}")
    }

    fn element(&self, name: &str, at: &str) -> String {
        match at.parse::<usize>() {
            Ok(_) => format!("self.{name}[{at}]"),
            Err(_) if at.contains(' ') => format!("self.{name}[({at}) as usize]"),
            Err(_) => format!("self.{name}[{at} as usize]"),
        }
    }

    fn input(&self, name: &str) -> String {
        format!("inputs.{name}")
    }

    fn inputs(&self) -> &'static str {
        "inputs"
    }

    fn choose(&self, condition: &str, then: &str, other: &str) -> String {
        format!("if {condition} {{ {then} }} else {{ {other} }}")
    }

    fn brackets_choices(&self) -> bool {
        false
    }

    fn cast(&self, ty: Ty, of: &str) -> String {
        format!("{of} as {}", self.ty(ty))
    }

    fn call(&self, helper: Helper, args: &str) -> String {
        format!("{}({args})", spelling(helper).rust)
    }

    fn same(&self, of: &str, text: &str) -> String {
        format!("{of} == {text:?}")
    }

    fn variable(&self, name: &str, ty: Ty, value: &str, is_set: bool) -> String {
        let word = if is_set { "let mut" } else { "let" };
        format!("{word} {name}: {} = {value};", self.ty(ty))
    }

    fn head(&self, keyword: &str, of: &str) -> String {
        format!("{keyword} {of}")
    }

    fn count_up(&self, name: &str, below: &str) -> String {
        format!("for {name} in 0..{below}")
    }

    fn arm(&self, number: u8) -> String {
        format!("{number} => {{")
    }

    fn arm_end(&self) -> &'static [&'static str] {
        &["}"]
    }

    fn otherwise(&self) -> &'static str {
        "_ => {}"
    }

    fn choice(&self, of: &str) -> String {
        format!("match {of}")
    }

    fn fill(&self, name: &str, value: &str, len: usize) -> Vec<String> {
        vec![format!("self.{name} = [{value}; {len}];")]
    }

    fn call_own(&self, function: &Function, args: &[String]) -> String {
        let mut args = args.to_vec();
        if function.takes_inputs {
            args.push("inputs".to_owned());
        }
        format!("self.{}({});", function.name, args.join(", "))
    }

    fn unread(&self, name: &str) -> String {
        format!("let _ = {name};")
    }
}

/// The text of the module.
pub(crate) fn rust(unit: &Unit, interface: &Interface) -> String {
    let mut w = Writer::new(Rust, unit);
    for line in interface.header("rust") {
        w.line(format!("//! {line}").trim_end());
    }
    w.line("");
    properties(&mut w, interface);
    inputs(&mut w, interface);
    outcomes(&mut w);
    monitor(&mut w);
    for helper in helpers(unit, interface) {
        w.lines(spelling(helper).rust_text);
    }
    wholes::rust_code(&mut w, interface);
    w.text
}

fn properties(w: &mut Writer<'_, Rust>, interface: &Interface) {
    w.line("/// The names of the properties; their numbers are those of [`Monitor::outcome`].");
    w.line(&format!("pub const PROPERTIES: [&str; {}] = [", interface.properties.len()));
    w.inside(|w| interface.properties.iter().for_each(|p| w.line(&format!("{:?},", p.name))));
    w.line("];");
    let (other, ty) = (interface.other_texts(), Rust.ty(interface.codes.ty()));
    for text in &interface.texts {
        w.line("");
        w.comment("///", &format!("The text {:?}, where an input is a text. Any other text {other}.", text.text));
        w.line(&format!("pub const {}: {ty} = {};", text.name, text.code));
    }
    w.line("");
}

fn inputs(w: &mut Writer<'_, Rust>, interface: &Interface) {
    w.comment("///", "What comes with a step. `Inputs::default()` is nothing; set what came, and that it came.");
    w.line("#[derive(Clone, Copy, Default, Debug)]");
    keep_names(w, interface.members.iter().map(|m| m.name.as_str()));
    w.line("pub struct Inputs {");
    w.inside(|w| {
        for member in &interface.members {
            w.comment("///", &member.doc);
            w.line(&format!("pub {}: {},", member.name, Rust.ty(member.ty)));
            if let Some(has) = &member.has {
                w.line("/// Whether that came.");
                w.line(&format!("pub {has}: bool,"));
            }
        }
    });
    w.line("}");
    w.line("");
    setters(w, interface);
}

/// Functions that take what is no number, and work out what the specification asks of it.
fn setters(w: &mut Writer<'_, Rust>, interface: &Interface) {
    if interface.asked().next().is_none() && interface.objects.is_empty() {
        return;
    }
    w.line("impl Inputs {");
    w.inside(|w| {
        wholes::rust(w, interface);
        if interface.asked().next().is_some() && !interface.objects.is_empty() {
            w.line("");
        }
        objects::rust(w, interface);
    });
    w.line("}");
    w.line("");
}

/// Names are the specification's, in whatever case.
fn keep_names<'n>(w: &mut Writer<'_, Rust>, mut names: impl Iterator<Item = &'n str>) {
    if names.any(|name| name.contains(|c: char| c.is_ascii_uppercase())) {
        w.line("#[allow(non_snake_case)]");
    }
}

fn outcomes(w: &mut Writer<'_, Rust>) {
    let mut words = |doc: &str, name: &str, variants: &[(&str, &str)]| {
        w.comment("///", doc);
        w.line("#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]");
        w.line(&format!("pub enum {name} {{"));
        w.inside(|w| {
            for (variant, doc) in variants {
                w.comment("///", doc);
                w.line(&format!("{},", camel(variant)));
            }
        });
        w.line("}");
        w.line("");
    };
    words("What is said of a property, from the worst to the best.", "Verdict", VERDICTS);
    words("Why a property is inconclusive.", "Cause", CAUSES);
    w.lines(OUTCOME);
}

/// `no_value` as a variant.
fn camel(name: &str) -> String {
    let capital = |word: &str| word.get(..1).unwrap_or("").to_uppercase() + word.get(1..).unwrap_or("");
    name.split('_').map(capital).collect()
}

const OUTCOME: &str = "\
/// What became of a property.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Outcome {
    /// The verdict.
    pub verdict: Verdict,
    /// Why it is inconclusive, where it is.
    pub cause: Cause,
    /// Obligations met, failed and open.
    pub met: u64,
    /// See `met`.
    pub failed: u64,
    /// See `met`.
    pub open: u64,
    /// When the obligation began that failed first, in nanoseconds; 0 where none failed.
    pub first_began: i64,
    /// When it failed.
    pub first_failed: i64,
}
";

fn monitor(w: &mut Writer<'_, Rust>) {
    w.line("");
    w.line("/// The monitors: all that they remember.");
    w.line("#[derive(Clone, Debug)]");
    keep_names(w, w.unit.fields.iter().map(|f| f.name.as_str()));
    w.line("pub struct Monitor {");
    w.inside(|w| {
        for field in &w.unit.fields {
            let ty = Rust.ty(field.ty);
            w.comment("///", &field.doc);
            w.line(&match field.len {
                Some(len) => format!("{}: [{ty}; {len}],", field.name),
                None => format!("{}: {ty},", field.name),
            });
        }
    });
    w.line("}");
    w.lines("\nimpl Default for Monitor {\n    fn default() -> Monitor {\n        Monitor::new()\n    }\n}\n\nimpl Monitor {");
    w.inside(|w| {
        w.line("/// Nothing has come yet.");
        w.line("pub const fn new() -> Monitor {");
        w.inside(|w| {
            w.line("Monitor {");
            w.inside(|w| {
                for field in &w.unit.fields {
                    let value = w.expr(&field.initial);
                    w.line(&match field.len {
                        Some(len) => format!("{}: [{value}; {len}],", field.name),
                        None => format!("{}: {value},", field.name),
                    });
                }
            });
            w.line("}");
        });
        w.line("}");
        w.unit.functions.iter().for_each(|f| function(w, f));
        w.line("");
        w.lines(&outcome());
    });
    w.line("}");
}

fn function(w: &mut Writer<'_, Rust>, function: &Function) {
    let public = PUBLIC.contains(&function.name.as_str());
    let mut params = vec!["&mut self".to_owned()];
    params.extend(function.params.iter().map(|(name, ty)| format!("{name}: {}", Rust.ty(*ty))));
    if function.takes_inputs {
        params.push("inputs: &Inputs".to_owned());
    }
    w.line("");
    w.comment("///", &function.doc);
    let word = if public { "pub fn" } else { "fn" };
    w.line(&format!("{word} {}({}) {{", function.name, params.join(", ")));
    w.inside(|w| w.body(function));
    w.line("}");
}

/// The function that reads an outcome out of the fields.
fn outcome() -> String {
    let words = |name: &str, all: &[(&str, &str)]| {
        let arms = all.iter().enumerate().skip(1);
        let arms = arms.map(|(i, (word, _))| format!("            {i} => {name}::{},\n", camel(word)));
        format!("{}            _ => {name}::{},\n", arms.collect::<String>(), camel(all[0].0))
    };
    format!(
        "\
/// What became of a property, as of the last call of `end`; `None` where there is no property of that number.
pub fn outcome(&self, property: usize) -> Option<Outcome> {{
    Some(Outcome {{
        verdict: match *self.verdict.get(property)? {{
{}        }},
        cause: match *self.cause.get(property)? {{
{}        }},
        met: *self.met.get(property)?,
        failed: *self.failed.get(property)?,
        open: *self.open.get(property)?,
        first_began: *self.first_began.get(property)?,
        first_failed: *self.first_failed.get(property)?,
    }})
}}

/// How many obligations of a property have failed so far; 0 where there is no property of that number.
pub fn failures(&self, property: usize) -> u64 {{
    self.failed.get(property).copied().unwrap_or(0)
}}",
        words("Verdict", VERDICTS),
        words("Cause", CAUSES)
    )
}

/// Whether an expression calls what only the crate `libm` has.
pub(crate) fn needs_libm(e: &Expr) -> bool {
    matches!(e, Expr::Call(helper, _) if spelling(*helper).rust.starts_with("libm::"))
}
