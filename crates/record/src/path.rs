//! A path selects one field of a message: `pose.pose.position.x`, `ranges[3]`.

use std::fmt;
use std::str::FromStr;

use lapwing_stream::Name;

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
    fn paths_are_read_and_printed() {
        for text in ["x", "pose.pose.position.x", "ranges[3]", "a[0][1].b"] {
            assert_eq!(text.parse::<Path>().unwrap().to_string(), text);
        }
        for text in ["", ".x", "a..b", "a[", "a[x]", "a[1]b", "[1]"] {
            assert!(text.parse::<Path>().is_err(), "{text:?} was taken for a path");
        }
    }
}
