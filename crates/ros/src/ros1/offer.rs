//! What a publisher's connection header offers: the type, its definition, how to decode it.

use lapwing_record::{Dialect, Library, MessageType, Node, RawChannel};

use super::checksum;
use super::definitions::Definitions;
use super::header::Header;
use super::topic::Failure;
use crate::connector::{Cause, Definition};

/// An offer that can be taken: its definition is there, and is the one that the publisher means.
#[derive(Clone, Debug)]
pub(crate) struct Offered {
    pub type_name: String,
    pub checksum: String,
    pub definition: String,
    pub channel: RawChannel,
    pub node: Option<String>,
    pub latched: bool,
    /// Whether messages begin with a header, in which publishers number them.
    pub is_numbered: bool,
}

impl Offered {
    /// Reads it from a publisher's header.
    pub fn read(topic: &str, header: &Header, definitions: &Definitions) -> Result<Offered, Failure> {
        let node = header.get("callerid").unwrap_or("its publisher");
        let disconnected = |what| Failure { cause: Cause::Disconnected(what), is_gone: false };
        let undefined = |what| Failure { cause: Cause::Undefined(what), is_gone: false };
        let need = |name| header.need(name).map_err(|e| disconnected(format!("{node}: {e}")));
        let (type_name, checksum) = (need("type")?, need("md5sum")?);
        if let Some(other) = header.get("topic").filter(|t| *t != topic) {
            return Err(disconnected(format!("{node} answers for {other}")));
        }
        let definition = definition(type_name, checksum, header, definitions)
            .map_err(|what| undefined(format!("{node}: {what}")))?;
        let layout = Library::default().layout(Dialect::Ros1, type_name, &definition);
        let layout = layout.map_err(|e| undefined(format!("{node}: {type_name}: {e}")))?;
        let is_numbered = matches!(layout.fields().first(), Some((_, Node::Message(first))) if first.schema().name == "std_msgs/Header");
        let channel = RawChannel {
            topic: topic.to_owned(),
            type_name: type_name.to_owned(),
            encoding: "ros1msg".to_owned(),
            definition: definition.clone().into_bytes(),
            messages: "ros1".to_owned(),
            ty: Ok(MessageType::Ros1(layout)),
        };
        Ok(Offered {
            type_name: type_name.to_owned(),
            checksum: checksum.to_owned(),
            definition,
            channel,
            node: header.get("callerid").map(str::to_owned),
            latched: header.get("latching") == Some("1"),
            is_numbered,
        })
    }
}

/// The definition that the publisher sends, else the one that is known here; in either case the one with its checksum.
fn definition(type_name: &str, sum: &str, header: &Header, known: &Definitions) -> Result<String, String> {
    let sent = header.get("message_definition").filter(|text| !text.trim().is_empty());
    let (text, whose) = match sent {
        Some(text) => (text.to_owned(), "it sends"),
        // A message without fields has a definition without text.
        None if sum == "d41d8cd98f00b204e9800998ecf8427e" => return Ok(String::new()),
        None => match known.find(type_name) {
            Some(Definition::Message(text)) => (text, "is known here"),
            _ => return Err(format!("it sends no definition of {type_name}, and none is installed or bundled")),
        },
    };
    let own = checksum::of_message(type_name, &text)
        .map_err(|what| format!("the definition of {type_name} that {whose}: {what}"))?;
    if own == sum || sum == "*" {
        return Ok(text);
    }
    Err(format!(
        "the definition of {type_name} that {whose} has the checksum {own}, and its messages are said to have {sum}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: &str = "d41d8cd98f00b204e9800998ecf8427e";

    fn read(fields: &[(&str, &str)]) -> Result<Offered, String> {
        let offered = Offered::read("/a", &Header::of(fields), &Definitions::default());
        offered.map_err(|failure| failure.cause.to_string())
    }

    #[test]
    fn what_is_sent_comes_before_what_is_known() {
        let sum = checksum::of_message("my/T", "int8 x").unwrap();
        let own =
            read(&[("type", "my/T"), ("md5sum", &sum), ("message_definition", "int8 x\n"), ("latching", "1")]).unwrap();
        assert!(own.latched && own.channel.ty.is_ok());
        let bool_sum = "8b94c1b53db61fb6aed406028ad6332a";
        let known = read(&[("type", "std_msgs/Bool"), ("md5sum", bool_sum), ("callerid", "/n")]).unwrap();
        assert_eq!((known.definition.trim(), known.node.as_deref()), ("bool data", Some("/n")));
        assert!(read(&[("type", "my/Nothing"), ("md5sum", EMPTY), ("message_definition", "")]).is_ok());
    }

    #[test]
    fn what_does_not_fit_is_refused_with_both_sides() {
        let lie = read(&[("type", "my/T"), ("md5sum", "0"), ("message_definition", "int8 x")]).unwrap_err();
        assert!(lie.contains("my/T") && lie.contains("said to have 0"), "{lie}");
        assert!(read(&[("type", "my/T"), ("md5sum", "0")]).unwrap_err().contains("no definition"));
        assert!(read(&[("type", "my/T")]).unwrap_err().contains("`md5sum`"));
        assert!(read(&[("type", "a/B"), ("md5sum", EMPTY), ("topic", "/b")]).unwrap_err().contains("/b"));
        assert!(read(&[("type", "my/T"), ("md5sum", "0"), ("message_definition", "not even a line")]).is_err());
    }
}
