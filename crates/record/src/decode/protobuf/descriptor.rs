//! Protobuf message types, from the `FileDescriptorSet` that recordings carry.

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_stream::{Name, Schema, Type};

use super::super::DecodeError;
use super::wire::{Entry, Wire, entries};

/// How deep a schema shows messages in messages; Protobuf types may contain themselves.
const MAX_SHOWN: usize = 12;
/// How many fields a schema shows at most, over all its levels.
const MAX_SHOWN_FIELDS: usize = 1 << 14;
/// How many types a descriptor set may have.
const MAX_TYPES: usize = 1 << 16;
/// How deep types may be declared within types.
const MAX_NESTED: usize = 32;

/// A message type, with all the types that it is made of.
#[derive(Debug)]
pub struct Message {
    schema: Arc<Schema>,
    pub(super) types: Vec<MessageDef>,
    /// Which of the types it is.
    pub(super) root: usize,
}

impl Message {
    /// What a specification sees of it.
    pub fn schema(&self) -> &Arc<Schema> {
        &self.schema
    }
}

/// One message type of a set.
#[derive(Debug, Default)]
pub(super) struct MessageDef {
    pub name: String,
    pub fields: Vec<Field>,
}

/// One field of a message type.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub name: Name,
    /// Its number on the wire.
    pub number: u32,
    pub kind: Kind,
    /// Whether it is an array.
    pub repeated: bool,
    /// Whether a reader can tell its absence from a zero.
    pub tells_absence: bool,
}

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Double,
    Float,
    /// `uint32`, `uint64`.
    Unsigned,
    /// `int32`, `int64` and enumerations.
    Signed,
    /// `sint32`, `sint64`.
    Zigzag,
    Fixed64,
    Fixed32,
    Sfixed64,
    Sfixed32,
    Bool,
    Text,
    Bytes,
    /// The message type of that index.
    Message(usize),
}

impl Kind {
    pub fn is_number(self) -> bool {
        !matches!(self, Kind::Bool | Kind::Text | Kind::Bytes | Kind::Message(_))
    }
}

type Read<T> = Result<T, DecodeError>;

/// The message type of that name in a `FileDescriptorSet`.
pub(crate) fn parse(set: &[u8], name: &str) -> Read<Arc<Message>> {
    let raw = collect(set)?;
    let index: BTreeMap<&str, usize> = raw.iter().enumerate().map(|(k, m)| (m.name.as_str(), k)).collect();
    let types = raw.iter().map(|message| link(message, &index)).collect::<Read<Vec<_>>>()?;
    let root =
        *index.get(name).ok_or_else(|| DecodeError::new(format!("its descriptor set does not define {name}")))?;
    let schema = Shown { types: &types, left: MAX_SHOWN_FIELDS }.schema(root, 0);
    Ok(Arc::new(Message { schema, types, root }))
}

/// A message type whose fields' types are not yet looked up.
struct RawMessage {
    name: String,
    proto3: bool,
    fields: Vec<RawField>,
}

#[derive(Default)]
struct RawField {
    name: String,
    number: u32,
    label: u64,
    ty: u64,
    type_name: String,
    optional: bool,
}

fn collect(set: &[u8]) -> Read<Vec<RawMessage>> {
    let mut found = Vec::new();
    for file in entries(set) {
        if let Entry { number: 1, value: Wire::Bytes(file) } = file? {
            collect_file(file, &mut found)?;
        }
    }
    Ok(found)
}

fn collect_file(file: &[u8], found: &mut Vec<RawMessage>) -> Read<()> {
    let mut package = String::new();
    let mut proto3 = false;
    for entry in entries(file) {
        match entry? {
            Entry { number: 2, value: Wire::Bytes(name) } => package = text(name),
            Entry { number: 12, value: Wire::Bytes(syntax) } => proto3 = syntax == b"proto3",
            _ => {}
        }
    }
    for entry in entries(file) {
        if let Entry { number: 4, value: Wire::Bytes(message) } = entry? {
            collect_message(message, &package, proto3, 0, found)?;
        }
    }
    Ok(())
}

