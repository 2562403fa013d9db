//! A message type with all its types looked up: what a decoder needs, and the schema that a specification sees.

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_stream::{Field, Name, Schema, Type, Value};

use super::share::Lookup;
use super::{Base, Definition, DefinitionError, FieldType};
use crate::decode::span::Span;

/// Messages may not be nested deeper than this.
const MAX_DEPTH: usize = 64;
/// One message may not use more types than this.
const MAX_TYPES: usize = 4096;

/// A message type: its fields in the order in which they are sent.
#[derive(Debug)]
pub struct Layout {
    schema: Arc<Schema>,
    fields: Vec<(Name, Node)>,
    /// What fields are that are left out, where that is not zero.
    defaults: Vec<(Name, Value)>,
    /// The bytes it takes, where that does not depend on its values: packed as ROS 1 does.
    packed: Option<Span>,
    /// The same, aligned as CDR does.
    aligned: Option<Span>,
}

/// What a field is made of.
#[derive(Clone, Debug)]
pub enum Node {
    /// A number or a boolean.
    Prim(Prim),
    /// A text of bytes.
    Text,
    /// A text of wide characters.
    WideText,
    /// An array of that many elements, or of varying length.
    Array {
        /// How many elements; `None` where each message says so.
        length: Option<usize>,
        /// What each of them is.
        element: Box<Node>,
    },
    /// A message.
    Message(Arc<Layout>),
}

/// A type of fixed size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Prim {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Prim {
    /// Its size, which is also its alignment, in bytes.
    pub fn size(self) -> usize {
        match self {
            Prim::Bool | Prim::I8 | Prim::U8 => 1,
            Prim::I16 | Prim::U16 => 2,
            Prim::I32 | Prim::U32 | Prim::F32 => 4,
            Prim::I64 | Prim::U64 | Prim::F64 => 8,
        }
    }
}

impl Layout {
    /// What a specification sees of it.
    pub fn schema(&self) -> &Arc<Schema> {
        &self.schema
    }

    /// The fields in the order in which they are sent.
    pub fn fields(&self) -> &[(Name, Node)] {
        &self.fields
    }

    /// What the field of that name is where a message is made that leaves it out, as far as the definition says that.
    pub fn default_of(&self, name: &str) -> Option<&Value> {
        self.defaults.iter().find(|(n, _)| &**n == name).map(|(_, value)| value)
    }

    /// How many bytes it takes, where that does not depend on its values.
    pub(crate) fn span(&self, aligned: bool) -> Option<Span> {
        if aligned { self.aligned } else { self.packed }
    }
}

impl Node {
    /// How many bytes it takes, where that does not depend on its values.
    pub(crate) fn span(&self, aligned: bool) -> Option<Span> {
        match self {
            Node::Prim(prim) => Some(Span::of(prim.size(), aligned)),
            Node::Array { length: Some(0), .. } => Some(Span::NONE),
            Node::Array { length: Some(n), element } => Some(element.span(aligned)?.times(*n as u64)),
            Node::Message(layout) => layout.span(aligned),
            Node::Text | Node::WideText | Node::Array { length: None, .. } => None,
        }
    }

    fn ty(&self) -> Type {
        match self {
            Node::Prim(Prim::Bool) => Type::Bool,
            Node::Prim(Prim::F32 | Prim::F64) => Type::Num { float: true },
            Node::Prim(_) => Type::Num { float: false },
            Node::Text | Node::WideText => Type::Str,
            Node::Array { element, .. } => Type::Array(Box::new(element.ty())),
            Node::Message(layout) => Type::Message(layout.schema.clone()),
        }
    }
}

/// Looks up all that a message is made of.
pub(super) fn resolve(name: &str, lookup: &mut Lookup<'_>) -> Result<Arc<Layout>, DefinitionError> {
    Resolver { lookup, done: BTreeMap::new(), open: Vec::new() }.message(name)
}

