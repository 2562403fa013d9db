//! Three truth values and Kleene's connectives (language reference, *Verdicts*: what is not yet seen is unknown).

use std::ops::Not;

/// True, false, or not yet known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Truth {
    True,
    False,
    Unknown,
}

use Truth::{False, True, Unknown};

impl Truth {
    /// False as soon as one side is, true once both are.
    pub fn and(self, other: Truth) -> Truth {
        match (self, other) {
            (False, _) | (_, False) => False,
            (True, True) => True,
            _ => Unknown,
        }
    }

    /// True as soon as one side is, false once both are.
    pub fn or(self, other: Truth) -> Truth {
        !(!self).and(!other)
    }

    /// `not self or other`
    pub fn implies(self, other: Truth) -> Truth {
        (!self).or(other)
    }

    /// Whether both sides are the same: known only when both are.
    pub fn iff(self, other: Truth) -> Truth {
        match (self, other) {
            (Unknown, _) | (_, Unknown) => Unknown,
            (a, b) => Truth::from(a == b),
        }
    }
}

impl Not for Truth {
    type Output = Truth;
    fn not(self) -> Truth {
        match self {
            True => False,
            False => True,
            Unknown => Unknown,
        }
    }
}

impl From<bool> for Truth {
    fn from(b: bool) -> Truth {
        if b { True } else { False }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_kleenes() {
        let all = [False, Unknown, True];
        let rank = |t| all.iter().position(|&x| x == t).unwrap_or(0);
        for a in all {
            for b in all {
                assert_eq!(rank(a.and(b)), rank(a).min(rank(b)), "{a:?} and {b:?}");
                assert_eq!(rank(a.or(b)), rank(a).max(rank(b)), "{a:?} or {b:?}");
                assert_eq!(a.implies(b), (!a).or(b));
            }
        }
        assert_eq!(True.iff(Unknown), Unknown);
        assert_eq!(False.iff(False), True);
    }
}
