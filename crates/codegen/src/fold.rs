//! What is constant is worked out beforehand: variables that nothing sets again, and all that follows from them.

use std::collections::{BTreeMap, BTreeSet};

use crate::code::{Bin, Block, Expr, Helper, Stmt};

/// Works out what is constant in the body of a function.
pub(crate) fn fold(body: Vec<Stmt>) -> Vec<Stmt> {
    let mut set = BTreeSet::new();
    sets(&body, &mut set);
    let mut known = BTreeMap::new();
    Block::of(|b| statements(body, &set, &mut known, b)).0
}

/// The variables that are set after they began.
fn sets(body: &[Stmt], found: &mut BTreeSet<String>) {
    for statement in body {
        match statement {
            Stmt::Set(Expr::Local(name), _) => drop(found.insert(name.clone())),
            Stmt::If(_, then, other) => [then, other].into_iter().for_each(|body| sets(body, found)),
            Stmt::While(_, body) | Stmt::For(_, _, body) => sets(body, found),
            Stmt::Match(_, arms) => arms.iter().for_each(|(_, body)| sets(body, found)),
            _ => {}
        }
    }
}

type Known = BTreeMap<String, Expr>;

fn statements(body: Vec<Stmt>, set: &BTreeSet<String>, known: &mut Known, b: &mut Block) {
    for statement in body {
        let inner = |body: Vec<Stmt>, known: &mut Known| Block::of(|b| statements(body, set, known, b)).0;
        match statement {
            Stmt::Let { name, ty, value, .. } => {
                let (value, is_set) = (expr(value, known), set.contains(&name));
                match value {
                    Expr::Bool(_) | Expr::Int(_) if !is_set => drop(known.insert(name, value)),
                    value => b.0.push(Stmt::Let { name, ty, value, is_set }),
                }
            }
            Stmt::Set(place, value) => b.0.push(Stmt::Set(expr(place, known), expr(value, known))),
            Stmt::If(condition, then, other) => {
                let (then, other) = (inner(then, known), inner(other, known));
                b.branch(expr(condition, known), |b| b.0 = then, |b| b.0 = other);
            }
            Stmt::While(condition, body) => b.0.push(Stmt::While(expr(condition, known), inner(body, known))),
            Stmt::For(name, below, body) => b.0.push(Stmt::For(name, expr(below, known), inner(body, known))),
            Stmt::Match(of, arms) => {
                let arms = arms.into_iter().map(|(n, body)| (n, inner(body, known))).collect();
                b.0.push(Stmt::Match(expr(of, known), arms));
            }
            Stmt::Fill(name, value) => b.0.push(Stmt::Fill(name, expr(value, known))),
            Stmt::Do(name, args) => b.0.push(Stmt::Do(name, args.into_iter().map(|a| expr(a, known)).collect())),
            Stmt::Comment(_) | Stmt::Return => b.0.push(statement),
        }
    }
}

fn expr(e: Expr, known: &Known) -> Expr {
    rewrite(e, &|leaf| match leaf {
        Expr::Local(name) => known.get(&name).cloned().unwrap_or(Expr::Local(name)),
        leaf => leaf,
    })
}

/// An expression with others in place of its leaves, and what is constant then worked out.
pub(crate) fn rewrite(e: Expr, leaf: &impl Fn(Expr) -> Expr) -> Expr {
    let again = |e: Box<Expr>| rewrite(*e, leaf);
    match e {
        Expr::Bool(_) | Expr::Int(_) | Expr::Float(_) | Expr::Local(_) | Expr::Field(_) | Expr::Input(_) => leaf(e),
        Expr::Elem(name, at) => Expr::Elem(name, Box::new(again(at))),
        Expr::Not(of) => !again(of),
        Expr::Neg(of) => Expr::Neg(Box::new(again(of))),
        Expr::As(ty, of) => Expr::As(ty, Box::new(again(of))),
        Expr::Choose(c, a, b) => again(c).choose(again(a), again(b)),
        Expr::Call(helper, args) => Expr::Call(helper, args.into_iter().map(|a| rewrite(a, leaf)).collect()),
        Expr::Same(of, text) => Expr::Same(Box::new(again(of)), text),
        Expr::Bin(op, a, b) => binary(op, again(a), again(b)),
    }
}

fn binary(op: Bin, a: Expr, b: Expr) -> Expr {
    match (op, a, b) {
        (Bin::And, a, b) => a & b,
        (Bin::Or, a, b) => a | b,
        (Bin::Eq, Expr::Int(a), Expr::Int(b)) => Expr::Bool(a == b),
        // A distance is never negative.
        (Bin::Ge, Expr::Call(Helper::Since, _), Expr::Int(0)) => Expr::Bool(true),
        (Bin::Lt, Expr::Call(Helper::Since, _), Expr::Int(0)) => Expr::Bool(false),
        (Bin::Add, e, Expr::Int(0)) => e,
        (op, a, b) => a.bin(op, b),
    }
}
