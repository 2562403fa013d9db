//! The stamp in the header of a message.

use lapwing_stream::{Time, Value};

use crate::decode::{Decoder, MessageType};
use crate::path::Path;

/// The number of values that a stamp is.
pub(crate) const PARTS: usize = 2;

/// Where the stamp of a header is.
pub(crate) fn paths() -> [Path; PARTS] {
    [Path::of_names(["header", "stamp", "sec"]), Path::of_names(["header", "stamp", "nanosec"])]
}

/// The time of a stamp; `None` where there is none, or a zero one.
pub(crate) fn time(stamp: &[Value]) -> Option<Time> {
    let [Value::Num(seconds), Value::Num(nanoseconds)] = stamp else { return None };
    let nanos = (*seconds as i64).checked_mul(1_000_000_000)?.checked_add(*nanoseconds as i64)?;
    (nanos != 0).then_some(Time(nanos))
}

/// Reads the stamps of the messages of one type.
#[derive(Debug)]
pub struct HeaderStamp {
    decoder: Decoder,
    values: Vec<Value>,
}

impl HeaderStamp {
    /// Of messages of that type; `None` where they have no header.
    pub fn new(ty: &MessageType) -> Option<HeaderStamp> {
        // A stamp has no array.
        let decoder = Decoder::new(ty, &paths(), 0).ok()?.prefix_only();
        Some(HeaderStamp { values: decoder.slots(), decoder })
    }

    /// The stamp of a message; `None` where it is zero, or cannot be read.
    pub fn read(&mut self, message: &[u8]) -> Option<Time> {
        self.decoder.decode(message, &mut self.values).ok()?;
        time(&self.values)
    }
}
