//! A look ahead into what does not tell at once what is in it: the topics and names of an NDJSON file.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;

use lapwing_stream::Name;

use crate::error::{Losses, OpenError};
use crate::format::stream::Stream;
use crate::format::{Head, Source};
use crate::options::Limits;

/// Reads so many bytes, and gives the names of the values in them; the topics are then known to the source.
pub(crate) fn names(source: &mut dyn Source, bytes: u64) -> Vec<Name> {
    // Whatever is wrong is found again, and noted, when the file is read.
    let mut losses = Losses::new(1);
    let mut known: BTreeSet<Name> = BTreeSet::new();
    let mut names = Vec::new();
    while let Ok(Some((_, head))) = source.advance(&mut losses) {
        if head == Head::Row {
            for name in source.cells().names() {
                if !known.contains(name) {
                    known.insert(name.clone());
                    names.push(name.clone());
                }
            }
        }
        if source.progress().0 >= bytes {
            break;
        }
    }
    names
}

/// All that a stream gives, in a temporary file that nobody else sees.
pub(crate) fn spool(stream: Stream, path: &Path, limits: &Limits) -> Result<File, OpenError> {
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
