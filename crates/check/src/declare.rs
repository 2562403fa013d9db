//! The declarations of signals, models, ground truth and patterns, checked whether anyone uses them or not.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{ItemKind, Pattern};

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

/// Reads the named expressions that nothing uses, for the faults in them: without a trace, where nothing else comes of it.
pub(crate) fn unused_definitions(cx: &mut Cx) {
    let names = cx.names;
    for (index, entry) in names.items.iter().enumerate() {
        let ItemKind::Definition(definition) = &entry.item.kind else { continue };
        let unused = cx.graph.users(index).next().is_none() && !cx.graph.is_cyclic(index);
        if unused && !is_judged(cx, index, &definition.each) {
            cx.apart(|cx| cx.lower(&Env::default(), &definition.body));
        }
    }
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
