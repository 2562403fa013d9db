//! The state of an instance as few bytes, while nothing happens to it.
//!
//! Of a thousand instances an event steps one. The others need not lie about in the shape in which they are stepped, with every list a buffer
//! of its own: each is a row of bytes, and is unpacked into one bench that they share, whose buffers are used again.
//!
//! A state is packed as words, field by field. Nearly all are zero or small, for the program knows their number and kind. So before every two
//! words stands a byte with two nibbles: 1 to 8 is the number of bytes of a word, its least first; 0 is one word that is zero, and 9 to 15 are
//! two to eight of them. This is the packing of Cap'n Proto, by words instead of bytes.

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::string::String;
use alloc::vec::Vec;
use core::cell::Cell;

use lapwing_stream::{Time, Value};

use crate::outcome::Episode;

/// Beyond so many bytes an instance is not packed: it keeps much, and packing would cost in proportion.
const MOST: usize = 512;
/// So many zero words are one nibble at most.
const ZEROS: u8 = 8;
/// There are no more words than this.
const WORDS: usize = MOST * 2 * ZEROS as usize;
/// So many bytes are kept free when a row of them has to grow, so that counters can.
const SLACK: usize = 16;

/// What can be written as words, and read back in place.
///
/// What is read is of the shape that was written: of the same program, or, where bytes were damaged, anything at all, but nothing that
/// panics.
pub(crate) trait Pack {
    fn pack(&self, to: &mut Packer);
    fn unpack(&mut self, from: &mut Unpacker<'_>);
}

/// Packs structures field by field. Fields after `without` are left as they are; all have to be named.
macro_rules! packed {
    ($type:ty { $($field:ident),* $(,)? } $(without { $($left:ident),* })?) => {
        impl $crate::pack::Pack for $type {
            fn pack(&self, to: &mut $crate::pack::Packer) {
                let Self { $($field,)* $($($left: _,)*)? } = self;
                $($crate::pack::Pack::pack($field, to);)*
            }

            fn unpack(&mut self, from: &mut $crate::pack::Unpacker<'_>) {
                let Self { $($field,)* $($($left: _,)*)? } = self;
                $($crate::pack::Pack::unpack($field, from);)*
            }
        }
    };
}
pub(crate) use packed;

packed!(Episode { failed, began, until, count });

/// Takes words in.
#[derive(Clone, Debug, Default)]
pub(crate) struct Packer {
    /// All that there may be.
    bytes: Vec<u8>,
    at: usize,
    /// Where the byte with the latest nibbles is, and whether its upper one is free.
    control: usize,
    is_half: bool,
    /// Zero words that have not been written yet.
    zeros: u8,
    is_too_much: bool,
}

impl Packer {
    /// Packs something into these bytes, which grow where they are too few. Returns whether it could.
    pub fn pack(&mut self, what: &impl Pack, into: &mut Box<[u8]>) -> bool {
        (self.at, self.is_half, self.zeros, self.is_too_much) = (0, false, 0, false);
        self.bytes.resize(MOST, 0);
        what.pack(self);
        self.end_zeros();
        let Some(packed) = self.bytes.get(..self.at).filter(|_| !self.is_too_much) else { return false };
        if into.len() < packed.len() {
            *into = alloc::vec![0; (packed.len() + SLACK).next_multiple_of(SLACK)].into_boxed_slice();
        }
        into[..packed.len()].copy_from_slice(packed);
        true
    }

    /// What comes cannot be packed.
    pub fn refuse(&mut self) {
        self.is_too_much = true;
    }

    #[inline]
    pub fn word(&mut self, word: u64) {
        if word == 0 {
            self.zeros += 1;
            if self.zeros == ZEROS {
                self.end_zeros();
            }
            return;
        }
        self.end_zeros();
        let length = 8 - word.leading_zeros() as u8 / 8;
        self.nibble(length);
        match self.bytes.get_mut(self.at..).and_then(<[u8]>::first_chunk_mut) {
            Some(room) => *room = word.to_le_bytes(),
            None => self.is_too_much = true,
        }
        self.at += usize::from(length);
    }

    #[inline]
    fn end_zeros(&mut self) {
        match core::mem::take(&mut self.zeros) {
            0 => {}
            1 => self.nibble(0),
            zeros => self.nibble(ZEROS - 1 + zeros),
        }
    }

