//! What is encoded comes out again as it went in, and is what others write.
//!
//! Needs what `tools/peers.sh` installs; without it the comparison fails and says so.

use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use lapwing_record::{Converter, Decoder, Dialect, Encoder, Encoding, Layout, Library, MessageType, Node, Prim};
use lapwing_stream::Value;
use serde_json::Value as Json;

/// Numbers by chance: xorshift, the same in every run.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % n
    }

    /// A value that a field can have.
    fn value(&mut self, node: &Node) -> Value {
        match node {
            Node::Message(layout) => self.message(layout),
            Node::Text | Node::WideText => {
                let letters = ['a', 'é', '√', ' ', '"', '\n'];
                Value::Str((0..self.below(6)).map(|_| letters[self.below(6) as usize]).collect())
            }
            Node::Prim(prim) => self.number(*prim),
            Node::Array { length, element } => {
                let count = length.unwrap_or(self.below(4) as usize);
                let items: Vec<Value> = (0..count).map(|_| self.value(element)).collect();
                match **element {
                    Node::Prim(prim) if prim != Prim::Bool => {
                        let number = |value| if let Value::Num(n) = value { n } else { f64::NAN };
                        Value::Nums(items.into_iter().map(number).collect())
                    }
                    _ => Value::List(items),
                }
            }
        }
    }

    fn message(&mut self, layout: &Layout) -> Value {
        Value::Record(layout.fields().iter().map(|(name, node)| (name.clone(), self.value(node))).collect())
    }

    fn number(&mut self, prim: Prim) -> Value {
        let whole = self.below(1 << 53) as f64;
        let signed = |bits: i32| Value::Num((whole % 2f64.powi(bits)) - 2f64.powi(bits - 1));
        match prim {
            Prim::Bool => Value::Bool(whole % 2.0 == 0.0),
            Prim::U8 => Value::Num(whole % 256.0),
            Prim::U16 => Value::Num(whole % 65536.0),
            Prim::U32 => Value::Num(whole % 4294967296.0),
            Prim::U64 => Value::Num(whole),
            Prim::I8 => signed(8),
            Prim::I16 => signed(16),
            Prim::I32 => signed(32),
            Prim::I64 => signed(53),
            Prim::F32 => Value::Num(f64::from(whole as f32 / 3.0)),
            Prim::F64 => Value::Num(whole / 3.0),
        }
    }
}

/// All fields of a message, decoded.
fn decoded(layout: &Arc<Layout>, encoding: Encoding, bytes: &[u8]) -> Value {
    let ty = match encoding {
        Encoding::Ros1 => MessageType::Ros1(layout.clone()),
        Encoding::Cdr => MessageType::Cdr(layout.clone()),
    };
    let names: Vec<_> = layout.fields().iter().map(|(name, _)| name.clone()).collect();
    let paths: Vec<_> = names.iter().map(|name| lapwing_record::Path::of_names([&**name])).collect();
    let mut decoder = Decoder::new(&ty, &paths, 1 << 20).unwrap();
    let mut values = decoder.slots();
    decoder.decode(bytes, &mut values).unwrap();
    Value::Record(names.into_iter().zip(values).collect())
}

#[test]
fn every_bundled_message_comes_out_as_it_went_in() {
    let mut chance = Chance(0x9E37_79B9_7F4A_7C15);
    let library = Library::default();
    let mut count = 0;
    for name in &library.names() {
        let layout = library.installed(name).unwrap();
        for encoding in [Encoding::Ros1, Encoding::Cdr] {
            let encoder = Encoder::new(layout.clone(), encoding);
            for _ in 0..20 {
                let message = chance.message(&layout);
                let bytes = encoder.encode(&message).unwrap_or_else(|e| panic!("{name}: {e}: {message:?}"));
                assert_eq!(decoded(&layout, encoding, &bytes), message, "{name}, {encoding:?}");
                count += 1;
            }
        }
    }
    assert!(count > 4000, "{count}");
}

#[test]
fn what_is_left_out_is_zero_or_the_default_of_the_definition() {
    let layout = Library::default().installed("geometry_msgs/PoseStamped").unwrap();
    let encoder = Encoder::new(layout.clone(), Encoding::Cdr);
    let nothing = encoder.encode(&Value::Missing).unwrap();
    assert_eq!(nothing, encoder.encode(&Value::Record(vec![])).unwrap());
    let at = |bytes: &[u8], path: &str| {
        let mut decoder = Decoder::new(&MessageType::Cdr(layout.clone()), &[path.parse().unwrap()], 10).unwrap();
        let mut values = decoder.slots();
        decoder.decode(bytes, &mut values).unwrap();
        values.remove(0)
    };
    assert_eq!((at(&nothing, "pose.orientation.w"), at(&nothing, "pose.orientation.x")), (1.0.into(), 0.0.into()));
    let stamp = Value::Record(vec![("stamp".into(), 12.25.into())]);
    let some = encoder.encode(&Value::Record(vec![("header".into(), stamp)])).unwrap();
    let parts = (at(&some, "header.stamp.sec"), at(&some, "header.stamp.nanosec"), at(&some, "header.frame_id"));
    assert_eq!(parts, (12.0.into(), 250_000_000.0.into(), "".into()));
}

