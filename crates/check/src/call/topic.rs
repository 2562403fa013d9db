//! Functions of a topic, and of a running system.

use lapwing_diag::{Code, Diagnostic};
use lapwing_stream::{Type, Value};
use lapwing_syntax::ast::{self, ExprKind};

use crate::checked::{Dim, Expr, Input, InputSource, Kind, Step};
use crate::context::{Cx, Env};
use crate::expr::plain;
use crate::names::Named;
use crate::term::Term;
use crate::trace::TraceShape;

use super::Call;

/// `age`
pub(super) fn age(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [topic] = call.args else { return None };
    let Some(topic) = topic_number(cx, env, topic) else { return Some(Term::poison(call.span)) };
    Some(Term::Expr(Expr { kind: Kind::Age(topic), ty: Type::Num { float: true }, dim: Dim::TIME, span: call.span }))
}

/// `frequency`
pub(super) fn frequency(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [topic, duration] = call.args else { return None };
    let topic = topic_number(cx, env, topic);
    let duration = cx.duration_of(env, duration);
    let (Some(topic), Some(duration)) = (topic, duration) else { return Some(Term::poison(call.span)) };
    let kind = Kind::Frequency(topic, duration);
    Some(Term::Expr(Expr { kind, ty: Type::Num { float: true }, dim: Dim::FREQUENCY, span: call.span }))
}

/// `fresh`
pub(super) fn fresh(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [topic] = call.args else { return None };
    let Some(topic) = topic_number(cx, env, topic) else { return Some(Term::poison(call.span)) };
    Some(Term::Expr(plain(Kind::Fresh(topic), Type::Bool, call.span)))
}

/// `publishers`: only a live monitor can count them.
pub(super) fn publishers(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [topic] = call.args else { return None };
    let Some(topic) = topic_named(cx, env, topic) else { return Some(Term::poison(call.span)) };
    let label = format!("publishers({})", topic.absolute());
    Some(of_the_system(cx, label, Type::Num { float: false }, call))
}

/// `running(C.A)`: only a component system says what runs.
pub(super) fn running(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [ast::Expr { kind: ExprKind::Path(idents), .. }] = call.args else { return None };
    let activity = idents.iter().map(|i| i.name.as_str()).collect::<Vec<_>>().join(".");
    if cx.trace.is_some_and(TraceShape::is_of_components) {
        let name = format!("/{}/running", activity.replace('.', "/"));
        let topic = cx.open(env, &ast::Topic { name, span: call.args[0].span }, None).topic;
        let field = cx.field(topic, &vec![Step::Field("data".to_owned())]);
        let (label, source) = (format!("running {activity}"), InputSource::Field { topic, field });
        // Before anything is said of it, nothing runs.
        let default = Some(Value::Bool(false));
        let input = Input { label, source, ty: Type::Bool, dim: Dim::UNKNOWN, default, stale: None };
        return Some(Term::Expr(cx.input(input, call.span)));
    }
    Some(of_the_system(cx, format!("running {activity}"), Type::Bool, call))
}

/// A signal that only a running system has.
fn of_the_system(cx: &mut Cx, label: String, ty: Type, call: &Call) -> Term {
    if cx.trace.is_some_and(|t| !t.live) {
        cx.found.blame(format!("`{label}` is known only of a running system, not from a recording"));
    }
    let source = InputSource::Column(cx.column(&label));
    Term::Expr(cx.input(Input { label, source, ty, dim: Dim::UNKNOWN, default: None, stale: None }, call.span))
}

fn topic_number(cx: &mut Cx, env: &Env, arg: &ast::Expr) -> Option<usize> {
    let topic = topic_named(cx, env, arg)?;
    Some(cx.open(env, &topic, None).topic)
}

/// The topic that an argument names: itself, by a parameter, or by a signal that is declared on it.
fn topic_named(cx: &mut Cx, env: &Env, arg: &ast::Expr) -> Option<ast::Topic> {
    match &arg.kind {
        ExprKind::Topic(topic) => return cx.without_holes(env, topic),
        _ if env.is_open(arg) => return None,
        ExprKind::Path(idents) if idents.len() == 1 => {
            let name = idents[0].name.as_str();
            if let Some((_, bound)) = env.params.iter().find(|(param, _)| *param == name) {
                let caller = env.caller.map_or_else(Env::default, Env::clone);
                return topic_named(cx, &caller, bound);
            }
            if let Some(Named::Decl(decl)) = cx.names.get(name) {
                return Some(decl.topic.clone());
            }
        }
        // The port of a component.
        ExprKind::Path(idents) if idents.len() == 2 && cx.names.get(&idents[0].name).is_none() => {
            return Some(ast::Topic { name: format!("/{}/{}", idents[0].name, idents[1].name), span: arg.span });
        }
        _ => {}
    }
    let text = cx.sources.slice(arg.span).trim_matches('"').trim_start_matches('/').to_owned();
    let diagnostic = Diagnostic::new(Code::WrongArguments, arg.span, "a topic is wanted here")
        .label("no topic")
        .help(format!("a topic begins with a slash: `/{text}`"));
    cx.report(env, diagnostic);
    None
}

impl Cx<'_> {
    /// A topic in which nothing is left open; reported where a `{r}` stands for nothing.
    pub fn without_holes(&mut self, env: &Env, topic: &ast::Topic) -> Option<ast::Topic> {
        let is_known = |hole: &str| env.topics.iter().any(|name| name == hole);
        let Some(hole) = holes(&topic.name).find(|hole| !is_known(hole)) else { return Some(topic.clone()) };
        let message = format!("`{{{hole}}}` stands for nothing here");
        let mut diagnostic = Diagnostic::new(Code::UnknownName, topic.span, message);
        diagnostic = match env.slices.iter().any(|name| name == hole) {
            true => diagnostic
                .label("its values are known only while the monitor runs")
                .help("a topic can be chosen by `for each … in topics` and by a list, `for each … in (a, b)`"),
            false => diagnostic
                .label(format!("no `for each {hole} in …` around it"))
                .help(format!("write `for each {hole} in topics {}: …` in front of the formula", topic.absolute())),
        };
        self.report(env, diagnostic);
        None
    }
}

/// What stands in the curly brackets of a topic.
fn holes(topic: &str) -> impl Iterator<Item = &str> {
    topic.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(hole, _)| hole)
}
