//! Where texts come from, and where includes are looked for.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Gives texts by their path: the disk, or a few files in memory.
pub trait Files {
    /// The bytes of a file.
    ///
    /// # Errors
    ///
    /// Those of reading it.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
}

/// The files of the machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

/// A larger file is no specification.
const LARGEST: u64 = 4 << 20;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let about = fs::metadata(path)?;
        if !about.is_file() {
            return Err(io::Error::other("it is no file"));
        }
        if about.len() > LARGEST {
            return Err(io::Error::other(format!(
                "it has {} MiB, and {} are the limit",
                about.len() >> 20,
                LARGEST >> 20
            )));
        }
        fs::read(path)
    }
}

/// Files in memory, by their path.
impl Files for std::collections::BTreeMap<PathBuf, String> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = self.get(path).map(|text| text.clone().into_bytes());
        found.ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))
    }
}

/// Where `#include` looks: beside the file that includes, then in the folders of `-I` in their order, then beside the files of the command line,
/// which GenoM3 has on its list as well.
///
/// `#include <…>` begins with the folders. Gives the places that were tried where there is no such file.
pub(crate) fn find(
    files: &dyn Files,
    wanted: &str,
    quoted: bool,
    from: &Path,
    (folders, roots): (&[PathBuf], &[PathBuf]),
) -> Result<(PathBuf, Vec<u8>), Vec<PathBuf>> {
    let beside = from.parent().unwrap_or(Path::new(""));
    let mut places: Vec<PathBuf> = folders.iter().map(|folder| folder.join(wanted)).collect();
    places.insert(if quoted { 0 } else { places.len() }, beside.join(wanted));
    places.extend(roots.iter().filter(|root| *root != beside).map(|root| root.join(wanted)));
    for place in &places {
        if let Ok(bytes) = files.read(place) {
            return Ok((place.clone(), bytes));
        }
    }
    Err(places)
}
