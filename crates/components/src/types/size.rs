//! How large first values are. It is known of all types that a component needs before any value is made.

use std::collections::BTreeMap;

use lapwing_genom::model::{Type, TypeId};

use super::{MOST_DEPTH, MOST_PARTS, Shape, Types};

/// How large the first value of a type is.
#[derive(Clone, Copy, Debug)]
struct Size {
    parts: u64,
    /// How many values stand one inside the other.
    height: usize,
}

impl Size {
    const ONE: Size = Size { parts: 1, height: 1 };
    /// Of what contains itself, or stands so deep that it may.
    const ENDLESS: Size = Size { parts: u64::MAX, height: usize::MAX };

    /// With so many values of another size inside.
    fn around(self, inner: Size, times: u64) -> Size {
        Size {
            parts: self.parts.saturating_add(inner.parts.saturating_mul(times)),
            height: self.height.max(inner.height.saturating_add(1)),
        }
    }
}

/// Sizes, each worked out once: a chain of structures of two of the one before has as many parts as a power of two.
pub(super) struct Sizes<'t> {
    types: &'t Types,
    known: BTreeMap<TypeId, Size>,
    /// Types of what is not there at first, and can be put in later.
    later: Vec<&'t Type>,
}

impl<'t> Sizes<'t> {
    pub fn new(types: &'t Types) -> Sizes<'t> {
        Sizes { types, known: BTreeMap::new(), later: Vec::new() }
    }

    /// Whether first values of a type can be made, and those of whatever can be put into them.
    pub fn are_fair(&mut self, ty: &'t Type) -> bool {
        self.later.push(ty);
        while let Some(ty) = self.later.pop() {
            let size = self.size(ty, 0);
            if size.parts > MOST_PARTS || size.height > MOST_DEPTH {
                return false;
            }
        }
        true
    }

    fn size(&mut self, ty: &'t Type, depth: usize) -> Size {
        let Type::Named(id) = ty else { return self.measured(ty, depth) };
        if let Some(size) = self.known.get(id) {
            return *size;
        }
        // Whoever asks before it is known asks from inside: the value contains itself.
        self.known.insert(*id, Size::ENDLESS);
        let size = self.measured(ty, depth);
        self.known.insert(*id, size);
        size
    }

    fn measured(&mut self, ty: &'t Type, depth: usize) -> Size {
        if depth > MOST_DEPTH {
            return Size::ENDLESS;
        }
        match self.types.shape(ty) {
            // An element is made even where there are none.
            Shape::Array(inner, length) => Size::ONE.around(self.size(inner, depth + 1), length.max(1)),
            Shape::Struct(fields) => {
                fields.iter().fold(Size::ONE, |size, field| size.around(self.size(&field.ty, depth + 1), 1))
            }
            Shape::Union(_, cases) => {
                let mut members = cases.iter().map(|(_, field)| &field.ty);
                let first = members.next();
                self.later.extend(members);
                first.map_or(Size::ONE, |first| Size::ONE.around(self.size(first, depth + 1), 1))
            }
            Shape::Sequence(inner, _) | Shape::Optional(inner) => {
                self.later.push(inner);
                Size::ONE
            }
            _ => Size::ONE,
        }
    }
}
