//! A run as bytes: saved at any instant, it goes on in another process with the verdicts that it would have had.
//!
//! The bytes belong to one program and one version of this format, and say so: eight bytes of a mark, the [fingerprint](fingerprint) of
//! the program, a checksum of what follows (both 64 bits, little-endian), and the state in the format of `postcard`. They find a file that is damaged or
//! belongs to something else; they are no seal, so that bytes from a stranger should not be resumed.

use alloc::vec::Vec;
use core::fmt::{self, Write};

use crate::feed::State;
use crate::program::Program;

/// What the bytes begin with; its last byte is the version of the format.
const MARK: [u8; 8] = *b"lapwing\x04";

/// What the bytes of a program begin with; the last byte is the version of the format.
const PROGRAM: [u8; 8] = *b"lw-prog\x01";

/// Why a program cannot be loaded.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NotLoaded {
    /// These are not the bytes of a program, or of another version.
    Unknown,
    /// Something is missing or was altered.
    Damaged,
}

impl fmt::Display for NotLoaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NotLoaded::Unknown => "this is no program that this version saved",
            NotLoaded::Damaged => "this program is damaged",
        })
    }
}

impl core::error::Error for NotLoaded {}

impl Program {
    /// The program as bytes.
    pub fn save(&self) -> Vec<u8> {
        // Writing to memory cannot fail: nothing in a program is without a length.
        let body = postcard::to_allocvec(self).unwrap_or_default();
        let mut bytes = PROGRAM.to_vec();
        bytes.extend(Hash::of(&body).to_le_bytes());
        bytes.extend(body);
        bytes
    }

    /// The program that [`Program::save`] wrote, ready to run.
    pub fn load(bytes: &[u8]) -> Result<Program, NotLoaded> {
        let rest = bytes.strip_prefix(&PROGRAM).ok_or(NotLoaded::Unknown)?;
        let (sum, body) = number(rest).ok_or(NotLoaded::Damaged)?;
        if sum != Hash::of(body) {
            return Err(NotLoaded::Damaged);
        }
        let mut program: Program = postcard::from_bytes(body).map_err(|_| NotLoaded::Damaged)?;
        program.link();
        Ok(program)
    }
}

/// Why a state cannot be resumed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NotResumed {
    /// These are not the bytes of a saved state, or of another version.
    Unknown,
    /// It is the state of another program: of a specification that was changed since, or checked against another recording.
    OtherProgram,
    /// Something is missing or was altered.
    Damaged,
}

impl fmt::Display for NotResumed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NotResumed::Unknown => "this is no state that this version saved",
            NotResumed::OtherProgram => "this state belongs to another specification",
            NotResumed::Damaged => "this state is damaged",
        })
    }
}

impl core::error::Error for NotResumed {}

impl State {
    /// The state as bytes.
    pub fn save(&self, program: &Program) -> Vec<u8> {
        // Writing to memory cannot fail: nothing in a state is without a length.
        let body = postcard::to_allocvec(self).unwrap_or_default();
        let mut bytes = MARK.to_vec();
        bytes.extend(fingerprint(program).to_le_bytes());
        bytes.extend(Hash::of(&body).to_le_bytes());
        bytes.extend(body);
        bytes
    }

    /// The state that [`State::save`] wrote for the same program.
    pub fn resume(program: &Program, bytes: &[u8]) -> Result<State, NotResumed> {
        let rest = bytes.strip_prefix(&MARK).ok_or(NotResumed::Unknown)?;
        let (of_program, rest) = number(rest).ok_or(NotResumed::Damaged)?;
        let (sum, body) = number(rest).ok_or(NotResumed::Damaged)?;
        if of_program != fingerprint(program) {
            return Err(NotResumed::OtherProgram);
        }
        if sum != Hash::of(body) {
            return Err(NotResumed::Damaged);
        }
        postcard::from_bytes(body).map_err(|_| NotResumed::Damaged)
    }
}

/// What tells programs apart: the same for equal ones.
pub fn fingerprint(program: &Program) -> u64 {
    let mut hash = Hash::new();
    // A hash takes any text.
    let _ = write!(hash, "{program:?}");
    hash.0
}

fn number(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let (first, rest) = bytes.split_first_chunk()?;
    Some((u64::from_le_bytes(*first), rest))
}

/// The 64-bit hash FNV-1a (Fowler, Noll and Vo).
struct Hash(u64);

impl Hash {
    fn new() -> Hash {
        Hash(0xcbf2_9ce4_8422_2325)
    }

    fn of(bytes: &[u8]) -> u64 {
        let mut hash = Hash::new();
        hash.add(bytes);
        hash.0
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}