    #[inline]
    fn nibble(&mut self, nibble: u8) {
        if !self.is_half {
            (self.control, self.at) = (self.at, self.at + 1);
        }
        match self.bytes.get_mut(self.control) {
            Some(control) if self.is_half => *control |= nibble << 4,
            Some(control) => *control = nibble,
            None => self.is_too_much = true,
        }
        self.is_half = !self.is_half;
    }
}

/// Gives words back.
#[derive(Clone, Debug)]
pub(crate) struct Unpacker<'a> {
    bytes: &'a [u8],
    /// The upper nibble of the latest byte with two, while it is to come.
    upper: Option<u8>,
    zeros: u8,
}

impl<'a> Unpacker<'a> {
    pub fn new(bytes: &'a [u8]) -> Unpacker<'a> {
        Unpacker { bytes, upper: None, zeros: 0 }
    }

    #[inline]
    pub fn word(&mut self) -> u64 {
        if self.zeros > 0 {
            self.zeros -= 1;
            return 0;
        }
        match self.nibble() {
            0 => 0,
            length @ 1..=8 => self.bytes(length),
            zeros => {
                self.zeros = zeros - ZEROS;
                0
            }
        }
    }

    #[inline]
    fn nibble(&mut self) -> u8 {
        if let Some(upper) = self.upper.take() {
            return upper;
        }
        let Some((control, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        self.upper = Some(control >> 4);
        control & 0xf
    }

    #[inline]
    fn bytes(&mut self, length: u8) -> u64 {
        let word = match self.bytes.first_chunk() {
            Some(bytes) => u64::from_le_bytes(*bytes) & (u64::MAX >> (64 - 8 * u32::from(length))),
            None => {
                let mut word = [0; 8];
                word.iter_mut().zip(self.bytes.iter().take(length.into())).for_each(|(to, from)| *to = *from);
                u64::from_le_bytes(word)
            }
        };
        self.bytes = self.bytes.get(length.into()..).unwrap_or_default();
        word
    }

    /// How many of something follow: no more than could have been written.
    fn count(&mut self) -> usize {
        (self.word() as usize).min(WORDS)
    }
}

/// Numbers that are words as they are.
macro_rules! words {
    ($($number:ty),*) => {$(
        impl Pack for $number {
            #[inline]
            fn pack(&self, to: &mut Packer) {
                to.word(*self as u64);
            }

            #[inline]
            fn unpack(&mut self, from: &mut Unpacker<'_>) {
                *self = from.word() as $number;
            }
        }
    )*};
}
words!(u64, u32, usize);

/// The beginning of time is 0 and its end 1, for they mean "never"; numbers near zero are small on either side of it.
impl Pack for i64 {
    #[inline]
    fn pack(&self, to: &mut Packer) {
        to.word(((self << 1) ^ (self >> 63)).cast_unsigned().wrapping_add(2) ^ 1);
    }

    #[inline]
    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        let word = (from.word() ^ 1).wrapping_sub(2);
        *self = (word >> 1).cast_signed() ^ -(word & 1).cast_signed();
    }
}

impl Pack for bool {
    #[inline]
    fn pack(&self, to: &mut Packer) {
        to.word(u64::from(*self));
    }

    #[inline]
    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        *self = from.word() != 0;
    }
}

impl Pack for f64 {
    fn pack(&self, to: &mut Packer) {
        to.word(self.to_bits());
    }

    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        *self = f64::from_bits(from.word());
    }
}

impl Pack for Time {
    fn pack(&self, to: &mut Packer) {
        self.0.pack(to);
    }

    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        self.0.unpack(from);
    }
}

impl<T: Pack + Copy + Default> Pack for Cell<T> {
    fn pack(&self, to: &mut Packer) {
        self.get().pack(to);
    }

    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        self.get_mut().unpack(from);
    }
}

impl<T: Pack + Default> Pack for Option<T> {
    #[inline]
    fn pack(&self, to: &mut Packer) {
        to.word(u64::from(self.is_some()));
        if let Some(some) = self {
            some.pack(to);
        }
    }

    #[inline]
    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        if from.word() == 0 {
            *self = None;
        } else {
            self.get_or_insert_default().unpack(from);
        }
    }
}

macro_rules! tuples {
    ($($($name:ident)+;)+) => {$(
        impl<$($name: Pack),+> Pack for ($($name,)+) {
            #[allow(non_snake_case)] // A type and its value have one name.
            fn pack(&self, to: &mut Packer) {
                let ($($name,)+) = self;
                $($name.pack(to);)+
            }

            #[allow(non_snake_case)]
            fn unpack(&mut self, from: &mut Unpacker<'_>) {
                let ($($name,)+) = self;
                $($name.unpack(from);)+
            }
        }
    )+};
}
tuples! { A B; A B C; }

