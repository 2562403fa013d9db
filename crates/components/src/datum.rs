//! Values as components have them: typed by the specification, integers exact.

use lapwing_genom::model::Step;

/// A value. What it means is in its type: members of a structure stand in the order of the declaration, an enumerator is its number.
#[derive(Clone, Debug, PartialEq)]
pub enum Datum {
    /// True or false.
    Bool(bool),
    /// A whole number, a character or the number of an enumerator.
    Int(i128),
    /// A number.
    Float(f64),
    /// A text.
    Text(String),
    /// The elements of an array or a sequence.
    List(Vec<Datum>),
    /// The members of a structure.
    Struct(Vec<Datum>),
    /// A union: what tells its members apart, and the member that is there, by its number.
    Union(i128, Option<(usize, Box<Datum>)>),
    /// A value that may be missing.
    Optional(Option<Box<Datum>>),
    /// Something that only codels know: whatever they made of it.
    Native(u64),
}

impl Datum {
    /// As a number, if it is one; true is 1.
    pub fn number(&self) -> Option<f64> {
        match self {
            Datum::Bool(b) => Some(f64::from(u8::from(*b))),
            Datum::Int(i) => Some(*i as f64),
            Datum::Float(x) => Some(*x),
            _ => None,
        }
    }

    /// Of how many parts it consists, itself included.
    pub(crate) fn parts(&self) -> u64 {
        match self {
            Datum::List(parts) | Datum::Struct(parts) => parts.iter().map(Datum::parts).sum::<u64>() + 1,
            Datum::Union(_, Some((_, part))) | Datum::Optional(Some(part)) => part.parts() + 1,
            _ => 1,
        }
    }

    /// A part of it. `members` are the numbers of members where the way leads through structures, as [`crate::types::Types::way`] finds them.
    pub(crate) fn part(&self, way: &[usize]) -> Option<&Datum> {
        way.iter().try_fold(self, |at, number| match at {
            Datum::Struct(parts) | Datum::List(parts) => parts.get(*number),
            _ => None,
        })
    }

    /// The same, to be changed.
    pub(crate) fn part_mut(&mut self, way: &[usize]) -> Option<&mut Datum> {
        way.iter().try_fold(self, |at, number| match at {
            Datum::Struct(parts) | Datum::List(parts) => parts.get_mut(*number),
            _ => None,
        })
    }
}

/// The steps of a path as it is written: `speed.linear`, `covariance[3]`. `None` where it is no path.
pub(crate) fn steps(path: &str) -> Option<Vec<Step>> {
    let mut all = Vec::new();
    for part in path.split('.').filter(|_| !path.is_empty()) {
        let (name, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
        if name.is_empty() {
            return None;
        }
        all.push(Step::Member(name.to_owned()));
        while let Some(inside) = rest.strip_prefix('[') {
            let (number, after) = inside.split_once(']')?;
            all.push(Step::Element(number.parse().ok()?));
            rest = after;
        }
        if !rest.is_empty() {
            return None;
        }
    }
    Some(all)
}

impl From<bool> for Datum {
    fn from(value: bool) -> Datum {
        Datum::Bool(value)
    }
}

impl From<f64> for Datum {
    fn from(value: f64) -> Datum {
        Datum::Float(value)
    }
}

impl From<i64> for Datum {
    fn from(value: i64) -> Datum {
        Datum::Int(i128::from(value))
    }
}

impl From<&str> for Datum {
    fn from(value: &str) -> Datum {
        Datum::Text(value.to_owned())
    }
}

impl From<Vec<f64>> for Datum {
    fn from(values: Vec<f64>) -> Datum {
        Datum::List(values.into_iter().map(Datum::Float).collect())
    }
}
