//! Arrays, of which no more is kept than what is asked of them: how many elements there are, the least and the greatest, one by its number,
//! whether something is true of any or of all. Each of these becomes an input of its own, and a function that is handed the array works
//! them all out, so that arrays of every length need the same memory.

use lapwing_check::checked::{self, Arith, Body, Connective, Func, Input, Kind, Read, ReadOf, Spec};
use lapwing_engine::program::Compare;
use lapwing_stream::Type;

use crate::code::{Expr, Helper, call, local};
use crate::interface::identifier;
use crate::value::compare;

/// An array that is handed over as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// What the specification calls it.
    pub label: String,
    /// The input of the checked specification that it is.
    pub input: usize,
    /// The function that takes it; in C the prefix and `_` stand before that.
    pub setter: String,
    pub(crate) parts: Vec<Part>,
}

/// Something that is asked of an array.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// The input that stands for it.
    pub input: usize,
    pub what: What,
}

/// What is asked. Elements that are NaN are none, but where they are asked for by their number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    Length,
    Least,
    Greatest,
    Element(usize),
    /// Of an element that is called `x`.
    Any(Expr),
    All(Expr),
}

/// Puts inputs of their own in the place of what a specification asks of arrays.
pub(crate) fn unfold(spec: &mut Spec) -> Vec<Array> {
    let mut arrays = Vec::new();
    let Spec { inputs, properties, machines, .. } = spec;
    for property in properties.iter_mut() {
        if let Body::Formula(formula) = &mut property.body {
            unfold_in(formula, inputs, &mut arrays);
        }
    }
    for machine in machines.iter_mut() {
        let states = machine.states.iter_mut().filter_map(|s| s.when.as_mut());
        let edges = machine.edges.iter_mut().filter_map(|e| e.when.as_mut());
        machine.sample.iter_mut().chain(states).chain(edges).for_each(|e| unfold_in(e, inputs, &mut arrays));
    }
    // What waited for an array waits for its parts, which all come with it.
    let reads = properties.iter_mut().map(|p| &mut p.reads).chain(machines.iter_mut().map(|m| &mut m.reads));
    for reads in reads {
        for array in &arrays {
            let of = |read: &Read| read.what == ReadOf::Input(array.input);
            let Some(read) = reads.iter().copied().find(of) else { continue };
            reads.retain(|read| !of(read));
            reads.extend(array.parts.iter().map(|part| Read { what: ReadOf::Input(part.input), ..read }));
        }
    }
    arrays
}

fn unfold_in(e: &mut checked::Expr, inputs: &mut Vec<Input>, arrays: &mut Vec<Array>) {
    let Some((array, what)) = asked(e, inputs) else {
        e.children_mut().into_iter().for_each(|c| unfold_in(c, inputs, arrays));
        return;
    };
    let of = match arrays.iter_mut().position(|known| known.input == array) {
        Some(at) => at,
        None => {
            let label = inputs[array].label.clone();
            let setter = format!("set_{}", identifier(&label));
            let setter = match arrays.iter().any(|known| known.setter == setter) {
                true => format!("{setter}_{}", arrays.len()),
                false => setter,
            };
            arrays.push(Array { label, input: array, setter, parts: Vec::new() });
            arrays.len() - 1
        }
    };
    let parts = &mut arrays[of].parts;
    let input = match parts.iter().find(|part| part.what == what) {
        Some(part) => part.input,
        None => {
            let label = what.label(&inputs[array].label);
            let ty = if what.body().is_some() { Type::Bool } else { Type::Num { float: true } };
            inputs.push(Input { label, ty, dim: e.dim, ..inputs[array].clone() });
            parts.push(Part { input: inputs.len() - 1, what });
            inputs.len() - 1
        }
    };
    e.kind = Kind::Input(input);
}

