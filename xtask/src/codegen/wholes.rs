//! Arrays and texts of a trace, in the words by which the driver hands them over: numbers between semicolons, a text as the digits of its bytes, and a
//! semicolon behind each name.

use std::collections::BTreeMap;

use lapwing_codegen::{From, Kind, Shape, Whole};
use lapwing_stream::Value;

/// The names and the numbers of tables that came last.
pub type Latest = BTreeMap<From, Value>;

/// The letter before the number of a whole.
pub fn letter(shape: Shape) -> char {
    match shape {
        Shape::Numbers => 'a',
        Shape::Text => 't',
        Shape::Table(_) => 'l',
        Shape::Columns => 'r',
    }
}

/// What a whole is called with; `Ok(None)` where it is not called, `Err` where a value is none that its function takes.
pub fn handed(
    whole: &Whole,
    latest: &mut Latest,
    found: impl Fn(From) -> Option<Value>,
) -> Result<Option<String>, Unfit> {
    let found = |from| found(from).filter(|value| *value != Value::Missing);
    let Shape::Table(names) = whole.shape else {
        return found(whole.from).map(|value| alone(whole, &value)).transpose();
    };
    let came = [names, whole.from].map(|from| {
        let value = found(from);
        value.map(|value| latest.insert(from, value)).is_some()
    });
    let (Some(names), Some(numbers)) = (latest.get(&names), latest.get(&whole.from)) else { return Ok(None) };
    if came == [false, false] {
        return Ok(None);
    }
    Ok(Some(format!("{}|{}", texts(names)?, elements(numbers)?)))
}

/// A value is of another kind than is taken.
#[derive(Debug)]
pub struct Unfit;

fn alone(whole: &Whole, value: &Value) -> Result<String, Unfit> {
    match value {
        value if whole.shape == Shape::Columns => columns(whole, value),
        Value::Str(text) => Ok(hex(text)),
        value => elements(value),
    }
}

/// How many elements there are, and an array for each part of them that is read.
fn columns(whole: &Whole, value: &Value) -> Result<String, Unfit> {
    let of = match value {
        Value::List(of) => of.as_slice(),
        Value::Nums(of) if of.is_empty() => &[],
        _ => return Err(Unfit),
    };
    let mut word = of.len().to_string();
    for column in &whole.columns {
        word.push('|');
        for element in of {
            let part = column.path.iter().try_fold(element, |of, name| of.field(name));
            word += &match (column.kind, part) {
                (Kind::Number, None) => "NaN".to_owned(),
                (Kind::Number, Some(Value::Num(x))) => format!("{x:?}"),
                (Kind::Truth, Some(Value::Bool(b))) => u8::from(*b).to_string(),
                (Kind::Text, Some(Value::Str(text))) => hex(text),
                _ => return Err(Unfit),
            };
            word.push(';');
        }
    }
    Ok(word)
}

fn elements(value: &Value) -> Result<String, Unfit> {
    match value {
        Value::Nums(of) => Ok(numbers(of)),
        Value::List(of) if of.is_empty() => Ok(String::new()),
        _ => Err(Unfit),
    }
}

/// Numbers between semicolons.
pub fn numbers(of: &[f64]) -> String {
    of.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(";")
}

fn texts(value: &Value) -> Result<String, Unfit> {
    let one = |value: &Value| match value {
        Value::Str(text) => Ok(format!("{};", hex(text))),
        _ => Err(Unfit),
    };
    match value {
        Value::List(of) => of.iter().map(one).collect(),
        Value::Nums(of) if of.is_empty() => Ok(String::new()),
        _ => Err(Unfit),
    }
}

fn hex(text: &str) -> String {
    text.bytes().map(|byte| format!("{byte:02x}")).collect()
}
