//! A checked specification as text, one property a line.

use lapwing_check::checked::{
    Arith, Body, Bound, Compare, Connective, EventSource, Expr, InputSource, Kind, Machine, Property, ReadOf, Scope,
    Spec, Step, Window,
};

/// All properties, with what they read.
pub fn properties(spec: &Spec) -> String {
    spec.properties.iter().map(|p| format!("{}\n", property(spec, p))).collect()
}

/// The formulas alone.
pub fn formulas(spec: &Spec) -> String {
    spec.properties.iter().map(|p| format!("{}: {}\n", p.name, body(spec, &p.body))).collect()
}

/// One property.
pub fn property(spec: &Spec, property: &Property) -> String {
    let mut text = format!("{}: {}", property.name, body(spec, &property.body));
    let reads: Vec<String> = property
        .reads
        .iter()
        .map(|read| {
            let what = match read.what {
                ReadOf::Input(input) => spec.inputs[input].label.clone(),
                ReadOf::Topic(topic) => spec.topics[topic].name.clone(),
            };
            if read.depth == 0 { what } else { format!("{what}@{}", read.depth) }
        })
        .collect();
    if !reads.is_empty() {
        text += &format!(" | reads {}", reads.join(" "));
    }
    if let Some(alphabet) = &property.alphabet {
        let names: Vec<&str> = alphabet.iter().map(|&e| spec.events[e].name.as_str()).collect();
        text += &format!(" | over {}", names.join(" "));
    }
    if !property.machines.is_empty() {
        let names: Vec<&str> = property.machines.iter().map(|&m| spec.machines[m].name.as_str()).collect();
        text += &format!(" | machines {}", names.join(" "));
    }
    for slice in &property.slices {
        let fields: Vec<String> = slice.fields.iter().map(|(e, f)| format!("{}:{f}", spec.events[*e].name)).collect();
        text += &format!(" | slice {}.{} [{}]", spec.events[slice.event].name, path(&slice.field), fields.join(" "));
    }
    if let Some(problem) = &property.problem {
        text += &format!(" | problem {problem}");
    }
    text
}

fn body(spec: &Spec, body: &Body) -> String {
    match body {
        Body::Formula(formula) => expr(spec, formula),
        Body::Machine(machine) => format!("machine {machine}"),
        Body::None => "nothing".to_owned(),
    }
}

/// A path as it is written.
pub fn path(path: &[Step]) -> String {
    let steps: Vec<String> = path
        .iter()
        .map(|step| match step {
            Step::Field(name) => name.clone(),
            Step::Index(index) => format!("[{index}]"),
        })
        .collect();
    steps.join(".")
}

/// The signals, one a line: label, source, type, dimension.
pub fn inputs(spec: &Spec) -> String {
    let line = |input: &lapwing_check::checked::Input| {
        let source = match &input.source {
            InputSource::Field { topic, field } => {
                let topic = &spec.topics[*topic];
                format!("{} {}", topic.name, path(&topic.fields[*field]))
            }
            InputSource::Column(column) => format!("column {}", spec.columns[*column]),
            InputSource::World { object, part } => format!("{} {part:?}", spec.objects[*object].name),
        };
        let mut line = format!("{}: {source}, {:?}", input.label, input.dim.0);
        if let Some(default) = &input.default {
            line += &format!(", default {default:?}");
        }
        if let Some(stale) = input.stale {
            line += &format!(", stale {stale}");
        }
        line + "\n"
    };
    spec.inputs.iter().map(line).collect()
}

/// The events, one a line.
pub fn events(spec: &Spec) -> String {
    let line = |event: &lapwing_check::checked::Event| {
        let source = match &event.source {
            EventSource::Message { topic } => format!("message {}", spec.topics[*topic].name),
            EventSource::Program(text) => format!("program {text}"),
            other => format!("{other:?}"),
        };
        let fields: Vec<String> = event.fields.iter().map(|f| path(&f.path)).collect();
        let when = event.when.as_ref().map(|w| format!(" when {}", expr(spec, w))).unwrap_or_default();
        format!("{}: {source} ({}){when}\n", event.name, fields.join(", "))
    };
    spec.events.iter().map(line).collect()
}

/// The machines, a block each.
pub fn machines(spec: &Spec) -> String {
    spec.machines.iter().map(|m| machine(spec, m)).collect()
}

fn machine(spec: &Spec, machine: &Machine) -> String {
    let mut text = format!("{} from {}\n", machine.name, machine.states.get(machine.initial).map_or("?", |s| &s.name));
    if let Some(sample) = &machine.sample {
        text += &format!("  sample {}\n", expr(spec, sample));
    }
    for state in &machine.states {
        text += &format!("  {}", state.name);
        if let Some(when) = &state.when {
            text += &format!(" when {}", expr(spec, when));
        }
        if let Some(on) = state.on {
            text += &format!(" on {}", spec.events[on].name);
        }
        if let Some(most) = state.at_most {
            text += &format!(" at most {most}");
        }
        text += "\n";
    }
    let edges: Vec<String> = machine
        .edges
        .iter()
        .map(|e| format!("{}->{}", machine.states[e.from].name, machine.states[e.to].name))
        .collect();
    text + &format!("  {}{}\n", edges.join(" "), if machine.else_stay { " else stay" } else { "" })
}

