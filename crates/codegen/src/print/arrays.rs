//! Functions that take an array and work out what is asked of it.

use crate::Interface;
use crate::arrays::{Array, What};
use crate::code::{Expr, Unit};
use crate::interface::{From, Member};

use super::c::C;
use super::rust::Rust;
use super::{Syntax, Writer};

impl Interface {
    /// The arrays that something is asked of, each with its parts and the members that these become.
    pub(crate) fn asked(&self) -> impl Iterator<Item = (&Array, Vec<(&Member, &What)>)> {
        let member = |input: usize| self.members.iter().find(move |m| m.from == From::Input(input));
        self.arrays.iter().filter_map(move |array| {
            let parts: Vec<_> = array.parts.iter().filter_map(|p| Some((member(p.input)?, &p.what))).collect();
            (!parts.is_empty()).then_some((array, parts))
        })
    }

    /// What is said of elements of arrays.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = &Expr> {
        self.arrays.iter().flat_map(|array| &array.parts).filter_map(|part| part.what.body())
    }
}

fn doc(array: &Array) -> String {
    format!("The array `{}` came: works out what is asked of it, and keeps no more of it than that.", array.label)
}

/// As methods of what comes with a step.
pub(super) fn rust(w: &mut Writer<'_, Rust>, interface: &Interface) {
    if interface.asked().next().is_none() {
        return;
    }
    w.line("impl Inputs {");
    for (number, (array, parts)) in interface.asked().enumerate() {
        if number > 0 {
            w.line("");
        }
        w.inside(|w| {
            w.comment("///", &doc(array));
            w.line(&format!("pub fn {}(&mut self, of: &[f64]) {{", array.setter));
            w.inside(|w| parts.iter().for_each(|(member, what)| rust_part(w, member, what)));
            w.line("}");
        });
    }
    w.line("}");
    w.line("");
}

fn rust_part(w: &mut Writer<'_, Rust>, member: &Member, what: &What) {
    let name = &member.name;
    let of_all = |sign: &str| {
        format!("of.iter().fold(f64::NAN, |best, &x| if x.is_nan() || x {sign} best {{ best }} else {{ x }})")
    };
    let value = match what {
        What::Length => "of.len() as f64".to_owned(),
        What::Least => of_all(">="),
        What::Greatest => of_all("<="),
        What::Element(n) => format!("of.get({n}).copied().unwrap_or(f64::NAN)"),
        What::Any(body) => format!("of.iter().any(|&x| !x.is_nan() && {})", w.operand(body, None)),
        What::All(body) => format!("of.iter().all(|&x| x.is_nan() || {})", w.operand(body, None)),
    };
    w.line(&format!("self.{name} = {value};"));
    if let Some(has) = &member.has {
        w.line(&format!("self.{has} = true;"));
    }
}

/// As functions on what comes with a step: their declarations for the header.
pub(super) fn c_header(w: &mut Writer<'_, C>, interface: &Interface) {
    for (array, _) in interface.asked() {
        w.line("");
        w.comment("//", &doc(array));
        let line = format!("{};", c_signature(w, array));
        w.line(&line);
    }
}

/// See [`c_header`]: the functions.
pub(super) fn c_source(w: &mut Writer<'_, C>, interface: &Interface) {
    for (array, parts) in interface.asked() {
        w.line("");
        let line = format!("{} {{", c_signature(w, array));
        w.line(&line);
        w.inside(|w| {
            if parts.iter().all(|(_, what)| **what == What::Length) {
                w.line("(void)of;");
            }
            parts.iter().for_each(|(member, what)| c_part(w, member, what));
        });
        w.line("}");
    }
}

fn c_signature(w: &Writer<'_, C>, array: &Array) -> String {
    let prefix = &w.syntax.prefix;
    format!("void {prefix}_{}({prefix}_inputs *in, const double *of, uint32_t count)", array.setter)
}

fn c_part(w: &mut Writer<'_, C>, member: &Member, what: &What) {
    let (to, nan) = (format!("in->{}", member.name), w.syntax.float(f64::NAN));
    let (first, step) = match what {
        What::Length => ("(double)count".to_owned(), None),
        What::Element(n) => (format!("count > {n} ? of[{n}] : {nan}"), None),
        What::Least => (nan, Some((format!("x == x && !(x >= {to})"), "x".to_owned()))),
        What::Greatest => (nan, Some((format!("x == x && !(x <= {to})"), "x".to_owned()))),
        What::Any(body) => {
            ("false".to_owned(), Some((format!("x == x && {}", w.operand(body, None)), "true".to_owned())))
        }
        What::All(body) => ("true".to_owned(), Some((format!("x == x && !({})", w.expr(body)), "false".to_owned()))),
    };
    w.line(&format!("{to} = {first};"));
    if let Some((condition, value)) = step {
        w.line("for (uint32_t i = 0; i < count; i++) {");
        w.inside(|w| {
            w.line("const double x = of[i];");
            w.line(&format!("if ({condition}) {{"));
            w.inside(|w| w.line(&format!("{to} = {value};")));
            w.line("}");
        });
        w.line("}");
    }
    if let Some(has) = &member.has {
        w.line(&format!("in->{has} = true;"));
    }
}

/// Shows what functions that take arrays compute, so that they get what they call.
pub(super) fn expressions<'e>(unit: &'e Unit, interface: &'e Interface, see: &mut impl FnMut(&Expr)) {
    unit.functions.iter().for_each(|f| crate::prune::reads(&f.body, &mut *see));
    interface.bodies().for_each(see);
}
