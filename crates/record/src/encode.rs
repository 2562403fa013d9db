//! Turns values into the bytes of a message: the way back of [`decode`](crate::Decoder), for what is published and asked.
//!
//! Values come as a specification or a program has them, and need not be complete: a field that is not named has the default of its
//! definition, else zero, an empty text, an empty array. What is named is checked against the definition; an error says where.

mod convert;
mod writer;

use std::fmt;
use std::sync::Arc;

use lapwing_stream::Value;

use crate::definition::{Layout, Node, Prim};
use crate::path::{Part, Path, aliases};
pub use convert::Converter;
use writer::Writer;

/// How messages are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// ROS 1: packed, little-endian.
    Ros1,
    /// ROS 2: plain CDR, little-endian, behind the four bytes that say so.
    Cdr,
}

/// A value that is no message of the wanted type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodeError {
    /// Where in the message; the empty path is the message itself.
    pub path: Path,
    /// What is wrong there.
    pub what: String,
}

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.path.parts().is_empty() { f.write_str(&self.what) } else { write!(f, "{}: {}", self.path, self.what) }
    }
}

impl std::error::Error for EncodeError {}

/// Encodes values as messages of one type.
///
/// ```
/// use lapwing_record::{Dialect, Encoder, Encoding, Library};
/// use lapwing_stream::Value;
/// let layout = Library::default().layout(Dialect::Ros1, "demo/Pair", "uint8 a\nfloat32[] b")?;
/// let encoder = Encoder::new(layout, Encoding::Ros1);
/// let message = Value::Record(vec![("b".into(), Value::Nums(vec![0.5]))]);
/// assert_eq!(encoder.encode(&message)?, [0, 1, 0, 0, 0, 0, 0, 0, 63]);
/// let wrong = encoder.encode(&Value::Record(vec![("a".into(), 300.0.into())])).unwrap_err();
/// assert_eq!(wrong.to_string(), "a: 300 does not fit into uint8, which is 0 to 255");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Encoder {
    layout: Arc<Layout>,
    encoding: Encoding,
    is_lenient: bool,
}

impl Encoder {
    /// An encoder of messages of that type.
    pub fn new(layout: Arc<Layout>, encoding: Encoding) -> Encoder {
        Encoder { layout, encoding, is_lenient: false }
    }

    /// Leaves out what the type has no field for: for values that were messages of another version of ROS.
    pub fn leaving_out_unknown(self) -> Encoder {
        Encoder { is_lenient: true, ..self }
    }

    /// The bytes of a message. [`Value::Missing`] and an empty record are the message that is all defaults.
    ///
    /// # Errors
    /// Where a field is named that the type does not have, where a value does not fit its field, and where the message gets too long.
    pub fn encode(&self, value: &Value) -> Result<Vec<u8>, EncodeError> {
        let mut run = Run { writer: Writer::new(self.encoding), path: Vec::new(), is_lenient: self.is_lenient };
        match run.message(&self.layout, value) {
            Ok(()) => Ok(run.writer.into_bytes()),
            Err(what) => Err(EncodeError { path: Path::new(run.path), what }),
        }
    }
}

/// One message being encoded.
struct Run {
    writer: Writer,
    /// Where it is. After an error it stays there.
    path: Vec<Part>,
    is_lenient: bool,
}

type Encoded = Result<(), String>;

impl Run {
    fn message(&mut self, layout: &Layout, value: &Value) -> Encoded {
        let fields = match value {
            Value::Missing => &[][..],
            Value::Record(fields) => fields,
            Value::Num(seconds) if is_stamp(layout) => return self.stamp(layout, *seconds),
            other => {
                let ty = &layout.schema().name;
                return Err(format!("{} where a {ty} is expected: write its fields in braces", other.kind()));
            }
        };
        self.check_names(layout, fields.iter().map(|(name, _)| &**name))?;
        if layout.fields().is_empty() {
            return self.writer.nothing();
        }
        for (name, node) in layout.fields() {
            let given = fields.iter().find(|(n, _)| is_name(n, name)).map(|(_, value)| value);
            let given = given.filter(|value| !matches!(value, Value::Missing));
            self.path.push(Part::Name(name.clone()));
            self.node(node, given.or_else(|| layout.default_of(name)).unwrap_or(&Value::Missing))?;
            self.path.pop();
        }
        Ok(())
    }

