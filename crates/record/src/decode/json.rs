//! Reads the wanted fields out of a JSON message, and passes over the rest.

use lapwing_stream::{Name, Schema, Type, Value};

use super::DecodeError;
use super::run::{list_of, nums_of, record_of, set_bool, set_number, set_text};
use super::scan::{Kind, Scanner};
use super::tree::Tree;
use crate::path::aliases;

type Read = Result<(), DecodeError>;

/// Reads the wanted fields of JSON messages of one type.
#[derive(Debug)]
pub(super) struct Reader {
    tree: Tree,
    /// Which slots the current message has filled.
    seen: Vec<bool>,
}

impl Reader {
    /// A reader of those fields; where a schema is known they must be in it.
    pub fn new(tree: Tree, schema: Option<&Schema>, slots: usize) -> Result<Reader, DecodeError> {
        if let Some(schema) = schema {
            check(&tree, schema)?;
        }
        Ok(Reader { tree, seen: vec![false; slots] })
    }

    pub fn read(&mut self, message: &[u8], elements: usize, values: &mut [Value]) -> Read {
        self.seen.fill(false);
        let mut scanner = Scanner::new(message);
        let mut into = Into { values, seen: &mut self.seen, budget: elements };
        into.place(&mut scanner, &self.tree)?;
        scanner.end()?;
        for (value, seen) in values.iter_mut().zip(&self.seen) {
            if !seen {
                *value = Value::Missing;
            }
        }
        Ok(())
    }
}

/// That a schema has the wanted fields, as far as it says.
fn check(tree: &Tree, schema: &Schema) -> Read {
    for (name, below) in tree.spelled(|name| schema.field(name).is_some()) {
        let Some(field) = schema.field(&name) else {
            let known: Vec<&str> = schema.fields.iter().map(|f| &*f.name).collect();
            return Err(DecodeError::new(format!(
                "{} has no field `{name}`; it has {}",
                schema.name,
                known.join(", ")
            )));
        };
        let mut ty = &field.ty;
        let mut places = vec![below];
        while let Type::Array(element) = ty {
            ty = element;
            places = places.iter().flat_map(|p| p.items.iter().map(|(_, t)| t)).collect();
        }
        if let Type::Message(inner) = ty {
            places.into_iter().try_for_each(|place| check(place, inner))?;
        }
    }
    Ok(())
}

/// Where the values go.
struct Into<'a> {
    values: &'a mut [Value],
    seen: &'a mut [bool],
    budget: usize,
}

impl Into<'_> {
    fn place(&mut self, scanner: &mut Scanner<'_>, tree: &Tree) -> Read {
        if let Some((&slot, others)) = tree.whole.split_first() {
            let before = scanner.clone();
            value(scanner, &mut self.budget, &mut self.values[slot])?;
            self.seen[slot] = true;
            for &other in others {
                self.values[other] = self.values[slot].clone();
                self.seen[other] = true;
            }
            if !tree.is_deep() {
                return Ok(());
            }
            *scanner = before;
        }
        match scanner.kind()? {
            Kind::Object if !tree.names.is_empty() => self.object(scanner, tree),
            Kind::Array if !tree.items.is_empty() => self.array(scanner, tree),
            _ => scanner.skip(),
        }
    }

    fn object(&mut self, scanner: &mut Scanner<'_>, tree: &Tree) -> Read {
        scanner.open(b'{')?;
        let mut first = true;
        while scanner.more(b'}', &mut first)? {
            let key = scanner.key()?;
            match tree.names.iter().find(|(name, _)| same(name, &key)) {
                Some((_, below)) => self.place(scanner, below)?,
                None => scanner.skip()?,
            }
        }
        Ok(())
    }

    fn array(&mut self, scanner: &mut Scanner<'_>, tree: &Tree) -> Read {
        scanner.open(b'[')?;
        let mut first = true;
        let mut index = 0;
        while scanner.more(b']', &mut first)? {
            match tree.items.iter().find(|(wanted, _)| *wanted == index) {
                Some((_, below)) => self.place(scanner, below)?,
                None => scanner.skip()?,
            }
            index += 1;
        }
        Ok(())
    }
}

/// Whether a wanted name is that key, in one of the spellings of a time stamp's fields.
fn same(wanted: &str, key: &str) -> bool {
    wanted == key || aliases(wanted).contains(&key)
}

/// Overwrites `into` by the next value. `null` is [`Value::Missing`].
pub(crate) fn value(scanner: &mut Scanner<'_>, budget: &mut usize, into: &mut Value) -> Read {
    match scanner.kind()? {
        Kind::Null => {
            scanner.null()?;
            *into = Value::Missing;
        }
        Kind::Bool => set_bool(into, scanner.bool()?),
        Kind::Number => set_number(into, scanner.number()?),
        Kind::Text => set_text(into, &scanner.text()?),
        Kind::Array => array(scanner, budget, into)?,
        Kind::Object => object(scanner, budget, into)?,
    }
    Ok(())
}

