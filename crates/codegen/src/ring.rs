//! Queues of stamps.

use crate::code::{Bin, Block, Expr, Ty, Unit, elem, field};

/// A queue of stamps in an array.
pub(crate) struct Ring {
    pub name: String,
    pub len: usize,
}

impl Ring {
    /// Adds its fields.
    pub fn new(unit: &mut Unit, name: String, len: usize) -> Ring {
        let ring = Ring { name, len };
        unit.array(&ring.name, Ty::I64, len, 0.into(), "Stamps at which an operand held.");
        unit.field(&format!("{}_head", ring.name), Ty::U32, 0.into(), "The oldest of them.");
        unit.field(&format!("{}_count", ring.name), Ty::U32, 0.into(), "How many there are.");
        ring
    }

    pub fn full(&self) -> String {
        format!("{}_full", self.name)
    }

    pub fn count(&self) -> Expr {
        field(format!("{}_count", self.name))
    }

    pub fn head(&self) -> Expr {
        field(format!("{}_head", self.name))
    }

    pub fn index(&self, k: Expr) -> Expr {
        let from_head = if k == Expr::Int(0) { return self.head() } else { self.head() + k };
        from_head.bin(Bin::Rem, self.len as i64)
    }

    /// The `k`-th stamp, oldest first.
    pub fn at(&self, k: Expr) -> Expr {
        elem(&self.name, self.index(k))
    }

    pub fn pop(&self, b: &mut Block) {
        b.set(&self.head(), (self.head() + 1.into()).bin(Bin::Rem, self.len as i64));
        b.set(&self.count(), self.count() - 1.into());
    }

    pub fn push(&self, b: &mut Block, stamp: &Expr, may_overflow: bool) {
        let push = |b: &mut Block| {
            b.set(&self.at(self.count()), stamp.clone());
            b.set(&self.count(), self.count() + 1.into());
        };
        match may_overflow {
            true => b.branch(self.count().lt(self.len as i64), push, |b| b.set(&field(self.full()), true)),
            false => push(b),
        }
    }
}