struct Resolver<'a, 'b> {
    lookup: &'a mut Lookup<'b>,
    done: BTreeMap<String, Arc<Layout>>,
    /// The messages that contain the current one, the outermost first.
    open: Vec<String>,
}

impl Resolver<'_, '_> {
    fn message(&mut self, name: &str) -> Result<Arc<Layout>, DefinitionError> {
        if let Some(layout) = self.done.get(name) {
            return Ok(layout.clone());
        }
        if let Some(at) = self.open.iter().position(|n| n == name) {
            let circle = self.open[at..].join(" → ");
            return Err(DefinitionError::new(format!("the definition goes round in a circle: {circle} → {name}")));
        }
        if self.open.len() >= MAX_DEPTH || self.done.len() >= MAX_TYPES {
            return Err(DefinitionError::new(format!(
                "{name}: more than {MAX_DEPTH} messages within each other, or {MAX_TYPES} types"
            )));
        }
        self.open.push(name.to_owned());
        let definition = self.lookup.take(name)?;
        let layout = Arc::new(self.build(definition)?);
        self.open.pop();
        self.done.insert(name.to_owned(), layout.clone());
        Ok(layout)
    }

    fn build(&mut self, definition: Definition) -> Result<Layout, DefinitionError> {
        let mut fields = Vec::with_capacity(definition.fields.len());
        let mut defaults = Vec::new();
        for field in definition.fields {
            defaults.extend(field.default.map(|value| (field.name.clone(), value)));
            fields.push((field.name, self.node(field.ty)?));
        }
        let described = fields.iter().map(|(name, node)| Field { name: name.clone(), ty: node.ty() }).collect();
        let schema = Schema { name: definition.name, fields: described, constants: definition.constants };
        let (packed, aligned) = (whole_span(&fields, false), whole_span(&fields, true));
        Ok(Layout { schema: Arc::new(schema), fields, defaults, packed, aligned })
    }

    fn node(&mut self, ty: FieldType) -> Result<Node, DefinitionError> {
        let mut node = match ty.base {
            Base::Prim(prim) => Node::Prim(prim),
            Base::Text => Node::Text,
            Base::WideText => Node::WideText,
            Base::Message(name) => Node::Message(self.message(&name)?),
        };
        for length in ty.arrays.into_iter().rev() {
            node = Node::Array { length, element: Box::new(node) };
        }
        Ok(node)
    }
}

/// The span of a message: of its fields, or in CDR of the one byte that stands in for none.
fn whole_span(fields: &[(Name, Node)], aligned: bool) -> Option<Span> {
    if fields.is_empty() && aligned {
        return Some(Span::of(1, aligned));
    }
    fields.iter().try_fold(Span::NONE, |span, (_, node)| Some(span.then(node.span(aligned)?)))
}

#[cfg(test)]
mod tests {
    use crate::definition::{Dialect, Library};

    #[test]
    fn circles_and_towers_are_refused() {
        let library = Library::default();
        let text = "b/B b\n===\nMSG: b/B\nc/C[] c\n===\nMSG: c/C\na/A[2] a";
        let error = library.layout(Dialect::Ros2, "a/A", text).unwrap_err().to_string();
        assert!(error.contains("a/A → b/B → c/C → a/A"), "{error}");

        let mut tower = String::from("p/T1 x\n");
        for k in 1..100 {
            tower.push_str(&format!("===\nMSG: p/T{k}\np/T{} x\n", k + 1));
        }
        assert!(library.layout(Dialect::Ros2, "p/T0", &tower).is_err());
    }

    #[test]
    fn a_ladder_of_types_costs_nothing() {
        let mut ladder = String::from("p/T1 x\np/T1 y\n");
        for k in 1..60 {
            ladder.push_str(&format!("===\nMSG: p/T{k}\np/T{0} x\np/T{0} y\n", k + 1));
        }
        ladder.push_str("===\nMSG: p/T60\nfloat64[1000000000] x\n");
        let layout = Library::default().layout(Dialect::Ros1, "p/T0", &ladder).unwrap();
        assert!(layout.span(false).is_some());
    }
}
