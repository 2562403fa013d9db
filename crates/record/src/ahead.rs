//! A look ahead into what does not tell at once what is in it: the topics, names and events of an NDJSON file.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;

use lapwing_stream::Name;

use crate::error::{Losses, OpenError};
use crate::format::{Head, Source};
use crate::options::Limits;

/// What a look ahead has found.
#[derive(Debug, Default)]
pub(crate) struct Names {
    /// The names of values, in the order in which they are met.
    pub values: Vec<Name>,
    /// The names of events.
    pub events: BTreeSet<Name>,
}

/// Reads so many bytes, and gives the names of the signals and events in them, but no more than `most` of each; the topics are then known to the
/// source.
pub(crate) fn names(source: &mut dyn Source, bytes: u64, most: usize) -> Names {
    // Whatever is wrong is found again, and noted, when the file is read.
    let mut losses = Losses::new(1);
    let mut known: BTreeSet<Name> = BTreeSet::new();
    let mut names = Names::default();
    while let Ok(Some((_, head))) = source.advance(&mut losses) {
        match head {
            Head::Row => source.cells().signals(&mut |name, _| {
                if names.values.len() < most && !known.contains(name) {
                    let name = Name::from(name);
                    known.insert(name.clone());
                    names.values.push(name);
                }
            }),
            Head::Event if names.events.len() < most && !names.events.contains(source.event()) => {
                names.events.insert(Name::from(source.event()));
            }
            Head::Event | Head::Message(_) => {}
        }
        if source.progress().0 >= bytes {
            break;
        }
    }
    names
}

/// All that a stream gives, in a temporary file that nobody else sees.
pub(crate) fn spool(stream: impl Read, path: &Path, limits: &Limits) -> Result<File, OpenError> {
    let (file, copied) =
        copy(stream.take(limits.file)).map_err(|error| OpenError::Io { path: path.to_owned(), error })?;
    if copied < limits.file {
        return Ok(file);
    }
    let what = format!("it has {copied} bytes or more, which is the limit: raise Limits::file if it can be trusted");
    Err(OpenError::Unsupported { path: path.to_owned(), what })
}

fn copy(mut from: impl Read) -> io::Result<(File, u64)> {
    let mut file = tempfile::tempfile()?;
    let copied = io::copy(&mut from, &mut file)?;
    file.rewind()?;
    Ok((file, copied))
}
