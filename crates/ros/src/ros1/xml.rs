//! XML-RPC: values, calls and answers, to and from text.

use std::fmt::Write;

use quick_xml::Reader;
use quick_xml::events::Event;

/// Values are not nested deeper.
const MAX_DEPTH: usize = 32;
/// There are not more values in a text.
const MAX_VALUES: usize = 1 << 20;

/// A value of XML-RPC. Bytes and dates, which ROS's own calls never have, stay the texts that they are written as.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Int(i64),
    Bool(bool),
    Double(f64),
    Text(String),
    Array(Vec<Value>),
    Struct(Vec<(String, Value)>),
}

impl Value {
    pub fn text(&self) -> Option<&str> {
        if let Value::Text(text) = self { Some(text) } else { None }
    }

    pub fn int(&self) -> Option<i64> {
        if let Value::Int(number) = self { Some(*number) } else { None }
    }

    /// Its elements; of what is no array, none.
    pub fn items(&self) -> &[Value] {
        if let Value::Array(items) = self { items } else { &[] }
    }

    /// Its elements that are texts.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.items().iter().filter_map(Value::text)
    }

    /// Whether it is true: `1` is, as ROS's own nodes take it.
    pub fn truth(&self) -> Option<bool> {
        match self {
            Value::Bool(truth) => Some(*truth),
            Value::Int(number) => Some(*number != 0),
            _ => None,
        }
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Value {
        Value::Text(text.to_owned())
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Value {
        Value::Int(number)
    }
}

impl From<Vec<Value>> for Value {
    fn from(items: Vec<Value>) -> Value {
        Value::Array(items)
    }
}

/// The text of a call.
pub(crate) fn write_call(method: &str, params: &[Value]) -> String {
    let mut text = format!("<?xml version=\"1.0\"?>\n<methodCall><methodName>{}</methodName><params>", escape(method));
    params.iter().for_each(|param| write_param(param, &mut text));
    text + "</params></methodCall>\n"
}

/// The text of an answer.
pub(crate) fn write_answer(value: &Value) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<methodResponse><params>");
    write_param(value, &mut text);
    text + "</params></methodResponse>\n"
}

fn write_param(value: &Value, into: &mut String) {
    *into += "<param>";
    write_value(value, into);
    *into += "</param>";
}

fn write_value(value: &Value, into: &mut String) {
    *into += "<value>";
    // To write into a text never fails.
    let _ = match value {
        Value::Int(number) => write!(into, "<int>{number}</int>"),
        Value::Bool(truth) => write!(into, "<boolean>{}</boolean>", u8::from(*truth)),
        Value::Double(number) => write!(into, "<double>{number}</double>"),
        Value::Text(text) => write!(into, "<string>{}</string>", escape(text)),
        Value::Array(items) => {
            *into += "<array><data>";
            items.iter().for_each(|item| write_value(item, into));
            write!(into, "</data></array>")
        }
        Value::Struct(members) => {
            *into += "<struct>";
            for (name, member) in members {
                let _ = write!(into, "<member><name>{}</name>", escape(name));
                write_value(member, into);
                *into += "</member>";
            }
            write!(into, "</struct>")
        }
    };
    *into += "</value>";
}

/// A text as it stands between tags. A reader takes a carriage return that stands there by itself for the end of a line.
fn escape(text: &str) -> String {
    quick_xml::escape::escape(text).replace('\r', "&#13;")
}

/// Reads a call: its method and its parameters.
pub(crate) fn read_call(text: &str) -> Result<(String, Vec<Value>), String> {
    let mut parser = Parser::new(text);
    parser.open("methodCall")?;
    parser.open("methodName")?;
    let method = parser.text_to("methodName")?;
    let mut params = Vec::new();
    match parser.tag()? {
        Tag::Open(name) if name == "params" => {
            while parser.opens("param", "params")? {
                params.push(parser.whole_value()?);
                parser.close("param")?;
            }
        }
        Tag::Close(_) => {}
        other => return Err(format!("{other:?} where parameters are expected")),
    }
    Ok((method.trim().to_owned(), params))
}

