//! What a type looks like, apart from its comments and constants; and the hash of that, by which ROS 2 tells versions of a type apart.
//!
//! The hash is REP 2011's: SHA-256 of a JSON text of the description, of the type and of all that it is made of. Publishers
//! announce it (`RIHS01_…`), so whoever has a definition can tell whether it is the one that the messages follow.

use std::collections::BTreeMap;
use std::fmt;

use sha2::{Digest, Sha256};

use super::name;

/// A text of definitions may not be longer than this, in bytes.
const MAX_TEXT: usize = 1 << 22;
/// A description may not have more types than this, nor a type more fields.
const MAX_TYPES: usize = 512;
const MAX_FIELDS: usize = 1 << 14;

/// The hash of a type.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TypeHash([u8; 32]);

impl TypeHash {
    /// Reads `RIHS01_` and 64 hexadecimal digits.
    pub fn parse(text: &str) -> Option<TypeHash> {
        let digits = text.strip_prefix("RIHS01_").filter(|d| d.len() == 64 && d.is_ascii())?;
        let mut hash = [0; 32];
        for (byte, pair) in hash.iter_mut().zip(digits.as_bytes().chunks_exact(2)) {
            *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
        }
        Some(TypeHash(hash))
    }

    /// The hash that an endpoint announces in its user data, among other things: `typehash=RIHS01_…;`. Zeros mean that it has none.
    pub fn announced(user_data: &[u8]) -> Option<TypeHash> {
        const KEY: &[u8] = b"typehash=";
        let at = user_data.windows(KEY.len()).position(|window| window == KEY)?;
        let value = user_data.get(at + KEY.len()..)?;
        let end = value.iter().position(|b| *b == b';').unwrap_or(value.len());
        TypeHash::parse(std::str::from_utf8(value.get(..end)?).ok()?).filter(|hash| hash.0 != [0; 32])
    }
}

impl fmt::Display for TypeHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("RIHS01_")?;
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for TypeHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// A field, as `type_description_interfaces/msg/Field` has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// The number of its base type, and of what is around that: 48 more for an array, 96 for a bounded sequence, 144 for a sequence.
    pub type_id: u8,
    /// The length of an array, the bound of a sequence; else 0.
    pub capacity: u64,
    /// The bound of a text; else 0.
    pub string_capacity: u64,
    /// The full name of a nested type; else empty.
    pub nested: String,
}

/// A type and all that it is made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// The full name of the type: `nav_msgs/msg/Odometry`.
    pub root: String,
    /// The fields of the type and of those that it needs, by full names.
    pub types: BTreeMap<String, Vec<Field>>,
}

/// The base types by their numbers, as `.msg` files spell them. IDL's `long double`, `wchar` and fixed strings have no place in
/// ROS 2, and `char` is a `uint8` there.
const BASES: &[(u8, &str)] = &[
    (2, "int8"),
    (3, "uint8"),
    (4, "int16"),
    (5, "uint16"),
    (6, "int32"),
    (7, "uint32"),
    (8, "int64"),
    (9, "uint64"),
    (10, "float32"),
    (11, "float64"),
    (13, "char"),
    (15, "bool"),
    (16, "byte"),
    (17, "string"),
    (18, "wstring"),
];
const NESTED: u8 = 1;
const STRING: u8 = 17;
const WSTRING: u8 = 18;
/// What a bounded text has beyond an unbounded one.
const BOUNDED: u8 = 4;
const ARRAY: u8 = 48;
const BOUNDED_SEQUENCE: u8 = 96;
const SEQUENCE: u8 = 144;

impl Description {
    /// Of a definition in `.msg` form, with those of other types after lines `MSG: pkg/Type`. An error says what is wrong with the text.
    pub fn of_text(root: &str, text: &str) -> Result<Description, String> {
        let root = name::full_type(root).ok_or_else(|| format!("`{root}` is no name of a type"))?;
        let sections = sections(&root, text)?;
        let (mut types, mut wanted) = (BTreeMap::new(), vec![root.clone()]);
        while let Some(name) = wanted.pop() {
            if types.contains_key(&name) {
                continue;
            }
            let lines = sections.get(name.as_str()).ok_or_else(|| format!("the definition of {name} is not there"))?;
            let fields = fields(&name, lines)?;
            wanted.extend(fields.iter().filter(|f| !f.nested.is_empty()).map(|f| f.nested.clone()));
            types.insert(name, fields);
        }
        Ok(Description { root, types })
    }

