//! Reading, writing and leaving, by C's library.

use core::fmt;

use lapwing_stream::Value;

#[link(name = "c")]
unsafe extern "C" {
    fn read(file: i32, into: *mut u8, most: usize) -> isize;
    fn write(file: i32, from: *const u8, most: usize) -> isize;
    fn _exit(code: i32) -> !;
}

/// Ends the program at once.
pub fn leave(code: i32) -> ! {
    // SAFETY: it takes any number and does not return.
    unsafe { _exit(code) }
}

/// Standard input, through a buffer of its own.
pub struct Input {
    buffer: [u8; 4096],
    at: usize,
    end: usize,
}

impl Default for Input {
    fn default() -> Input {
        Input { buffer: [0; 4096], at: 0, end: 0 }
    }
}

impl Input {
    fn byte(&mut self) -> Option<u8> {
        if self.at == self.end {
            // SAFETY: the buffer is as long as is said.
            let count = unsafe { read(0, self.buffer.as_mut_ptr(), self.buffer.len()) };
            (self.at, self.end) = (0, usize::try_from(count).ok()?);
        }
        let byte = *self.buffer.get(..self.end)?.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    /// Fills bytes; `None` where the input ends before.
    pub fn fill(&mut self, bytes: &mut [u8]) -> Option<()> {
        bytes.iter_mut().try_for_each(|byte| {
            *byte = self.byte()?;
            Some(())
        })
    }

    /// A number of 32 bits.
    pub fn number(&mut self) -> Option<u32> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes)?;
        Some(u32::from_le_bytes(bytes))
    }

    /// A stamp; `None` at the end.
    pub fn stamp(&mut self) -> Option<i64> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes)?;
        Some(i64::from_le_bytes(bytes))
    }

    /// A cell.
    pub fn cell(&mut self, cell: &mut Value) -> Option<()> {
        let kind = self.byte()?;
        let number = f64::from_bits(self.stamp()?.cast_unsigned());
        *cell = match kind {
            0 => Value::Missing,
            1 => Value::Bool(number != 0.0),
            2 => Value::Num(number),
            _ => return None,
        };
        Some(())
    }
}

/// Standard output.
pub struct Output;

impl fmt::Write for Output {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut bytes = text.as_bytes();
        while !bytes.is_empty() {
            // SAFETY: that many bytes are there.
            let count = unsafe { write(1, bytes.as_ptr(), bytes.len()) };
            bytes = usize::try_from(count).ok().filter(|&n| n > 0).and_then(|n| bytes.get(n..)).ok_or(fmt::Error)?;
        }
        Ok(())
    }
}

/// What unwinding would call, were there any: the engine was compiled for programs that unwind, and refers to it. Nothing gets here, for a
/// panic ends the program.
#[unsafe(no_mangle)]
pub extern "C" fn rust_eh_personality() {
    leave(102)
}

/// See [`rust_eh_personality`].
#[unsafe(no_mangle)]
pub extern "C" fn _Unwind_Resume() -> ! {
    leave(102)
}
