//! From what a recording says of a type to what can be decoded.

use std::sync::Arc;

use lapwing_stream::{Field, Schema, Type};

use crate::decode::{MessageType, protobuf};
use crate::definition::{Dialect, Library, normal_name};

/// JSON schemas deeper than this are of any type below.
const MAX_DEPTH: usize = 32;

/// What a recording says of a type.
pub(crate) struct Said<'a> {
    /// Its name, as the recording spells it.
    pub name: &'a str,
    /// How the definition is written: `ros2msg`, `jsonschema`, ….
    pub encoding: &'a str,
    /// The definition; may be empty.
    pub definition: &'a [u8],
    /// How the messages are encoded: `cdr`, `json`, ….
    pub messages: &'a str,
}

/// What a recording says of a type, to be kept.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Declared {
    pub name: String,
    pub encoding: String,
    pub definition: Vec<u8>,
    pub messages: String,
}

impl Said<'_> {
    /// A copy that can be kept.
    pub fn declared(&self) -> Declared {
        Declared {
            name: self.name.to_owned(),
            encoding: self.encoding.to_owned(),
            definition: self.definition.to_vec(),
            messages: self.messages.to_owned(),
        }
    }
}

/// How messages of that type are decoded, or why they cannot be.
pub(crate) fn message_type(said: &Said<'_>, library: &Library) -> Result<MessageType, String> {
    let name = normal_name(said.name);
    match (said.messages, said.encoding) {
        (_, "flatbuffer") | ("flatbuffer", _) => {
            Err(format!("{name} is encoded in FlatBuffers, which is not supported: record it as protobuf, json or cdr"))
        }
        ("ros1", "ros1msg") => {
            library.layout(Dialect::Ros1, &name, &text(said)).map(MessageType::Ros1).map_err(|e| e.to_string())
        }
        ("cdr", "ros2msg" | "ros2idl" | "omgidl" | "") => cdr(said, &name, library),
        ("json", "jsonschema") => json_schema(&name, said.definition).map(MessageType::Json),
        ("json", _) => Ok(MessageType::Json(None)),
        ("protobuf", "protobuf") => {
            protobuf::parse(said.definition, &name).map(MessageType::Protobuf).map_err(|e| e.to_string())
        }
        (messages, encoding) => Err(format!(
            "{name}: messages encoded as `{messages}` with definitions as `{encoding}` are not supported: ros1 with ros1msg, \
             cdr with ros2msg or ros2idl, json with jsonschema, and protobuf are"
        )),
    }
}

/// CDR: by its own definition, else by an installed or bundled one.
fn cdr(said: &Said<'_>, name: &str, library: &Library) -> Result<MessageType, String> {
    let text = text(said);
    let layout = match said.encoding {
        _ if text.trim().is_empty() => library.installed(name),
        "ros2idl" | "omgidl" => library.layout(Dialect::Idl, name, &text),
        _ => library.layout(Dialect::Ros2, name, &text),
    };
    layout.map(MessageType::Cdr).map_err(|e| e.to_string())
}

fn text<'a>(said: &Said<'a>) -> std::borrow::Cow<'a, str> {
    String::from_utf8_lossy(said.definition)
}

/// What a JSON schema says of the fields, as far as it is simple; the rest is of any type. One that names no field, as
/// `{"type": "object"}`, says nothing.
fn json_schema(name: &str, text: &[u8]) -> Result<Option<Arc<Schema>>, String> {
    let schema: serde_json::Value =
        serde_json::from_slice(text).map_err(|e| format!("the JSON schema of {name} is no JSON: {e}"))?;
    Ok(schema.get("properties").is_some().then(|| object(name, &schema, 0)))
}

fn object(name: &str, schema: &serde_json::Value, depth: usize) -> Arc<Schema> {
    let properties = schema.get("properties").and_then(|p| p.as_object());
    let fields = properties
        .into_iter()
        .flatten()
        .map(|(key, value)| Field { name: key.as_str().into(), ty: ty(key, value, depth + 1) });
    Arc::new(Schema { name: name.to_owned(), fields: fields.collect(), constants: Vec::new() })
}

fn ty(name: &str, schema: &serde_json::Value, depth: usize) -> Type {
    if depth > MAX_DEPTH {
        return Type::Any;
    }
    match schema.get("type").and_then(|t| t.as_str()) {
        Some("boolean") => Type::Bool,
        Some("number") => Type::Num { float: true },
        Some("integer") => Type::Num { float: false },
        Some("string") => Type::Str,
        Some("array") => {
            Type::Array(Box::new(schema.get("items").map_or(Type::Any, |items| ty(name, items, depth + 1))))
        }
        Some("object") if schema.get("properties").is_some() => Type::Message(object(name, schema, depth)),
        _ => Type::Any,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said<'a>(encoding: &'a str, definition: &'a str, messages: &'a str) -> Said<'a> {
        Said { name: "p/msg/T", encoding, definition: definition.as_bytes(), messages }
    }

    #[test]
    fn each_encoding_goes_to_its_reader() {
        let library = Library::default();
        let get = |encoding, definition, messages| message_type(&said(encoding, definition, messages), &library);
        assert!(matches!(get("ros1msg", "time t", "ros1"), Ok(MessageType::Ros1(_))));
        assert!(matches!(get("ros2msg", "float64 x", "cdr"), Ok(MessageType::Cdr(_))));
        assert!(matches!(get("", "", "json"), Ok(MessageType::Json(None))));
        let MessageType::Json(Some(schema)) =
            get("jsonschema", r#"{"properties":{"x":{"type":"number"},"y":{}}}"#, "json").unwrap()
        else {
            panic!()
        };
        assert!(matches!(get("jsonschema", r#"{"type":"object"}"#, "json"), Ok(MessageType::Json(None))));
        assert_eq!(schema.field("x").unwrap().ty, Type::Num { float: true });
        assert_eq!(schema.field("y").unwrap().ty, Type::Any);
        for (encoding, messages, word) in
            [("flatbuffer", "flatbuffer", "FlatBuffers"), ("ros2msg", "cbor", "cbor"), ("", "cdr", "--msgs")]
        {
            assert!(get(encoding, "", messages).unwrap_err().contains(word));
        }
    }
}
