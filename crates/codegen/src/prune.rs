//! What nobody reads is not written: variables without a reader, branches without a statement.

use std::collections::BTreeSet;

use crate::code::{Expr, Function, Stmt, Unit};
use crate::fold::fold;

/// Removes the variables of a function's body that nothing reads, and statements that do nothing.
pub(crate) fn prune(body: Vec<Stmt>) -> Vec<Stmt> {
    block(body, &mut BTreeSet::new())
}

/// Walks backwards; `read` holds what the statements after read.
fn block(body: Vec<Stmt>, read: &mut BTreeSet<String>) -> Vec<Stmt> {
    let mut kept = Vec::new();
    for statement in body.into_iter().rev() {
        if let Some(statement) = one(statement, read) {
            kept.push(statement);
        }
    }
    kept.reverse();
    kept
}

fn one(statement: Stmt, read: &mut BTreeSet<String>) -> Option<Stmt> {
    match statement {
        Stmt::Let { ref name, ref value, .. } => {
            if !read.contains(name) {
                return None;
            }
            locals(value, read);
        }
        Stmt::Set(Expr::Local(ref name), ref value) => {
            if !read.contains(name) {
                return None;
            }
            locals(value, read);
        }
        Stmt::Set(ref place, ref value) => [place, value].into_iter().for_each(|e| locals(e, read)),
        Stmt::If(condition, then, other) => {
            let (then, other) = (block(then, read), block(other, read));
            if is_idle(&then) && is_idle(&other) {
                return None;
            }
            locals(&condition, read);
            return Some(Stmt::If(condition, then, other));
        }
        // What a loop's body reads, an earlier round of it may have set.
        Stmt::While(condition, body) => {
            locals(&condition, read);
            reads(&body, &mut |e| locals(e, read));
            return Some(Stmt::While(condition, block(body, read)));
        }
        Stmt::For(name, below, body) => {
            locals(&below, read);
            reads(&body, &mut |e| locals(e, read));
            return Some(Stmt::For(name, below, block(body, read)));
        }
        Stmt::Match(of, arms) => {
            let arms: Vec<_> = arms.into_iter().map(|(n, body)| (n, block(body, read))).collect();
            if arms.iter().all(|(_, body)| is_idle(body)) {
                return None;
            }
            locals(&of, read);
            return Some(Stmt::Match(of, arms));
        }
        Stmt::Fill(_, ref value) => locals(value, read),
        Stmt::Do(_, ref args) => args.iter().for_each(|e| locals(e, read)),
        Stmt::Comment(_) | Stmt::Return => {}
    }
    Some(statement)
}

fn is_idle(body: &[Stmt]) -> bool {
    body.iter().all(|s| matches!(s, Stmt::Comment(_)))
}

/// Shows every expression in statements.
pub(crate) fn reads(body: &[Stmt], see: &mut impl FnMut(&Expr)) {
    for statement in body {
        match statement {
            Stmt::Let { value, .. } | Stmt::Fill(_, value) => see(value),
            // A variable that is set is read only where its value is asked for.
            Stmt::Set(Expr::Local(_), value) => see(value),
            Stmt::Set(place, value) => {
                see(place);
                see(value);
            }
            Stmt::If(condition, then, other) => {
                see(condition);
                reads(then, see);
                reads(other, see);
            }
            Stmt::While(condition, body) | Stmt::For(_, condition, body) => {
                see(condition);
                reads(body, see);
            }
            Stmt::Match(of, arms) => {
                see(of);
                arms.iter().for_each(|(_, body)| reads(body, see));
            }
            Stmt::Do(_, args) => args.iter().for_each(&mut *see),
            Stmt::Comment(_) | Stmt::Return => {}
        }
    }
}

/// Shows an expression and all below it.
pub(crate) fn below(e: &Expr, see: &mut impl FnMut(&Expr)) {
    see(e);
    match e {
        Expr::Elem(_, of) | Expr::Not(of) | Expr::Neg(of) | Expr::As(_, of) | Expr::Same(of, _) => below(of, see),
        Expr::Bin(_, a, b) => [a, b].into_iter().for_each(|e| below(e, see)),
        Expr::Choose(a, b, c) => [a, b, c].into_iter().for_each(|e| below(e, see)),
        Expr::Call(_, args) => args.iter().for_each(|e| below(e, see)),
        Expr::Bool(_) | Expr::Int(_) | Expr::Float(_) | Expr::Local(_) | Expr::Field(_) | Expr::Input(_) => {}
    }
}

fn locals(e: &Expr, into: &mut BTreeSet<String>) {
    below(e, &mut |e| {
        if let Expr::Local(name) = e {
            into.insert(name.clone());
        }
    });
}

/// Whether statements read a member of what comes with a step.
pub(crate) fn reads_inputs(body: &[Stmt]) -> bool {
    let mut found = false;
    reads(body, &mut |e| below(e, &mut |e| found |= matches!(e, Expr::Input(_))));
    found
}

