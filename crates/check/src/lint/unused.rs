//! `unused-name` and `library-property`: what is declared for nothing.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::ItemKind;

use crate::context::{Cx, Env};
use crate::names::declared;

/// Looks at all statements. A name that begins with an underscore is left alone.
pub(super) fn check(cx: &mut Cx) {
    let names = cx.names;
    for (index, entry) in names.items.iter().enumerate() {
        if entry.library {
            library(cx, index);
            continue;
        }
        let Some(name) = declared(&entry.item.kind) else { continue };
        if name.name.starts_with('_') || cx.graph.is_cyclic(index) || cx.graph.users(index).next().is_some() {
            continue;
        }
        let (what, help) = match &entry.item.kind {
            // What has no property at all is a file for others to use, or one that is only begun.
            ItemKind::Decl(_) | ItemKind::Event(_) | ItemKind::Pattern(_) if cx.spec.properties.is_empty() => continue,
            ItemKind::Decl(_) => {
                ("signal", "its topic is read all the same, and makes instants; remove the line if nothing needs it")
            }
            ItemKind::Event(_) => {
                ("event", "remove the line, or list the event after `over` where it should count as an instant")
            }
            ItemKind::Pattern(_) => ("pattern", "remove it, or call it"),
            ItemKind::Definition(d) if d.each.is_empty() && !cx.graph.is_temporal(index) => (
                "name",
                "it says nothing about time, so it is no property; to have it checked write `property NAME: …`",
            ),
            _ => continue,
        };
        let diagnostic =
            Diagnostic::new(Code::UnusedName, name.span, format!("the {what} `{}` is never used", name.name))
                .label("never used")
                .help(help);
        cx.report(&Env::default(), diagnostic);
    }
}

/// A property in a used file is not judged.
fn library(cx: &mut Cx, index: usize) {
    let item = cx.names.items[index].item;
    if !matches!(item.kind, ItemKind::Property(_)) || cx.graph.users(index).next().is_some() {
        return;
    }
    let diagnostic = Diagnostic::new(Code::LibraryProperty, item.span, "a property in a used file is not checked")
        .label("only declarations and patterns are taken from here")
        .help("make it a pattern, or give the file to `lapwing check` as a specification of its own");
    cx.report(&Env::default(), diagnostic);
}
