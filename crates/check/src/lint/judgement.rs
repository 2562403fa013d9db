//! `cannot-fail` and `cannot-hold`: what is decided before anything has been seen.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast;

use crate::checked::{Bound, Compare, Connective, Expr, Kind, Scope};
use crate::constant::constant;
use crate::context::{Cx, Env};

use super::range::comparison;

/// Looks at a whole property.
pub(super) fn check(cx: &mut Cx, written: &ast::Expr, formula: &Expr, property: usize) {
    let mut impossible = Vec::new();
    contradictions(formula, &mut impossible);
    for span in &impossible {
        let text = cx.sources.slice(*span);
        let diagnostic = Diagnostic::new(Code::CannotHold, *span, format!("`{text}` is true of no number"))
            .label("these exclude each other")
            .help("one of the comparisons points the wrong way, or `or` was meant");
        cx.report(&Env::default(), diagnostic);
    }
    if !impossible.is_empty() {
        return;
    }
    match judge(formula) {
        Some(true) => cannot_fail(cx, formula.span, "it is true whatever happens"),
        Some(false) => {
            let diagnostic = Diagnostic::new(Code::CannotHold, formula.span, "this can never hold")
                .label("false whatever happens")
                .help("such a property fails on every trace; one of its conditions is not what was meant");
            cx.report(&Env::default(), diagnostic);
        }
        None => alphabet(cx, written, formula, property),
    }
}

fn cannot_fail(cx: &mut Cx, span: Span, why: &str) {
    let diagnostic = Diagnostic::new(Code::CannotFail, span, "this can never fail")
        .label(why)
        .help("a property that cannot fail watches nothing; one of its conditions is not what was meant");
    cx.report(&Env::default(), diagnostic);
}

/// What a formula is worth on every trace, where that is certain.
fn judge(expr: &Expr) -> Option<bool> {
    match &expr.kind {
        Kind::Bool(value) => Some(*value),
        Kind::Truth(inner) => constant(inner).map(|x| x != 0.0 && !x.is_nan()),
        Kind::Compare { op, margin, left, right } => {
            let margin = margin.as_ref().map_or(Some(0.0), |m| constant(m))?;
            match (constant(left), constant(right)) {
                (Some(l), Some(r)) => Some(compare(*op, l, r, margin)),
                _ => None,
            }
        }
        Kind::Not(inner) => judge(inner).map(|v| !v),
        Kind::Connective(op, left, right) => connective(expr, *op, judge(left), judge(right)),
        // Over no position the first is true and the second false, so the other value needs a position.
        Kind::Always(bound, inner) => judge(inner).filter(|v| *v || *bound == Bound::ALL),
        Kind::Eventually(bound, inner) => judge(inner).filter(|v| !*v || *bound == Bound::ALL),
        Kind::Once(bound, inner) => judge(inner).filter(|v| !*v || *bound == Bound::ALL),
        Kind::Historically(bound, inner) => judge(inner).filter(|v| *v || *bound == Bound::ALL),
        Kind::Scope(scope, trigger, body) => self::scope(*scope, judge(trigger), judge(body)),
        Kind::Until(_, _, right) | Kind::Since(_, _, right) => judge(right).filter(|v| !*v),
        Kind::Previously(inner) | Kind::Next(inner) | Kind::Held(_, inner) | Kind::Becomes(inner) => {
            judge(inner).filter(|v| !*v)
        }
        Kind::AfterUntil(opens, _, body) => (judge(opens) == Some(false) || judge(body) == Some(true)).then_some(true),
        _ => None,
    }
}

fn connective(expr: &Expr, op: Connective, left: Option<bool>, right: Option<bool>) -> Option<bool> {
    match (op, left, right) {
        (Connective::And, Some(false), _) | (Connective::And, _, Some(false)) => Some(false),
        (Connective::And, Some(true), Some(true)) => Some(true),
        (Connective::Or, Some(true), _) | (Connective::Or, _, Some(true)) => Some(true),
        (Connective::Or, Some(false), Some(false)) => Some(false),
        (Connective::Or, None, None) => covers_all(expr).then_some(true),
        (Connective::Implies, Some(false), _) | (Connective::Implies, _, Some(true)) => Some(true),
        (Connective::Implies, Some(true), Some(false)) => Some(false),
        (Connective::Iff, Some(l), Some(r)) => Some(l == r),
        _ => None,
    }
}

fn scope(scope: Scope, trigger: Option<bool>, body: Option<bool>) -> Option<bool> {
    match scope {
        Scope::Until => trigger.filter(|v| !*v),
        _ if trigger == Some(false) || body == Some(true) => Some(true),
        _ => None,
    }
}

fn compare(op: Compare, left: f64, right: f64, margin: f64) -> bool {
    let equal = left == right || (left - right).abs() <= margin;
    match op {
        Compare::Eq => equal,
        Compare::Ne => !equal,
        Compare::Lt => left < right + margin,
        Compare::Le => left <= right + margin,
        Compare::Gt => left > right - margin,
        Compare::Ge => left >= right - margin,
    }
}

