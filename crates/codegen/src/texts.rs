//! Texts as numbers. Where texts are compared with those that the specification writes down, each of these has a number, and any other text is 0.
//! Where two texts are compared that only a trace knows, every text has a number that follows from its bytes.

use lapwing_engine::program::{Node, Program};

use crate::code::Ty;
use crate::interface::Kind;
use crate::kinds::{Kinds, each_positions};

/// How texts become numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Codes {
    /// By their place among those that are written down, from 1.
    Listed,
    /// By a hash of 63 bits: two texts of one hash would be taken for the same.
    Hashed,
}

impl Codes {
    /// What a program needs.
    pub(crate) fn of(program: &Program, kinds: &Kinds) -> Codes {
        let mut codes = Codes::Listed;
        each_positions(program, |at| {
            for node in &at.nodes {
                let Node::CompareAny { left, right, .. } = node else { continue };
                let is_unknown =
                    |of: u32| kinds.settled(at, of) == Kind::Text && !matches!(at.nodes[of as usize], Node::Str(_));
                if is_unknown(*left) && is_unknown(*right) {
                    codes = Codes::Hashed;
                }
            }
        });
        codes
    }

    /// The type of a text's number.
    pub(crate) fn ty(self) -> Ty {
        match self {
            Codes::Listed => Ty::U32,
            Codes::Hashed => Ty::U64,
        }
    }

    /// The number of a text that is written down at that place.
    pub(crate) fn code(self, place: usize, text: &str) -> i64 {
        match self {
            Codes::Listed => place as i64 + 1,
            Codes::Hashed => hash(text),
        }
    }
}

/// Where the hash begins, and what it is multiplied by for every byte.
pub(crate) const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0000_0100_0000_01b3);

/// FNV-1a (Fowler, Noll, Vo), without its last bit.
fn hash(text: &str) -> i64 {
    let all = text.bytes().fold(FNV.0, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(FNV.1));
    (all >> 1) as i64
}
