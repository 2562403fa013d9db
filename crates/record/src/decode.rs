//! Turns the bytes of a message into the values of the wanted fields, and only those.

mod cursor;
mod json;
mod plan;
pub(crate) mod protobuf;
mod run;
pub(crate) mod scan;
pub(crate) mod span;
mod tree;

use std::sync::Arc;

use lapwing_stream::{Schema, Value};

pub(crate) use json::value as json_value;
pub(crate) use run::{set_bool, set_number, set_text};

use crate::definition::Layout;
use crate::path::Path;
use plan::Plan;
use tree::Tree;

/// What a message type is, as far as decoding goes.
#[derive(Clone, Debug)]
pub enum MessageType {
    /// ROS 1: packed, little-endian.
    Ros1(Arc<Layout>),
    /// ROS 2: CDR, either endianness.
    Cdr(Arc<Layout>),
    /// JSON, with a schema where one is known.
    Json(Option<Arc<Schema>>),
    /// Protobuf, by its descriptor.
    Protobuf(Arc<protobuf::Message>),
}

impl MessageType {
    /// What a specification sees of it, where anything is known before a value is seen.
    pub fn schema(&self) -> Option<&Arc<Schema>> {
        match self {
            MessageType::Ros1(layout) | MessageType::Cdr(layout) => Some(layout.schema()),
            MessageType::Json(schema) => schema.as_ref(),
            MessageType::Protobuf(message) => Some(message.schema()),
        }
    }
}

/// A message, or its definition, that does not fit what is wanted of it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct DecodeError {
    what: String,
}

impl DecodeError {
    pub(crate) fn new(what: impl Into<String>) -> DecodeError {
        DecodeError { what: what.into() }
    }
}

/// Decodes the wanted fields of one message type. Made once; decoding does not allocate once its values have their size.
///
/// ```
/// use lapwing_record::{Decoder, Dialect, Library, MessageType};
/// let layout = Library::default().layout(Dialect::Ros1, "demo/Pair", "uint8 a\nfloat32[] b")?;
/// let mut decoder = Decoder::new(&MessageType::Ros1(layout), &["b[1]".parse()?, "a".parse()?], 1000)?;
/// let mut values = decoder.slots();
/// decoder.decode(&[7, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 63], &mut values)?;
/// assert_eq!(values, [0.5.into(), 7.0.into()]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Decoder {
    how: How,
    slots: usize,
    /// How many array elements one message may hold.
    elements: usize,
}

#[derive(Debug)]
enum How {
    Ros1(Plan),
    Cdr(Plan),
    Json(json::Reader),
    Protobuf(protobuf::Reader),
}

impl Decoder {
    /// A decoder of those fields, the k-th into the k-th value; at most `elements` array elements a message.
    ///
    /// An error names a field that the type does not have, and those that it has.
    pub fn new(ty: &MessageType, fields: &[Path], elements: usize) -> Result<Decoder, DecodeError> {
        let tree = Tree::new(fields);
        let how = match ty {
            MessageType::Ros1(layout) => How::Ros1(Plan::new(layout, &tree, false)?),
            MessageType::Cdr(layout) => How::Cdr(Plan::new(layout, &tree, true)?),
            MessageType::Json(schema) => How::Json(json::Reader::new(tree, schema.as_deref(), fields.len())?),
            MessageType::Protobuf(message) => How::Protobuf(protobuf::Reader::new(message, tree, fields.len())?),
        };
        Ok(Decoder { how, slots: fields.len(), elements })
    }

    /// Stops after the last wanted field, without a look at what follows: for a caller who wants the header alone.
    pub(crate) fn prefix_only(mut self) -> Decoder {
        if let How::Ros1(plan) | How::Cdr(plan) = &mut self.how {
            plan.cut();
        }
        self
    }

    /// As many values as there are fields, all [`Value::Missing`].
    pub fn slots(&self) -> Vec<Value> {
        let mut values = Vec::new();
        values.resize_with(self.slots, Value::default);
        values
    }

    /// Overwrites `values` by the fields of a message, reusing their buffers. After an error they are unspecified.
    pub fn decode(&mut self, message: &[u8], values: &mut [Value]) -> Result<(), DecodeError> {
        if values.len() != self.slots {
            return Err(DecodeError::new(format!("{} values for {} fields", values.len(), self.slots)));
        }
        match &mut self.how {
            How::Ros1(plan) => run::packed(plan, message, self.elements, values),
            How::Cdr(plan) => run::cdr(plan, message, self.elements, values),
            How::Json(reader) => reader.read(message, self.elements, values),
            How::Protobuf(reader) => reader.read(message, self.elements, values),
        }
    }
}
