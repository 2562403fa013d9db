//! Message definitions: what `.msg` and `.idl` texts say, before and after their types are looked up.

pub(crate) mod bundled;
mod idl;
mod layout;
mod msg;
mod share;

use lapwing_stream::{Constant, Name, Value};

pub use bundled::text_with_parts as bundled_text;
pub use layout::{Layout, Node, Prim};
pub use share::Library;

/// A text that is no message definition, or not one that can be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct DefinitionError {
    what: String,
}

impl DefinitionError {
    pub(crate) fn new(what: impl Into<String>) -> DefinitionError {
        DefinitionError { what: what.into() }
    }
}

/// Whose rules a definition follows. They differ in what `char`, `time` and an empty message are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// `.msg` files of ROS 1.
    Ros1,
    /// `.msg` files of ROS 2.
    Ros2,
    /// `.idl` files, as ROS 2's tools write them.
    Idl,
}

/// A text of definitions may not be longer than this, in bytes.
const MAX_TEXT: usize = 1 << 22;
/// A message may not have more fields than this, those of its fields not counted.
const MAX_FIELDS: usize = 1 << 14;

/// One message type as its definition says it, with the names of other types not yet looked up.
#[derive(Clone, Debug, PartialEq, Default)]
pub(crate) struct Definition {
    /// The full name without `/msg`: `nav_msgs/Odometry`.
    pub name: String,
    pub fields: Vec<FieldDef>,
    pub constants: Vec<Constant>,
}

impl Definition {
    /// The full names of the messages that its fields are, each as often as it occurs.
    pub fn parts(&self) -> impl Iterator<Item = &String> {
        self.fields.iter().filter_map(|f| if let Base::Message(name) = &f.ty.base { Some(name) } else { None })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldDef {
    pub name: Name,
    pub ty: FieldType,
    /// What it is where a message does not say, for those who make messages.
    pub default: Option<Value>,
}

/// The type of a field: a base, and the lengths of the arrays around it, the outermost first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldType {
    pub base: Base,
    /// `None` is an array of varying length.
    pub arrays: Vec<Option<usize>>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Base {
    Prim(Prim),
    Text,
    WideText,
    /// A message of that full name.
    Message(String),
}

/// All definitions of a text, the root first.
pub(crate) fn parse(dialect: Dialect, root: &str, text: &str) -> Result<Vec<Definition>, DefinitionError> {
    if text.len() > MAX_TEXT {
        return Err(DefinitionError::new(format!("its definition is longer than {MAX_TEXT} bytes")));
    }
    match dialect {
        Dialect::Ros1 | Dialect::Ros2 => msg::parse(dialect, root, text),
        Dialect::Idl => idl::parse(root, text),
    }
}

/// The name of a type as everything here spells it: `nav_msgs/msg/Odometry`, `nav_msgs::msg::dds_::Odometry_` and
/// `nav_msgs/Odometry` are all `nav_msgs/Odometry`.
pub fn normal_name(name: &str) -> String {
    if let Some((package, rest)) = name.split_once("::msg::") {
        let rest = rest.strip_prefix("dds_::").and_then(|r| r.strip_suffix('_')).unwrap_or(rest);
        return format!("{package}/{rest}");
    }
    match name.split_once("/msg/") {
        Some((package, rest)) => format!("{package}/{rest}"),
        None => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_normalised() {
        for name in
            ["nav_msgs/msg/Odometry", "nav_msgs/Odometry", "nav_msgs::msg::dds_::Odometry_", "nav_msgs::msg::Odometry"]
        {
            assert_eq!(normal_name(name), "nav_msgs/Odometry");
        }
        assert_eq!(normal_name("foxglove.Pose"), "foxglove.Pose");
    }
}
