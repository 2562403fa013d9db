//! Calls and answers as bytes: [`lapwing_genom::emit`] says what they are. An answer may be anything: nothing in it is trusted.

use std::collections::BTreeMap;

use lapwing_components::codel::{Argument, Held};
use lapwing_components::{Answer, Call, Datum, Layout, Types};
use lapwing_genom::model::{Basic, Direction, Type};
use lapwing_stream::Duration;

/// Values inside values no deeper than this.
const MOST_DEPTH: usize = 64;

/// An answer has no more parts than bytes, and this many beside: elements may be structures without members, which take no byte.
const MOST_EMPTY: usize = 1 << 20;

/// Writes a call as the bytes that [`lapwing_genom::emit`] says.
///
/// # Errors
///
/// A value has no form in C, in words.
pub fn write_call(call: &Call, out: &mut Vec<u8>) -> Result<(), String> {
    out.push(u8::from(call.is_logical));
    out.extend(u64::try_from(call.now.0).unwrap_or(0).to_ne_bytes());
    for Argument { ty, value, .. } in &call.arguments {
        match value {
            Held::Data(datum) => write(call.types(), ty, datum, out)?,
            Held::Port { content, .. } => {
                out.push(u8::from(content.is_some()));
                if let Some(datum) = content {
                    write(call.types(), ty, datum, out)?;
                }
            }
            Held::Ports { content, .. } => {
                length(content.len(), out);
                for (name, datum) in content {
                    text(name, out);
                    write(call.types(), ty, datum, out)?;
                }
            }
            Held::Remote => {}
        }
    }
    Ok(())
}

fn length(length: usize, out: &mut Vec<u8>) {
    out.extend(u32::try_from(length).unwrap_or(u32::MAX).to_ne_bytes());
}

fn text(text: &str, out: &mut Vec<u8>) {
    length(text.len(), out);
    out.extend(text.as_bytes());
}

fn write(types: &Types, ty: &Type, datum: &Datum, out: &mut Vec<u8>) -> Result<(), String> {
    match (types.layout(ty), datum) {
        (Layout::Basic(basic), datum) => basic_out(basic, datum, out),
        (Layout::Text(_), Datum::Text(s)) => {
            text(s, out);
            Ok(())
        }
        (Layout::Enum(_), Datum::Int(i)) => {
            out.extend(u32::try_from(*i).unwrap_or(0).to_ne_bytes());
            Ok(())
        }
        (Layout::Array(inner, _), Datum::List(items)) => {
            items.iter().try_for_each(|item| write(types, inner, item, out))
        }
        (Layout::Sequence(inner, _), Datum::List(items)) => {
            length(items.len(), out);
            items.iter().try_for_each(|item| write(types, inner, item, out))
        }
        (Layout::Struct(fields), Datum::Struct(parts)) => {
            fields.iter().zip(parts).try_for_each(|(field, part)| write(types, &field.ty, part, out))
        }
        (Layout::Optional(inner), Datum::Optional(value)) => {
            out.push(u8::from(value.is_some()));
            value.iter().try_for_each(|value| write(types, inner, value, out))
        }
        (Layout::Union(cases), Datum::Union(tag, value)) => {
            let there = member(&cases, *tag);
            let tag = i64::try_from(*tag).map_err(|_| format!("a union of {tag} has no form in C"))?;
            out.extend(tag.to_ne_bytes());
            match (there, value) {
                (None, None) => Ok(()),
                (Some((wanted, ty)), Some((number, value))) if wanted == *number => write(types, ty, value, out),
                _ => Err(format!("a union of {tag} has another member there")),
            }
        }
        (Layout::Native, Datum::Native(handle)) => {
            out.extend(handle.to_ne_bytes());
            Ok(())
        }
        (_, other) => Err(format!("a value has no form in C: {other:?}")),
    }
}

/// The member of a union that is there: its number and its type. There may be none.
fn member<'t>(cases: &[(Vec<i128>, &'t Type)], tag: i128) -> Option<(usize, &'t Type)> {
    let labelled = cases.iter().position(|(tags, _)| tags.contains(&tag));
    let number = labelled.or_else(|| cases.iter().position(|(tags, _)| tags.is_empty()))?;
    cases.get(number).map(|(_, ty)| (number, *ty))
}

fn basic_out(basic: Basic, datum: &Datum, out: &mut Vec<u8>) -> Result<(), String> {
    let whole = match datum {
        Datum::Int(i) => *i,
        Datum::Bool(b) => i128::from(*b),
        _ => 0,
    };
    match (basic, datum) {
        (Basic::Boolean | Basic::Char | Basic::Octet, Datum::Int(_) | Datum::Bool(_)) => out.push(whole as u8),
        (Basic::Short | Basic::UnsignedShort, Datum::Int(_)) => out.extend((whole as u16).to_ne_bytes()),
        (Basic::Long | Basic::UnsignedLong | Basic::WideChar, Datum::Int(_)) => {
            out.extend((whole as u32).to_ne_bytes())
        }
        (Basic::LongLong | Basic::UnsignedLongLong, Datum::Int(_)) => out.extend((whole as u64).to_ne_bytes()),
        (Basic::Float, Datum::Float(x)) => out.extend((*x as f32).to_ne_bytes()),
        (Basic::Double, Datum::Float(x)) => out.extend(x.to_ne_bytes()),
        (_, other) => return Err(format!("a value has no form in C: {other:?}")),
    }
    Ok(())
}