/// The innermost conjunctions of comparisons that exclude each other.
fn contradictions(expr: &Expr, found: &mut Vec<Span>) {
    let before = found.len();
    expr.children().into_iter().for_each(|child| contradictions(child, found));
    if found.len() > before || !matches!(expr.kind, Kind::Connective(Connective::And, ..)) {
        return;
    }
    let mut parts = Vec::new();
    operands(expr, Connective::And, &mut parts);
    let ranges: Vec<_> = parts.into_iter().filter_map(comparison).collect();
    for (index, (what, range)) in ranges.iter().enumerate() {
        let same = ranges[..index].iter().filter(|(other, _)| alike(other, what));
        if same.fold(*range, |all, (_, other)| all.and(*other)).is_empty() {
            found.push(expr.span);
            return;
        }
    }
}

/// Whether a disjunction is true of every number.
fn covers_all(expr: &Expr) -> bool {
    let mut parts = Vec::new();
    operands(expr, Connective::Or, &mut parts);
    let ranges: Vec<_> = parts.into_iter().filter_map(comparison).collect();
    ranges.iter().enumerate().any(|(index, (what, range))| {
        ranges[..index].iter().any(|(other, r)| alike(other, what) && range.covers_all_with(*r))
    })
}

/// The operands of a chain of one connective.
fn operands<'e>(expr: &'e Expr, op: Connective, found: &mut Vec<&'e Expr>) {
    match &expr.kind {
        Kind::Connective(o, left, right) if *o == op => {
            operands(left, op, found);
            operands(right, op, found);
        }
        _ => found.push(expr),
    }
}

/// Whether two expressions say the same, wherever they stand.
fn alike(a: &Expr, b: &Expr) -> bool {
    let same = match (&a.kind, &b.kind) {
        (Kind::Input(x), Kind::Input(y)) => x == y,
        (Kind::EventField { event: e, field: f }, Kind::EventField { event, field }) => (e, f) == (event, field),
        (Kind::Num(x), Kind::Num(y)) => x == y,
        (Kind::Age(x), Kind::Age(y)) => x == y,
        (Kind::Param(x), Kind::Param(y)) => x == y,
        (Kind::Neg(_), Kind::Neg(_)) => true,
        (Kind::Arith(x, ..), Kind::Arith(y, ..)) => x == y,
        (Kind::Call(x, _), Kind::Call(y, _)) => x == y,
        (Kind::Lookback(_, x), Kind::Lookback(_, y)) => x == y,
        (Kind::Delta(_), Kind::Delta(_)) | (Kind::Rate(_), Kind::Rate(_)) => true,
        _ => false,
    };
    let (left, right) = (a.children(), b.children());
    same && left.len() == right.len() && left.into_iter().zip(right).all(|(l, r)| alike(l, r))
}

/// So many events of an alphabet are tried in all combinations.
const MOST_EVENTS: usize = 8;

/// An `always` over events alone that every event of its alphabet satisfies: without another event it cannot fail.
fn alphabet(cx: &mut Cx, written: &ast::Expr, formula: &Expr, property: usize) {
    let Some(events) = cx.spec.properties.get(property).and_then(|p| p.alphabet.clone()) else { return };
    let body = match &formula.kind {
        Kind::Always(bound, body) if *bound == Bound::ALL => body,
        _ if !formula.has_future() => formula,
        _ => return,
    };
    if events.len() > MOST_EVENTS {
        return;
    }
    // At each of its positions at least one event of the alphabet occurs.
    let always = (1u32..1 << events.len()).all(|set| {
        let occurs = |event: usize| events.iter().position(|e| *e == event).is_some_and(|i| set & (1 << i) != 0);
        at(body, &occurs) == Some(true)
    });
    if !always {
        return;
    }
    let names: Vec<&str> = events.iter().map(|&e| cx.spec.events[e].name.as_str()).collect();
    let listed = names.join(", ");
    let diagnostic = Diagnostic::new(Code::CannotFail, written.span, "this can never fail")
        .label("every event that makes an instant satisfies it")
        .help(format!("it steps only where {listed} occurs: list the events that should break it after `over`"))
        .help(format!("for example `over ({listed}, the_opposite)`"));
    cx.report(&Env::default(), diagnostic);
}

/// The value of a formula of events, where these occur and no others.
fn at(expr: &Expr, occurs: &impl Fn(usize) -> bool) -> Option<bool> {
    match &expr.kind {
        Kind::Bool(value) => Some(*value),
        Kind::Event(event) => Some(occurs(*event)),
        Kind::Not(inner) => at(inner, occurs).map(|v| !v),
        Kind::Connective(op, left, right) => {
            let (left, right) = (at(left, occurs)?, at(right, occurs)?);
            Some(match op {
                Connective::And => left && right,
                Connective::Or => left || right,
                Connective::Implies => !left || right,
                Connective::Iff => left == right,
            })
        }
        _ => None,
    }
}
