//! The canonical formula of a property: names resolved, patterns expanded, implicit operators written out.

use lapwing_check::checked::{self, Arith, Bound, Compare, Connective, Expr, Func, Kind, Scope, Window};

use crate::shown::is_name;
use crate::spec::Spec;
use crate::words;

/// Prints formulas of a specification.
pub(crate) struct Printer<'p> {
    pub spec: &'p Spec,
    pub meaning: &'p checked::Spec,
}

impl Printer<'_> {
    /// A property's formula, with the `always` that it implies.
    pub fn judged(&self, formula: &Expr) -> String {
        match formula.has_future() {
            true => self.print(formula),
            false => format!("always {}", self.print(formula)),
        }
    }

    /// A formula or expression.
    pub fn print(&self, e: &Expr) -> String {
        if let Some(name) = self.name(e) {
            return name;
        }
        match &e.kind {
            Kind::Num(x) => x.to_string(),
            Kind::Bool(b) => b.to_string(),
            Kind::Str(s) => format!("{s:?}"),
            Kind::Input(input) => self.meaning.inputs.get(*input).map_or("?".to_owned(), |i| i.label.clone()),
            Kind::Event(event) => self.event(*event),
            Kind::EventField { event, field } => format!("{}.{}", self.event(*event), self.event_field(*event, *field)),
            Kind::InState { machine, state } => self.state(*machine, *state),
            Kind::Updated(inputs) => {
                let label = inputs.first().and_then(|i| self.meaning.inputs.get(*i)).map_or("?", |i| i.label.as_str());
                format!("updated({label})")
            }
            Kind::Param(number) => format!("value {}", number + 1),
            Kind::Var(level) => "v".to_owned() + &"'".repeat(*level),
            Kind::Field(of, name) => format!("{}.{name}", self.inner(of)),
            Kind::Index(of, index) => format!("{}[{index}]", self.inner(of)),
            Kind::Truth(of) => self.print(of),
            Kind::Neg(of) => format!("-{}", self.inner(of)),
            Kind::Not(of) => format!("not {}", self.inner(of)),
            Kind::Arith(op, l, r) => format!("{} {} {}", self.inner(l), arith(*op), self.inner(r)),
            Kind::Compare { op, margin, left, right } => {
                let margin = margin.as_ref().map(|m| format!("{{{}}}", self.print(m))).unwrap_or_default();
                format!("{} {}{margin} {}", self.operand(left), compare(*op), self.operand(right))
            }
            Kind::Connective(op, l, r) => format!("{} {} {}", self.part(l), connective(*op), self.part(r)),
            Kind::Call(func, args) => format!("{}({})", function(*func), self.list(args)),
            Kind::Quantified { all, array, body } => {
                format!("{}({}, v => {})", if *all { "all" } else { "any" }, self.print(array), self.print(body))
            }
            Kind::Lookback(of, depth) => format!("@{{{}, -{depth}}}", self.print(of)),
            Kind::Delta(of) => format!("delta({})", self.print(of)),
            Kind::Rate(of) => format!("rate({})", self.print(of)),
            Kind::Window(window, of, over) => format!("{}({}, {over})", self::window(*window), self.print(of)),
            Kind::Age(topic) => format!("age({})", self.topic(*topic)),
            Kind::Frequency(topic, over) => format!("frequency({}, {over})", self.topic(*topic)),
            Kind::Fresh(topic) => format!("fresh({})", self.topic(*topic)),
            Kind::Previously(of) => format!("previously {}", self.print(of)),
            Kind::Becomes(of) => format!("becomes {}", self.print(of)),
            Kind::Once(b, of) => format!("once{} {}", bound(b), self.print(of)),
            Kind::Historically(b, of) => format!("historically{} {}", bound(b), self.print(of)),
            Kind::Since(b, l, r) => format!("{} since{} {}", self.inner(l), bound(b), self.inner(r)),
            Kind::Held(d, of) => format!("held for {d} {}", self.inner(of)),
            Kind::Always(b, of) => format!("always{} {}", bound(b), self.print(of)),
            Kind::Eventually(b, of) => format!("eventually{} {}", bound(b), self.print(of)),
            Kind::Next(of) => format!("next {}", self.print(of)),
            Kind::Until(b, l, r) => format!("{} until{} {}", self.inner(l), bound(b), self.inner(r)),
            Kind::Scope(scope, x, body) => {
                format!("{} {}, {}", words::scope(*scope), self.print(x), self.body(*scope, body))
            }
            Kind::AfterUntil(x, y, body) => {
                format!("after_until {}, {}, {}", self.print(x), self.print(y), self.judged(body))
            }
        }
    }

    /// The body of a scope: only that of `whenever` is taken as it stands.
    fn body(&self, scope: Scope, body: &Expr) -> String {
        if scope == Scope::Whenever { self.print(body) } else { self.judged(body) }
    }

    /// The text of a state formula or number that the specification has a name for.
    fn name(&self, e: &Expr) -> Option<String> {
        let text = self.spec.slice(e.span);
        (!e.has_future() && is_name(text)).then(|| text.to_owned())
    }

    /// With brackets, unless it stands for itself.
    fn inner(&self, e: &Expr) -> String {
        let alone = matches!(
            e.kind,
            Kind::Num(_)
                | Kind::Bool(_)
                | Kind::Str(_)
                | Kind::Input(_)
                | Kind::Event(_)
                | Kind::EventField { .. }
                | Kind::Updated(_)
                | Kind::Call(..)
                | Kind::Quantified { .. }
                | Kind::Lookback(..)
                | Kind::Delta(_)
                | Kind::Rate(_)
                | Kind::Window(..)
                | Kind::Age(_)
                | Kind::Frequency(..)
                | Kind::Fresh(_)
                | Kind::Field(..)
                | Kind::Index(..)
                | Kind::Var(_)
        );
        let text = self.print(e);
        if alone || self.name(e).is_some() { text } else { format!("({text})") }
    }

    /// A part of a connective, which binds less tightly than comparisons.
    fn part(&self, e: &Expr) -> String {
        if matches!(e.kind, Kind::Compare { .. } | Kind::Not(_)) { self.print(e) } else { self.inner(e) }
    }

    /// An operand of a comparison, which binds less tightly than sums.
    fn operand(&self, e: &Expr) -> String {
        match e.kind {
            Kind::Arith(..) | Kind::Neg(_) => self.print(e),
            _ => self.inner(e),
        }
    }

    fn list(&self, args: &[Expr]) -> String {
        args.iter().map(|a| self.print(a)).collect::<Vec<_>>().join(", ")
    }

    fn topic(&self, topic: usize) -> &str {
        self.meaning.topics.get(topic).map_or("?", |t| t.name.as_str())
    }

    fn event(&self, event: usize) -> String {
        self.meaning.events.get(event).map_or("?".to_owned(), |e| e.name.clone())
    }

    fn event_field(&self, event: usize, field: usize) -> String {
        let path = self.meaning.events.get(event).and_then(|e| e.fields.get(field)).map(|f| super::path(&f.path));
        path.unwrap_or_default()
    }

    fn state(&self, machine: usize, state: Option<usize>) -> String {
        let Some(machine) = self.meaning.machines.get(machine) else { return "?".to_owned() };
        let state = state.and_then(|s| machine.states.get(s)).map_or("undefined", |s| s.name.as_str());
        format!("{} == {state}", machine.name)
    }
}