    /// Its hash.
    pub fn hash(&self) -> TypeHash {
        TypeHash(Sha256::digest(self.json()).into())
    }

    /// The text whose hash is taken: as Python's `json.dumps` writes it, with a blank after each comma and colon. Defaults are left out.
    /// All names are words (see [`is_sound`](Description::is_sound)), so nothing needs escaping.
    fn json(&self) -> String {
        let own = self.types.get(&self.root).map(Vec::as_slice).unwrap_or_default();
        let others = self.types.iter().filter(|(name, _)| **name != self.root);
        let others: Vec<String> = others.map(|(name, fields)| type_json(name, fields)).collect();
        format!(
            "{{\"type_description\": {}, \"referenced_type_descriptions\": [{}]}}",
            type_json(&self.root, own),
            others.join(", ")
        )
    }

    /// Whether its names are names, its types are known, and nothing is in it that the type does not need: what comes over the
    /// network may be anything.
    pub fn is_sound(&self) -> bool {
        let is_word = |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        let is_full = |n: &str| name::full_type(n).is_some_and(|full| full == n);
        let is_field = |f: &Field| is_word(&f.name) && base(f).is_some();
        let are_fields = |fields: &Vec<Field>| fields.len() <= MAX_FIELDS && fields.iter().all(is_field);
        self.types.len() <= MAX_TYPES
            && self.types.iter().all(|(n, fields)| is_full(n) && are_fields(fields))
            && self.part(&self.root).as_ref() == Some(self)
    }

    /// The description as a text in `.msg` form, as recorders write it. Comments and constants are not in a description.
    pub fn text(&self) -> String {
        let mut text = self.types.get(&self.root).map(|fields| lines(fields)).unwrap_or_default();
        for (name, fields) in self.types.iter().filter(|(name, _)| **name != self.root) {
            text.push_str(&format!("{}\nMSG: {}\n{}", "=".repeat(80), short_name(name), lines(fields)));
        }
        text
    }

    /// The part of it that one of its types is.
    pub fn part(&self, root: &str) -> Option<Description> {
        let (mut types, mut wanted) = (BTreeMap::new(), vec![root]);
        while let Some(name) = wanted.pop() {
            let fields = self.types.get(name)?;
            if types.insert(name.to_owned(), fields.clone()).is_none() {
                wanted.extend(fields.iter().map(|f| f.nested.as_str()).filter(|n| !n.is_empty()));
            }
        }
        Some(Description { root: root.to_owned(), types })
    }
}

fn type_json(name: &str, fields: &[Field]) -> String {
    let field = |f: &Field| {
        format!(
            "{{\"name\": \"{}\", \"type\": {{\"type_id\": {}, \"capacity\": {}, \"string_capacity\": {}, \
             \"nested_type_name\": \"{}\"}}}}",
            f.name, f.type_id, f.capacity, f.string_capacity, f.nested
        )
    };
    let fields: Vec<String> = fields.iter().map(field).collect();
    format!("{{\"type_name\": \"{name}\", \"fields\": [{}]}}", fields.join(", "))
}

