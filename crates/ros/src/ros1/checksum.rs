//! The checksum of a message's definition: what publishers and subscribers of ROS 1 compare before they talk.
//!
//! MD5 of the definition without comments and blanks, constants first, in which every type that is a message stands as its own checksum
//! (wiki.ros.org/msg and genmsg's `compute_md5_text`).

use std::collections::BTreeMap;

use lapwing_record::normal_name;

/// Messages may not be nested deeper.
const MAX_DEPTH: usize = 64;

const BUILTIN: &str =
    " bool byte char int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64 string time duration ";

/// The checksum of a message, from its definition with those of all messages in it.
pub(crate) fn of_message(type_name: &str, text: &str) -> Result<String, String> {
    Ok(hex(&canonical(type_name, text)?))
}

/// The checksum of a service, from the definitions of its request and its answer.
pub(crate) fn of_service(type_name: &str, request: &str, answer: &str) -> Result<String, String> {
    Ok(hex(&(canonical(type_name, request)? + &canonical(type_name, answer)?)))
}

fn hex(text: &str) -> String {
    format!("{:x}", md5::compute(text))
}

/// The text of which the checksum is taken.
fn canonical(type_name: &str, text: &str) -> Result<String, String> {
    let mut sections = sections(&normal_name(type_name), text);
    let root = sections.remove(&normal_name(type_name)).unwrap_or_default();
    Sums { sections, done: BTreeMap::new() }.canonical(&normal_name(type_name), root, 0)
}

/// The definitions of a text by their names; the one without a name is the root's.
fn sections<'t>(root: &str, text: &'t str) -> BTreeMap<String, &'t str> {
    let mut found = BTreeMap::new();
    let (mut name, mut begin, mut at) = (root.to_owned(), 0, 0);
    for line in text.split_inclusive('\n') {
        if let Some(next) = line.trim().strip_prefix("MSG:") {
            found.entry(name).or_insert(&text[begin..at]);
            name = normal_name(next.trim());
            begin = at + line.len();
        }
        at += line.len();
    }
    found.entry(name).or_insert(&text[begin..]);
    found
}

/// The messages that the fields of a definition are made of, as they are called in full.
pub(crate) fn parts(type_name: &str, text: &str) -> Vec<String> {
    let fields = text.lines().filter_map(|line| Member::of(line).ok().flatten());
    let message = |member| match member {
        Member::Field { ty, .. } => full_name(type_name, ty),
        Member::Constant { .. } => None,
    };
    fields.filter_map(message).collect()
}

/// What a field's type is called in full; nothing where it is no message.
fn full_name(within: &str, ty: &str) -> Option<String> {
    let bare = ty.split('[').next().unwrap_or_default();
    if BUILTIN.contains(&format!(" {bare} ")) {
        return None;
    }
    let package = within.split('/').next().unwrap_or_default();
    Some(match bare {
        "Header" => "std_msgs/Header".to_owned(),
        name if name.contains('/') => normal_name(name),
        name => format!("{package}/{name}"),
    })
}

struct Sums<'t> {
    sections: BTreeMap<String, &'t str>,
    done: BTreeMap<String, String>,
}

impl Sums<'_> {
    fn canonical(&mut self, name: &str, text: &str, depth: usize) -> Result<String, String> {
        if depth > MAX_DEPTH {
            return Err(format!("more than {MAX_DEPTH} messages within each other"));
        }
        let (mut constants, mut fields) = (String::new(), String::new());
        for line in text.split('\n') {
            match Member::of(line)? {
                Some(Member::Constant { ty, name, value }) => constants += &format!("{ty} {name}={value}\n"),
                Some(Member::Field { ty, name: field }) => {
                    let sum = full_name(name, ty).map(|part| self.sum(&part, depth + 1)).transpose()?;
                    fields += &format!("{} {field}\n", sum.as_deref().unwrap_or(ty));
                }
                None => {}
            }
        }
        Ok((constants + &fields).trim().to_owned())
    }

    fn sum(&mut self, name: &str, depth: usize) -> Result<String, String> {
        if let Some(sum) = self.done.get(name) {
            return Ok(sum.clone());
        }
        let text = self.sections.get(name).copied().ok_or_else(|| format!("it has no definition of {name}"))?;
        let sum = hex(&self.canonical(name, text, depth)?);
        self.done.insert(name.to_owned(), sum.clone());
        Ok(sum)
    }
}