/// The variables that statements read.
pub(crate) fn locals_of(body: &[Stmt]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    reads(body, &mut |e| locals(e, &mut found));
    found
}

/// Removes the functions that nothing calls, and the fields that nothing reads, but for those kept, and what sets them.
pub(crate) fn without_unread(mut unit: Unit, kept: &[&str]) -> Unit {
    loop {
        drop_uncalled(&mut unit);
        let mut read: BTreeSet<String> = kept.iter().map(|name| (*name).to_owned()).collect();
        unit.functions.iter().for_each(|f| fields_read(&f.body, &mut read));
        let before = unit.fields.len();
        unit.fields.retain(|f| read.contains(&f.name));
        if unit.fields.len() == before {
            return unit;
        }
        for function in &mut unit.functions {
            let body = std::mem::take(&mut function.body);
            function.body = prune(fold(without_sets(body, &read)));
        }
        drop_idle_functions(&mut unit);
    }
}

/// The functions that callers call.
pub(crate) const PUBLIC: [&str; 3] = ["step", "advance", "end"];

fn drop_uncalled(unit: &mut Unit) {
    let mut called: BTreeSet<String> = PUBLIC.iter().map(|name| (*name).to_owned()).collect();
    // Each calls only those before it.
    for function in unit.functions.iter().rev() {
        if called.contains(&function.name) {
            calls(&function.body, &mut called);
        }
    }
    unit.functions.retain(|f| called.contains(&f.name));
}

fn calls(body: &[Stmt], found: &mut BTreeSet<String>) {
    for statement in body {
        match statement {
            Stmt::Do(name, _) => drop(found.insert(name.clone())),
            Stmt::If(_, then, other) => [then, other].into_iter().for_each(|body| calls(body, found)),
            Stmt::While(_, body) | Stmt::For(_, _, body) => calls(body, found),
            Stmt::Match(_, arms) => arms.iter().for_each(|(_, body)| calls(body, found)),
            _ => {}
        }
    }
}

/// What does nothing any more is not called.
fn drop_idle_functions(unit: &mut Unit) {
    let idle = |f: &Function| is_idle(&f.body) && !PUBLIC.contains(&f.name.as_str());
    let idle: Vec<String> = unit.functions.iter().filter(|f| idle(f)).map(|f| f.name.clone()).collect();
    if idle.is_empty() {
        return;
    }
    unit.functions.retain(|f| !idle.contains(&f.name));
    for function in &mut unit.functions {
        let body = std::mem::take(&mut function.body);
        function.body = prune(each(body, &|s| !matches!(s, Stmt::Do(name, _) if idle.contains(name))));
    }
}

fn without_sets(body: Vec<Stmt>, read: &BTreeSet<String>) -> Vec<Stmt> {
    each(body, &|s| match s {
        Stmt::Set(Expr::Field(name) | Expr::Elem(name, _), _) | Stmt::Fill(name, _) => read.contains(name),
        _ => true,
    })
}

/// Keeps some of the statements, at every depth.
fn each(body: Vec<Stmt>, keep: &dyn Fn(&Stmt) -> bool) -> Vec<Stmt> {
    let inner = |s: Stmt| match s {
        Stmt::If(c, then, other) => Stmt::If(c, each(then, keep), each(other, keep)),
        Stmt::While(c, body) => Stmt::While(c, each(body, keep)),
        Stmt::For(name, below, body) => Stmt::For(name, below, each(body, keep)),
        Stmt::Match(of, arms) => Stmt::Match(of, arms.into_iter().map(|(n, body)| (n, each(body, keep))).collect()),
        s => s,
    };
    body.into_iter().filter(|s| keep(s)).map(inner).collect()
}

/// The fields that statements read: what is only set is not.
fn fields_read(body: &[Stmt], into: &mut BTreeSet<String>) {
    let mut note = |e: &Expr| {
        below(e, &mut |e| {
            if let Expr::Field(name) | Expr::Elem(name, _) = e {
                into.insert(name.clone());
            }
        });
    };
    reads_but_places(body, &mut note);
}

/// As [`reads`], but of a place that is set only its index; `x = x + 1` reads nothing.
fn reads_but_places(body: &[Stmt], see: &mut impl FnMut(&Expr)) {
    for statement in body {
        match statement {
            Stmt::Set(place, value) => {
                if let Expr::Elem(_, at) = place {
                    see(at);
                }
                match value {
                    Expr::Bin(_, left, right) if **left == *place => see(right),
                    value => see(value),
                }
            }
            Stmt::If(condition, then, other) => {
                see(condition);
                reads_but_places(then, see);
                reads_but_places(other, see);
            }
            Stmt::While(condition, body) | Stmt::For(_, condition, body) => {
                see(condition);
                reads_but_places(body, see);
            }
            Stmt::Match(of, arms) => {
                see(of);
                arms.iter().for_each(|(_, body)| reads_but_places(body, see));
            }
            other => reads(std::slice::from_ref(other), see),
        }
    }
}