/// The name as `.msg` files have it: `nav_msgs/Odometry`, but `std_srvs/srv/Trigger_Request`.
fn short_name(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

fn lines(fields: &[Field]) -> String {
    let line = |f: &Field| {
        let around = match f.type_id / ARRAY {
            0 => String::new(),
            1 => format!("[{}]", f.capacity),
            2 => format!("[<={}]", f.capacity),
            _ => "[]".to_owned(),
        };
        format!("{}{around} {}\n", base(f).unwrap_or_default(), f.name)
    };
    // An empty message has one byte on the wire that no definition speaks of.
    fields.iter().filter(|f| f.name != PLACEHOLDER).map(line).collect()
}

/// The type of a field, or of its elements, as `.msg` files spell it. `None` where there is no such type.
fn base(field: &Field) -> Option<String> {
    let id = field.type_id % ARRAY;
    if field.type_id >= SEQUENCE + ARRAY {
        return None;
    }
    match id {
        NESTED => (!field.nested.is_empty()).then(|| short_name(&field.nested)),
        _ if id == STRING + BOUNDED => Some(format!("string<={}", field.string_capacity)),
        _ if id == WSTRING + BOUNDED => Some(format!("wstring<={}", field.string_capacity)),
        _ => BASES.iter().find(|(number, _)| *number == id).map(|(_, name)| (*name).to_owned()),
    }
}

/// The field that a message without fields has in a description.
const PLACEHOLDER: &str = "structure_needs_at_least_one_member";

/// The lines of each definition in a text, by full names.
fn sections<'a>(root: &str, text: &'a str) -> Result<BTreeMap<String, Vec<&'a str>>, String> {
    if text.len() > MAX_TEXT {
        return Err(format!("the definition of {root} is longer than {MAX_TEXT} bytes"));
    }
    let mut sections: BTreeMap<String, Vec<&str>> = BTreeMap::from([(root.to_owned(), Vec::new())]);
    let mut current = root.to_owned();
    for line in text.lines().map(str::trim) {
        if let Some(name) = line.strip_prefix("MSG:") {
            let name = name.trim();
            current = name::full_type(name).ok_or_else(|| format!("`{name}` is no name of a type"))?;
            if sections.len() >= MAX_TYPES {
                return Err(format!("the definition of {root} has more than {MAX_TYPES} types"));
            }
        } else if !(line.is_empty() || line.starts_with('#') || line.starts_with("===")) {
            sections.entry(current.clone()).or_default().push(line);
            continue;
        }
        sections.entry(current.clone()).or_default();
    }
    Ok(sections)
}

fn fields(name: &str, lines: &[&str]) -> Result<Vec<Field>, String> {
    let package = name.split('/').next().unwrap_or_default();
    let mut fields = Vec::new();
    for line in lines {
        let wrong = || format!("the definition of {name}: `{line}` is no field");
        let (ty, rest) = line.split_once(char::is_whitespace).ok_or_else(wrong)?;
        let rest = rest.trim_start();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let (field_name, rest) = rest.split_at(end);
        if field_name.is_empty() || fields.len() >= MAX_FIELDS {
            return Err(wrong());
        }
        if !rest.trim_start().starts_with('=') {
            fields.push(field(package, field_name, ty).ok_or_else(wrong)?);
        }
    }
    if fields.is_empty() {
        fields.extend(field(package, PLACEHOLDER, "uint8"));
    }
    Ok(fields)
}