    /// Whether the type has fields of those names, and each is named once.
    fn check_names<'n>(&mut self, layout: &Layout, names: impl Iterator<Item = &'n str> + Clone) -> Encoded {
        for (k, name) in names.clone().enumerate() {
            let is_known = layout.fields().iter().any(|(field, _)| is_name(name, field));
            let is_again = names.clone().take(k).any(|before| before == name);
            if is_known && !is_again || self.is_lenient {
                continue;
            }
            self.path.push(Part::Name(name.into()));
            return Err(if is_again { "it is given twice".to_owned() } else { no_such_field(layout, name) });
        }
        Ok(())
    }

    /// Seconds as a stamp or a duration.
    fn stamp(&mut self, layout: &Layout, seconds: f64) -> Encoded {
        let whole = seconds.floor();
        // Rounded up to a whole second it would not be a part of one.
        let nanoseconds = ((seconds - whole) * 1e9).round().min(999_999_999.0);
        for ((_, node), part) in layout.fields().iter().zip([whole, nanoseconds]) {
            self.node(node, &Value::Num(part))?;
        }
        Ok(())
    }

    fn node(&mut self, node: &Node, value: &Value) -> Encoded {
        match (node, value) {
            (Node::Message(layout), _) => self.message(layout, value),
            (Node::Array { length, element }, _) => self.array(*length, element, value),
            (Node::Text, Value::Missing) => self.writer.text(""),
            (Node::Text, Value::Str(text)) => self.writer.text(text),
            (Node::WideText, Value::Missing) => self.writer.wide_text(""),
            (Node::WideText, Value::Str(text)) => self.writer.wide_text(text),
            (Node::Text | Node::WideText, other) => Err(format!("{} where a text is expected", other.kind())),
            (Node::Prim(prim), Value::Missing) => self.writer.number(*prim, 0.0),
            (Node::Prim(Prim::Bool), Value::Bool(truth)) => self.writer.number(Prim::Bool, f64::from(u8::from(*truth))),
            (Node::Prim(Prim::Bool), other) => Err(format!("{} where true or false is expected", other.kind())),
            (Node::Prim(prim), Value::Num(number)) => {
                check(*prim, *number)?;
                self.writer.number(*prim, *number)
            }
            (Node::Prim(_), other) => Err(format!("{} where a number is expected", other.kind())),
        }
    }

    fn array(&mut self, length: Option<usize>, element: &Node, value: &Value) -> Encoded {
        let given = match value {
            Value::Missing => length.unwrap_or(0),
            Value::Nums(numbers) => numbers.len(),
            Value::List(list) => list.len(),
            other => return Err(format!("{} where an array is expected", other.kind())),
        };
        match length {
            Some(length) if length != given => return Err(format!("{given} elements where {length} are expected")),
            Some(_) => {}
            None => self.writer.length(given)?,
        }
        self.writer.spend(given)?;
        for k in 0..given {
            let number;
            let item = match value {
                Value::Nums(numbers) => {
                    number = numbers.get(k).map_or(Value::Missing, |n| Value::Num(*n));
                    &number
                }
                Value::List(list) => list.get(k).unwrap_or(&Value::Missing),
                _ => &Value::Missing,
            };
            self.path.push(Part::Index(k));
            self.node(element, item)?;
            self.path.pop();
        }
        Ok(())
    }
}

/// Whether a name stands for a field: by itself, or as another version of ROS has it.
fn is_name(name: &str, field: &str) -> bool {
    name == field || aliases(field).contains(&name)
}

/// Whether seconds can stand for it.
fn is_stamp(layout: &Layout) -> bool {
    matches!(
        layout.schema().name.as_str(),
        "time" | "duration" | "builtin_interfaces/Time" | "builtin_interfaces/Duration"
    )
}

fn no_such_field(layout: &Layout, name: &str) -> String {
    let known: Vec<&str> = layout.fields().iter().map(|(field, _)| &**field).collect();
    let likeness = |field: &&&str| strsim::jaro_winkler(name, field);
    let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let ty = &layout.schema().name;
    match nearest.filter(|field| likeness(field) > 0.75) {
        Some(field) => format!("{ty} has no such field; did you mean `{field}`?"),
        None if known.is_empty() => format!("{ty} has no fields"),
        None => format!("{ty} has no such field; it has {}", known.join(", ")),
    }
}

/// Whether a number fits.
fn check(prim: Prim, number: f64) -> Encoded {
    let (name, least, beyond) = match prim {
        Prim::F64 | Prim::Bool => return Ok(()),
        Prim::F32 if number.is_finite() && (number as f32).is_infinite() => {
            return Err(format!("{number} does not fit into float32, which ends at {}", f32::MAX));
        }
        Prim::F32 => return Ok(()),
        Prim::I8 => ("int8", -128.0, 128.0),
        Prim::U8 => ("uint8", 0.0, 256.0),
        Prim::I16 => ("int16", -32_768.0, 32_768.0),
        Prim::U16 => ("uint16", 0.0, 65_536.0),
        Prim::I32 => ("int32", -2_147_483_648.0, 2_147_483_648.0),
        Prim::U32 => ("uint32", 0.0, 4_294_967_296.0),
        Prim::I64 => ("int64", -9_223_372_036_854_775_808.0, 9_223_372_036_854_775_808.0),
        Prim::U64 => ("uint64", 0.0, 18_446_744_073_709_551_616.0),
    };
    if !(least..beyond).contains(&number) {
        return Err(format!("{number} does not fit into {name}, which is {least} to {}", beyond - 1.0));
    }
    if number.fract() != 0.0 { Err(format!("{number} is no whole number, and {name} is")) } else { Ok(()) }
}