/// Reads an answer; a fault is an error with its text.
pub(crate) fn read_answer(text: &str) -> Result<Value, String> {
    let mut parser = Parser::new(text);
    parser.open("methodResponse")?;
    match parser.tag()? {
        Tag::Open(name) if name == "params" => {
            parser.open("param")?;
            parser.whole_value()
        }
        Tag::Open(name) if name == "fault" => Err(fault(&parser.whole_value()?)),
        other => Err(format!("{other:?} where an answer is expected")),
    }
}

fn fault(value: &Value) -> String {
    let Value::Struct(members) = value else { return "a fault without a reason".to_owned() };
    let said = members.iter().find(|(name, _)| name == "faultString").and_then(|(_, text)| text.text());
    said.unwrap_or("a fault without a reason").to_owned()
}

/// The tags of a text, one after the other, with the text between them.
struct Parser<'t> {
    reader: Reader<&'t [u8]>,
    /// What stands before the last tag.
    between: String,
    values: usize,
}

#[derive(Debug)]
enum Tag {
    Open(String),
    Close(String),
}

impl<'t> Parser<'t> {
    fn new(text: &'t str) -> Parser<'t> {
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Parser { reader, between: String::new(), values: 0 }
    }

    /// The next tag.
    fn tag(&mut self) -> Result<Tag, String> {
        self.between.clear();
        loop {
            match self.reader.read_event().map_err(|e| e.to_string())? {
                Event::Start(tag) => return Ok(Tag::Open(tag.name().into_inner().to_owned())),
                Event::End(tag) => return Ok(Tag::Close(tag.name().into_inner().to_owned())),
                Event::Text(text) => self.between += &text.xml10_content(),
                Event::CData(text) => self.between += &text.xml10_content(),
                Event::GeneralRef(entity) => {
                    let known = match entity.resolve_char_ref().map_err(|e| e.to_string())? {
                        Some(letter) => letter,
                        None => predefined(&entity.xml10_content())?,
                    };
                    self.between.push(known);
                }
                Event::Eof => return Err("the text ends early".to_owned()),
                // With its entities a short text can stand for an endless one.
                Event::DocType(_) => return Err("a document type is not accepted".to_owned()),
                Event::Empty(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
            }
        }
    }

    fn open(&mut self, name: &str) -> Result<(), String> {
        match self.tag()? {
            Tag::Open(found) if found == name => Ok(()),
            other => Err(format!("{other:?} where <{name}> is expected")),
        }
    }

    fn close(&mut self, name: &str) -> Result<(), String> {
        match self.tag()? {
            Tag::Close(found) if found == name => Ok(()),
            other => Err(format!("{other:?} where </{name}> is expected")),
        }
    }

    /// Whether one more of that name begins before the surrounding one ends.
    fn opens(&mut self, name: &str, around: &str) -> Result<bool, String> {
        match self.tag()? {
            Tag::Open(found) if found == name => Ok(true),
            Tag::Close(found) if found == around => Ok(false),
            other => Err(format!("{other:?} where <{name}> or </{around}> is expected")),
        }
    }

    fn text_to(&mut self, name: &str) -> Result<String, String> {
        self.close(name)?;
        Ok(std::mem::take(&mut self.between))
    }

    fn whole_value(&mut self) -> Result<Value, String> {
        self.open("value")?;
        self.value(0)
    }

    /// A value whose tag was opened, up to where that is closed.
    fn value(&mut self, depth: usize) -> Result<Value, String> {
        self.values += 1;
        if depth > MAX_DEPTH || self.values > MAX_VALUES {
            return Err(format!("more than {MAX_DEPTH} values within each other, or {MAX_VALUES} values"));
        }
        let kind = match self.tag()? {
            // Without a type it is a text.
            Tag::Close(_) => return Ok(Value::Text(std::mem::take(&mut self.between))),
            Tag::Open(kind) => kind,
        };
        let value = match kind.as_str() {
            "array" => self.array(depth)?,
            "struct" => self.members(depth)?,
            _ => scalar(&kind, self.text_to(&kind)?)?,
        };
        self.close("value")?;
        Ok(value)
    }

    fn array(&mut self, depth: usize) -> Result<Value, String> {
        self.open("data")?;
        let mut items = Vec::new();
        while self.opens("value", "data")? {
            items.push(self.value(depth + 1)?);
        }
        self.close("array")?;
        Ok(Value::Array(items))
    }

    fn members(&mut self, depth: usize) -> Result<Value, String> {
        let mut members = Vec::new();
        while self.opens("member", "struct")? {
            self.open("name")?;
            let name = self.text_to("name")?;
            self.open("value")?;
            members.push((name, self.value(depth + 1)?));
            self.close("member")?;
        }
        Ok(Value::Struct(members))
    }
}

fn scalar(kind: &str, text: String) -> Result<Value, String> {
    let wrong = || format!("`{}` is no {kind}", text.chars().take(40).collect::<String>());
    Ok(match kind {
        "int" | "i4" | "i8" => Value::Int(text.trim().parse().map_err(|_| wrong())?),
        "double" => Value::Double(text.trim().parse().map_err(|_| wrong())?),
        "boolean" => match text.trim() {
            "1" | "true" => Value::Bool(true),
            "0" | "false" => Value::Bool(false),
            _ => return Err(wrong()),
        },
        _ => Value::Text(text),
    })
}

fn predefined(entity: &str) -> Result<char, String> {
    Ok(match entity {
        "amp" => '&',
        "lt" => '<',
        "gt" => '>',
        "quot" => '"',
        "apos" => '\'',
        _ => return Err(format!("`&{entity};` stands for nothing")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_kind() -> Value {
        Value::Array(vec![
            Value::Int(-3),
            Value::Bool(true),
            Value::Double(0.25),
            "a <b> & 'c' \"d\"\r\n".into(),
            "".into(),
            Value::Array(Vec::new()),
            Value::Struct(vec![("n<".to_owned(), Value::Array(vec![1.into()]))]),
        ])
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(read_answer(&write_answer(&every_kind())), Ok(every_kind()));
        let params = [every_kind(), "x".into()];
        assert_eq!(read_call(&write_call("requestTopic", &params)), Ok(("requestTopic".to_owned(), params.to_vec())));
        assert_eq!(
            read_call("<methodCall><methodName>getPid</methodName></methodCall>"),
            Ok(("getPid".into(), vec![]))
        );
    }

    #[test]
    fn other_peoples_ways_of_writing_are_read() {
        let text = "<?xml version='1.0'?>\n<methodResponse>\n<params>\n<param>\n<value><array><data>\n<value><i4>1</i4></value>\n\
                    <value>plain &amp; &#65;&#x42;</value><value><nil/></value><value><string><![CDATA[<x>]]></string></value>\n<!-- c -->\n</data></array></value></param></params></methodResponse>";
        let expected = Value::Array(vec![1.into(), "plain & AB".into(), "".into(), "<x>".into()]);
        assert_eq!(read_answer(text), Ok(expected));
    }

    #[test]
    fn faults_and_hostile_texts_are_errors() {
        let fault = "<methodResponse><fault><value><struct><member><name>faultCode</name><value><int>1</int></value></member>\
                     <member><name>faultString</name><value><string>no such method</string></value></member></struct></value></fault></methodResponse>";
        assert_eq!(read_answer(fault), Err("no such method".to_owned()));
        let deep = format!("<methodResponse><params><param>{}", "<value><array><data>".repeat(100_000));
        assert!(read_answer(&deep).unwrap_err().contains("within each other"));
        for text in [
            "",
            "<methodResponse>",
            "<methodResponse><params></params></methodResponse>",
            "<methodResponse><params><param><value><int>x</int></value></param></params></methodResponse>",
            "<methodResponse><params><param><value>&bomb;</value></param></params></methodResponse>",
            "<!DOCTYPE x [<!ENTITY a \"b\">]><methodResponse/>",
            "<methodCall><methodName>a</methodCall>",
        ] {
            assert!(read_answer(text).is_err() && read_call(text).is_err(), "{text}");
        }
    }
}