/// An expression, fully bracketed.
pub fn expr(spec: &Spec, e: &Expr) -> String {
    let x = |e: &Expr| expr(spec, e);
    match &e.kind {
        Kind::Num(n) => format!("{n}"),
        Kind::Bool(b) => format!("{b}"),
        Kind::Str(s) => format!("{s:?}"),
        Kind::Input(i) => spec.inputs[*i].label.clone(),
        Kind::Event(i) => format!("!{}", spec.events[*i].name),
        Kind::EventField { event, field } => {
            let event = &spec.events[*event];
            format!("!{}.{}", event.name, path(&event.fields[*field].path))
        }
        Kind::InState { machine, state } => {
            let machine = &spec.machines[*machine];
            format!("{}=={}", machine.name, state.map_or("undefined", |s| &machine.states[s].name))
        }
        Kind::Updated(inputs) => {
            let names: Vec<&str> = inputs.iter().map(|&i| spec.inputs[i].label.as_str()).collect();
            format!("updated({})", names.join(" "))
        }
        Kind::Param(i) => format!("${i}"),
        Kind::Var(i) => format!("%{i}"),
        Kind::Field(e, name) => format!("{}.{name}", x(e)),
        Kind::Index(e, i) => format!("{}[{i}]", x(e)),
        Kind::Truth(e) => format!("truth({})", x(e)),
        Kind::Neg(e) => format!("-{}", x(e)),
        Kind::Arith(op, l, r) => {
            let op = match op {
                Arith::Add => "+",
                Arith::Sub => "-",
                Arith::Mul => "*",
                Arith::Div => "/",
            };
            format!("({} {op} {})", x(l), x(r))
        }
        Kind::Compare { op, margin, left, right } => {
            let op = match op {
                Compare::Eq => "==",
                Compare::Ne => "!=",
                Compare::Lt => "<",
                Compare::Le => "<=",
                Compare::Gt => ">",
                Compare::Ge => ">=",
            };
            let margin = margin.as_ref().map(|m| format!("{{{}}}", x(m))).unwrap_or_default();
            format!("({} {op}{margin} {})", x(left), x(right))
        }
        Kind::Not(e) => format!("not {}", x(e)),
        Kind::Connective(op, l, r) => {
            let op = match op {
                Connective::And => "and",
                Connective::Or => "or",
                Connective::Implies => "=>",
                Connective::Iff => "<=>",
            };
            format!("({} {op} {})", x(l), x(r))
        }
        Kind::Call(func, args) => format!("{func:?}({})", args.iter().map(x).collect::<Vec<_>>().join(" ")),
        Kind::Quantified { all, array, body } => {
            format!("{}({}: {})", if *all { "all" } else { "any" }, x(array), x(body))
        }
        Kind::Lookback(e, n) => format!("@{n}{}", x(e)),
        Kind::Delta(e) => format!("delta({})", x(e)),
        Kind::Rate(e) => format!("rate({})", x(e)),
        Kind::Window(w, e, d) => {
            let w = match w {
                Window::Min => "min",
                Window::Max => "max",
                Window::Mean => "mean",
                Window::Count => "count",
            };
            format!("{w}_over({} {d})", x(e))
        }
        Kind::Age(t) => format!("age({})", spec.topics[*t].name),
        Kind::Frequency(t, d) => format!("frequency({} {d})", spec.topics[*t].name),
        Kind::Fresh(t) => format!("fresh({})", spec.topics[*t].name),
        Kind::Previously(e) => format!("prev {}", x(e)),
        Kind::Becomes(e) => format!("becomes {}", x(e)),
        Kind::Once(b, e) => format!("once{} {}", bound(b), x(e)),
        Kind::Historically(b, e) => format!("hist{} {}", bound(b), x(e)),
        Kind::Since(b, l, r) => format!("({} since{} {})", x(l), bound(b), x(r)),
        Kind::Held(d, e) => format!("held {d} {}", x(e)),
        Kind::Always(b, e) => format!("always{} {}", bound(b), x(e)),
        Kind::Eventually(b, e) => format!("eventually{} {}", bound(b), x(e)),
        Kind::Next(e) => format!("next {}", x(e)),
        Kind::Until(b, l, r) => format!("({} until{} {})", x(l), bound(b), x(r)),
        Kind::Scope(scope, t, f) => {
            let word = match scope {
                Scope::After => "after",
                Scope::Until => "until",
                Scope::Before => "before",
                Scope::While => "while",
                Scope::Whenever => "whenever",
            };
            format!("{word} {}, {}", x(t), x(f))
        }
        Kind::AfterUntil(o, c, f) => format!("after_until {}, {}, {}", x(o), x(c), x(f)),
    }
}

fn bound(bound: &Bound) -> String {
    let Some(hi) = bound.hi else { return String::new() };
    let (open, close) = (if bound.lo_closed { '[' } else { '(' }, if bound.hi_closed { ']' } else { ')' });
    format!("{open}{},{hi}{close}", bound.lo)
}
