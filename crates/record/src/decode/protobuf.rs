//! Reads the wanted fields out of a Protobuf message by its descriptor, and passes over the rest.
//!
//! A field that is absent is [`Value::Missing`] where the descriptor can tell absence: messages, `optional` fields, and all of proto2.
//! Of the others proto3 sends no zero, so that an absent one *is* its zero; an absent repeated field is an empty array.

mod descriptor;
mod wire;

use std::sync::Arc;

use lapwing_stream::{Name, Value};

pub use descriptor::Message;
pub(crate) use descriptor::parse;

use super::DecodeError;
use super::run::{list_of, nums_of, record_of, set_text};
use super::tree::Tree;
use descriptor::{Field, Kind, MessageDef};
use wire::{Entry, Wire};

/// Messages may not be nested deeper than this.
const MAX_DEPTH: usize = 64;

type Read<T> = Result<T, DecodeError>;

/// Reads the wanted fields of one message type.
#[derive(Debug)]
pub(super) struct Reader {
    message: Arc<Message>,
    root: Vec<Wanted>,
    seen: Vec<bool>,
}

/// What is wanted of one field.
#[derive(Debug)]
struct Wanted {
    field: Field,
    /// The slots that get its value.
    whole: Vec<usize>,
    /// What is wanted of its own fields.
    below: Vec<Wanted>,
    /// What is wanted of its elements: which, into which slots, and what of their fields.
    items: Vec<(usize, Vec<usize>, Vec<Wanted>)>,
}

impl Reader {
    /// A reader of those fields; a field that the type does not have is an error.
    pub fn new(message: &Arc<Message>, tree: Tree, slots: usize) -> Read<Reader> {
        if !tree.whole.is_empty() {
            return Err(DecodeError::new("a whole Protobuf message is asked for: name a field"));
        }
        let root = wanted(&message.types, message.root, &tree)?;
        Ok(Reader { message: message.clone(), root, seen: vec![false; slots] })
    }

    pub fn read(&mut self, data: &[u8], elements: usize, values: &mut [Value]) -> Read<()> {
        self.seen.fill(false);
        let mut into =
            Into { values, seen: &mut self.seen, from: From { types: &self.message.types, budget: elements } };
        into.message(data, &self.root)?;
        for (value, seen) in values.iter_mut().zip(&self.seen) {
            if !seen {
                *value = Value::Missing;
            }
        }
        Ok(())
    }
}

fn wanted(types: &[MessageDef], of: usize, tree: &Tree) -> Read<Vec<Wanted>> {
    let Some(message) = types.get(of) else { return Ok(Vec::new()) };
    let find = |name: &str| message.fields.iter().find(|f| &*f.name == name);
    let mut all = Vec::new();
    for (name, below) in tree.spelled(|name| find(name).is_some()) {
        let Some(field) = find(&name) else {
            let known: Vec<&str> = message.fields.iter().map(|f| &*f.name).collect();
            return Err(DecodeError::new(format!(
                "{} has no field `{name}`; it has {}",
                message.name,
                known.join(", ")
            )));
        };
        if field.repeated && !below.names.is_empty() {
            return Err(DecodeError::new(format!("`{name}` is an array: write an index after it, as in `{name}[0]`")));
        }
        if !field.repeated && !below.items.is_empty() {
            return Err(DecodeError::new(format!("`{name}` is no array: it has no elements")));
        }
        let mut items = Vec::new();
        for (index, item) in &below.items {
            items.push((*index, item.whole.clone(), inside(types, field, item)?));
        }
        all.push(Wanted {
            field: field.clone(),
            whole: below.whole.clone(),
            below: inside(types, field, below)?,
            items,
        });
    }
    Ok(all)
}

/// What is wanted inside a field, which must then be a message.
fn inside(types: &[MessageDef], field: &Field, tree: &Tree) -> Read<Vec<Wanted>> {
    match (tree.names.first(), field.kind) {
        (None, _) => Ok(Vec::new()),
        (Some(_), Kind::Message(index)) => wanted(types, index, tree),
        (Some((name, _)), _) => {
            Err(DecodeError::new(format!("`{name}` is asked of `{}`, a plain value, which has no fields", field.name)))
        }
    }
}

/// Where the values go.
struct Into<'a> {
    values: &'a mut [Value],
    seen: &'a mut [bool],
    from: From<'a>,
}

