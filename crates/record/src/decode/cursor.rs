//! A position in the bytes of a message, every move of which is checked.

use super::DecodeError;
use crate::definition::Prim;

type Read<T> = Result<T, DecodeError>;

/// How bytes stand for numbers on a wire, known when the code is compiled.
pub(super) trait Wire {
    /// Whether numbers stand at multiples of their size.
    const ALIGNED: bool;
    /// Whether their first byte is the highest.
    const BIG: bool;
}

/// ROS 1.
pub(super) struct Packed;
/// CDR, the low byte first.
pub(super) struct CdrLittle;
/// CDR, the high byte first.
pub(super) struct CdrBig;

impl Wire for Packed {
    const ALIGNED: bool = false;
    const BIG: bool = false;
}
impl Wire for CdrLittle {
    const ALIGNED: bool = true;
    const BIG: bool = false;
}
impl Wire for CdrBig {
    const ALIGNED: bool = true;
    const BIG: bool = true;
}

/// A position in a message.
pub(super) struct Cursor<'a, W> {
    pub data: &'a [u8],
    pub at: usize,
    /// How many more array elements may be read.
    pub budget: usize,
    /// Bytes of a wide character.
    pub wide: usize,
    wire: std::marker::PhantomData<W>,
}

impl<'a, W: Wire> Cursor<'a, W> {
    pub fn new(data: &'a [u8], budget: usize, wide: usize) -> Self {
        Cursor { data, at: 0, budget, wide, wire: std::marker::PhantomData }
    }

    /// The bytes not yet passed.
    pub fn left(&self) -> usize {
        self.data.len() - self.at
    }

    /// Over so many bytes.
    #[inline]
    pub fn jump(&mut self, bytes: u64) -> Read<()> {
        if bytes > self.left() as u64 {
            return Err(self.too_short(bytes));
        }
        self.at += bytes as usize;
        Ok(())
    }

    #[inline]
    fn take(&mut self, bytes: usize) -> Read<&'a [u8]> {
        match self.data.get(self.at..).and_then(|rest| rest.get(..bytes)) {
            Some(taken) => {
                self.at += bytes;
                Ok(taken)
            }
            None => Err(self.too_short(bytes as u64)),
        }
    }

    #[cold]
    fn too_short(&self, bytes: u64) -> DecodeError {
        let Cursor { at, data, .. } = self;
        let left = data.len() - at;
        DecodeError::new(format!(
            "{bytes} bytes are expected at byte {at} of the message, which has {left} left: it does not fit its definition"
        ))
    }

    #[inline]
    fn align(&mut self, size: usize) {
        if W::ALIGNED {
            // May go beyond the end; the next look at the data says so.
            self.at = self.at.next_multiple_of(size).min(self.data.len());
        }
    }

    #[inline]
    fn array<const N: usize>(&mut self) -> Read<[u8; N]> {
        self.align(N);
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        if W::BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// A length or a count.
    #[inline]
    pub fn length(&mut self) -> Read<usize> {
        Ok(u32::from_le_bytes(self.array()?) as usize)
    }

    #[inline]
    pub fn num(&mut self, prim: Prim) -> Read<f64> {
        Ok(match prim {
            Prim::Bool | Prim::U8 => f64::from(u8::from_le_bytes(self.array()?)),
            Prim::I8 => f64::from(i8::from_le_bytes(self.array()?)),
            Prim::I16 => f64::from(i16::from_le_bytes(self.array()?)),
            Prim::U16 => f64::from(u16::from_le_bytes(self.array()?)),
            Prim::I32 => f64::from(i32::from_le_bytes(self.array()?)),
            Prim::U32 => f64::from(u32::from_le_bytes(self.array()?)),
            Prim::I64 => i64::from_le_bytes(self.array()?) as f64,
            Prim::U64 => u64::from_le_bytes(self.array()?) as f64,
            Prim::F32 => f64::from(f32::from_le_bytes(self.array()?)),
            Prim::F64 => f64::from_le_bytes(self.array()?),
        })
    }

    /// So many numbers, in place of those in `out`. One check of the bounds for all.
    pub fn nums(&mut self, prim: Prim, count: usize, out: &mut Vec<f64>) -> Read<()> {
        out.clear();
        if count == 0 {
            return Ok(());
        }
        self.spend(count)?;
        self.align(prim.size());
        let bytes = self.take(count.saturating_mul(prim.size()))?;
        match prim {
            Prim::Bool | Prim::U8 => out.extend(bytes.iter().map(|b| f64::from(*b))),
            Prim::I8 => out.extend(bytes.iter().map(|b| f64::from(*b as i8))),
            Prim::I16 => out.extend(each::<W, 2>(bytes).map(|b| f64::from(i16::from_le_bytes(b)))),
            Prim::U16 => out.extend(each::<W, 2>(bytes).map(|b| f64::from(u16::from_le_bytes(b)))),
            Prim::I32 => out.extend(each::<W, 4>(bytes).map(|b| f64::from(i32::from_le_bytes(b)))),
            Prim::U32 => out.extend(each::<W, 4>(bytes).map(|b| f64::from(u32::from_le_bytes(b)))),
            Prim::I64 => out.extend(each::<W, 8>(bytes).map(|b| i64::from_le_bytes(b) as f64)),
            Prim::U64 => out.extend(each::<W, 8>(bytes).map(|b| u64::from_le_bytes(b) as f64)),
            Prim::F32 => out.extend(each::<W, 4>(bytes).map(|b| f64::from(f32::from_le_bytes(b)))),
            Prim::F64 => out.extend(each::<W, 8>(bytes).map(f64::from_le_bytes)),
        }
        Ok(())
    }

    /// A text. CDR counts a zero byte at its end, ROS 1 has none.
    pub fn text(&mut self) -> Read<&'a [u8]> {
        let length = self.length()?;
        let bytes = self.take(length)?;
        match bytes {
            [rest @ .., 0] if W::ALIGNED => Ok(rest),
            all => Ok(all),
        }
    }

    /// A wide text: the number of its characters, then each as a number of two or four bytes.
    pub fn wide_text(&mut self, mut each_char: impl FnMut(u32)) -> Read<()> {
        let count = self.length()?;
        for _ in 0..count {
            let unit = if self.wide == 2 {
                u32::from(u16::from_le_bytes(self.array()?))
            } else {
                u32::from_le_bytes(self.array()?)
            };
            each_char(unit);
        }
        Ok(())
    }

    /// Counts array elements against the limit.
    pub fn spend(&mut self, elements: usize) -> Read<()> {
        match self.budget.checked_sub(elements) {
            Some(left) => self.budget = left,
            None => {
                return Err(DecodeError::new(
                    "it has more array elements than the limit allows: raise Limits::elements, or want single elements",
                ));
            }
        }
        Ok(())
    }
}

/// The numbers of an array, each with its low byte first.
fn each<W: Wire, const N: usize>(bytes: &[u8]) -> impl Iterator<Item = [u8; N]> + '_ {
    bytes.chunks_exact(N).map(|chunk| {
        let mut number = [0; N];
        number.copy_from_slice(chunk);
        if W::BIG {
            number.reverse();
        }
        number
    })
}