fn collect_message(message: &[u8], scope: &str, proto3: bool, depth: usize, found: &mut Vec<RawMessage>) -> Read<()> {
    if depth > MAX_NESTED || found.len() >= MAX_TYPES {
        return Err(DecodeError::new("its descriptor set has too many types, or nests them too deeply"));
    }
    let (mut name, mut fields) = (String::new(), Vec::new());
    for entry in entries(message) {
        match entry? {
            Entry { number: 1, value: Wire::Bytes(own) } => name = text(own),
            Entry { number: 2, value: Wire::Bytes(field) } => fields.push(raw_field(field)?),
            _ => {}
        }
    }
    let name = if scope.is_empty() { name } else { format!("{scope}.{name}") };
    for entry in entries(message) {
        if let Entry { number: 3, value: Wire::Bytes(nested) } = entry? {
            collect_message(nested, &name, proto3, depth + 1, found)?;
        }
    }
    found.push(RawMessage { name, proto3, fields });
    Ok(())
}

fn raw_field(field: &[u8]) -> Read<RawField> {
    let mut raw = RawField::default();
    for entry in entries(field) {
        match entry? {
            Entry { number: 1, value: Wire::Bytes(name) } => raw.name = text(name),
            Entry { number: 3, value: Wire::Varint(n) } => raw.number = u32::try_from(n).unwrap_or(0),
            Entry { number: 4, value: Wire::Varint(n) } => raw.label = n,
            Entry { number: 5, value: Wire::Varint(n) } => raw.ty = n,
            Entry { number: 6, value: Wire::Bytes(name) } => raw.type_name = text(name),
            // A member of a `oneof`, and that of the one which `optional` makes, can be absent.
            Entry { number: 9 | 17, value: Wire::Varint(_) } => raw.optional = true,
            _ => {}
        }
    }
    Ok(raw)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn link(raw: &RawMessage, index: &BTreeMap<&str, usize>) -> Read<MessageDef> {
    let mut fields = Vec::with_capacity(raw.fields.len());
    for field in &raw.fields {
        let kind =
            kind(field, index).map_err(|what| DecodeError::new(format!("{}.{}: {what}", raw.name, field.name)))?;
        fields.push(Field {
            name: field.name.as_str().into(),
            number: field.number,
            kind,
            repeated: field.label == 3,
            tells_absence: !raw.proto3 || field.optional || matches!(kind, Kind::Message(_)),
        });
    }
    Ok(MessageDef { name: raw.name.clone(), fields })
}

fn kind(field: &RawField, index: &BTreeMap<&str, usize>) -> Result<Kind, &'static str> {
    Ok(match field.ty {
        1 => Kind::Double,
        2 => Kind::Float,
        3 | 5 | 14 => Kind::Signed,
        4 | 13 => Kind::Unsigned,
        6 => Kind::Fixed64,
        7 => Kind::Fixed32,
        8 => Kind::Bool,
        9 => Kind::Text,
        10 => return Err("groups are not supported"),
        11 => Kind::Message(
            *index.get(field.type_name.trim_start_matches('.')).ok_or("its type is not in the descriptor set")?,
        ),
        12 => Kind::Bytes,
        15 => Kind::Sfixed32,
        16 => Kind::Sfixed64,
        17 | 18 => Kind::Zigzag,
        _ => return Err("its type is unknown"),
    })
}

/// Makes schemas, bounded: a type that contains itself is shown to some depth, and is of any type below.
struct Shown<'a> {
    types: &'a [MessageDef],
    left: usize,
}

impl Shown<'_> {
    fn schema(&mut self, index: usize, depth: usize) -> Arc<Schema> {
        let Some(message) = self.types.get(index) else { return Arc::default() };
        let mut fields = Vec::new();
        for field in &message.fields {
            let one = self.ty(field.kind, depth);
            let ty = if field.repeated { Type::Array(Box::new(one)) } else { one };
            fields.push(lapwing_stream::Field { name: field.name.clone(), ty });
        }
        Arc::new(Schema { name: message.name.clone(), fields, constants: Vec::new() })
    }

    fn ty(&mut self, kind: Kind, depth: usize) -> Type {
        let Some(left) = self.left.checked_sub(1) else { return Type::Any };
        self.left = left;
        match kind {
            Kind::Bool => Type::Bool,
            Kind::Text => Type::Str,
            Kind::Bytes => Type::Array(Box::new(Type::Num { float: false })),
            Kind::Double | Kind::Float => Type::Num { float: true },
            Kind::Message(_) if depth >= MAX_SHOWN => Type::Any,
            Kind::Message(index) => Type::Message(self.schema(index, depth + 1)),
            _ => Type::Num { float: false },
        }
    }
}
