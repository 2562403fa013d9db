//! Capsules: a violation as a folder that shows and replays it.
//!
//! A capsule holds the part of the recording around the violation, the specification, the verdict and a page that explains it. A clip
//! lacks what came before it, so each one is replayed when it is written: where the verdict is another, the clip begins earlier, and
//! where none will do, the capsule says so.

mod clip;
mod page;
mod replay;
mod table;
mod window;

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use lapwing_react::{Event, Property, Report, Violation, line};
use lapwing_record::{Format, OpenError, ReadError, TimeSource};
use serde_json::{Value, json};

use crate::session::Options;
use crate::shape;
use crate::spec::Spec;
use window::Window;

pub use replay::{Replayed, replay};

/// What stands in every capsule.
const CLIP: &str = "clip.mcap";
const SPEC: &str = "spec.rv";
const VERDICT: &str = "verdict.json";
const README: &str = "README.md";

/// A violation that is to become a capsule.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'s> {
    /// The specification.
    pub spec: &'s Spec,
    /// The recording.
    pub trace: &'s Path,
    /// How it was read.
    pub options: &'s Options,
    /// What was said of it.
    pub report: &'s Report,
    /// The property that was violated.
    pub property: &'s Property,
    /// An episode of it.
    pub violation: &'s Violation,
}

/// A capsule that has been written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Its folder.
    pub folder: PathBuf,
    /// Whether its clip gives the same verdict.
    pub replays: bool,
}

/// Why there is no capsule, or why it cannot be read.
#[derive(Debug)]
pub enum CapsuleError {
    /// A file of it cannot be written or read.
    Io(PathBuf, io::Error),
    /// The recording cannot be opened again.
    Open(OpenError),
    /// The recording cannot be read again.
    Read(ReadError),
    /// Something else, as a sentence.
    Other(String),
}

/// Writes a capsule into a folder, which is made.
pub fn write(subject: &Subject<'_>, folder: &Path) -> Result<Written, CapsuleError> {
    if subject.trace == Path::new("-") {
        return Err(CapsuleError::Other("standard input cannot be read twice: save it to a file first".to_owned()));
    }
    fs::create_dir_all(folder).map_err(|e| CapsuleError::Io(folder.to_owned(), e))?;
    let source = Source::of(subject)?;
    write_specification(subject.spec, folder)?;
    let mut written = (false, Window::plain(subject.violation));
    for window in window::candidates(subject.violation, &source.clock) {
        source.cut(subject, &window, folder)?;
        put(folder, VERDICT, &verdict(subject, &window, true).to_string())?;
        let is_same = replay(folder).is_ok_and(|replayed| replayed.is_same);
        written = (is_same, window);
        if is_same {
            break;
        }
    }
    let (replays, window) = written;
    put(folder, VERDICT, &format!("{:#}\n", verdict(subject, &window, replays)))?;
    put(folder, README, &page::readme(subject, &window, replays, folder))?;
    Ok(Written { folder: folder.to_owned(), replays })
}

/// What the recording is, and what the specification wants of it.
struct Source {
    format: Format,
    topics: Vec<String>,
    clock: lapwing_check::checked::Clock,
}

impl Source {
    fn of(subject: &Subject<'_>) -> Result<Source, CapsuleError> {
        let recording = open(subject)?;
        let meaning = subject.spec.against(&shape::of(&recording)).spec;
        let topics = meaning.topics.iter().map(|t| t.name.clone()).collect();
        Ok(Source { format: recording.format(), topics, clock: meaning.clock })
    }

    /// Writes the clip; of a recording of text both for viewers and as text, which is what replays.
    fn cut(&self, subject: &Subject<'_>, window: &Window, folder: &Path) -> Result<(), CapsuleError> {
        let clip = folder.join(CLIP);
        match self.format {
            Format::Csv | Format::Ndjson => {
                let text = folder.join(if self.format == Format::Csv { "clip.csv" } else { "clip.ndjson" });
                table::cut(subject, &self.topics, window, (&clip, &text), self.format)
            }
            _ => clip::cut(subject, &self.topics, window, &clip),
        }
    }
}

fn open(subject: &Subject<'_>) -> Result<lapwing_record::Recording, CapsuleError> {
    let mut how = subject.options.recording.clone();
    how.look_ahead = u64::MAX;
    lapwing_record::open(subject.trace, how).map_err(CapsuleError::Open)
}

/// The specification, and beside it the files that it uses.
fn write_specification(spec: &Spec, folder: &Path) -> Result<(), CapsuleError> {
    let home = Path::new(spec.name()).parent().unwrap_or(Path::new(""));
    for (number, (name, text)) in spec.texts().enumerate() {
        let path = Path::new(name);
        let place = match number {
            0 => Path::new(SPEC),
            _ => path.strip_prefix(home).unwrap_or(path),
        };
        let is_inside = place.components().all(|c| matches!(c, std::path::Component::Normal(_)));
        if is_inside && place.extension().is_some_and(|e| e == "rv") {
            if let Some(parent) = folder.join(place).parent() {
                fs::create_dir_all(parent).map_err(|e| CapsuleError::Io(parent.to_owned(), e))?;
            }
            put(folder, &place.to_string_lossy(), text)?;
        }
    }
    Ok(())
}

fn put(folder: &Path, name: &str, text: &str) -> Result<(), CapsuleError> {
    let path = folder.join(name);
    fs::write(&path, text).map_err(|e| CapsuleError::Io(path, e))
}

/// The verdict as data: the violation as reports have it, and what the clip is.
fn verdict(subject: &Subject<'_>, window: &Window, replays: bool) -> Value {
    let event = Event::Violation { property: subject.property, violation: subject.violation };
    let mut object: Value = serde_json::from_str(&line(&subject.report.trace, event)).unwrap_or(Value::Null);
    if let Some(object) = object.as_object_mut() {
        object.remove("type");
        object.insert("verdict".to_owned(), json!(subject.property.verdict.word()));
        let time = match subject.options.recording.time {
            TimeSource::Log => "log",
            TimeSource::Header => "header",
        };
        let clip = json!({
            "from_ns": window.from.map(|t| t.0), "to_ns": window.to.0, "carries_latest": window.carries,
            "time": time, "reorder_ns": subject.options.recording.reorder.nanos(), "replays": replays,
        });
        object.insert("clip".to_owned(), clip);
    }
    object
}

impl fmt::Display for CapsuleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CapsuleError::Io(path, error) => write!(f, "{}: {error}", path.display()),
            CapsuleError::Open(error) => error.fmt(f),
            CapsuleError::Read(error) => error.fmt(f),
            CapsuleError::Other(what) => f.write_str(what),
        }
    }
}

impl std::error::Error for CapsuleError {}
