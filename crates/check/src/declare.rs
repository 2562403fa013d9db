//! The declarations of signals, models, ground truth and patterns, checked whether anyone uses them or not.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{Expr, ItemKind, Pattern};

use crate::call::is_function;
use crate::context::{Cx, Env};
use crate::property::is_judged;
use crate::world;

/// Checks all declarations, and reads the topics that they name: what is declared is read.
pub(crate) fn check(cx: &mut Cx) {
    let env = Env::default();
    let names = cx.names;
    for entry in &names.items {
        match &entry.item.kind {
            ItemKind::Decl(decl) => {
                let ((), _) = cx.apart(|cx| {
                    let place = cx.declared(&env, decl, decl.topic.span);
                    if let Some(place) = place.filter(|_| cx.schemaless()) {
                        place.declare_topic(cx, &decl.topic);
                    }
                });
            }
            ItemKind::Pattern(pattern) => shadows_function(cx, &env, pattern),
            _ => {}
        }
    }
    cx.apart(world::declare_models);
    cx.apart(world::declare_sources);
}

/// Reads the named expressions and the patterns that nothing uses, for the faults in them: without a trace, where nothing else
/// comes of it. What is used by another of them is read with that.
pub(crate) fn unused(cx: &mut Cx) {
    let names = cx.names;
    let own = |&index: &usize| !names.items[index].shipped && !cx.graph.is_cyclic(index);
    let (used, unused): (Vec<usize>, Vec<usize>) =
        (0..names.items.len()).filter(own).partition(|&index| cx.graph.users(index).next().is_some());
    for index in unused {
        match &names.items[index].item.kind {
            ItemKind::Definition(d) if !is_judged(cx, index, &d.each) => aside(cx, &Env::default(), &d.body),
            ItemKind::Pattern(pattern) => by_itself(cx, pattern),
            _ => {}
        }
    }
    for index in used {
        match &names.items[index].item.kind {
            ItemKind::Pattern(pattern) if !cx.expanded.contains(&index) => by_itself(cx, pattern),
            _ => {}
        }
    }
}

/// Reads a pattern whatever its arguments will be: for what none of them could cure.
fn by_itself(cx: &mut Cx, pattern: &Pattern) {
    let env = Env { unknown: &pattern.params, sampling: true, ..Env::default() };
    aside(cx, &env, &pattern.body);
}

/// Reads an expression for the faults in it.
fn aside(cx: &mut Cx, env: &Env, expr: &Expr) {
    cx.aside(|cx| cx.lower(env, expr));
}

fn shadows_function(cx: &mut Cx, env: &Env, pattern: &Pattern) {
    let name = &pattern.name;
    if is_function(&name.name) {
        let message = format!("`{}` is the name of a function", name.name);
        cx.report(env, Diagnostic::new(Code::DuplicateName, name.span, message).label("give the pattern another name"));
    }
    for (index, param) in pattern.params.iter().enumerate() {
        if let Some(first) = pattern.params[..index].iter().find(|p| p.name == param.name) {
            let diagnostic = Diagnostic::new(
                Code::DuplicateName,
                param.span,
                format!("the parameter `{}` stands twice", param.name),
            )
            .also(first.span, "first here");
            cx.report(env, diagnostic);
        }
    }
}
