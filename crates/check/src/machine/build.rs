//! From the text of a state diagram to the machine.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{self, ItemKind};

use crate::checked::{Edge, Machine, State};
use crate::context::{Cx, Env};
use crate::names::Named;
use crate::reads::Uses;
use lapwing_diag::suggest;

/// Builds all machines, in their order.
pub(crate) fn build_all(cx: &mut Cx) {
    for index in 0..cx.machines.len() {
        let names = cx.names;
        let Some(item) = cx.machines.get(index).map(|e| e.item) else { continue };
        let ItemKind::Machine(ast) = &names.items[item].item.kind else { continue };
        let ((machine, uses), found) = cx.apart(|cx| build(cx, ast, index));
        cx.spec.machines.push(machine);
        if let Some(entry) = cx.machines.get_mut(index) {
            (entry.uses, entry.found) = (uses, found);
        }
    }
}

fn build(cx: &mut Cx, ast: &ast::Machine, index: usize) -> (Machine, Uses) {
    let env = Env::default().inside("a state diagram", ast.name.span);
    let sampling = Env { sampling: true, ..env.clone() };
    let sample = ast.sample.as_ref().map(|e| cx.formula_of(&sampling, e));
    let initial = initial(cx, &env, ast, index);
    let states = states(cx, &env, ast, index);
    let edges = ast.edges.iter().filter_map(|edge| self::edge(cx, &env, index, edge)).collect();
    let name = ast.name.name.clone();
    let mut machine =
        Machine { name, sample, initial, states, else_stay: ast.else_stay, edges, reads: Vec::new(), alphabet: None };
    let uses = uses_of(cx, &machine);
    machine.reads = uses.reads();
    machine.alphabet = (!uses.signals && !uses.events.is_empty()).then(|| uses.events.iter().copied().collect());
    (machine, uses)
}

fn initial(cx: &mut Cx, env: &Env, ast: &ast::Machine, index: usize) -> usize {
    let Some(initial) = &ast.initial else {
        let first = ast.states.first().map_or("waiting", |s| s.name.name.as_str());
        let message = format!("the state diagram `{}` has no initial state", ast.name.name);
        let diagnostic = Diagnostic::new(Code::NoInitialState, ast.name.span, message)
            .label("where does it begin?")
            .help(format!("say so in it: `initial {first}`; a state that needs no condition may be named there alone"));
        cx.report(env, diagnostic);
        return 0;
    };
    cx.machines.get(index).and_then(|e| e.state(&initial.name)).unwrap_or(0)
}

/// The states; the initial one comes first where no line declares it.
fn states(cx: &mut Cx, env: &Env, ast: &ast::Machine, index: usize) -> Vec<State> {
    let bare = |name: &str| State { name: name.to_owned(), when: None, on: None, at_most: None, at_least: None };
    let mut states: Vec<State> = Vec::new();
    let count = cx.machines.get(index).map_or(0, |e| e.states.len());
    if let Some(initial) = ast.initial.as_ref().filter(|_| count > ast.states.len()) {
        states.push(bare(&initial.name));
    }
    for (i, state) in ast.states.iter().enumerate() {
        if let Some(first) = ast.states[..i].iter().find(|s| s.name.name == state.name.name) {
            let message = format!("the state `{}` is declared twice", state.name.name);
            let diagnostic = Diagnostic::new(Code::DuplicateName, state.name.span, message)
                .label("declared again here")
                .also(first.name.span, "first declared here")
                .help("join the two conditions by `or`");
            cx.report(env, diagnostic);
        }
        states.push(State {
            name: state.name.name.clone(),
            when: state.when.as_ref().map(|e| cx.formula_of(env, e)),
            on: state.on.as_ref().and_then(|e| event_named(cx, env, e)),
            at_most: state.at_most.as_ref().and_then(|d| cx.duration(env, d)),
            at_least: state.at_least.as_ref().and_then(|d| cx.duration(env, d)),
        });
    }
    states
}

fn edge(cx: &mut Cx, env: &Env, index: usize, edge: &ast::Edge) -> Option<Edge> {
    let from = state_named(cx, env, index, &edge.from);
    let to = state_named(cx, env, index, &edge.to);
    let on = edge.on.as_ref().and_then(|e| event_named(cx, env, e));
    let when = edge.when.as_ref().map(|e| cx.formula_of(env, e));
    Some(Edge { from: from?, to: to?, on, when })
}

/// The number of a state; reported where there is none of that name.
pub(super) fn state_named(cx: &mut Cx, env: &Env, machine: usize, name: &ast::Ident) -> Option<usize> {
    let entry = cx.machines.get(machine)?;
    if let Some(state) = entry.state(&name.name) {
        return Some(state);
    }
    let states = || entry.states.iter().map(String::as_str);
    let guess = suggest::nearest(&name.name, states());
    let message = format!("the state diagram `{}` has no state `{}`{}", entry.name, name.name, suggest::or_else(guess));
    let mut diagnostic = Diagnostic::new(Code::UnknownState, name.span, message)
        .label("unknown state")
        .help(format!("its states are {}", suggest::listed(states())));
    if let Some(guess) = guess {
        diagnostic = diagnostic.fix(name.span, guess);
    }
    cx.report(env, diagnostic);
    None
}

/// The number of a declared event; reported where there is none of that name.
pub(crate) fn event_named(cx: &mut Cx, env: &Env, name: &ast::Ident) -> Option<usize> {
    if let Some(Named::Event(event)) = cx.names.get(&name.name) {
        cx.needs_event(event);
        return Some(event);
    }
    let guess = suggest::nearest(&name.name, cx.names.events.keys().copied());
    let what = if cx.names.values.contains_key(name.name.as_str()) {
        "it is declared, but as something else"
    } else {
        "unknown event"
    };
    let message = format!("`{}` is no event{}", name.name, suggest::or_else(guess));
    let mut diagnostic = Diagnostic::new(Code::UnknownName, name.span, message)
        .label(what)
        .help(format!("an event is declared: `event {0}`, `event {0} = message /{0}`", name.name));
    if let Some(guess) = guess {
        diagnostic = diagnostic.fix(name.span, guess);
    }
    cx.report(env, diagnostic);
    None
}

fn uses_of(cx: &Cx, machine: &Machine) -> Uses {
    let mut uses = Uses::default();
    for expr in machine.conditions() {
        uses.add(&cx.spec.inputs, &cx.machines, expr);
    }
    uses.events.extend(machine.states.iter().filter_map(|s| s.on));
    uses.events.extend(machine.edges.iter().filter_map(|e| e.on));
    uses.wait_for_machines(&cx.machines, &cx.spec.events);
    uses
}