/// A line of a definition.
enum Member<'l> {
    Field { ty: &'l str, name: &'l str },
    Constant { ty: &'l str, name: &'l str, value: &'l str },
}

impl<'l> Member<'l> {
    fn of(line: &'l str) -> Result<Option<Member<'l>>, String> {
        let clean = line.split('#').next().unwrap_or_default().trim();
        if clean.is_empty() || clean.starts_with("===") {
            return Ok(None);
        }
        let wrong = || format!("`{}` is no field", clean.chars().take(60).collect::<String>());
        let (ty, rest) = clean.split_once(char::is_whitespace).ok_or_else(wrong)?;
        if !rest.contains('=') {
            let name = rest.trim();
            return if name.contains(char::is_whitespace) {
                Err(wrong())
            } else {
                Ok(Some(Member::Field { ty, name }))
            };
        }
        // The value of a text reaches to the end of the line: what looks like a comment belongs to it.
        let whole = if ty == "string" { line } else { clean };
        let (before, value) = whole.split_once('=').ok_or_else(wrong)?;
        let name = match ty {
            // As genmsg has it: from the first blank on, blanks and all.
            "string" => before.split_once(' ').map_or("", |(_, name)| name),
            _ => before.split_once(char::is_whitespace).map_or("", |(_, name)| name.trim()),
        };
        Ok(Some(Member::Constant { ty, name, value: value.trim() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn well_known_checksums_come_out() {
        let vector = "float64 x\nfloat64 y\nfloat64 z\n";
        assert_eq!(of_message("geometry_msgs/Vector3", vector).unwrap(), "4a842b65f413084dc2b10fb484ea7f17");
        let ruler = "=".repeat(80);
        let twist =
            format!("# why\nVector3  linear\nVector3  angular\n\n{ruler}\nMSG: geometry_msgs/Vector3\n{vector}");
        assert_eq!(of_message("geometry_msgs/Twist", &twist).unwrap(), "9f195f881246fdfa2798d1d3eebca84a");
        let header = "uint32 seq\ntime stamp\nstring frame_id";
        assert_eq!(of_message("std_msgs/Header", header).unwrap(), "2176decaecbce78abc3b96ef049fabed");
        let log = format!(
            "byte DEBUG=1 #debug level\nbyte INFO=2\nbyte WARN=4\nbyte ERROR=8\nbyte FATAL=16\nHeader header\nbyte level\nstring name\n\
             string msg\nstring file\nstring function\nuint32 line\nstring[] topics\n{ruler}\nMSG: std_msgs/Header\n{header}"
        );
        assert_eq!(of_message("rosgraph_msgs/Log", &log).unwrap(), "acffd30cd6b6de30f120938c17c593fb");
        assert_eq!(of_message("std_msgs/Empty", "").unwrap(), "d41d8cd98f00b204e9800998ecf8427e");
        assert_eq!(
            of_service("std_srvs/Trigger", "", "bool success\nstring message").unwrap(),
            "937c9679a518e3a18d831e57125ea522"
        );
    }

    #[test]
    fn what_is_incomplete_or_goes_round_is_an_error() {
        assert!(of_message("a/A", "b/B b").unwrap_err().contains("b/B"));
        assert!(of_message("a/A", "a/B b\n===\nMSG: a/B\na/B b").unwrap_err().contains("within each other"));
        assert!(of_message("a/A", "int32").is_err());
    }
}
