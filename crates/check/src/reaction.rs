//! Reactions and guards: whether what they name is there, and their actions in words.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast::{Action, Guard, Ident, ItemKind, Reaction, TypePath};

use crate::checked;
use crate::context::{Cx, Env};
use crate::definitions::Half;
use crate::message;
use crate::names::declared;
use crate::property::is_judged;
use lapwing_diag::suggest;

/// Reads the reactions and guards of the file.
pub(crate) fn read(cx: &mut Cx) {
    let names = cx.names;
    let env = Env::default();
    for entry in names.items.iter().filter(|e| !e.library) {
        let reaction = match &entry.item.kind {
            ItemKind::Reaction(reaction) => on_violation(cx, &env, reaction, entry.item.span),
            ItemKind::Guard(guard) => of_guard(cx, &env, guard, entry.item.span),
            _ => continue,
        };
        cx.spec.reactions.push(reaction);
    }
}

fn on_violation(cx: &mut Cx, env: &Env, reaction: &Reaction, span: Span) -> checked::Reaction {
    property(cx, env, &reaction.property);
    let at_most_every = reaction.at_most_every.as_ref().and_then(|d| cx.duration(env, d));
    let actions = reaction.actions.iter().map(|action| self::action(cx, env, action)).collect();
    checked::Reaction { property: reaction.property.name.clone(), at_most_every, actions, span }
}

fn of_guard(cx: &mut Cx, env: &Env, guard: &Guard, span: Span) -> checked::Reaction {
    property(cx, env, &guard.property);
    cx.topic(&guard.from.absolute(), guard.from.span);
    cx.topic(&guard.to.absolute(), guard.to.span);
    if guard.to.absolute() == guard.from.absolute() {
        let diagnostic =
            Diagnostic::new(Code::Misplaced, guard.from.span, "a guard passes messages from one topic to another")
                .label("this is the topic that is guarded")
                .help("let the sender publish on another topic, and name that after `from`");
        cx.report(env, diagnostic);
    }
    let instead = guard.instead.as_ref();
    let action = checked::Action::Guard(checked::Guard {
        to: guard.to.absolute(),
        from: guard.from.absolute(),
        instead: instead.map(|(ty, message)| message::read(cx, env, &guard.to, ty, Half::Whole, message)),
        fail_open: guard.fail_open,
    });
    checked::Reaction { property: guard.property.name.clone(), at_most_every: None, actions: vec![action], span }
}

/// Reads and checks an action.
fn action(cx: &mut Cx, env: &Env, action: &Action) -> checked::Action {
    let dotted = |names: &[Ident]| names.iter().map(|n| n.name.as_str()).collect::<Vec<_>>().join(".");
    match action {
        Action::Publish(topic, ty, message) => {
            cx.topic(&topic.absolute(), topic.span);
            checked::Action::Publish(message::read(cx, env, topic, ty, Half::Whole, message))
        }
        Action::Call(service, ty, message) => {
            checked::Action::Call(message::read(cx, env, service, ty, Half::Request, message))
        }
        Action::Request(activity) => checked::Action::Request(dotted(activity)),
        Action::Run(handler) => checked::Action::Run(handler.name.clone()),
        Action::Reset(_) => checked::Action::Reset,
        Action::Stop(_) => checked::Action::Stop,
    }
}

/// A type as it is written.
pub(crate) fn type_name(ty: &TypePath) -> String {
    match &ty.package {
        Some(package) => format!("{}/{}", package.name, ty.name.name),
        None => ty.name.name.clone(),
    }
}

/// Reports a name that is no property, or none that is judged on its own.
fn property(cx: &mut Cx, env: &Env, name: &Ident) {
    let names = cx.names;
    let item = names.values.get(name.name.as_str()).copied();
    let found = item.map(|i| &names.items[i].item.kind);
    match (item, found) {
        (Some(item), Some(ItemKind::Property(_) | ItemKind::Machine(_))) if names.items[item].library => {
            elsewhere(cx, env, name, item);
        }
        (_, Some(ItemKind::Property(_) | ItemKind::Machine(_))) => {}
        (Some(item), Some(ItemKind::Definition(d))) if is_judged(cx, item, &d.each) => {}
        (Some(item), Some(ItemKind::Definition(_))) => not_judged(cx, env, name, item),
        _ => unknown(cx, env, name),
    }
}

fn not_judged(cx: &mut Cx, env: &Env, name: &Ident, item: usize) {
    let message = format!("`{}` is not judged on its own, so it is never violated", name.name);
    let mut diagnostic = Diagnostic::new(Code::NotJudged, name.span, message).label("no property");
    let user = cx.graph.users(item).next();
    if let Some(span) = user.and_then(|u| declared(&cx.names.items[u].item.kind)).map(|n| n.span) {
        diagnostic = diagnostic.also(span, "it is part of this");
    }
    diagnostic = diagnostic.help(format!("to have it judged, write `property {0}: …` instead of `{0} = …`", name.name));
    cx.report(env, diagnostic);
}

fn elsewhere(cx: &mut Cx, env: &Env, name: &Ident, item: usize) {
    let message = format!("`{}` stands in a used file and is not judged here, so it is never violated", name.name);
    let mut diagnostic = Diagnostic::new(Code::NotJudged, name.span, message).label("no property of this file");
    if let Some(there) = declared(&cx.names.items[item].item.kind) {
        diagnostic = diagnostic.also(there.span, "declared here");
    }
    cx.report(env, diagnostic.help("move it into this file, or make it a pattern that this file uses"));
}

fn unknown(cx: &mut Cx, env: &Env, name: &Ident) {
    let is_property =
        |kind: &ItemKind| matches!(kind, ItemKind::Property(_) | ItemKind::Definition(_) | ItemKind::Machine(_));
    let names =
        cx.names.values.iter().filter(|(_, i)| is_property(&cx.names.items[**i].item.kind)).map(|(name, _)| *name);
    let guess = suggest::nearest(&name.name, names);
    let message = format!("there is no property `{}`{}", name.name, suggest::or_else(guess));
    let mut diagnostic = Diagnostic::new(Code::UnknownName, name.span, message)
        .label("unknown property")
        .help("give the property a name: `property NAME: …`");
    if let Some(guess) = guess {
        diagnostic = diagnostic.fix(name.span, guess);
    }
    cx.report(env, diagnostic);
}