/// Takes in an answer, whatever it is: what has changed is put into the call.
///
/// # Errors
///
/// What is wrong with it.
pub fn read_answer(call: &mut Call, bytes: &[u8]) -> Result<Answer, String> {
    let types = call.types().clone();
    let mut reader = Reader { bytes, types: &types, left: bytes.len().saturating_add(MOST_EMPTY) };
    let kind = reader.byte()?;
    let name = reader.text()?;
    let busy = reader.u64()?;
    call.busy = Duration::from_nanos(i64::try_from(busy).unwrap_or(i64::MAX));
    for argument in call.arguments.iter_mut().filter(|a| a.direction != Direction::In) {
        reader.argument(argument)?;
    }
    if !reader.bytes.is_empty() {
        return Err(format!("{} bytes too many", reader.bytes.len()));
    }
    match kind {
        0 => Ok(Answer::Event(name)),
        1 => Ok(Answer::Exception(name)),
        2 => Ok(Answer::Ok),
        other => Err(format!("there is no answer of the kind {other}")),
    }
}

struct Reader<'b> {
    bytes: &'b [u8],
    types: &'b Types,
    /// How many parts may still come.
    left: usize,
}

impl Reader<'_> {
    fn argument(&mut self, argument: &mut Argument) -> Result<(), String> {
        let Argument { ty, value, .. } = argument;
        match value {
            Held::Data(datum) => *datum = self.value(ty, 0)?,
            Held::Port { written, .. } => {
                for _ in 0..self.length()? {
                    written.push(self.value(ty, 0)?);
                }
            }
            Held::Ports { content, written } => {
                let content: &mut BTreeMap<String, Datum> = content;
                for _ in 0..self.length()? {
                    let (name, value) = (self.text()?, self.value(ty, 0)?);
                    content.insert(name.clone(), value.clone());
                    written.push((name, value));
                }
            }
            Held::Remote => {}
        }
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (first, rest) = self.bytes.split_first_chunk::<N>().ok_or("it is too short")?;
        self.bytes = rest;
        Ok(*first)
    }

    fn byte(&mut self) -> Result<u8, String> {
        self.take::<1>().map(|[b]| b)
    }

    fn u64(&mut self) -> Result<u64, String> {
        self.take().map(u64::from_ne_bytes)
    }

    /// A length: of nothing can there be more than there are bytes, as everything takes one at least.
    fn length(&mut self) -> Result<usize, String> {
        let length = u32::from_ne_bytes(self.take()?) as usize;
        if length > self.bytes.len() {
            return Err(format!("it says that {length} things follow, and {} bytes do", self.bytes.len()));
        }
        Ok(length)
    }

    fn text(&mut self) -> Result<String, String> {
        let length = self.length()?;
        let (text, rest) = self.bytes.split_at(length);
        self.bytes = rest;
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    fn value(&mut self, ty: &Type, depth: usize) -> Result<Datum, String> {
        if depth > MOST_DEPTH {
            return Err("values stand too deep inside values".to_owned());
        }
        self.left = self.left.checked_sub(1).ok_or("it has more parts than its bytes can be")?;
        let types = self.types;
        Ok(match types.layout(ty) {
            Layout::Basic(basic) => self.basic(basic)?,
            Layout::Text(most) => {
                let text = self.text()?;
                if most.is_some_and(|most| text.len() as u64 > most) {
                    return Err(format!("a text has {} bytes, which are too many", text.len()));
                }
                Datum::Text(text)
            }
            Layout::Enum(count) => {
                let number = u32::from_ne_bytes(self.take()?);
                if number as usize >= count {
                    return Err(format!("there is no enumerator with the number {number}"));
                }
                Datum::Int(i128::from(number))
            }
            Layout::Array(inner, length) => {
                let items = (0..length).map(|_| self.value(inner, depth + 1));
                Datum::List(items.collect::<Result<_, _>>()?)
            }
            Layout::Sequence(inner, most) => {
                let length = self.length()?;
                if most.is_some_and(|most| length as u64 > most) {
                    return Err(format!("a sequence has {length} elements, which are too many"));
                }
                let items = (0..length).map(|_| self.value(inner, depth + 1));
                Datum::List(items.collect::<Result<_, _>>()?)
            }
            Layout::Struct(fields) => {
                let parts = fields.iter().map(|field| self.value(&field.ty, depth + 1));
                Datum::Struct(parts.collect::<Result<_, _>>()?)
            }
            Layout::Optional(inner) => match self.byte()? {
                0 => Datum::Optional(None),
                _ => Datum::Optional(Some(Box::new(self.value(inner, depth + 1)?))),
            },
            Layout::Union(cases) => {
                let tag = i128::from(i64::from_ne_bytes(self.take()?));
                let value = match member(&cases, tag) {
                    Some((number, inner)) => Some((number, Box::new(self.value(inner, depth + 1)?))),
                    None => None,
                };
                Datum::Union(tag, value)
            }
            Layout::Native => Datum::Native(self.u64()?),
            Layout::Other(what) => return Err(format!("{what} has no form in C")),
        })
    }

    fn basic(&mut self, basic: Basic) -> Result<Datum, String> {
        Ok(match basic {
            Basic::Boolean => Datum::Bool(self.byte()? != 0),
            Basic::Char => Datum::Int(i128::from(self.byte()? as i8)),
            Basic::Octet => Datum::Int(i128::from(self.byte()?)),
            Basic::Short => Datum::Int(i128::from(i16::from_ne_bytes(self.take()?))),
            Basic::UnsignedShort => Datum::Int(i128::from(u16::from_ne_bytes(self.take()?))),
            Basic::Long | Basic::WideChar => Datum::Int(i128::from(i32::from_ne_bytes(self.take()?))),
            Basic::UnsignedLong => Datum::Int(i128::from(u32::from_ne_bytes(self.take()?))),
            Basic::LongLong => Datum::Int(i128::from(i64::from_ne_bytes(self.take()?))),
            Basic::UnsignedLongLong => Datum::Int(i128::from(self.u64()?)),
            Basic::Float => Datum::Float(f64::from(f32::from_ne_bytes(self.take()?))),
            Basic::Double => Datum::Float(f64::from_ne_bytes(self.take()?)),
            Basic::Any => return Err("a value of the type `any` has no form in C".to_owned()),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use lapwing_genom::model::{Basic, Field, Model, TypeDef, TypeDefKind, TypeId};
    use lapwing_stream::Time;

    use super::*;

    /// A structure of a number, a text and a sequence of at most 3 numbers.
    fn call() -> Call {
        let field = |name: &str, ty| Field { name: name.to_owned(), ty, span: Default::default() };
        let few = Type::Sequence(Box::new(Type::Basic(Basic::Short)), Some(3));
        let fields = vec![field("x", Type::Basic(Basic::Double)), field("t", Type::Text(None)), field("few", few)];
        let def = TypeDef { path: vec!["s".to_owned()], kind: TypeDefKind::Struct(fields), span: Default::default() };
        let types = Types::new(&Model { types: vec![def], ..Model::default() }).unwrap();
        let ty = Arc::new(Type::Named(TypeId(0)));
        let argument = |name: &str, direction, value| Argument { name: name.into(), direction, ty: ty.clone(), value };
        let datum = Datum::Struct(vec![
            Datum::Float(0.5),
            Datum::Text("abc".to_owned()),
            Datum::List(vec![Datum::Int(-1), Datum::Int(2)]),
        ]);
        let port = Held::Port { content: Some(datum.clone()), written: Vec::new() };
        let arguments = vec![argument("d", Direction::InOut, Held::Data(datum)), argument("p", Direction::Out, port)];
        Call::new(Arc::from("C"), Arc::from("f"), Time(7), arguments, types)
    }

    /// An answer that gives back what the call has, and writes it to the port once.
    fn answer(call: &Call) -> Vec<u8> {
        let mut bytes = vec![0];
        text("main", &mut bytes);
        bytes.extend(5_u64.to_ne_bytes());
        for (place, argument) in call.arguments.iter().enumerate() {
            if place == 1 {
                length(1, &mut bytes);
            }
            if let Held::Data(datum) | Held::Port { content: Some(datum), .. } = &argument.value {
                write(call.types(), &argument.ty, datum, &mut bytes).unwrap();
            }
        }
        bytes
    }

    #[test]
    fn an_answer_gives_back_what_was_given() {
        let (mut after, before) = (call(), call());
        assert_eq!(read_answer(&mut after, &answer(&before)), Ok(Answer::event("main")));
        assert_eq!(after.busy, Duration::from_nanos(5));
        let (Held::Data(one), Held::Data(two)) = (&before.arguments[0].value, &after.arguments[0].value) else {
            panic!()
        };
        assert_eq!(one, two);
        let Held::Port { written, .. } = &after.arguments[1].value else { panic!() };
        assert_eq!(written.as_slice(), std::slice::from_ref(one));
    }

    #[test]
    fn every_beginning_of_an_answer_and_every_other_byte_is_an_error_or_an_answer() {
        let good = answer(&call());
        for end in 0..good.len() {
            assert!(read_answer(&mut call(), &good[..end]).is_err(), "{end}");
        }
        for at in 0..good.len() {
            for byte in [0, 1, 3, 0x7f, 0xff] {
                let mut bad = good.clone();
                bad[at] = byte;
                // It must come back, whatever it says.
                let _ = read_answer(&mut call(), &bad);
            }
        }
        let mut long = good.clone();
        long.push(0);
        assert!(read_answer(&mut call(), &long).unwrap_err().contains("1 bytes too many"));
    }
}
