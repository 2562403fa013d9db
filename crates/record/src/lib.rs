//! Recordings and message definitions: files of many formats in, decoded fields out.
//!
//! # From a file to values
//!
//! 1. [`expand`] makes paths of the words on a command line.
//! 2. [`open`] recognises the format by content and finds the topics, with their schemas.
//! 3. [`Recording::read`] says which fields are wanted.
//! 4. [`Reader::next`] gives messages, rows and events one after the other; only wanted fields are ever decoded.
//!
//! What is damaged is passed over where that is possible and listed in [`Reader::losses`]: reading a hostile file neither
//! panics nor takes more memory than [`Limits`] says.
//!
//! ```
//! use lapwing_record::{Item, Options, open};
//! let file = std::env::temp_dir().join("lapwing-record-doc.csv");
//! std::fs::write(&file, "time,speed\n0.1,1.5\n0.2,\n")?;
//! let mut reader = open(&file, Options::default())?.read(&[]);
//! while let Some(item) = reader.next() {
//!     if let Item::Row { time, cells } = item? {
//!         println!("{time}: speed = {:?}", cells.get("speed"));
//!     }
//! }
//! assert!(reader.losses().is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Live connectors use the same definitions and decoders: [`Library`], [`MessageType`], [`Decoder`]; what they publish is made by an [`Encoder`].

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod ahead;
mod cells;
mod decimal;
mod decode;
mod definition;
mod encode;
mod error;
mod expand;
mod format;
mod met;
mod open;
mod options;
mod path;
mod raw;
mod reader;
mod recording;
mod reorder;
mod stamp;

pub use cells::{Cells, Signal};
pub use decode::{DecodeError, Decoder, MessageType};
pub use definition::{DefinitionError, Dialect, Layout, Library, Node, Prim, bundled_text, normal_name};
pub use encode::{Converter, EncodeError, Encoder, Encoding};
pub use error::{Loss, OpenError, Place, Position, ReadError};
pub use expand::expand;
pub use format::{Format, messages::Messages};
pub use met::{Met, MetField};
pub use options::{Limits, Options, TimeSource};
pub use path::{Part, Path, PathError};
pub use raw::{RawChannel, RawMessage, RawReader};
pub use reader::{Item, Reader};
pub use recording::{Recording, TopicInfo, Wanted, open};
pub use stamp::HeaderStamp;