/// The program knows how many there are.
impl<T: Pack> Pack for Box<[T]> {
    #[inline]
    fn pack(&self, to: &mut Packer) {
        self.iter().for_each(|item| item.pack(to));
    }

    #[inline]
    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        self.iter_mut().for_each(|item| item.unpack(from));
    }
}

/// Collections whose length changes.
macro_rules! collections {
    ($($collection:ident),*) => {$(
        impl<T: Pack + Default> Pack for $collection<T> {
            fn pack(&self, to: &mut Packer) {
                to.word(self.len() as u64);
                for item in self {
                    if to.is_too_much {
                        return;
                    }
                    item.pack(to);
                }
            }

            fn unpack(&mut self, from: &mut Unpacker<'_>) {
                self.resize_with(from.count(), T::default);
                self.iter_mut().for_each(|item| item.unpack(from));
            }
        }
    )*};
}
collections!(Vec, VecDeque);

/// Scalars and texts; what else there is is refused.
impl Pack for Value {
    fn pack(&self, to: &mut Packer) {
        match self {
            Value::Missing => to.word(0),
            Value::Bool(is) => to.word(1 + u64::from(*is)),
            Value::Num(number) => {
                to.word(3);
                number.pack(to);
            }
            Value::Str(text) => {
                to.word(4 + text.len() as u64);
                text.as_bytes().chunks(8).take(MOST).for_each(|chunk| {
                    let mut word = [0; 8];
                    word[..chunk.len()].copy_from_slice(chunk);
                    to.word(u64::from_le_bytes(word));
                });
                to.is_too_much |= text.len() > MOST;
            }
            _ => to.refuse(),
        }
    }

    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        match from.word() {
            0 => *self = Value::Missing,
            word @ 1..=2 => *self = Value::Bool(word == 2),
            3 => *self = Value::Num(f64::from_bits(from.word())),
            word => {
                let buffer = match core::mem::take(self) {
                    Value::Str(text) => text.into_bytes(),
                    _ => Vec::new(),
                };
                *self = Value::Str(text_of((word - 4) as usize, buffer, from));
            }
        }
    }
}

/// A text of that many bytes.
fn text_of(length: usize, mut buffer: Vec<u8>, from: &mut Unpacker<'_>) -> String {
    let length = length.min(MOST);
    buffer.clear();
    while buffer.len() < length {
        buffer.extend(from.word().to_le_bytes());
    }
    buffer.truncate(length);
    String::from_utf8(buffer).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back<T: Pack + Default>(what: &T) -> T {
        let (mut bytes, mut back) = (Box::default(), T::default());
        assert!(Packer::default().pack(what, &mut bytes));
        back.unpack(&mut Unpacker::new(&bytes));
        back
    }

    #[test]
    fn numbers_come_back() {
        let mut numbers: Vec<i64> = (0..63).flat_map(|n| [1 << n, -1 << n, (1 << n) - 1]).take(40).collect();
        numbers.extend([i64::MIN, i64::MAX, i64::MIN + 1, i64::MAX - 1]);
        assert_eq!(back(&numbers), numbers);
        let zeros: Vec<u64> = (0..40).map(|n| u64::from(n % 11 == 0)).collect();
        assert_eq!(back(&zeros), zeros);
    }

    #[test]
    fn values_come_back() {
        let texts = ["", "eight by", "not eight bytes"].map(Value::from);
        let mut values: Vec<Value> =
            texts.into_iter().chain([Value::Missing, Value::Bool(false), Value::Bool(true)]).collect();
        values.push(Value::Num(-0.5));
        assert_eq!(back(&values), values);
    }

    #[test]
    fn what_is_rare_takes_little_and_what_is_much_is_refused() {
        let mut bytes: Box<[u8]> = Box::default();
        let mut packer = Packer::default();
        assert!(packer.pack(&alloc::vec![None::<i64>; 100], &mut bytes));
        assert!(bytes.len() <= 32, "{}", bytes.len());
        assert!(!packer.pack(&alloc::vec![i64::MAX - 1; 100], &mut bytes));
        assert!(!packer.pack(&Value::Nums(Vec::new()), &mut bytes));
        assert!(packer.pack(&7_u64, &mut bytes));
    }

    /// Bytes of anything at all are read to their end.
    #[test]
    fn damaged_bytes_are_read() {
        let mut chance = 1_u64;
        for _ in 0..2000 {
            let bytes: Vec<u8> = (0..chance >> 58).map(|n| (chance >> (n % 8 * 8)) as u8).collect();
            let mut read: Vec<(Value, Option<(i64, bool)>)> = Vec::new();
            read.unpack(&mut Unpacker::new(&bytes));
            chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        }
    }
}
