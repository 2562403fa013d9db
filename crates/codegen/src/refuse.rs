//! What no monitor is generated for: found in the checked specification, where every formula has its place.

use lapwing_check::checked::{Body, Bound, EventSource, Expr, Func, Kind, Property, Scope, Spec};
use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;

use crate::machines::MOST_STATES;

/// Why a property cannot be generated, at its places. Empty where it can, as far as its text tells.
pub(crate) fn refused(spec: &Spec, property: &Property) -> Vec<Diagnostic> {
    let mut refusals = Refusals {
        spec,
        found: Vec::new(),
        machines: vec![false; spec.machines.len()],
        events: vec![false; spec.events.len()],
    };
    if let Some(problem) = &property.problem {
        refusals.add(property.span, format!("this property cannot be judged: {problem}"), "");
    }
    if !property.slices.is_empty() {
        refusals.add(
            property.span,
            "an instance for each value of an event would need memory of no fixed size",
            "list the instances: `for each r in (robot1, robot2): …`",
        );
    }
    property.alphabet.iter().flatten().for_each(|&event| refusals.event(event, property.span));
    property.machines.iter().for_each(|&machine| refusals.machine(machine));
    match &property.body {
        Body::Formula(formula) => {
            refusals.values(formula);
            refusals.obligations(formula);
        }
        Body::Machine(machine) => refusals.machine(*machine),
        Body::None => {}
    }
    refusals.found
}

/// A refusal, as it is reported.
pub(crate) fn refusal(span: Span, message: impl Into<String>, help: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::NotGenerated, span, message);
    if help.is_empty() { diagnostic } else { diagnostic.help(help) }
}

struct Refusals<'s> {
    spec: &'s Spec,
    found: Vec<Diagnostic>,
    /// The machines that were looked through.
    machines: Vec<bool>,
    /// The events that were.
    events: Vec<bool>,
}

