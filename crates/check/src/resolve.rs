//! Names: what a dotted name means where it stands.
//!
//! The order is that of nearness: variables of `any` and `all`, parameters, slices, the fields of an event inside its `when`, what
//! the file declares, the ground truth, and last what the trace has: columns, ports, constants of messages.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::{Type, Value};
use lapwing_syntax::ast::{self, Ident};

use crate::checked::{Dim, Event, EventSource, Expr, Kind};
use crate::constant::constant_value;
use crate::context::{Cx, Env};
use crate::messages::{self, Known};
use crate::names::{Formula, Named};
use crate::place::{Place, Root, describe};
use crate::term::Term;
use crate::world;
use lapwing_diag::suggest;

impl Cx<'_> {
    /// What a dotted name means.
    pub fn path(&mut self, env: &Env, idents: &[Ident], span: Span) -> Term {
        let Some((head, rest)) = idents.split_first() else { return Term::poison(span) };
        let at = env.place(span);
        if let Some(term) = self.of_topic(env, head, rest) {
            return term.at(at);
        }
        if let Some(local) = self.local(env, head) {
            let argument = rest.is_empty() && env.params.iter().any(|(name, _)| *name == head.name);
            let term = self.fields(env, local, rest);
            return if argument { term } else { term.at(at) };
        }
        if let Some(event) = env.event {
            return self.in_when(env, event, idents, at);
        }
        if let Some(named) = self.names.get(&head.name) {
            let term = self.named(env, named, head, rest, at);
            return term.at(at);
        }
        let joined = idents.iter().map(|i| i.name.as_str()).collect::<Vec<_>>().join(".");
        if self.trace.is_some_and(|t| t.schemaless && t.has_column(&joined)) {
            let dim = world::dim_of(idents);
            return column(joined, dim, at);
        }
        if let Some(term) = world::quantity(self, env, idents, at) {
            return term;
        }
        self.of_the_trace(env, idents, joined, at)
    }

    /// Variables, parameters and slices.
    fn local(&mut self, env: &Env, head: &Ident) -> Option<Term> {
        if let Some(var) = env.vars.iter().rev().find(|v| v.name == head.name) {
            let index = self.lambdas - 1 - var.level;
            return Some(Term::Expr(Expr {
                kind: Kind::Var(index),
                ty: var.ty.clone(),
                dim: var.known.dim,
                span: head.span,
            }));
        }
        if env.unknown.iter().any(|name| name.name == head.name) {
            return Some(column(head.name.clone(), Dim::UNKNOWN, head.span));
        }
        if let Some((_, arg)) = env.params.iter().find(|(name, _)| *name == head.name) {
            let caller = env.caller.map_or_else(Env::default, Env::clone);
            let event = env.event.or(caller.event);
            let caller =
                Env { no_future: env.no_future, depth: env.depth + 1, sampling: env.sampling, event, ..caller };
            return Some(self.lower(&caller, arg));
        }
        let slice = env.slices.iter().rposition(|name| *name == head.name)?;
        Some(Term::Expr(Expr { kind: Kind::Param(slice), ty: Type::Any, dim: Dim::UNKNOWN, span: head.span }))
    }

    /// `topic.header.stamp`, where the parameter `topic` stands for `/odom`: a field of its latest message.
    fn of_topic(&mut self, env: &Env, head: &Ident, rest: &[Ident]) -> Option<Term> {
        if rest.is_empty() || !env.params.iter().any(|(name, _)| *name == head.name) {
            return None;
        }
        let name = ast::Expr { kind: ast::ExprKind::Path(vec![head.clone()]), span: head.span, parens: false };
        let (caller, argument) = self.argument(env, &name);
        let ast::ExprKind::Topic(topic) = &argument.kind else { return None };
        let Some(topic) = self.without_holes(&caller, topic) else { return Some(Term::poison(head.span)) };
        let name = topic.absolute();
        let in_columns = self.schemaless() && self.trace.is_some_and(|t| !t.columns_open && t.topic(&name).is_none());
        let whole = match in_columns {
            true => column(name, Dim::UNKNOWN, head.span),
            false => {
                let opened = self.open(env, &topic, None);
                let (root, ty, known) = (Root::Topic(opened.topic), opened.ty, opened.known);
                let place = Place {
                    root,
                    path: Vec::new(),
                    label: name,
                    ty,
                    known,
                    default: None,
                    stale: None,
                    span: head.span,
                };
                Term::Place(Box::new(place))
            }
        };
        Some(self.fields(env, whole, rest))
    }

    fn fields(&mut self, env: &Env, term: Term, rest: &[Ident]) -> Term {
        rest.iter().fold(term, |term, name| term.field(self, env, name))
    }

    /// A bare name in an event's `when`: one of its fields, else a constant of the file.
    fn in_when(&mut self, env: &Env, event: usize, idents: &[Ident], at: Span) -> Term {
        let place = self.event_place(event, at);
        let head = &idents[0];
        let has_field = match &place.ty {
            Type::Message(schema) => schema.field(&head.name).is_some(),
            _ => !matches!(self.names.get(&head.name), Some(Named::Formula(_))),
        };
        if !has_field {
            if let Some(Named::Formula(formula)) = self.names.get(&head.name) {
                return self.formula(env, formula, at);
            }
            if let Some(value) = self.message_constant(env, idents, at) {
                return value;
            }
        }
        self.fields(env, Term::Place(Box::new(place)), idents).at(at)
    }

    /// What the file declares by that name.
    fn named(&mut self, env: &Env, named: Named, head: &Ident, rest: &[Ident], at: Span) -> Term {
        match named {
            Named::Decl(decl) => match self.declared(env, decl, at) {
                Some(place) => self.fields(env, Term::Place(Box::new(place)), rest),
                None => Term::poison(at),
            },
            Named::Formula(formula) => {
                let term = self.formula(env, formula, at);
                self.fields(env, term, rest)
            }
            Named::Event(event) if rest.is_empty() => {
                self.needs_event(event);
                Term::Expr(Expr { kind: Kind::Event(event), ty: Type::Bool, dim: Dim::UNKNOWN, span: at })
            }
            Named::Event(event) => {
                self.needs_event(event);
                let place = Place { label: head.name.clone(), ..self.event_place(event, at) };
                self.fields(env, Term::Place(Box::new(place)), rest)
            }
            Named::Machine(machine) => {
                let state = rest.first().map_or_else(
                    || machine.states.first().map_or("a_state", |s| s.name.name.as_str()),
                    |r| r.name.as_str(),
                );
                let name = &head.name;
                let message = format!("`{name}` is a state diagram, no value");
                let diagnostic = Diagnostic::new(Code::Misplaced, at, message)
                    .label("what of it?")
                    .help(format!("whether it stands in a state: `{name} == {state}`"))
                    .help(format!(
                        "whether it just entered or left one: `entered({name}.{state})`, `left({name}.{state})`"
                    ));
                self.report(env, diagnostic);
                Term::poison(at)
            }
        }
    }

    /// A named expression or formula, where it is used.
    fn formula(&mut self, env: &Env, formula: Formula, at: Span) -> Term {
        if self.graph.is_cyclic(formula.item) {
            self.found.failed = true;
            self.found.blame("a name that it uses is defined by itself".to_owned());
            return Term::poison(at);
        }
        if let Some(each) = formula.each.first() {
            let message = "a property with `for each` stands for many formulas and cannot be used as one";
            let diagnostic = Diagnostic::new(Code::Misplaced, at, message)
                .also(each.var.span, "here")
                .help("repeat the `for each` here and name a formula without one");
            self.report(env, diagnostic);
            return Term::poison(at);
        }
        self.lower(&env.of_definition(), formula.body)
    }

    /// The place that a `decl` names, at the end of its path.
    pub fn declared(&mut self, env: &Env, decl: &ast::Decl, at: Span) -> Option<Place> {
        let root_env = Env::default();
        let lacks = self.trace.is_some_and(|t| t.topic(&decl.topic.absolute()).is_none());
        let (root, ty, known) = match decl.default {
            // What has a default is defined without any message: that there is none is no reason not to judge.
            Some(_) if lacks => self.apart(|cx| cx.declared_root(env, &decl.topic, &decl.ty)).0,
            _ => self.declared_root(env, &decl.topic, &decl.ty),
        };
        let ty = self.said_in_lines(decl).unwrap_or(ty);
        let place =
            Place { root, path: Vec::new(), label: String::new(), ty, known, default: None, stale: None, span: at };
        let mut place = place.follow(self, &root_env, &decl.ty.path)?;
        place.label = decl.name.name.clone();
        place.default = decl.default.as_ref().and_then(|e| self.default_value(&root_env, e, &place.ty));
        place.stale = decl.stale.as_ref().and_then(|d| self.duration(&root_env, d));
        Some(place)
    }

    /// The type of a declared topic whose messages come as lines of NDJSON that name it; a column of the declared name goes before.
    fn said_in_lines(&self, decl: &ast::Decl) -> Option<Type> {
        let trace = self.trace.filter(|t| t.schemaless && !t.has_column(&decl.name.name))?;
        let schema = trace.topic(&decl.topic.absolute())?.schema.clone()?;
        let is_meant = schema.name.rsplit('/').next() == Some(decl.ty.name.name.as_str());
        is_meant.then_some(Type::Message(schema))
    }

    /// The beginning of the way that a declaration describes.
    pub fn declared_root(&mut self, env: &Env, topic: &ast::Topic, ty: &ast::TypePath) -> (Root, Type, Known) {
        if self.schemaless() {
            let package = ty.package.as_ref().map(|p| p.name.as_str());
            let message = messages::known_type(package, &ty.name.name);
            return (Root::Declared(topic.clone(), ty.clone()), Type::Any, Known { dim: Dim::UNKNOWN, message });
        }
        let opened = self.open(env, topic, Some(ty));
        (Root::Topic(opened.topic), opened.ty, opened.known)
    }

    fn default_value(&mut self, env: &Env, expr: &ast::Expr, ty: &Type) -> Option<Value> {
        let term = self.lower(env, expr);
        let lowered = term.value(self, env);
        let Some(value) = constant_value(&lowered) else {
            if !self.found.failed {
                let message = "a default must be a number, a truth value or a text that is known beforehand";
                self.report(env, Diagnostic::new(Code::NotConstant, expr.span, message).label("this is not constant"));
            }
            return None;
        };
        let fits = matches!(
            (&value, ty),
            (_, Type::Any)
                | (Value::Num(_), Type::Num { .. })
                | (Value::Bool(_), Type::Bool)
                | (Value::Str(_), Type::Str)
        );
        if !fits {
            let message = format!("the default is {}, the signal {}", value.kind(), describe(ty));
            self.report(
                env,
                Diagnostic::new(Code::TypeMismatch, expr.span, message).label("does not go with the field's type"),
            );
            return None;
        }
        Some(value)
    }

    /// The fields of an event.
    pub fn event_place(&mut self, event: usize, at: Span) -> Place {
        let Event { source, .. } = &self.spec.events[event];
        let mut ty = Type::Any;
        if let EventSource::Message { topic } = source
            && let Some(trace) = self.trace
            && let Some(schema) = trace.topic(&self.spec.topics[*topic].name).and_then(|t| t.schema.clone())
        {
            ty = Type::Message(schema);
        }
        let half = self.halves.get(&event);
        let path = half.map(|half| half.path()).unwrap_or_default();
        let ty = half.map_or_else(|| ty.clone(), |half| half.ty(&ty));
        let known = Known { dim: Dim::UNKNOWN, message: known_message(&ty) };
        let label = String::new();
        Place { root: Root::Event(event), path, label, ty, known, default: None, stale: None, span: at }
    }

    /// A name that nothing declares.
    fn of_the_trace(&mut self, env: &Env, idents: &[Ident], joined: String, at: Span) -> Term {
        if let Some(port) = self.port(env, idents, at) {
            return port;
        }
        if let Some(value) = self.message_constant(env, idents, at) {
            return value;
        }
        let dim = world::dim_of(idents);
        match self.trace {
            None => column(joined, dim, at),
            Some(trace) if trace.schemaless && trace.columns_open => column(joined, dim, at),
            Some(_) => {
                // A whole whose parts are columns: `norm(v)` with `v.x` and `v.y`.
                let prefix = format!("{joined}.");
                if self.trace.is_some_and(|t| t.schemaless && t.columns.iter().any(|c| c.starts_with(&prefix))) {
                    return column(joined, dim, at);
                }
                self.unknown(env, idents, &joined, at);
                Term::poison(at)
            }
        }
    }

    /// The port `C.P` of a component system is the topic `/C/P`.
    fn port(&mut self, env: &Env, idents: &[Ident], at: Span) -> Option<Term> {
        let [component, port, rest @ ..] = idents else { return None };
        let name = format!("/{}/{}", component.name, port.name);
        let trace = self.trace?;
        if !(trace.is_of_components() && trace.columns_open) {
            trace.topic(&name)?;
        }
        let topic = ast::Topic { name, span: at };
        let opened = self.open(env, &topic, None);
        let label = format!("{}.{}", component.name, port.name);
        let root = Root::Topic(opened.topic);
        let (ty, known) = (opened.ty, opened.known);
        let place = Place { root, path: Vec::new(), label, ty, known, default: None, stale: None, span: at };
        Some(self.fields(env, Term::Place(Box::new(place)), rest).at(at))
    }

    fn unknown(&mut self, env: &Env, idents: &[Ident], joined: &str, at: Span) {
        let Some(trace) = self.trace else { return };
        let around = self.unit_around(joined, at);
        if let Some((span, Some(unit))) = around {
            let message =
                format!("unknown name `{joined}`: the unit `{}` is written `{unit}`", self.sources.slice(span));
            let diagnostic = Diagnostic::new(Code::UnknownName, span, message).label(format!("write `{unit}`"));
            return self.report(env, diagnostic.fix(span, unit));
        }
        let head = idents[0].name.as_str();
        let as_topic = format!("/{}", head);
        let guess = self.meant(env, idents, joined);
        let what =
            if trace.schemaless { "nothing declares it and no column has this name" } else { "nothing declares it" };
        let message = format!("unknown name `{joined}`{}", suggest::or_else(guess.as_deref()));
        let mut diagnostic = Diagnostic::new(Code::UnknownName, at, message).label(what);
        if let Some((span, None)) = around {
            let (written, units) = (self.sources.slice(span), lapwing_syntax::units_listed());
            diagnostic = diagnostic.help(format!("if `{written}` is meant as a unit: the units are {units}"));
        }
        if let Some(topic) = trace.topic(&as_topic) {
            let ty = crate::trace::plain_type(&topic.type_name);
            diagnostic =
                diagnostic.help(format!("the topic {as_topic} needs a declaration: `decl {head} {as_topic} {ty}`"));
        }
        if let Some(parts) = world::parts_of(idents).filter(|_| trace.schemaless) {
            diagnostic = diagnostic.help(format!("it would also be computed from the columns {parts}"));
        }
        if trace.schemaless {
            diagnostic = diagnostic
                .help(format!("the recording has {}", suggest::listed(trace.columns.iter().map(String::as_str))));
        }
        if let Some(edit) = guess.and_then(|guess| self.as_written(idents, &guess)) {
            diagnostic = diagnostic.fix(at, edit);
        }
        self.report(env, diagnostic);
    }

    /// What seems to be the unit of a number, of which an unknown name is the end, as `s2` in `1.5 m/s2`; and the unit that was meant, where
    /// there is such a one.
    fn unit_around(&self, name: &str, at: Span) -> Option<(Span, Option<&'static str>)> {
        let before = self.sources.text(at.file).get(..at.start as usize)?;
        let meant = lapwing_syntax::meant_unit(before, name)?;
        Some((Span { start: at.start.saturating_sub(meant.before as u32), ..at }, meant.unit))
    }

    /// A name that is proposed in place of another, with the variables of `for each` where they stand in that one: of the instance `r2`
    /// of `r.w` the name `r2.v` is `r.v`. `None` where a variable would be lost, so that the edit would be wrong in other instances.
    fn as_written(&self, idents: &[Ident], guess: &str) -> Option<String> {
        let mut parts: Vec<&str> = guess.split('.').collect();
        for (index, ident) in idents.iter().enumerate() {
            let written = self.sources.slice(ident.span).trim_matches('`');
            if written != ident.name {
                let part = parts.get_mut(index).filter(|part| **part == ident.name)?;
                *part = written;
            }
        }
        lapwing_syntax::written(&parts.join("."))
    }

    /// What an unknown name was probably meant to be: a column, a declared name with the same tail, or a quantity of the same object.
    fn meant(&self, env: &Env, idents: &[Ident], joined: &str) -> Option<String> {
        let columns = || self.trace.iter().flat_map(|t| &t.columns).map(String::as_str);
        let of_instance = columns().filter(|column| self.as_written(idents, column).is_some());
        if let Some(column) = suggest::nearest(joined, of_instance).or_else(|| suggest::nearest(joined, columns())) {
            return Some(column.to_owned());
        }
        let (head, tail) = joined.split_once('.').map_or((joined, None), |(head, tail)| (head, Some(tail)));
        let params = env.params.iter().map(|(name, _)| *name);
        let vars = env.vars.iter().map(|v| v.name.as_str());
        let objects = self.names.beliefs.keys().map(|(object, _)| *object).filter(|_| tail.is_some());
        let reach = params.chain(vars).chain(self.names.values.keys().copied()).chain(objects);
        if let Some(name) = suggest::nearest(head, reach) {
            return Some(tail.map_or_else(|| name.to_owned(), |tail| format!("{name}.{tail}")));
        }
        let asked = idents.get(1).filter(|_| !self.schemaless())?;
        let quantities = world::QUANTITIES.iter().filter_map(|q| q.split('.').next());
        let quantity = suggest::nearest(&asked.name, quantities)?;
        let rest: String = idents[2..].iter().map(|i| format!(".{}", i.name)).collect();
        Some(format!("{head}.{quantity}{rest}"))
    }

    /// `BatteryState.CHARGING`: a constant of a message, by its name or, where that says which, by the end of its name.
    fn message_constant(&mut self, env: &Env, idents: &[Ident], at: Span) -> Option<Term> {
        let [message, constant] = idents else { return None };
        let capital = |name: &str| name.starts_with(|c: char| c.is_ascii_uppercase());
        let is_constant = |name: &str| !name.chars().any(|c| c.is_ascii_lowercase());
        if !capital(&message.name) || !is_constant(&constant.name) {
            return None;
        }
        let known = self.constants_of(&message.name);
        let found = match_constant(&known, &constant.name);
        if let [(_, value)] = found.as_slice() {
            return Some(Term::Expr(literal(value, at)));
        }
        if known.is_empty() || self.trace.is_none() {
            return None;
        }
        let names = || known.iter().map(|(name, _)| name.as_str());
        let diagnostic = match found.is_empty() {
            true => {
                let guess = suggest::nearest(&constant.name, names());
                let message =
                    format!("{} has no constant `{}`{}", message.name, constant.name, suggest::or_else(guess));
                Diagnostic::new(Code::UnknownName, constant.span, message)
                    .help(format!("its constants are {}", suggest::listed(names())))
            }
            false => {
                let message = format!("`{}` can be several constants of {}", constant.name, message.name);
                let which = suggest::listed(found.iter().map(|(name, _)| name.as_str()));
                Diagnostic::new(Code::UnknownName, constant.span, message).help(format!("write one of {which}"))
            }
        };
        self.report(env, diagnostic);
        Some(Term::poison(at))
    }

    /// The constants of a message type: as the trace defines them, else those that are known anyway.
    fn constants_of(&self, message: &str) -> Vec<(String, Value)> {
        let schemas = self.trace.iter().flat_map(|t| &t.topics).filter_map(|t| t.schema.as_ref());
        for schema in schemas {
            if let Some(found) = world::find_schema(schema, message, 0) {
                return found.constants.iter().map(|c| (c.name.to_string(), c.value.clone())).collect();
            }
        }
        messages::constants(message).iter().map(|(name, value)| ((*name).to_owned(), Value::Num(*value))).collect()
    }
}

