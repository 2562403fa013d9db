//! What a formula means, as a sentence.

use lapwing_check::checked::{Bound, Connective, Expr, Kind, Scope, Spec};

use super::formula::Printer;

/// What a property means.
pub(super) fn of(printer: &Printer, formula: &Expr) -> String {
    judged(printer, formula)
}

/// A state diagram: what it says, and the diagram on one line.
pub(super) fn of_machine(meaning: &Spec, number: usize) -> (String, String) {
    let Some(machine) = meaning.machines.get(number) else { return Default::default() };
    let name = |state: usize| machine.states.get(state).map_or("?", |s| s.name.as_str());
    let edges = machine.edges.iter().map(|e| format!("{} -> {}", name(e.from), name(e.to)));
    let mut words = format!(
        "the robot, which begins in {}, goes from one of {} states to another only along an edge that is drawn",
        name(machine.initial),
        machine.states.len()
    );
    for state in &machine.states {
        let bounds = [("at least", state.at_least), ("at most", state.at_most)];
        let bounds: Vec<String> =
            bounds.into_iter().filter_map(|(word, bound)| Some(format!("{word} {}", bound?))).collect();
        if !bounds.is_empty() {
            words += &format!(", and stays in {} for {}", state.name, bounds.join(" and "));
        }
    }
    (words, edges.collect::<Vec<_>>().join(", "))
}

/// A formula that is judged: one about the present counts at every instant.
fn judged(printer: &Printer, e: &Expr) -> String {
    match e.has_future() {
        true => words(printer, e),
        false => everywhere(printer, e, ""),
    }
}

fn everywhere(printer: &Printer, e: &Expr, when: &str) -> String {
    match &e.kind {
        Kind::Not(of) if !e.has_future() => format!("at no instant{when} {}", printer.print(of)),
        _ => format!("at every instant{when} {}", words(printer, e)),
    }
}

fn words(printer: &Printer, e: &Expr) -> String {
    if !e.has_future() {
        return printer.print(e);
    }
    match &e.kind {
        Kind::Always(bound, of) => everywhere(printer, of, &within(bound)),
        Kind::Eventually(bound, of) => format!("at some instant{} {}", within(bound), words(printer, of)),
        Kind::Next(of) => format!("at the next instant {}", words(printer, of)),
        Kind::Until(bound, l, r) => {
            format!(
                "{} at every instant until one{} at which {}, which must come",
                words(printer, l),
                within(bound),
                words(printer, r)
            )
        }
        Kind::Not(of) => format!("it is not so that {}", words(printer, of)),
        Kind::Connective(op, l, r) => {
            let (l, r) = (words(printer, l), words(printer, r));
            match op {
                Connective::And => format!("{l}, and {r}"),
                Connective::Or => format!("{l}, or {r}"),
                Connective::Implies => format!("if {l}, then {r}"),
                Connective::Iff => format!("{l} exactly if {r}"),
            }
        }
        Kind::Scope(scope, x, body) => in_scope(printer, *scope, x, body),
        Kind::AfterUntil(x, y, body) => format!(
            "each time {} begins a stretch, up to the next instant with {} or the end: {}",
            words(printer, x),
            words(printer, y),
            judged(printer, body)
        ),
        _ => printer.print(e),
    }
}

fn in_scope(printer: &Printer, scope: Scope, x: &Expr, body: &Expr) -> String {
    let x = words(printer, x);
    match scope {
        Scope::After => format!("from the first instant with {x} on, for good: {}", judged(printer, body)),
        Scope::Until => format!("{x} comes at some instant, and before it: {}", judged(printer, body)),
        Scope::Before => format!("if {x} ever comes, before it: {}", judged(printer, body)),
        Scope::While => format!("in every stretch of instants with {x}: {}", judged(printer, body)),
        Scope::Whenever => format!("at every instant with {x}, seen from there: {}", words(printer, body)),
    }
}

fn within(bound: &Bound) -> String {
    match bound.hi {
        None => String::new(),
        Some(hi) if bound.lo.nanos() == 0 => format!(" within {hi}"),
        Some(hi) => format!(" between {} and {hi} from there", bound.lo),
    }
}