/// What an expression asks of which array, if it is no more than that.
fn asked(e: &checked::Expr, inputs: &[Input]) -> Option<(usize, What)> {
    let array = |of: &checked::Expr| match of.kind {
        Kind::Input(i) => inputs.get(i).filter(|input| is_array(input)).map(|_| i),
        _ => None,
    };
    match &e.kind {
        Kind::Call(Func::Len, args) => Some((array(args.first()?)?, What::Length)),
        Kind::Call(Func::MinOf, args) => Some((array(args.first()?)?, What::Least)),
        Kind::Call(Func::MaxOf, args) => Some((array(args.first()?)?, What::Greatest)),
        Kind::Index(of, n) => Some((array(of)?, What::Element(*n))),
        Kind::Quantified { all, array: of, body } => {
            let body = of_element(body)?;
            Some((array(of)?, if *all { What::All(body) } else { What::Any(body) }))
        }
        _ => None,
    }
}

/// An array of numbers. What no type tells of is one, as long as it is only asked what arrays are asked; where its elements are compared with texts that
/// is refused as a comparison of values of two kinds.
fn is_array(input: &Input) -> bool {
    let may_be = match &input.ty {
        Type::Array(of) => matches!(**of, Type::Num { .. }),
        ty => *ty == Type::Any,
    };
    may_be && input.default.is_none()
}

/// What is said of an element, where it depends on nothing else.
fn of_element(e: &checked::Expr) -> Option<Expr> {
    Some(match &e.kind {
        Kind::Num(x) => Expr::Float(*x),
        Kind::Bool(b) => Expr::Bool(*b),
        Kind::Var(0) => local("x"),
        Kind::Neg(of) => Expr::Neg(Box::new(of_element(of)?)),
        Kind::Arith(op, l, r) => {
            let (l, r) = (of_element(l)?, of_element(r)?);
            match op {
                Arith::Add => l + r,
                Arith::Sub => l - r,
                Arith::Mul => l.mul(r),
                Arith::Div => l.div(r),
            }
        }
        Kind::Compare { op, margin, left, right } => {
            // An element is a number; of a truth value or a text it is not known whether it is one.
            let is_number = |e: &checked::Expr| matches!((&e.kind, &e.ty), (Kind::Var(0), _) | (_, Type::Num { .. }));
            if !is_number(left) || !is_number(right) {
                return None;
            }
            let margin = match margin {
                Some(margin) => Some(of_element(margin)?),
                None => None,
            };
            compare(operator(*op), of_element(left)?, of_element(right)?, margin)
        }
        Kind::Call(Func::Abs, args) => call(Helper::Abs, vec![of_element(args.first()?)?]),
        Kind::Not(of) => !of_element(of)?,
        Kind::Connective(op, l, r) => {
            let (l, r) = (of_element(l)?, of_element(r)?);
            match op {
                Connective::And => l & r,
                Connective::Or => l | r,
                Connective::Implies => !l | r,
                Connective::Iff => l.same(r),
            }
        }
        _ => return None,
    })
}

fn operator(op: checked::Compare) -> Compare {
    match op {
        checked::Compare::Eq => Compare::Eq,
        checked::Compare::Ne => Compare::Ne,
        checked::Compare::Lt => Compare::Lt,
        checked::Compare::Le => Compare::Le,
        checked::Compare::Gt => Compare::Gt,
        checked::Compare::Ge => Compare::Ge,
    }
}

impl What {
    fn label(&self, array: &str) -> String {
        match self {
            What::Length => format!("len({array})"),
            What::Least => format!("min({array})"),
            What::Greatest => format!("max({array})"),
            What::Element(n) => format!("{array}[{n}]"),
            What::Any(_) => format!("any({array})"),
            What::All(_) => format!("all({array})"),
        }
    }

    /// What is said of each element.
    pub fn body(&self) -> Option<&Expr> {
        match self {
            What::Any(body) | What::All(body) => Some(body),
            _ => None,
        }
    }
}