/// The constants that a name can mean: the one of just that name, else those that end in it. `NOT_CHARGING` is no `CHARGING`.
fn match_constant<'c>(known: &'c [(String, Value)], name: &str) -> Vec<&'c (String, Value)> {
    if let Some(exact) = known.iter().find(|(n, _)| n == name) {
        return vec![exact];
    }
    let tail = format!("_{name}");
    let prefix = |n: &str| n.strip_suffix(&tail).map(str::to_owned);
    let ends: Vec<(&(String, Value), String)> = known.iter().filter_map(|c| Some((c, prefix(&c.0)?))).collect();
    let longer = |p: &str| ends.iter().any(|(_, other)| p.starts_with(&format!("{other}_")));
    ends.iter().filter(|(_, p)| !longer(p)).map(|(c, _)| *c).collect()
}

fn known_message(ty: &Type) -> Option<&'static str> {
    let Type::Message(schema) = ty else { return None };
    let (package, short) = schema.name.split_once('/')?;
    messages::known_type(Some(package), short)
}

/// An undeclared column.
fn column(name: String, dim: Dim, span: Span) -> Term {
    let known = Known { dim, message: None };
    let place = Place {
        root: Root::Column,
        path: Vec::new(),
        label: name,
        ty: Type::Any,
        known,
        default: None,
        stale: None,
        span,
    };
    Term::Place(Box::new(place))
}

/// A value written out.
fn literal(value: &Value, span: Span) -> Expr {
    let (kind, ty) = match value {
        Value::Bool(b) => (Kind::Bool(*b), Type::Bool),
        Value::Str(s) => (Kind::Str(s.clone()), Type::Str),
        Value::Num(x) => (Kind::Num(*x), Type::Num { float: x.fract() != 0.0 }),
        _ => (Kind::Num(f64::NAN), Type::Num { float: true }),
    };
    Expr { kind, ty, dim: Dim::UNKNOWN, span }
}
