//! A node asked what its types are: the service `~/get_type_description`, which every node has since Jazzy.

use std::collections::BTreeMap;

use super::cdr::{Malformed, Reader, Writer};
use super::description::{Description, Field, TypeHash};

/// The type of the service.
pub const TYPE: &str = "type_description_interfaces/srv/GetTypeDescription";

/// The service of a node.
pub fn service(node: &str) -> String {
    format!("{node}/get_type_description")
}

/// The request for a type and the texts of its definitions.
pub fn request(type_name: &str, hash: TypeHash) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.text(type_name).text(&hash.to_string()).bool(true);
    writer.finish()
}

/// What a node answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// What the type is.
    pub description: Description,
    /// The texts of `.msg` files, by full names of types.
    pub texts: BTreeMap<String, String>,
}

/// Reads the answer. An error says why there is no description.
pub fn answer(message: &[u8]) -> Result<Answer, String> {
    let malformed = |Malformed(what): Malformed| format!("its answer is malformed: {what}");
    let mut reader = Reader::new(message).map_err(malformed)?;
    let is_successful = reader.bool().map_err(malformed)?;
    let reason = reader.text().map_err(malformed)?;
    if !is_successful {
        return Err(format!("it says `{}`", reason.chars().take(200).collect::<String>()));
    }
    let answer = body(&mut reader).map_err(malformed)?;
    if !answer.description.is_sound() {
        return Err("its answer describes no type".to_owned());
    }
    Ok(answer)
}

fn body(reader: &mut Reader<'_>) -> Result<Answer, Malformed> {
    let (root, fields) = individual(reader)?;
    let mut types: BTreeMap<String, Vec<Field>> = reader.sequence(8, individual)?.into_iter().collect();
    types.insert(root.clone(), fields);
    let source = |r: &mut Reader<'_>| Ok((r.text()?, r.text()?, r.text()?));
    let sources = reader.sequence(12, source)?;
    let _extra = reader.sequence(8, |r| Ok((r.text()?, r.text()?)))?;
    let texts = sources.into_iter().filter(|(_, encoding, _)| encoding == "msg");
    Ok(Answer { description: Description { root, types }, texts: texts.map(|(name, _, text)| (name, text)).collect() })
}

fn individual(reader: &mut Reader<'_>) -> Result<(String, Vec<Field>), Malformed> {
    Ok((reader.text()?, reader.sequence(24, field)?))
}

fn field(reader: &mut Reader<'_>) -> Result<Field, Malformed> {
    let name = reader.text()?;
    let (type_id, capacity, string_capacity) = (reader.u8()?, reader.u64()?, reader.u64()?);
    let nested = reader.text()?;
    let _default = reader.text()?;
    Ok(Field { name, type_id, capacity, string_capacity, nested })
}

impl Answer {
    /// The definition as a text in `.msg` form: the files' own texts, which have the constants, where all of them are there and say the same as
    /// the description; else the description's.
    pub fn text(&self) -> String {
        self.files().unwrap_or_else(|| self.description.text())
    }

    fn files(&self) -> Option<String> {
        let root = &self.description.root;
        let mut text = self.texts.get(root)?.trim_end().to_owned() + "\n";
        for name in self.description.types.keys().filter(|name| *name != root) {
            let file = self.texts.get(name)?.trim_end();
            text.push_str(&format!("{}\nMSG: {}\n{file}\n", "=".repeat(80), name.replacen("/msg/", "/", 1)));
        }
        (Description::of_text(root, &text).as_ref() == Ok(&self.description)).then_some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "int32 K=3\nD d\nstring<=9 s";

    /// An answer as a node encodes it, with the texts of its files.
    fn encoded(is_successful: bool, texts: &[(&str, &str)]) -> Vec<u8> {
        let whole = format!("{TEXT}\n===\nMSG: p/D\nfloat64[] x");
        let description = Description::of_text("p/T", &whole).unwrap();
        let mut w = Writer::default();
        w.bool(is_successful).text("no such type");
        let individual = |w: &mut Writer, name: &str| {
            let fields = &description.types[name];
            w.text(name).u32(u32::try_from(fields.len()).unwrap());
            for f in fields {
                w.text(&f.name).bytes(&[f.type_id]);
                for number in [f.capacity, f.string_capacity] {
                    while !(w.clone().finish().len() - 4).is_multiple_of(8) {
                        w.bytes(&[0]);
                    }
                    w.bytes(&number.to_le_bytes());
                }
                w.text(&f.nested).text("");
            }
        };
        individual(&mut w, "p/msg/T");
        w.u32(1);
        individual(&mut w, "p/msg/D");
        w.u32(u32::try_from(texts.len()).unwrap());
        for (name, text) in texts {
            w.text(name).text("msg").text(text);
        }
        w.u32(0);
        w.finish()
    }

    #[test]
    fn the_files_have_the_constants() {
        let answer = answer(&encoded(true, &[("p/msg/T", TEXT), ("p/msg/D", "float64[] x # far\n")])).unwrap();
        let text = answer.text();
        assert!(text.contains("K=3") && text.contains("MSG: p/D\nfloat64[] x # far\n"), "{text}");
    }

    #[test]
    fn without_the_files_the_description_does() {
        for texts in [&[("p/msg/T", TEXT)][..], &[("p/msg/T", TEXT), ("p/msg/D", "float64[] lie")]] {
            let answer = answer(&encoded(true, texts)).unwrap();
            let text = answer.text();
            assert!(!text.contains("K=3") && text.contains("string<=9 s"), "{text}");
            assert_eq!(Description::of_text("p/T", &text), Ok(answer.description));
        }
    }

    #[test]
    fn a_node_may_refuse_or_send_anything() {
        assert!(answer(&encoded(false, &[])).unwrap_err().contains("no such type"));
        let message = encoded(true, &[("p/msg/T", TEXT)]);
        for cut in 0..message.len() {
            assert!(answer(&message[..cut]).is_err(), "{cut}");
        }
        for at in 0..message.len() {
            let mut broken = message.clone();
            broken[at] ^= 0xa5;
            if let Ok(answer) = answer(&broken) {
                let _ = answer.text();
            }
        }
    }
}