/// A time bound as it is written, with a blank before it.
pub(super) fn bound(b: &Bound) -> String {
    let (open, close) = (if b.lo_closed { '[' } else { '(' }, if b.hi_closed { ']' } else { ')' });
    match b.hi {
        None => String::new(),
        Some(hi) if b.lo.nanos() == 0 && b.lo_closed && b.hi_closed => format!(" within {hi}"),
        Some(hi) => format!(" within {open}{}, {hi}{close}", b.lo),
    }
}

fn arith(op: Arith) -> char {
    match op {
        Arith::Add => '+',
        Arith::Sub => '-',
        Arith::Mul => '*',
        Arith::Div => '/',
    }
}

/// A comparison as it is written.
pub(crate) fn compare(op: Compare) -> &'static str {
    match op {
        Compare::Eq => "==",
        Compare::Ne => "!=",
        Compare::Lt => "<",
        Compare::Le => "<=",
        Compare::Gt => ">",
        Compare::Ge => ">=",
    }
}

fn connective(op: Connective) -> &'static str {
    match op {
        Connective::And => "and",
        Connective::Or => "or",
        Connective::Implies => "implies",
        Connective::Iff => "iff",
    }
}

fn window(window: Window) -> &'static str {
    match window {
        Window::Min => "min_over",
        Window::Max => "max_over",
        Window::Mean => "mean_over",
        Window::Count => "count",
    }
}

fn function(func: Func) -> &'static str {
    match func {
        Func::Abs => "abs",
        Func::Sign => "sign",
        Func::Min | Func::MinOf => "min",
        Func::Max | Func::MaxOf => "max",
        Func::Sqrt => "sqrt",
        Func::Sin => "sin",
        Func::Cos => "cos",
        Func::Atan2 => "atan2",
        Func::Norm => "norm",
        Func::Roll => "roll",
        Func::Pitch => "pitch",
        Func::Yaw => "yaw",
        Func::AngleDiff => "angle_diff",
        Func::AngleBetween => "angle_between",
        Func::IntoBody => "into_body",
        Func::Deg => "deg",
        Func::Rad => "rad",
        Func::IsNan => "isnan",
        Func::Len => "len",
        Func::Lookup => "lookup",
        Func::StartsWith => "starts_with",
        Func::EndsWith => "ends_with",
        Func::Contains => "contains",
    }
}
