//! A specification to start from.

use std::collections::BTreeSet;
use std::path::Path;

use lapwing_record::{OpenError, Recording, TopicInfo};
use lapwing_stream::{Schema, Type};
use lapwing_syntax::{FileId, parse, written};

use crate::session::Options;

/// What stands at the top of every one.
const HEAD: &str = "\
# What must be true of your robot. A line that begins with # is a comment: take the sign away to make it count.
#
#   lapwing check THIS.rv RECORDING     checks a recording
#   lapwing explain THIS.rv             says what each property means
";

/// What there is to say without a recording.
const EXAMPLES: &str = "
# Signals: a name, the topic that it comes from, and the field of its messages.
#
# decl speed /odom nav_msgs/Odometry.twist.twist.linear.x
# decl cmd   /cmd_vel geometry_msgs/Twist.linear.x
# decl scan  /scan sensor_msgs/LaserScan.ranges

# Properties: what must be true, and when.
#
# never speed > 1.5 m/s
# never min(scan) < 0.2 m
# always age(/scan) < 0.5 s
# whenever held for 0.5 s (cmd > 0.03 m/s), speed > -0.01 m/s
# follows: whenever becomes cmd > 0.1 m/s, eventually within 2 s speed > 0.05 m/s
";

/// A field deeper than this in a message is not looked for.
const DEEPEST: usize = 6;

/// A specification to start from, without a recording.
pub fn blank() -> String {
    format!("{HEAD}{EXAMPLES}")
}

/// A specification to start from, with the topics or columns of a recording.
pub fn of(trace: &Path, options: &Options) -> Result<String, OpenError> {
    let recording = lapwing_record::open(trace, options.recording.clone())?;
    let mut out = String::from(HEAD);
    out += &format!("\n# What {} carries ({}).\n", shown(&trace.to_string_lossy()), recording.format());
    match recording.is_schemaless() && recording.topics().is_empty() {
        true => columns(&recording, &mut out),
        false => topics(&recording, &mut out),
    }
    Ok(out)
}

/// The columns of a table: they need no declaration.
fn columns(recording: &Recording, out: &mut String) {
    if recording.columns().is_empty() {
        *out += "# Its values are signals by their names and need no declaration.\n";
        *out += "\n# never speed > 1.5\n";
        return;
    }
    *out += "# Its columns are signals by their names and need no declaration:\n";
    let mut signals = Vec::new();
    for column in recording.columns() {
        match written(column) {
            Some(signal) => {
                *out += &format!("#   {}\n", shown(&signal));
                signals.push(signal);
            }
            None => *out += &format!("#   {}, a name that no specification can write: rename it\n", shown(column)),
        }
    }
    if !signals.is_empty() {
        *out += "\n# Properties to begin with.\n#\n";
        signals.iter().take(3).for_each(|signal| *out += &format!("# never {signal} > 1.5\n"));
    }
}

fn topics(recording: &Recording, out: &mut String) {
    let mut properties = Vec::new();
    let mut fresh = Vec::new();
    let mut names = BTreeSet::new();
    for topic in recording.topics() {
        let messages = topic.messages.map(|n| format!(", {n} messages")).unwrap_or_default();
        *out += &format!("\n# {} {}{messages}\n", shown(&topic.name), shown(&topic.type_name));
        match declared(topic, &mut names) {
            Some(signal) => {
                *out += &signal.declaration;
                properties.extend(signal.properties);
                fresh.push(signal.fresh);
            }
            None => *out += &undeclared(topic),
        }
    }
    // Of messages of one's own it is known at least that they should keep coming.
    if properties.is_empty() {
        properties.extend(fresh.into_iter().take(3));
    }
    if !properties.is_empty() {
        *out += "\n# Properties to begin with.\n#\n";
        properties.iter().for_each(|p| *out += &format!("# {p}\n"));
    }
}

/// Why there is no declaration.
fn undeclared(topic: &TopicInfo) -> String {
    match (&topic.schema, short(&topic.type_name)) {
        (_, "ModelStates") => {
            "# The ground truth: `NAME.position`, `NAME.velocity`, `NAME.distance.OTHER` need no declaration.\n"
                .to_owned()
        }
        (Err(why), _) => format!("# Its type is not known: {}\n", shown(why.lines().next().unwrap_or_default())),
        (Ok(schema), _) if first(schema, 0).is_some() => {
            "# Its name, or that of its type, is one that no specification can write.\n".to_owned()
        }
        (Ok(_), _) => "# It has no field that is a number, a boolean or a text.\n".to_owned(),
    }
}

/// A declaration, and what may be asked of it.
struct Signal {
    declaration: String,
    properties: Vec<String>,
    /// That its messages keep coming.
    fresh: String,
}

