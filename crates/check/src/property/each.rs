//! `for each`: which instances of a property there are.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{EachSet, Expr, ForEach, Ident, Topic};

use crate::checked::{Event, EventSource, Path, Point, PointKind, Step};
use crate::context::{Cx, Env};
use crate::machine::event_named;
use crate::names::Named;

use super::substitute::{in_topic, substitute};

/// More instances than this are refused.
const MOST_INSTANCES: usize = 10_000;

/// The instances of a property.
#[derive(Debug, Default)]
pub(super) struct Instances {
    pub list: Vec<Instance>,
    /// The slices, outermost first: variable, event, field.
    pub slices: Vec<(String, usize, Path)>,
    /// Why there is no instance at all.
    pub nothing: Option<String>,
}

/// One instance: what stands for the variables.
#[derive(Clone, Debug, Default)]
pub(super) struct Instance {
    values: Vec<(String, String)>,
}

impl Instance {
    /// `[robot1][north]`
    pub fn suffix(&self) -> String {
        self.values.iter().map(|(_, value)| format!("[{value}]")).collect()
    }

    /// The formula of this instance.
    pub fn formula(&self, body: &Expr) -> Expr {
        self.values.iter().fold(body.clone(), |body, (var, value)| substitute(&body, var, value))
    }

    fn topic(&self, topic: &Topic) -> Topic {
        self.values.iter().fold(topic.clone(), |topic, (var, value)| in_topic(&topic, var, value))
    }

    fn with(&self, var: &Ident, value: &str) -> Instance {
        let mut values = self.values.clone();
        values.push((var.name.clone(), value.to_owned()));
        Instance { values }
    }
}

/// Unrolls the quantifiers, outermost first.
pub(super) fn instances(cx: &mut Cx, env: &Env, each: &[ForEach]) -> Instances {
    let mut all = Instances { list: vec![Instance::default()], ..Instances::default() };
    for each in each {
        if all.list.is_empty() {
            break;
        }
        match &each.set {
            EachSet::List(values) => over_list(cx, env, &mut all, &each.var, values),
            EachSet::Topics(topic) => over_topics(cx, &mut all, &each.var, topic),
            EachSet::Values(event, path) => over_values(cx, env, &mut all, &each.var, event, path),
        }
        if all.list.len() > MOST_INSTANCES {
            let message = format!("`for each` makes more than {MOST_INSTANCES} instances here");
            cx.report(env, Diagnostic::new(Code::TooLarge, each.var.span, message));
            all.list.truncate(1);
        }
    }
    all
}

fn over_list(cx: &mut Cx, env: &Env, all: &mut Instances, var: &Ident, values: &[Ident]) {
    for (index, value) in values.iter().enumerate() {
        if let Some(first) = values[..index].iter().find(|v| v.name == value.name) {
            let diagnostic =
                Diagnostic::new(Code::DuplicateName, value.span, format!("`{}` is listed twice", value.name))
                    .label("once more here")
                    .also(first.span, "first here");
            cx.report(env, diagnostic);
        }
    }
    if values.is_empty() {
        all.nothing = Some("the list of `for each` is empty".to_owned());
    }
    all.list = all
        .list
        .iter()
        .flat_map(|one| values.iter().map(|v| one.with(var, &v.name)))
        .take(MOST_INSTANCES + 1)
        .collect();
}

/// One instance per topic of the trace that matches; without a trace the formula as it stands.
fn over_topics(cx: &Cx, all: &mut Instances, var: &Ident, topic: &Topic) {
    let Some(trace) = cx.trace else { return };
    let before = std::mem::take(&mut all.list);
    for one in &before {
        let pattern = one.topic(topic).absolute();
        let mut values: Vec<&str> = trace.topics.iter().filter_map(|t| matched(&pattern, &var.name, &t.name)).collect();
        values.sort_unstable();
        values.dedup();
        all.list.extend(values.into_iter().map(|value| one.with(var, value)));
    }
    if all.list.is_empty() {
        all.nothing = Some(format!("no topic {} matches {}", trace.of_here(), topic.absolute()));
    }
}

/// What `{r}` stands for where a topic matches `/{r}/odom`: one part of a name, without slashes, the same everywhere.
fn matched<'t>(pattern: &str, var: &str, topic: &'t str) -> Option<&'t str> {
    let hole = format!("{{{var}}}");
    let (before, after) = pattern.split_once(&hole)?;
    let rest = topic.strip_prefix(before)?;
    // What follows the hole up to the next slash belongs to the same part of the name.
    let part = &rest[..rest.find('/').unwrap_or(rest.len())];
    let tail = &after[..after.find('/').unwrap_or(after.len())];
    let value = match tail.contains(&hole) {
        true => part,
        false => part.strip_suffix(tail)?,
    };
    (!value.is_empty() && pattern.replace(&hole, value) == topic).then_some(value)
}

fn over_values(cx: &mut Cx, env: &Env, all: &mut Instances, var: &Ident, event: &Ident, path: &[Ident]) {
    let Some(number) = sliced_event(cx, env, event) else { return };
    let path = path.iter().map(|part| Step::Field(part.name.clone())).collect();
    all.slices.push((var.name.clone(), number, path));
}

/// The event whose values make instances: a declared one, or `call`, any span of a program.
fn sliced_event(cx: &mut Cx, env: &Env, event: &Ident) -> Option<usize> {
    if !matches!(event.name.as_str(), "call" | "return") || matches!(cx.names.get(&event.name), Some(Named::Event(_))) {
        return event_named(cx, env, event);
    }
    if cx.trace.is_some_and(|t| !t.live) {
        cx.found.blame("a recording has no calls".to_owned());
    }
    let kind = if event.name == "call" { PointKind::Call } else { PointKind::Return };
    let source = EventSource::Point(Point { kind, path: Vec::new(), below: None });
    let known = cx.spec.events.iter().position(|e| e.source == source);
    Some(known.unwrap_or_else(|| {
        cx.spec.events.push(Event { name: event.name.clone(), source, fields: Vec::new(), when: None });
        cx.spec.events.len() - 1
    }))
}

#[cfg(test)]
mod tests {
    use super::matched;

    #[test]
    fn holes_in_topics() {
        assert_eq!(matched("/{r}/odom", "r", "/robot1/odom"), Some("robot1"));
        assert_eq!(matched("/{r}/odom", "r", "/a/b/odom"), None);
        assert_eq!(matched("/robot{r}/odom", "r", "/robot12/odom"), Some("12"));
        assert_eq!(matched("/{r}_base/x", "r", "/left_base/x"), Some("left"));
        assert_eq!(matched("/{r}", "r", "/odom"), Some("odom"));
        assert_eq!(matched("/{r}/{r}", "r", "/a/a"), Some("a"));
        assert_eq!(matched("/{r}/{r}", "r", "/a/b"), None);
        assert_eq!(matched("/odom", "r", "/odom"), None);
    }
}
