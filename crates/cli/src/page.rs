//! Where the report page goes.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use lapwing_page::Entry;

use crate::complain::Complaint;

/// The file of the page. It is made before anything is checked: a path that cannot be written to is better known at once.
#[derive(Debug)]
pub struct Page {
    path: PathBuf,
    file: File,
}

impl Page {
    /// Makes the file, or empties it.
    pub fn create(path: &Path) -> Result<Page, Complaint> {
        let file = File::create(path).map_err(|e| {
            let complaint = Complaint::new(format!("{}: the report cannot be written: {e}", path.display()));
            match path.parent().is_some_and(|folder| !folder.as_os_str().is_empty() && !folder.exists()) {
                true => complaint.help("the folder is not there; Lapwing makes none"),
                false => complaint,
            }
        })?;
        Ok(Page { path: path.to_owned(), file })
    }

    /// Writes the page. Gives what to say of it, and whether it is there now.
    pub fn write(self, entries: &[Entry]) -> (String, bool) {
        let path = self.path.display();
        let mut to = BufWriter::new(self.file);
        match lapwing_page::write(&mut to, entries).and_then(|()| to.flush()) {
            Ok(()) => (format!("the report is in {path}\n"), true),
            Err(e) => (format!("error: {path}: the report cannot be written: {e}\n"), false),
        }
    }
}
