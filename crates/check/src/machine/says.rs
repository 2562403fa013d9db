//! What expressions say about state diagrams: `m == s`, `entered(m.s)`, `left(m.s)`, and in their own `sample when` `updated(x)`.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast::{self, ExprKind, Ident};

use crate::call::Call;
use crate::checked::{Compare, EventSource, Expr, Kind};
use crate::context::{Cx, Env, poison};
use crate::expr::plain;
use crate::term::Term;

use super::build::state_named;

impl Cx<'_> {
    /// `m == s` and `m != s`; `None` where no machine is compared.
    pub fn state_test(
        &mut self,
        env: &Env,
        op: Compare,
        left: &ast::Expr,
        right: &ast::Expr,
        written: Span,
    ) -> Option<Expr> {
        if !matches!(op, Compare::Eq | Compare::Ne) {
            return None;
        }
        let (machine, state) = match (self.machine_in(env, left), self.machine_in(env, right)) {
            (Some(machine), _) => (machine, right),
            (None, Some(machine)) => (machine, left),
            (None, None) => return None,
        };
        let span = env.place(written);
        let (place, state) = self.argument(env, state);
        if place.is_open(state) {
            return Some(poison(span));
        }
        let ExprKind::Path(idents) = &state.kind else {
            let message = "a state diagram is compared with one of its states, by name";
            self.report(env, Diagnostic::new(Code::Misplaced, state.span, message).label("no state"));
            return Some(poison(span));
        };
        let state = match idents.as_slice() {
            [name] if name.name == "undefined" => None,
            // `m == m.s` says the same as `m == s`.
            [.., name] => match state_named(self, env, machine, name) {
                Some(state) => Some(state),
                None => return Some(poison(span)),
            },
            [] => return Some(poison(span)),
        };
        self.needs_machine(machine);
        let test = plain(Kind::InState { machine, state }, Type::Bool, span);
        Some(match op {
            Compare::Ne => plain(Kind::Not(Box::new(test)), Type::Bool, span),
            _ => test,
        })
    }

    /// The machine that an expression names.
    fn machine_in(&self, env: &Env, expr: &ast::Expr) -> Option<usize> {
        let (env, expr) = self.argument(env, expr);
        match &expr.kind {
            ExprKind::Path(idents) if idents.len() == 1 => self.machine_named(&env, &idents[0]),
            _ => None,
        }
    }

    fn machine_named(&self, env: &Env, name: &Ident) -> Option<usize> {
        let shadowed = env.vars.iter().any(|v| v.name == name.name) || env.slices.contains(&name.name);
        if shadowed { None } else { self.machines.index(&name.name) }
    }

    /// The expression that a parameter stands for, and the place where it means something; any other stands for itself.
    pub fn argument<'x>(&self, env: &Env<'x>, expr: &'x ast::Expr) -> (Env<'x>, &'x ast::Expr) {
        let (mut env, mut expr) = (env.clone(), expr);
        while let ExprKind::Path(idents) = &expr.kind
            && let [name] = idents.as_slice()
            && let Some((_, bound)) = env.params.iter().find(|(param, _)| *param == name.name)
        {
            expr = bound;
            env = env.caller.map_or_else(Env::default, Env::clone);
        }
        (env, expr)
    }

    /// Notes that what is being read needs a machine: if that cannot be judged, neither can this.
    pub fn needs_machine(&mut self, machine: usize) {
        let Some(entry) = self.machines.get(machine) else { return };
        if self.graph.is_cyclic(entry.item) || entry.found.failed {
            self.found.failed = true;
        }
        if let Some(problem) = entry.found.problem() {
            self.found.blame(format!("the state diagram `{}`: {problem}", entry.name));
        }
    }
}

/// `entered(m.s)` and `left(m.s)`
pub(crate) fn entered_or_left(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [arg] = call.args else { return None };
    let (place, arg) = cx.argument(env, arg);
    if place.is_open(arg) {
        return Some(Term::poison(call.span));
    }
    let ExprKind::Path(idents) = &arg.kind else { return None };
    let [machine, state] = idents.as_slice() else { return None };
    let Some(index) = cx.machine_named(&place, machine) else {
        let names: Vec<String> =
            (0..cx.machines.len()).filter_map(|i| cx.machines.get(i)).map(|e| e.name.clone()).collect();
        let guess = lapwing_diag::suggest::nearest(&machine.name, names.iter().map(String::as_str));
        let message = format!("there is no state diagram `{}`{}", machine.name, lapwing_diag::suggest::or_else(guess));
        let mut diagnostic = Diagnostic::new(Code::UnknownName, machine.span, message).label("unknown");
        if let Some(guess) = guess {
            diagnostic = diagnostic.fix(machine.span, guess);
        }
        cx.report(env, diagnostic);
        return Some(Term::poison(call.span));
    };
    let Some(number) = state_named(cx, env, index, state) else { return Some(Term::poison(call.span)) };
    cx.needs_machine(index);
    let source = match call.name {
        "entered" => EventSource::Entered { machine: index, state: number },
        _ => EventSource::Left { machine: index, state: number },
    };
    let event = cx.state_event(source, format!("{}({}.{})", call.name, machine.name, state.name));
    Some(Term::Expr(plain(Kind::Event(event), Type::Bool, call.span)))
}

/// `updated(x)`
pub(crate) fn updated(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [arg] = call.args else { return None };
    if !env.sampling {
        let diagnostic =
            Diagnostic::new(Code::Misplaced, call.written, "`updated(…)` asks what a state diagram has not yet seen")
                .label("not inside a `sample when`")
                .help("elsewhere `fresh(/topic)` tells whether a message came at this instant");
        cx.report(env, diagnostic);
        return Some(Term::poison(call.span));
    }
    let inputs = match cx.lower(env, arg) {
        Term::Compound(compound) if !compound.parts.is_empty() => compound.parts.iter().flat_map(inputs_of).collect(),
        term => inputs_of(&term.value(cx, env)),
    };
    if inputs.is_empty() && !cx.found.failed {
        let message = "only a signal can be updated";
        cx.report(env, Diagnostic::new(Code::Misplaced, arg.span, message).label("this reads no signal"));
    }
    Some(Term::Expr(plain(Kind::Updated(inputs), Type::Bool, call.span)))
}

/// The signals in an expression, each once.
fn inputs_of(expr: &Expr) -> Vec<usize> {
    let mut found = std::collections::BTreeSet::new();
    let mut open = vec![expr];
    while let Some(expr) = open.pop() {
        if let Kind::Input(input) = expr.kind {
            found.insert(input);
        }
        open.extend(expr.children());
    }
    found.into_iter().collect()
}
