//! Types as monitors and recordings know them.

use std::sync::Arc;

use lapwing_genom::model::{Field, Type, TypeId};
use lapwing_stream as stream;

use super::{MOST_DEPTH, Shape, Types};

/// A type is told with no more members than this, all of them counted. Structures of two structures each would be twice as many at every level.
const MOST_FIELDS: usize = 1 << 14;

/// A type that is being told, member by member.
pub(super) struct Outline<'t> {
    types: &'t Types,
    /// The structures around what is being told: what contains itself is told as far as that.
    above: Vec<TypeId>,
    /// How many members may still be told.
    left: usize,
}

impl<'t> Outline<'t> {
    pub fn new(types: &'t Types) -> Outline<'t> {
        Outline { types, above: Vec::new(), left: MOST_FIELDS }
    }

    pub fn ty(&mut self, ty: &'t Type, depth: usize) -> stream::Type {
        if depth > MOST_DEPTH {
            return stream::Type::Any;
        }
        match self.types.shape(ty) {
            Shape::Bool => stream::Type::Bool,
            Shape::Int(..) | Shape::Native => stream::Type::Num { float: false },
            Shape::Float => stream::Type::Num { float: true },
            Shape::Text(_) | Shape::Enum(_) => stream::Type::Str,
            Shape::Array(inner, _) | Shape::Sequence(inner, _) => {
                stream::Type::Array(Box::new(self.ty(inner, depth + 1)))
            }
            Shape::Optional(inner) => self.ty(inner, depth + 1),
            Shape::Struct(fields) => self.structure(ty, fields, depth),
            Shape::Union(..) | Shape::Other(_) => stream::Type::Any,
        }
    }

    fn structure(&mut self, ty: &Type, fields: &'t [Field], depth: usize) -> stream::Type {
        let Type::Named(id) = ty else { return stream::Type::Any };
        let Some(left) = self.left.checked_sub(fields.len()).filter(|_| !self.above.contains(id)) else {
            return stream::Type::Any;
        };
        self.left = left;
        self.above.push(*id);
        let mut told = Vec::new();
        for field in fields {
            told.push(stream::Field { name: field.name.as_str().into(), ty: self.ty(&field.ty, depth + 1) });
        }
        self.above.pop();
        let schema = stream::Schema { name: self.types.type_name(ty), fields: told, constants: Vec::new() };
        stream::Type::Message(Arc::new(schema))
    }
}