fn field(package: &str, name: &str, ty: &str) -> Option<Field> {
    let (ty, around, capacity) = match ty.split_once('[') {
        None => (ty, 0, 0),
        Some((ty, rest)) => match (rest.strip_suffix(']')?, rest.strip_prefix("<=")) {
            ("", _) => (ty, SEQUENCE, 0),
            (_, Some(bound)) => (ty, BOUNDED_SEQUENCE, bound.strip_suffix(']')?.parse().ok()?),
            (length, None) => (ty, ARRAY, length.parse().ok()?),
        },
    };
    let (ty, string_capacity) = match ty.split_once("<=") {
        None => (ty, 0),
        Some((ty, bound)) => (ty, bound.parse().ok()?),
    };
    let bounded = if string_capacity > 0 { BOUNDED } else { 0 };
    let known = |id: u8| Field {
        name: name.to_owned(),
        type_id: id + around,
        capacity,
        string_capacity,
        nested: String::new(),
    };
    let nested = |full: String| Field { nested: full, ..known(NESTED) };
    Some(match ty {
        "string" => known(STRING + bounded),
        "wstring" => known(WSTRING + bounded),
        _ if bounded > 0 => return None,
        "char" => known(3),
        "time" => nested("builtin_interfaces/msg/Time".to_owned()),
        "duration" => nested("builtin_interfaces/msg/Duration".to_owned()),
        _ => match BASES.iter().find(|(_, base)| *base == ty) {
            Some((id, _)) => known(*id),
            None if ty.contains('/') => nested(name::full_type(ty)?),
            None => nested(name::full_type(&format!("{package}/{ty}"))?),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the share tree of ROS 2 Jazzy.
    const HEADER: (&str, &str, &str) = (
        "std_msgs/msg/Header",
        "# when\nbuiltin_interfaces/Time stamp\nstring frame_id # where\n=====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec",
        "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    );

    #[test]
    fn the_hash_of_a_header() {
        let (name, text, hash) = HEADER;
        let description = Description::of_text(name, text).unwrap();
        assert_eq!(description.hash().to_string(), hash);
        assert_eq!(TypeHash::parse(hash), Some(description.hash()));
        assert!(description.is_sound());
        let again = Description::of_text(name, &description.text()).unwrap();
        assert_eq!(again, description);
    }

    #[test]
    fn every_kind_of_field_comes_back_from_the_text() {
        let text = "bool a\nbyte b\nstring<=5 c\nwstring<=6[<=2] d\nfloat64[3] e\nuint8[] f\nstring[<=4] g \"x=y\"\nint32 K=5\nint32 h 7\nD i\nx/srv/E_Request[<=1] j\n\
                    ===\nMSG: p/D\nint8 CONSTANT = 3\n===\nMSG: x/srv/E_Request\nduration t\n===\nMSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec";
        let description = Description::of_text("p/T", text).unwrap();
        assert!(description.is_sound(), "{description:?}");
        assert_eq!(Description::of_text("p/T", &description.text()), Ok(description.clone()));
        let root = &description.types["p/msg/T"];
        assert_eq!(root.len(), 10, "{root:?}");
        assert_eq!((root[3].type_id, root[3].capacity, root[3].string_capacity), (118, 2, 6));
        let part = description.part("x/srv/E_Request").unwrap();
        assert_eq!(part.types.len(), 2);
        assert_eq!(description.part("x/srv/F"), None);
    }

    #[test]
    fn what_is_no_definition_is_refused() {
        for text in ["float64", "float64[ x", "float64[<=a] x", "int32<=3 x", "Nowhere x", "a/b/c/d x", "MSG: ?\n"] {
            assert!(Description::of_text("p/T", text).is_err(), "{text}");
        }
        assert!(Description::of_text("T", "").is_err());
    }

    #[test]
    fn what_comes_over_the_network_may_be_anything() {
        let (name, text, _) = HEADER;
        let sound = Description::of_text(name, text).unwrap();
        let broken = |change: &dyn Fn(&mut Description)| {
            let mut description = sound.clone();
            change(&mut description);
            description.is_sound()
        };
        assert!(broken(&|_| {}));
        assert!(!broken(&|d| d.root = "other/msg/T".to_owned()));
        assert!(!broken(&|d| d.types.get_mut(name).unwrap()[0].name = "a\", \"b".to_owned()));
        assert!(!broken(&|d| d.types.get_mut(name).unwrap()[0].nested = "gone/msg/T".to_owned()));
        assert!(!broken(&|d| d.types.get_mut(name).unwrap()[1].type_id = 108));
        assert!(!broken(&|d| d.types.get_mut(name).unwrap()[1].type_id = 255));
        assert!(!broken(&|d| drop(d.types.insert("a/msg/Superfluous".to_owned(), Vec::new()))));
    }

    #[test]
    fn an_announced_hash_is_found_among_other_things() {
        let (.., hash) = HEADER;
        let announced = |text: String| TypeHash::announced(text.as_bytes());
        assert_eq!(announced(format!("enclave=/;typehash={hash};")), TypeHash::parse(hash));
        assert_eq!(announced(format!("typehash={hash};\0")), TypeHash::parse(hash));
        assert_eq!(announced(format!("typehash=RIHS01_{};", "0".repeat(64))), None);
        assert_eq!(announced("typehash=RIHS01_12;".to_owned()), None);
        assert_eq!(announced("typehash=RIHS02_".to_owned() + &hash[7..]), None);
        assert_eq!(TypeHash::announced(&[255, 254]), None);
    }
}
