//! A path selects one field of a message: `pose.pose.position.x`, `ranges[3]`.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use lapwing_stream::{Name, Value};

/// A way from a message to one of its fields: names of fields and indices into arrays.
///
/// ```
/// use lapwing_record::Path;
/// let path: Path = "transforms[0].transform.translation.x".parse()?;
/// assert_eq!(path.to_string(), "transforms[0].transform.translation.x");
/// # Ok::<(), lapwing_record::PathError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Path {
    parts: Vec<Part>,
}

/// One step of a [`Path`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// Into the field of that name.
    Name(Name),
    /// Into the element of that index, from 0.
    Index(usize),
}

/// A text that is no path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is no field path: {what}; write names separated by dots and indices in brackets, as in `poses[0].position.x`"
)]
pub struct PathError {
    /// The text.
    pub text: String,
    /// What is wrong with it.
    pub what: &'static str,
}

impl Path {
    /// A path of those parts; the empty one is the whole message.
    pub fn new(parts: impl IntoIterator<Item = Part>) -> Path {
        Path { parts: parts.into_iter().collect() }
    }

    /// A path of names only.
    pub fn of_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Path {
        Path::new(names.into_iter().map(|n| Part::Name(n.into())))
    }

    /// The parts, from the message inwards.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What it selects of a value; `None` where that has no such field or element.
    pub fn find_in<'v>(&self, whole: &'v Value) -> Option<Cow<'v, Value>> {
        find(&self.parts, whole)
    }
}

fn find<'v>(parts: &[Part], whole: &'v Value) -> Option<Cow<'v, Value>> {
    let Some((part, rest)) = parts.split_first() else { return Some(Cow::Borrowed(whole)) };
    match (part, whole) {
        (Part::Name(name), whole) => find(rest, whole.field(name)?),
        (Part::Index(index), Value::List(list)) => find(rest, list.get(*index)?),
        (Part::Index(index), Value::Nums(xs)) if rest.is_empty() => xs.get(*index).map(|x| Cow::Owned(Value::Num(*x))),
        _ => None,
    }
}

/// The ways in which the name of a signal leads into another value of a row: `o.p.x` is `x` of `o.p`, or `p.x` of `o`. The longest key
/// comes first.
pub(crate) fn ways(name: &str) -> impl Iterator<Item = (&str, Path)> {
    let cuts = name.rmatch_indices(['.', '[']).map(|(at, _)| at).filter(|at| *at > 0);
    cuts.filter_map(|at| {
        let (key, rest) = name.split_at(at);
        // A path begins with a name, what is left of one need not.
        let Path { mut parts } = format!("key{rest}").parse().ok()?;
        parts.remove(0);
        Some((key, Path { parts }))
    })
}

impl FromStr for Path {
    type Err = PathError;

    fn from_str(text: &str) -> Result<Path, PathError> {
        let error = |what| PathError { text: text.to_owned(), what };
        let mut parts = Vec::new();
        for step in text.split('.') {
            let (name, mut indices) = step.split_at(step.find('[').unwrap_or(step.len()));
            if name.is_empty() {
                return Err(error("a name is empty"));
            }
            parts.push(Part::Name(name.into()));
            while !indices.is_empty() {
                let (index, rest) = indices
                    .strip_prefix('[')
                    .and_then(|t| t.split_once(']'))
                    .ok_or_else(|| error("a bracket is not closed"))?;
                let index = index.parse().map_err(|_| error("an index is no whole number"))?;
                parts.push(Part::Index(index));
                indices = rest;
            }
        }
        Ok(Path { parts })
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, part) in self.parts.iter().enumerate() {
            match part {
                Part::Name(name) if k == 0 => f.write_str(name)?,
                Part::Name(name) => write!(f, ".{name}")?,
                Part::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// The names under which other versions of ROS, other encodings and other tools know the field `name` of a time stamp.
///
/// A path that says `secs` finds `sec`, and the other way round.
pub(crate) fn aliases(name: &str) -> &'static [&'static str] {
    match name {
        "sec" | "secs" | "seconds" => &["sec", "secs", "seconds"],
        "nanosec" | "nsecs" | "nsec" | "nanos" => &["nanosec", "nsecs", "nsec", "nanos"],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_leads_into_other_values() {
        let all: Vec<String> = ways("o.p[1].x").map(|(key, way)| format!("{key} {:?}", way.parts().len())).collect();
        assert_eq!(all, ["o.p[1] 1", "o.p 2", "o 3"]);
        assert_eq!([ways("plain").count(), ways(".x").count(), ways("a[x").count()], [0, 0, 0]);
        let inner = Value::Record(vec![("x".into(), Value::Num(2.0))]);
        let whole = Value::Record(vec![("l".into(), Value::List(vec![inner])), ("n".into(), Value::Nums(vec![5.0]))]);
        let at = |text: &str| text.parse::<Path>().unwrap().find_in(&whole).map(Cow::into_owned);
        assert_eq!([at("l[0].x"), at("n[0]")], [Some(Value::Num(2.0)), Some(Value::Num(5.0))]);
        assert_eq!([at("l[1].x"), at("n[0].x"), at("n[1]"), at("m")], [None, None, None, None]);
    }

    #[test]
    fn paths_are_read_and_printed() {
        for text in ["x", "pose.pose.position.x", "ranges[3]", "a[0][1].b"] {
            assert_eq!(text.parse::<Path>().unwrap().to_string(), text);
        }
        for text in ["", ".x", "a..b", "a[", "a[x]", "a[1]b", "[1]"] {
            assert!(text.parse::<Path>().is_err(), "{text:?} was taken for a path");
        }
    }
}