#[test]
fn a_message_of_one_version_of_ros_becomes_one_of_the_other_and_back() {
    let ros2 = Library::default().installed("sensor_msgs/Range").unwrap();
    let text = "Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\nfloat32 max_range\nfloat32 range\n\
                ===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
    let ros1 = Library::default().layout(Dialect::Ros1, "sensor_msgs/Range", text).unwrap();
    let stamp = record(&[("sec", 3.0.into()), ("nanosec", 4.0.into())]);
    let header = record(&[("stamp", stamp), ("frame_id", "nose".into())]);
    let message = record(&[("header", header), ("radiation_type", 1.0.into()), ("range", 0.5.into())]);
    let bytes = Encoder::new(ros2.clone(), Encoding::Cdr).encode(&message).unwrap();
    let there =
        Converter::new(&MessageType::Cdr(ros2.clone()), ros1.clone(), Encoding::Ros1).unwrap().convert(&bytes).unwrap();
    assert_eq!(there, Encoder::new(ros1.clone(), Encoding::Ros1).encode(&message).unwrap());
    let mut back = Converter::new(&MessageType::Ros1(ros1), ros2, Encoding::Cdr).unwrap();
    assert_eq!((back.convert(&there).unwrap(), back.convert(&there).unwrap()), (bytes.clone(), bytes));
    assert!(back.convert(&there[1..]).is_err());
}

fn record(fields: &[(&str, Value)]) -> Value {
    Value::Record(fields.iter().map(|(name, value)| ((*name).into(), value.clone())).collect())
}

#[test]
fn what_does_not_fit_is_refused_with_its_place() {
    let text = "uint8 small\nbool flag\nstring name\nint32[3] three\nPart part\nPart[] parts\nfloat32 f\nint64 i\n\
                ===\nMSG: p/Part\nfloat64 x\nstring label\n===\nMSG: p/None\n";
    let layout = Library::default().layout(Dialect::Ros1, "p/Root", text).unwrap();
    let encoder = Encoder::new(layout.clone(), Encoding::Ros1);
    let list = |n: usize| Value::Nums(vec![1.0; n]);
    for (field, value, says) in [
        ("smal", 1.0.into(), "smal: p/Root has no such field; did you mean `small`?"),
        ("part", record(&[("q", 1.0.into())]), "part.q: p/Part has no such field; it has x, label"),
        ("part", 1.0.into(), "part: a number where a p/Part is expected: write its fields in braces"),
        ("small", 256.0.into(), "small: 256 does not fit into uint8, which is 0 to 255"),
        ("small", 0.5.into(), "small: 0.5 is no whole number, and uint8 is"),
        ("small", f64::NAN.into(), "small: NaN does not fit into uint8, which is 0 to 255"),
        ("small", true.into(), "small: a boolean where a number is expected"),
        ("flag", 1.0.into(), "flag: a number where true or false is expected"),
        ("name", 1.0.into(), "name: a number where a text is expected"),
        ("three", list(2), "three: 2 elements where 3 are expected"),
        ("three", 1.0.into(), "three: a number where an array is expected"),
        (
            "parts",
            Value::List(vec![record(&[]), record(&[("label", 1.0.into())])]),
            "parts[1].label: a number where a text is expected",
        ),
        ("f", 1e300.into(), "does not fit into float32"),
        ("i", 1e19.into(), "does not fit into int64"),
    ] {
        let error = encoder.encode(&record(&[(field, value)])).unwrap_err().to_string();
        assert!(error.contains(says), "{error}\n{says}");
    }
    let twice = encoder.encode(&record(&[("small", 1.0.into()), ("small", 2.0.into())])).unwrap_err();
    assert_eq!(twice.to_string(), "small: it is given twice");
    let lenient = encoder.clone().leaving_out_unknown();
    let other = record(&[("small", 1.0.into()), ("variance", 2.0.into())]);
    assert_eq!(lenient.encode(&other), encoder.encode(&record(&[("small", 1.0.into())])));
}

#[test]
fn what_would_never_end_is_refused() {
    for text in ["float64[1000000000] x", "p/None[1000000000] x\n===\nMSG: p/None\n"] {
        let layout = Library::default().layout(Dialect::Ros1, "p/Root", text).unwrap();
        assert!(Encoder::new(layout, Encoding::Ros1).encode(&Value::Missing).is_err(), "{text}");
    }
}

/// A value as JSON has it.
fn value(json: &Json) -> Value {
    match json {
        Json::Null => Value::Missing,
        Json::Bool(b) => Value::Bool(*b),
        Json::Number(n) => Value::Num(n.as_f64().unwrap()),
        Json::String(s) => Value::Str(s.clone()),
        Json::Array(items) if !items.is_empty() && items.iter().all(Json::is_number) => {
            Value::Nums(items.iter().filter_map(Json::as_f64).collect())
        }
        Json::Array(items) => Value::List(items.iter().map(value).collect()),
        Json::Object(fields) => {
            Value::Record(fields.iter().map(|(name, v)| (name.as_str().into(), value(v))).collect())
        }
    }
}

#[test]
fn the_bytes_are_those_that_others_write() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = here.join("../../.venv/bin/python");
    assert!(python.exists(), "the other writers are not installed: run tools/peers.sh once, then this test again");
    let done = Command::new(python).arg(here.join("tests/others/encode.py")).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let mut seen = [0, 0];
    for line in String::from_utf8(done.stdout).unwrap().lines() {
        let case: Json = serde_json::from_str(line).unwrap();
        let text = |name: &str| case[name].as_str().unwrap();
        let (dialect, encoding) = match text("encoding") {
            "ros1" => (Dialect::Ros1, Encoding::Ros1),
            _ => (Dialect::Ros2, Encoding::Cdr),
        };
        let layout = Library::default().layout(dialect, text("type"), text("definition")).unwrap();
        let bytes = Encoder::new(layout, encoding).encode(&value(&case["message"])).unwrap();
        let hex: String = bytes.iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(hex, text("bytes"), "{} as {}: {}", text("type"), text("encoding"), case["message"]);
        seen[usize::from(encoding == Encoding::Cdr)] += 1;
    }
    assert!(seen[0] > 300 && seen[1] > 300, "{seen:?}");
}