impl Into<'_> {
    /// Goes over a message once for each wanted field: messages have few, and no index.
    fn message(&mut self, data: &[u8], wanted: &[Wanted]) -> Read<()> {
        wanted.iter().try_for_each(|one| self.field(data, one))
    }

    fn field(&mut self, data: &[u8], wanted: &Wanted) -> Read<()> {
        let field = &wanted.field;
        if let Some((&slot, others)) = wanted.whole.split_first() {
            self.from.whole(data, field, &mut self.values[slot], 0)?;
            self.seen[slot] = true;
            for &other in others {
                self.values[other] = self.values[slot].clone();
                self.seen[other] = true;
            }
        }
        if !wanted.below.is_empty() {
            let mut last = None;
            for entry in wire::entries(data) {
                match entry? {
                    Entry { number, value: Wire::Bytes(bytes) } if number == field.number => last = Some(bytes),
                    _ => {}
                }
            }
            if let Some(bytes) = last {
                self.message(bytes, &wanted.below)?;
            }
        }
        if wanted.items.is_empty() { Ok(()) } else { self.items(data, wanted) }
    }

    fn items(&mut self, data: &[u8], wanted: &Wanted) -> Read<()> {
        let mut index = 0;
        for entry in wire::entries(data) {
            let entry = entry?;
            if entry.number != wanted.field.number {
                continue;
            }
            for one in wire::unpacked(entry.value, wanted.field.kind) {
                let one = one?;
                for (_, whole, below) in wanted.items.iter().filter(|(k, ..)| *k == index) {
                    for &slot in whole {
                        self.from.single(one, wanted.field.kind, &mut self.values[slot], 0)?;
                        self.seen[slot] = true;
                    }
                    match one {
                        Wire::Bytes(bytes) if !below.is_empty() => self.message(bytes, below)?,
                        _ => {}
                    }
                }
                index += 1;
            }
        }
        Ok(())
    }
}

/// Where whole values come from.
struct From<'a> {
    types: &'a [MessageDef],
    budget: usize,
}

impl From<'_> {
    fn spend(&mut self, elements: usize) -> Read<()> {
        let left = self.budget.checked_sub(elements);
        self.budget = left.ok_or_else(|| {
            DecodeError::new(
                "it has more array elements than the limit allows: raise Limits::elements, or want single elements",
            )
        })?;
        Ok(())
    }

    /// Overwrites `into` by a field: the last where it comes more than once, what its absence stands for where it does not.
    fn whole(&mut self, data: &[u8], field: &Field, into: &mut Value, depth: usize) -> Read<()> {
        let (mut found, mut count) = (false, 0);
        for entry in wire::entries(data) {
            let entry = entry?;
            if entry.number != field.number {
                continue;
            }
            found = true;
            if !field.repeated {
                self.single(entry.value, field.kind, into, depth)?;
                continue;
            }
            for one in wire::unpacked(entry.value, field.kind) {
                self.spend(1)?;
                self.element(one?, field.kind, into, count, depth)?;
                count += 1;
            }
        }
        match into {
            _ if count == 0 && (field.repeated || !found) => *into = absent(field),
            Value::Nums(nums) if field.repeated => nums.truncate(count),
            Value::List(list) if field.repeated => list.truncate(count),
            _ => {}
        }
        Ok(())
    }

    /// One element of a repeated field, at its place in the array.
    fn element(&mut self, one: Wire<'_>, kind: Kind, into: &mut Value, at: usize, depth: usize) -> Read<()> {
        if kind.is_number() {
            let number = wire::number(one, kind)?;
            let nums = nums_of(into);
            match nums.get_mut(at) {
                Some(place) => *place = number,
                None => nums.push(number),
            }
            return Ok(());
        }
        let list = list_of(into);
        if at == list.len() {
            list.push(Value::Missing);
        }
        self.single(one, kind, &mut list[at], depth)
    }

    fn single(&mut self, one: Wire<'_>, kind: Kind, into: &mut Value, depth: usize) -> Read<()> {
        match (kind, one) {
            (Kind::Bool, Wire::Varint(n)) => *into = Value::Bool(n != 0),
            (Kind::Text, Wire::Bytes(bytes)) => set_text(into, &String::from_utf8_lossy(bytes)),
            (Kind::Bytes, Wire::Bytes(bytes)) => {
                self.spend(bytes.len())?;
                let nums = nums_of(into);
                nums.clear();
                nums.extend(bytes.iter().map(|b| f64::from(*b)));
            }
            (Kind::Message(index), Wire::Bytes(bytes)) => self.record(bytes, index, into, depth + 1)?,
            (kind, one) => *into = Value::Num(wire::number(one, kind)?),
        }
        Ok(())
    }

    fn record(&mut self, data: &[u8], index: usize, into: &mut Value, depth: usize) -> Read<()> {
        if depth > MAX_DEPTH {
            return Err(DecodeError::new("its messages are nested too deeply"));
        }
        let Some(message) = self.types.get(index) else { return Ok(()) };
        self.spend(message.fields.len())?;
        let record = record_of(into);
        let same =
            record.len() == message.fields.len() && record.iter().zip(&message.fields).all(|((n, _), f)| *n == f.name);
        if !same {
            record.clear();
            record.extend(message.fields.iter().map(|f| (Name::clone(&f.name), Value::Missing)));
        }
        message.fields.iter().zip(record).try_for_each(|(field, (_, value))| self.whole(data, field, value, depth))
    }
}

/// What an absent field stands for.
fn absent(field: &Field) -> Value {
    match field.kind {
        kind if field.repeated && kind.is_number() => Value::Nums(Vec::new()),
        _ if field.repeated => Value::List(Vec::new()),
        _ if field.tells_absence => Value::Missing,
        Kind::Message(_) => Value::Missing,
        Kind::Bool => Value::Bool(false),
        Kind::Text => Value::Str(String::new()),
        Kind::Bytes => Value::Nums(Vec::new()),
        _ => Value::Num(0.0),
    }
}