/// An array: of numbers as long as its elements are numbers. `null` among them is NaN: so do most writers of JSON spell it.
fn array(scanner: &mut Scanner<'_>, budget: &mut usize, into: &mut Value) -> Read {
    let before = scanner.clone();
    let nums = nums_of(into);
    nums.clear();
    scanner.open(b'[')?;
    let mut first = true;
    while scanner.more(b']', &mut first)? {
        match scanner.kind()? {
            Kind::Number => nums.push(scanner.number()?),
            Kind::Null if !nums.is_empty() || number_follows(scanner) => {
                scanner.null()?;
                nums.push(f64::NAN);
            }
            _ => {
                *scanner = before;
                return list(scanner, budget, into);
            }
        }
        spend(budget)?;
    }
    Ok(())
}

/// Whether the first element of the array that is not `null` is a number, or there is none.
fn number_follows(scanner: &Scanner<'_>) -> bool {
    let mut ahead = scanner.clone();
    let mut first = true;
    while let Ok(true) = ahead.more(b']', &mut first) {
        match ahead.kind() {
            Ok(Kind::Null) if ahead.null().is_ok() => {}
            Ok(Kind::Number) => return true,
            _ => return false,
        }
    }
    true
}

fn list(scanner: &mut Scanner<'_>, budget: &mut usize, into: &mut Value) -> Read {
    let list = list_of(into);
    scanner.open(b'[')?;
    let (mut first, mut count) = (true, 0);
    while scanner.more(b']', &mut first)? {
        spend(budget)?;
        if count == list.len() {
            list.push(Value::Missing);
        }
        value(scanner, budget, &mut list[count])?;
        count += 1;
    }
    list.truncate(count);
    Ok(())
}

fn object(scanner: &mut Scanner<'_>, budget: &mut usize, into: &mut Value) -> Read {
    let record = record_of(into);
    scanner.open(b'{')?;
    let (mut first, mut count) = (true, 0);
    while scanner.more(b'}', &mut first)? {
        spend(budget)?;
        let key = scanner.key()?;
        match record.get_mut(count) {
            Some((name, _)) if **name == *key => {}
            Some((name, _)) => *name = Name::from(&*key),
            None => record.push((Name::from(&*key), Value::Missing)),
        }
        value(scanner, budget, &mut record[count].1)?;
        count += 1;
    }
    record.truncate(count);
    Ok(())
}

fn spend(budget: &mut usize) -> Read {
    match budget.checked_sub(1) {
        Some(left) => {
            *budget = left;
            Ok(())
        }
        None => Err(DecodeError::new(
            "it has more array elements than the limit allows: raise Limits::elements, or want single elements",
        )),
    }
}

#[cfg(test)]
mod tests {
    use crate::decode::{Decoder, MessageType};
    use lapwing_stream::Value;

    fn read(text: &str, paths: &[&str]) -> Vec<Value> {
        let fields: Vec<_> = paths.iter().map(|p| p.parse().unwrap()).collect();
        let mut decoder = Decoder::new(&MessageType::Json(None), &fields, 100).unwrap();
        let mut values = decoder.slots();
        // Twice: what an earlier message left must not shine through.
        decoder.decode(br#"{"a":{"b":7},"r":[9,9,9,9],"o":{"z":1}}"#, &mut values).unwrap();
        decoder.decode(text.as_bytes(), &mut values).unwrap();
        values
    }

    #[test]
    fn only_the_wanted_fields_are_read() {
        let text = r#"{"x":{"deep":[1,{"y":2}]},"a":{"b":1.5,"c":true},"r":[1,null,NaN],"s":"t"}"#;
        let values = read(text, &["a.b", "a.c", "s", "r[0]", "r[9]", "nope.x", "a"]);
        assert_eq!(values[..4], [1.5.into(), true.into(), "t".into(), 1.0.into()]);
        assert_eq!(values[4..6], [Value::Missing, Value::Missing]);
        assert_eq!(values[6], Value::Record(vec![("b".into(), 1.5.into()), ("c".into(), true.into())]));
    }

    #[test]
    fn arrays_of_numbers_and_others() {
        let Value::Nums(nums) = &read(r#"{"r":[null,1,null]}"#, &["r"])[0] else { panic!() };
        assert!(nums[0].is_nan() && nums[1] == 1.0 && nums[2].is_nan());
        assert_eq!(read(r#"{"r":[]}"#, &["r"])[0], Value::Nums(vec![]));
        assert_eq!(read(r#"{"r":[1,"a",null]}"#, &["r"])[0], Value::List(vec![1.0.into(), "a".into(), Value::Missing]));
    }

    #[test]
    fn both_spellings_of_a_stamp_are_found() {
        assert_eq!(
            read(r#"{"stamp":{"secs":3,"nsecs":4}}"#, &["stamp.sec", "stamp.nanosec"]),
            [3.0.into(), 4.0.into()]
        );
    }

    #[test]
    fn a_message_cannot_ask_for_more_memory_than_the_limit() {
        let mut decoder = Decoder::new(&MessageType::Json(None), &["r".parse().unwrap()], 100).unwrap();
        let mut values = decoder.slots();
        let text = format!(r#"{{"r":[{}1]}}"#, "1,".repeat(1000));
        assert!(decoder.decode(text.as_bytes(), &mut values).unwrap_err().to_string().contains("limit"));
    }
}