impl Refusals<'_> {
    fn add(&mut self, span: Span, message: impl Into<String>, help: &str) {
        let diagnostic = refusal(span, message, help);
        if !self.found.contains(&diagnostic) {
            self.found.push(diagnostic);
        }
    }

    fn machine(&mut self, machine: usize) {
        if std::mem::replace(&mut self.machines[machine], true) {
            return;
        }
        let spec = self.spec;
        let plan = &spec.machines[machine];
        if plan.states.len() > MOST_STATES {
            let own = spec.properties.iter().find(|p| p.body == Body::Machine(machine)).or(spec.properties.first());
            let message = format!("the state of a machine is one byte, and `{}` has {}", plan.name, plan.states.len());
            let help = format!("a machine of at most {MOST_STATES} states, or several");
            own.iter().for_each(|p| self.add(p.span, message.as_str(), &help));
        }
        plan.conditions().for_each(|e| self.values(e));
        let place = plan.conditions().next().map(|e| e.span).or(spec.properties.first().map(|p| p.span));
        let on = plan.states.iter().filter_map(|s| s.on).chain(plan.edges.iter().filter_map(|e| e.on));
        if let Some(place) = place {
            on.for_each(|event| self.event(event, place));
        }
    }

    fn event(&mut self, event: usize, place: Span) {
        if std::mem::replace(&mut self.events[event], true) {
            return;
        }
        let spec = self.spec;
        match spec.events[event].source {
            EventSource::Entered { machine, .. } | EventSource::Left { machine, .. } => self.machine(machine),
            _ => {}
        }
        if spec.events[event].fields.iter().any(|f| is_structured(&f.ty)) {
            self.add(place, "an event with an array or a message that would have to be kept as a whole", ARRAYS);
        }
        spec.events[event].when.iter().for_each(|when| self.values(when));
    }

    /// Values of kinds that generated code does not have, anywhere in an expression.
    fn values(&mut self, e: &Expr) {
        let spec = self.spec;
        match &e.kind {
            Kind::Input(i) => {
                if is_structured(&spec.inputs[*i].ty) {
                    self.add(e.span, "an array or a message would have to be kept as a whole", ARRAYS);
                }
            }
            Kind::Field(..) | Kind::Index(..) | Kind::Quantified { .. } | Kind::Var(_) => {
                self.add(e.span, "an array or a message would have to be kept as a whole", ARRAYS);
                return;
            }
            Kind::Call(Func::Len | Func::MinOf | Func::MaxOf | Func::Lookup, _) => {
                self.add(e.span, "this function needs an array, which would have to be kept as a whole", ARRAYS);
                return;
            }
            Kind::Call(Func::StartsWith | Func::EndsWith | Func::Contains, _) => {
                let message = "a text is looked through for one that is not written down: both would have to be kept";
                self.add(
                    e.span,
                    message,
                    "look for a text in quotes, or compare in the program and hand over what it comes to",
                );
                return;
            }
            Kind::Param(_) => self.add(e.span, "the value of an instance is not known beforehand", ""),
            Kind::Event(event) | Kind::EventField { event, .. } => self.event(*event, e.span),
            Kind::InState { machine, .. } => self.machine(*machine),
            _ => {}
        }
        e.children().into_iter().for_each(|c| self.values(c));
    }

    /// The way in which obligations split a formula: scopes outermost cut the trace into segments, whatever opens them.
    fn obligations(&mut self, f: &Expr) {
        match &f.kind {
            _ if !f.has_future() => {}
            Kind::Always(_, body) => self.future(body),
            Kind::Connective(lapwing_check::checked::Connective::And, l, r) => {
                self.obligations(l);
                self.obligations(r);
            }
            Kind::Scope(Scope::Whenever, x, body) => [x, body].into_iter().for_each(|e| self.future(e)),
            Kind::Scope(_, x, body) if !x.has_future() => self.obligations(body),
            Kind::AfterUntil(x, y, body) if !x.has_future() && !y.has_future() => self.obligations(body),
            _ => self.future(f),
        }
    }

    /// Scopes that open or close late, anywhere in a formula.
    fn future(&mut self, e: &Expr) {
        let is_late = match &e.kind {
            Kind::Scope(scope, x, _) => *scope != Scope::Whenever && x.has_future(),
            Kind::AfterUntil(x, y, _) => x.has_future() || y.has_future(),
            _ => false,
        };
        if is_late {
            self.opens_late(e);
        }
        e.children().into_iter().for_each(|c| self.future(c));
    }

    fn opens_late(&mut self, e: &Expr) {
        let message =
            "a scope that opens or closes on a formula about the future would have to remember what was before";
        self.add(e.span, message, "open it on something that is known at once");
    }
}

/// The first bound of a formula that begins at other positions than its obligations do.
pub(crate) fn late_bound(property: &Property) -> Option<Span> {
    fn below(e: &Expr, is_inside: bool) -> Option<Span> {
        let bound = match &e.kind {
            Kind::Always(bound, _) | Kind::Eventually(bound, _) | Kind::Until(bound, ..) => Some(bound),
            _ => None,
        };
        match bound.is_some_and(|bound| is_inside && *bound != Bound::ALL && e.has_future()) {
            true => Some(e.span),
            false => e.children().into_iter().find_map(|c| below(c, is_inside || bound.is_some())),
        }
    }
    match &property.body {
        // An `always` that is outermost is where obligations begin.
        Body::Formula(Expr { kind: Kind::Always(_, of), .. }) => below(of, false),
        Body::Formula(formula) => below(formula, false),
        Body::Machine(_) | Body::None => None,
    }
}

const ARRAYS: &str = "of an array ask for its length, for a number in one of its elements, or whether something that depends on nothing else is true of any or all; \
                      of one of numbers also for the least and the greatest; of a message declare the field that is wanted";

fn is_structured(ty: &Type) -> bool {
    matches!(ty, Type::Array(_) | Type::Message(_))
}
