//! The shape of a message: what a `.msg` definition, a Protobuf descriptor or a JSON schema says of it.

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::value::Name;

/// The type of a field, as far as a specification can tell types apart.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    /// True or false.
    Bool,
    /// Any integer or floating-point number; `float` says which, for the lint on comparing floats by `==`.
    Num { float: bool },
    /// A text.
    Str,
    /// An array, of fixed or varying length.
    Array(alloc::boxed::Box<Type>),
    /// A message inside a message. ROS 1's `time` and `duration` are messages of `sec` and `nanosec`, as ROS 2's are.
    Message(Arc<Schema>),
    /// Unknown before a value is seen: a CSV column, a JSON field without a schema.
    Any,
}

/// A message type: its fields in order and its constants.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Schema {
    /// The full name without `/msg`, for every version of ROS: `nav_msgs/Odometry`.
    pub name: String,
    /// The fields, in the order of the definition.
    pub fields: Vec<Field>,
    /// The constants, in the order of the definition.
    pub constants: Vec<Constant>,
}

/// One field of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: Type,
}

/// One constant of a message, such as `BatteryState.POWER_SUPPLY_STATUS_CHARGING`.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// Its name.
    pub name: Name,
    /// Its value: a number, a boolean or a text.
    pub value: crate::Value,
}

impl Schema {
    /// The field of that name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|f| &*f.name == name)
    }

    /// The constant of that name.
    pub fn constant(&self, name: &str) -> Option<&Constant> {
        self.constants.iter().find(|c| &*c.name == name)
    }
}
