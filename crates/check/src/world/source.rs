//! Where the ground truth of an object comes from: a `world` statement, else the simulator's model states.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast::{self, Ident, TypePath, WorldSource};

use crate::checked::{ObjectSource, Step};
use crate::context::{Cx, Env};

/// Gazebo's ground truth of everything.
pub(crate) const DEFAULT_TOPIC: &str = "/gazebo/model_states";

/// The types that ground truth may have.
const TYPES: &[&str] = &["Odometry", "PoseStamped", "ModelStates"];

/// The number of an object; a source that the trace lacks is a cause each time it is asked for.
pub(super) fn object(cx: &mut Cx, env: &Env, name: &str, span: Span) -> usize {
    let source = match declared(cx, name) {
        Some(WorldSource::Topic { topic, ty }) => {
            let topic = ast::Topic { name: topic.name.replace("{name}", name), span: topic.span };
            on_topic(cx, env, &topic, ty)
        }
        Some(WorldSource::Tf { fixed, frame }) => transforms(cx, env, &fixed.name, &frame.name, fixed.span),
        None => {
            let topic = ast::Topic { name: DEFAULT_TOPIC.to_owned(), span };
            on_topic(cx, env, &topic, &type_named("ModelStates", span))
        }
    };
    cx.object(name, source)
}

/// Whether the trace, one without schemas, has the topic that an object's ground truth would come from.
pub(super) fn is_there(cx: &Cx, name: &str) -> bool {
    let topic = match declared(cx, name) {
        Some(WorldSource::Topic { topic, .. }) => topic.absolute().replace("{name}", name),
        Some(WorldSource::Tf { .. }) => "/tf".to_owned(),
        None => DEFAULT_TOPIC.to_owned(),
    };
    cx.trace.is_some_and(|t| t.topic(&topic).is_some())
}

/// Checks the `world` statements, and reads the topics that they name.
pub(crate) fn declare_sources(cx: &mut Cx) {
    let env = Env::default();
    for world in cx.names.worlds.clone() {
        match &world.source {
            WorldSource::Topic { ty, .. } if !TYPES.contains(&ty.name.name.as_str()) => unsuited(cx, &env, ty),
            WorldSource::Topic { topic, ty } if !topic.name.contains("{name}") && may_have(cx, &topic.absolute()) => {
                on_topic(cx, &env, topic, ty);
            }
            WorldSource::Tf { fixed, frame } if may_have(cx, "/tf") => {
                transforms(cx, &env, &fixed.name, &frame.name, fixed.span);
            }
            WorldSource::Topic { .. } | WorldSource::Tf { .. } => {}
        }
    }
}

/// Whether a topic must be looked for: one of columns alone is not expected to have it.
fn may_have(cx: &Cx, topic: &str) -> bool {
    !cx.schemaless() || cx.trace.is_some_and(|t| t.topic(topic).is_some())
}

/// The statement about this very object, else the one about all.
fn declared<'a>(cx: &Cx<'a>, name: &str) -> Option<&'a WorldSource> {
    let of = |world: &&&ast::World| world.object.as_ref().is_some_and(|o| o.name == name);
    let all = |world: &&&ast::World| world.object.is_none();
    let worlds = &cx.names.worlds;
    worlds.iter().find(of).or_else(|| worlds.iter().find(all)).map(|world| &world.source)
}

fn on_topic(cx: &mut Cx, env: &Env, topic: &ast::Topic, ty: &TypePath) -> ObjectSource {
    let topic = cx.open(env, topic, Some(ty)).topic;
    let mut field = |names: &[&str]| {
        let path = names.iter().map(|n| Step::Field((*n).to_owned())).collect();
        cx.field(topic, &path)
    };
    match ty.name.name.as_str() {
        "Odometry" => {
            ObjectSource::Odometry { topic, pose: field(&["pose", "pose"]), twist: field(&["twist", "twist"]) }
        }
        "PoseStamped" => ObjectSource::Pose { topic, pose: field(&["pose"]) },
        _ => {
            let (name, pose, twist) = (field(&["name"]), field(&["pose"]), field(&["twist"]));
            ObjectSource::ModelStates { topic, name, pose, twist }
        }
    }
}

fn transforms(cx: &mut Cx, env: &Env, fixed: &str, frame: &str, span: Span) -> ObjectSource {
    let there = |name: &str| cx.trace.is_none_or(|t| t.topic(name).is_some());
    let names: Vec<&str> = ["/tf", "/tf_static"].into_iter().filter(|n| there(n)).collect();
    let names = if names.is_empty() { vec!["/tf"] } else { names };
    let mut topics = Vec::new();
    for name in names {
        let topic = ast::Topic { name: name.to_owned(), span };
        let topic = cx.open(env, &topic, Some(&type_named("TFMessage", span))).topic;
        topics.push((topic, cx.field(topic, &vec![Step::Field("transforms".to_owned())])));
    }
    ObjectSource::Tf { topics, fixed: fixed.to_owned(), frame: frame.to_owned() }
}

fn unsuited(cx: &mut Cx, env: &Env, ty: &TypePath) {
    let message = format!("a {} is no ground truth of an object", ty.name.name);
    let diagnostic = Diagnostic::new(Code::WorldSource, ty.span, message)
        .label("not one of the types that hold a pose")
        .help("ground truth comes as Odometry, PoseStamped or ModelStates, or as `world robot tf map robot/base_link`");
    cx.report(env, diagnostic);
}

fn type_named(name: &str, span: Span) -> TypePath {
    TypePath { package: None, name: Ident { name: name.to_owned(), span }, path: Vec::new(), span }
}