/// The declaration of a topic, by a name that none of `names` is, and which is added to them.
fn declared(topic: &TopicInfo, names: &mut BTreeSet<String>) -> Option<Signal> {
    let schema = topic.schema.as_ref().ok()?;
    let field = usual(short(&topic.type_name))
        .filter(|path| has(schema, path))
        .map(str::to_owned)
        .or_else(|| first(schema, 0))?;
    let absolute = format!("/{}", topic.name.trim_start_matches('/'));
    let line = |name: &str| format!("decl {name} {absolute} {}.{field}\n", topic.type_name);
    let plain = unlike(name(&absolute), names);
    let name = if is_fine(&line(&plain)) { plain.clone() } else { format!("`{plain}`") };
    let declaration = line(&name);
    if !is_fine(&declaration) {
        return None;
    }
    names.insert(plain);
    let properties = properties(&name, &absolute, short(&topic.type_name));
    Some(Signal { declaration, properties, fresh: fresh(&absolute) })
}

/// The name, or one made of it that is none of `names`: `/a/b` and `/a_b` are two topics.
fn unlike(name: String, names: &BTreeSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    std::iter::once(name.clone()).chain(numbered).find(|name| !names.contains(name)).unwrap_or(name)
}

/// The field that people usually ask about.
fn usual(ty: &str) -> Option<&'static str> {
    Some(match ty {
        "Odometry" => "twist.twist.linear.x",
        "Twist" => "linear.x",
        "TwistStamped" => "twist.linear.x",
        "LaserScan" => "ranges",
        "Imu" => "angular_velocity.z",
        "BatteryState" => "percentage",
        "PoseStamped" => "pose.position.x",
        "PoseWithCovarianceStamped" => "pose.pose.position.x",
        "JointState" => "velocity",
        _ => return None,
    })
}

/// What is often asked of a topic of that type.
fn properties(name: &str, topic: &str, ty: &str) -> Vec<String> {
    let fresh = fresh(topic);
    match ty {
        "Odometry" | "TwistStamped" => vec![format!("never {name} > 1.5 m/s"), fresh],
        "LaserScan" => vec![format!("never min({name}) < 0.2 m"), fresh],
        "Twist" => vec![format!("never {name} > 1.5 m/s")],
        "BatteryState" => vec![format!("never {name} < 0.2")],
        _ => Vec::new(),
    }
}

fn fresh(topic: &str) -> String {
    format!("always age({topic}) < 1 s")
}

/// Whether a schema has a field at the end of a way.
fn has(schema: &Schema, path: &str) -> bool {
    let mut schema = schema;
    let mut parts = path.split('.').peekable();
    while let Some(part) = parts.next() {
        match schema.field(part).map(|f| &f.ty) {
            Some(Type::Message(inner)) => schema = inner,
            Some(_) => return parts.peek().is_none(),
            None => return false,
        }
    }
    false
}

/// The way to the first number, boolean or text of a message, headers aside.
fn first(schema: &Schema, depth: usize) -> Option<String> {
    let fields = || schema.fields.iter().filter(|f| &*f.name != "header");
    let scalar = fields().find(|f| matches!(f.ty, Type::Bool | Type::Num { .. } | Type::Str));
    if let Some(field) = scalar {
        return Some(field.name.to_string());
    }
    let inner = |f: &lapwing_stream::Field| match &f.ty {
        Type::Message(inner) if depth < DEEPEST => first(inner, depth + 1).map(|rest| format!("{}.{rest}", f.name)),
        _ => None,
    };
    fields().find_map(inner)
}

fn short(type_name: &str) -> &str {
    type_name.rsplit(['/', '.']).next().unwrap_or(type_name)
}

/// A name for a topic: its own, with `_` for every slash.
fn name(topic: &str) -> String {
    let name: String =
        topic.trim_start_matches('/').chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    match name.starts_with(|c: char| c.is_alphabetic()) {
        true => name,
        false => format!("topic_{name}"),
    }
}

/// Whether a statement can be read, as one.
fn is_fine(statement: &str) -> bool {
    let read = parse(FileId(0), statement);
    read.diagnostics.is_empty() && read.file.items.len() == 1
}

/// What a recording says, on one line of a comment: whoever wrote it must not write statements.
fn shown(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { c.escape_default().to_string() } else { c.to_string() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spec;

    #[test]
    fn what_a_recording_calls_its_topics_is_never_a_statement() {
        assert_eq!(shown("/a\nnever 1 > 0\r"), "/a\\nnever 1 > 0\\r");
        assert!(!is_fine("decl a /a\ndecl b /b T.x\n") && !is_fine("never x > 0\nnever y > 0\n"));
    }

    #[test]
    fn the_blank_one_is_a_specification_with_its_comments_and_without() {
        let spec = |text: &str| Spec::parse("new.rv", text, &|_| None).map_err(|e| e.to_string());
        assert!(spec(&blank()).is_ok());
        let bare: String = EXAMPLES
            .lines()
            .filter(|l| l.contains("decl ") || !l.contains(':') || l.contains("follows"))
            .map(|l| l.trim_start_matches(['#', ' ']).to_owned() + "\n")
            .collect();
        let read = spec(&bare).unwrap();
        assert_eq!(read.alone().spec.properties.len(), 5, "{bare}");
        assert_eq!(lapwing_syntax::format(&blank()).unwrap(), blank());
    }
}
