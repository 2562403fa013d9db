//! What the names within a type stand for.

use crate::code::Slot;
use crate::value::Type;
use std::collections::BTreeMap;

/// What a name within a type stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symbol {
    /// A variable of the frame.
    Var { ty: Type, slot: Slot, access: Access },
    /// A clock, whose unit has so many nanoseconds.
    Clock { slot: Slot, unit: i64 },
}

/// What may be done with a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    /// It may be read and written.
    Write,
    /// It may only be read, because it is a parameter or seen through a port that shows it as constant.
    Const,
    /// It may only be read here.
    Here,
}

/// The names within a type: `x`, and `p.x` of what is seen through a port.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    symbols: BTreeMap<String, Symbol>,
}

impl Names {
    pub fn var(&mut self, name: impl Into<String>, ty: Type, slot: Slot, access: Access) {
        self.symbols.insert(name.into(), Symbol::Var { ty, slot, access });
    }

    pub fn clock(&mut self, name: &str, slot: Slot, unit: i64) {
        self.symbols.insert(name.to_owned(), Symbol::Clock { slot, unit });
    }

    pub fn get(&self, name: &str) -> Option<Symbol> {
        self.symbols.get(name).copied()
    }

    pub fn all(&self) -> impl Iterator<Item = &str> {
        self.symbols.keys().map(String::as_str)
    }
}
