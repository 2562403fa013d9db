//! A capsule, checked again.

use std::fs;
use std::path::{Path, PathBuf};

use lapwing_react::{Property, Report, Violation};
use lapwing_record::TimeSource;
use lapwing_stream::{Duration, Time};
use serde_json::Value;

use super::{CLIP, CapsuleError, SPEC, VERDICT};
use crate::session::{Options, Session};
use crate::spec::Spec;

/// What checking a capsule again came to.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// What was said of the clip.
    pub report: Report,
    /// The property that the capsule is of, as it came out now, where it is there.
    pub property: Option<Property>,
    /// What failed, and when, as the capsule has it.
    pub name: String,
    /// When what failed began.
    pub began: Time,
    /// When it failed.
    pub failed: Time,
    /// Whether the clip gives the same violation: the same property, beginning and failure.
    pub is_same: bool,
    /// Whether it gave the same when it was written.
    pub was_same: bool,
}

/// Checks the clip of a capsule with its specification, and compares.
pub fn replay(folder: &Path) -> Result<Replayed, CapsuleError> {
    let verdict = verdict(folder)?;
    let wrong =
        |what: &str| CapsuleError::Other(format!("{}: {what}: it is no capsule's", folder.join(VERDICT).display()));
    let name = verdict["name"].as_str().ok_or_else(|| wrong("it names no property"))?.to_owned();
    let time = |key: &str| verdict[key].as_i64().map(Time);
    let began = time("began_ns").ok_or_else(|| wrong("`began_ns` is missing"))?;
    let failed = time("failed_ns").ok_or_else(|| wrong("`failed_ns` is missing"))?;
    let spec = Spec::load(&folder.join(SPEC)).map_err(|e| CapsuleError::Other(e.to_string()))?;
    let specs = [spec];
    let session = Session::open(&specs, &clip(folder), &options(&verdict)).map_err(CapsuleError::Open)?;
    let report = session.run(&mut ());
    let property = report.properties.iter().find(|p| p.name == name).cloned();
    let is_this = |v: &Violation| v.began == began && v.failed == failed;
    let is_same = property.as_ref().is_some_and(|p| p.violations.iter().any(is_this));
    let was_same = verdict["clip"]["replays"].as_bool().unwrap_or(true);
    Ok(Replayed { report, property, name, began, failed, is_same, was_same })
}

fn verdict(folder: &Path) -> Result<Value, CapsuleError> {
    let path = folder.join(VERDICT);
    let text = fs::read_to_string(&path).map_err(|e| CapsuleError::Io(path.clone(), e))?;
    serde_json::from_str(&text).map_err(|e| CapsuleError::Other(format!("{}: {e}", path.display())))
}

/// What replays: the text where there is one, else the messages.
fn clip(folder: &Path) -> PathBuf {
    let texts = ["clip.csv", "clip.ndjson"].map(|name| folder.join(name));
    texts.into_iter().find(|path| path.is_file()).unwrap_or_else(|| folder.join(CLIP))
}

/// Its time is that by which the recording was read.
fn options(verdict: &Value) -> Options {
    let mut options = Options::default();
    if verdict["clip"]["time"] == "header" {
        options.recording.time = TimeSource::Header;
    }
    if let Some(reorder) = verdict["clip"]["reorder_ns"].as_i64() {
        options.recording.reorder = Duration::from_nanos(reorder);
    }
    options
}
