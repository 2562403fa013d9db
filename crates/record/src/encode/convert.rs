//! Messages of one encoding as messages of another: what was ROS 2 for a node of ROS 1, and the other way round.

use std::sync::Arc;

use lapwing_stream::{Name, Value};

use super::{Encoder, Encoding};
use crate::decode::{DecodeError, Decoder, MessageType};
use crate::definition::Layout;
use crate::path::Path;

/// One message has no more array elements: those of a large point cloud.
const ELEMENTS: usize = 1 << 26;

/// Converts the messages of one type, field by field, by name. What only one side has is left out, or has its default.
#[derive(Debug)]
pub struct Converter {
    decoder: Decoder,
    names: Vec<Name>,
    values: Vec<Value>,
    encoder: Encoder,
}

impl Converter {
    /// A converter from messages of that type to the other.
    pub fn new(from: &MessageType, to: Arc<Layout>, encoding: Encoding) -> Result<Converter, DecodeError> {
        let Some(schema) = from.schema() else { return Err(DecodeError::new("it has no definition")) };
        let names: Vec<Name> = schema.fields.iter().map(|field| field.name.clone()).collect();
        let paths: Vec<Path> = names.iter().map(|name| Path::of_names([&**name])).collect();
        let decoder = Decoder::new(from, &paths, ELEMENTS)?;
        let values = decoder.slots();
        Ok(Converter { decoder, names, values, encoder: Encoder::new(to, encoding).leaving_out_unknown() })
    }

    /// The bytes of a message in the other encoding.
    pub fn convert(&mut self, message: &[u8]) -> Result<Vec<u8>, DecodeError> {
        self.decoder.decode(message, &mut self.values)?;
        let values = std::mem::take(&mut self.values);
        let whole = Value::Record(self.names.iter().cloned().zip(values).collect());
        let bytes = self.encoder.encode(&whole).map_err(|error| DecodeError::new(error.to_string()));
        if let Value::Record(fields) = whole {
            self.values = fields.into_iter().map(|(_, value)| value).collect();
        }
        bytes
    }
}
