//! `--capsules DIR`: a folder for each violation.

use std::fs;
use std::path::{Path, PathBuf};

use lapwing::capsule::{self, Subject, Written};
use lapwing::{Options, Report, Spec};

/// So many violations of a property become capsules in one recording.
const MOST: usize = 20;

/// The longest part of a folder's name, in characters.
const LONGEST: usize = 60;

/// What is to be told of the capsules of one recording.
#[derive(Debug, Default)]
pub struct Told {
    /// What was written, as text.
    pub notes: String,
    /// Whether one could not be written.
    pub has_failed: bool,
}

/// Writes the capsules of one recording, the `number`-th of `count`, into a folder.
pub fn write(
    folder: &Path,
    (number, count): (usize, usize),
    specs: &[Spec],
    trace: &Path,
    options: &Options,
    report: &Report,
) -> Told {
    let mut told = Told::default();
    let home = match count {
        0 | 1 => folder.to_owned(),
        _ => {
            folder.join(format!("{:03}-{}", number + 1, name(&trace.file_stem().unwrap_or_default().to_string_lossy())))
        }
    };
    for (property, spec) in
        report.properties.iter().filter_map(|p| Some((p, specs.iter().find(|s| s.name() == p.file)?)))
    {
        for (k, violation) in property.violations.iter().enumerate().take(MOST) {
            let subject = Subject { spec, trace, options, report, property, violation };
            let place = free(&home, &format!("{}-{}", name(&property.name), k + 1));
            match place.and_then(|place| capsule::write(&subject, &place).map_err(|e| e.to_string())) {
                Ok(Written { folder, replays: true }) => told.notes += &format!("wrote {}\n", folder.display()),
                Ok(Written { folder, .. }) => {
                    told.notes += &format!(
                        "wrote {}: its clip does not give the same verdict, see its README.md\n",
                        folder.display()
                    );
                }
                Err(why) => {
                    told.notes += &format!("error: no capsule of {}: {why}\n", property.name);
                    told.has_failed = true;
                }
            }
        }
        let more = property.violations.len().saturating_sub(MOST);
        if more > 0 {
            told.notes += &format!("{}: {more} more violations got no capsule\n", property.name);
        }
    }
    told
}

/// A folder that is not there yet, of that name or one like it. What is there is not overwritten.
fn free(home: &Path, name: &str) -> Result<PathBuf, String> {
    fs::create_dir_all(home).map_err(|e| format!("{}: {e}", home.display()))?;
    let names = std::iter::once(name.to_owned()).chain((2..1000).map(|k| format!("{name}.{k}")));
    for path in names.map(|n| home.join(n)) {
        match fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(format!("{}: {e}", path.display())),
        }
    }
    Err(format!("{}: there are too many capsules of this name", home.join(name).display()))
}

/// A text as part of a file's name.
fn name(text: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '-' };
    let name: String = text.chars().map(plain).take(LONGEST).collect();
    let name = name.trim_matches('-');
    if name.is_empty() { "unnamed".to_owned() } else { name.to_owned() }
}
