//! Protobuf's wire format: numbered entries of four shapes.

use super::super::DecodeError;
use super::Kind;

/// One value as it stands in a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wire<'a> {
    Varint(u64),
    Fixed64(u64),
    Fixed32(u32),
    Bytes(&'a [u8]),
}

/// One value with the number of its field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<'a> {
    pub number: u32,
    pub value: Wire<'a>,
}

type Read<T> = Result<T, DecodeError>;

/// The entries of a message in order. After an error there are no more.
pub(super) fn entries(data: &[u8]) -> impl Iterator<Item = Read<Entry<'_>>> {
    let mut rest = data;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let entry = entry(&mut rest);
        if entry.is_err() {
            rest = &[];
        }
        Some(entry)
    })
}

fn entry<'a>(rest: &mut &'a [u8]) -> Read<Entry<'a>> {
    let tag = varint(rest)?;
    let number = u32::try_from(tag >> 3).map_err(|_| broken("a field number is too large"))?;
    let value = match tag & 7 {
        0 => Wire::Varint(varint(rest)?),
        1 => Wire::Fixed64(u64::from_le_bytes(array(rest)?)),
        2 => {
            let length = usize::try_from(varint(rest)?).unwrap_or(usize::MAX);
            let (bytes, after) =
                rest.split_at_checked(length).ok_or_else(|| broken("a length reaches beyond its end"))?;
            *rest = after;
            Wire::Bytes(bytes)
        }
        5 => Wire::Fixed32(u32::from_le_bytes(array(rest)?)),
        3 | 4 => return Err(broken("it has a group, which is not supported")),
        _ => return Err(broken("a field has an unknown shape")),
    };
    Ok(Entry { number, value })
}

#[cold]
fn broken(what: &str) -> DecodeError {
    DecodeError::new(format!("it is no Protobuf message: {what}"))
}

fn array<const N: usize>(rest: &mut &[u8]) -> Read<[u8; N]> {
    let (bytes, after) = rest.split_first_chunk::<N>().ok_or_else(|| broken("it ends within a number"))?;
    *rest = after;
    Ok(*bytes)
}

fn varint(rest: &mut &[u8]) -> Read<u64> {
    let mut value = 0u64;
    for shift in (0..64).step_by(7) {
        let (byte, after) = rest.split_first().ok_or_else(|| broken("it ends within a number"))?;
        *rest = after;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Ok(value);
        }
    }
    Err(broken("a number is longer than 64 bits"))
}

/// The values that an entry of a repeated field stands for: many where they are packed, else the one.
pub(super) fn unpacked(value: Wire<'_>, kind: Kind) -> impl Iterator<Item = Read<Wire<'_>>> {
    let packed = matches!(value, Wire::Bytes(_)) && (kind.is_number() || kind == Kind::Bool);
    let mut rest: &[u8] = match value {
        Wire::Bytes(bytes) if packed => bytes,
        _ => &[],
    };
    let mut alone = (!packed).then_some(value);
    std::iter::from_fn(move || {
        if let Some(value) = alone.take() {
            return Some(Ok(value));
        }
        if rest.is_empty() {
            return None;
        }
        let one = match kind {
            Kind::Double | Kind::Fixed64 | Kind::Sfixed64 => {
                array(&mut rest).map(|b| Wire::Fixed64(u64::from_le_bytes(b)))
            }
            Kind::Float | Kind::Fixed32 | Kind::Sfixed32 => {
                array(&mut rest).map(|b| Wire::Fixed32(u32::from_le_bytes(b)))
            }
            _ => varint(&mut rest).map(Wire::Varint),
        };
        if one.is_err() {
            rest = &[];
        }
        Some(one)
    })
}

/// The number that a value is.
pub(super) fn number(value: Wire<'_>, kind: Kind) -> Read<f64> {
    Ok(match (kind, value) {
        (Kind::Double, Wire::Fixed64(n)) => f64::from_bits(n),
        (Kind::Float, Wire::Fixed32(n)) => f64::from(f32::from_bits(n)),
        (Kind::Fixed64, Wire::Fixed64(n)) => n as f64,
        (Kind::Sfixed64, Wire::Fixed64(n)) => n as i64 as f64,
        (Kind::Fixed32, Wire::Fixed32(n)) => f64::from(n),
        (Kind::Sfixed32, Wire::Fixed32(n)) => f64::from(n as i32),
        (Kind::Unsigned, Wire::Varint(n)) => n as f64,
        (Kind::Signed, Wire::Varint(n)) => n as i64 as f64,
        (Kind::Zigzag, Wire::Varint(n)) => ((n >> 1) as i64 ^ -((n & 1) as i64)) as f64,
        _ => return Err(broken("a field has another shape than its descriptor says")),
    })
}
