//! From the words on a command line to the recordings that they name.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::OpenError;

/// Folders may not be nested deeper than this below the one that is named.
const MAX_DEPTH: usize = 16;
/// How many recordings one word may name.
const MAX_FOUND: usize = 1 << 20;
/// The endings of recordings in a folder: what else lies there is not looked at.
const ENDINGS: &[&str] = &["mcap", "db3", "bag", "csv", "ndjson", "jsonl", "zstd"];

/// The recordings that words name: files, rosbag2 folders, folders of recordings (searched to their depths, for names with
/// the usual endings), globs such as `runs/**/*.mcap`, and `-`.
///
/// Words keep their order; what one word names is sorted. A word that names nothing is an error.
pub fn expand(words: &[String]) -> Result<Vec<PathBuf>, OpenError> {
    let mut found = Vec::new();
    for word in words {
        let before = found.len();
        one(word, &mut found)?;
        if found.len() == before {
            return Err(OpenError::Unrecognised { path: word.into(), seen: "it names no recording".to_owned() });
        }
    }
    Ok(found)
}

fn one(word: &str, found: &mut Vec<PathBuf>) -> Result<(), OpenError> {
    let path = Path::new(word);
    // What exists is taken by its name, even where that has brackets in it.
    if word == "-" || path.exists() || !word.contains(['*', '?', '[']) {
        return below(path, 0, true, found);
    }
    let wrong = |what: String| OpenError::Unsupported { path: path.to_owned(), what };
    let matches = glob::glob(word).map_err(|e| wrong(format!("it is no pattern: {e}")))?;
    let error = |e: glob::GlobError| OpenError::Io { path: e.path().to_owned(), error: e.into() };
    let mut paths = matches.collect::<Result<Vec<_>, _>>().map_err(error)?;
    paths.sort();
    paths.iter().try_for_each(|path| below(path, 0, true, found))
}

/// A recording, or all recordings in a folder.
fn below(path: &Path, depth: usize, named: bool, found: &mut Vec<PathBuf>) -> Result<(), OpenError> {
    let is_recording = path.is_file() && (named || has_ending(path)) || path.join("metadata.yaml").is_file();
    if is_recording || named && !path.is_dir() {
        if found.len() >= MAX_FOUND {
            let what = format!("more than {MAX_FOUND} recordings are named: name fewer at a time");
            return Err(OpenError::Unsupported { path: path.to_owned(), what });
        }
        found.push(path.to_owned());
        return Ok(());
    }
    if !path.is_dir() || depth > MAX_DEPTH {
        return Ok(());
    }
    let error = |error| OpenError::Io { path: path.to_owned(), error };
    let mut inside = Vec::new();
    for entry in fs::read_dir(path).map_err(error)? {
        inside.push(entry.map_err(error)?.path());
    }
    inside.sort();
    inside.iter().try_for_each(|path| below(path, depth + 1, false, found))
}

fn has_ending(path: &Path) -> bool {
    path.extension().and_then(|e| e.to_str()).is_some_and(|e| ENDINGS.contains(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_globs_and_files_are_expanded_in_order() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        fs::create_dir_all(at("runs/bag")).unwrap();
        for name in
            ["runs/b.mcap", "runs/a.csv", "runs/notes.txt", "runs/bag/metadata.yaml", "runs/bag/bag_0.db3", "x[1].bag"]
        {
            fs::write(at(name), "").unwrap();
        }
        let words = |names: &[&str]| names.iter().map(|n| at(n).to_string_lossy().into_owned()).collect::<Vec<_>>();
        assert_eq!(
            expand(&words(&["x[1].bag", "runs"])).unwrap(),
            [at("x[1].bag"), at("runs/a.csv"), at("runs/b.mcap"), at("runs/bag")]
        );
        assert_eq!(expand(&words(&["runs/*.[cm]*"])).unwrap(), [at("runs/a.csv"), at("runs/b.mcap")]);
        assert_eq!(expand(&["-".to_owned()]).unwrap(), [PathBuf::from("-")]);
        assert!(expand(&words(&["runs/*.bag"])).is_err());
    }
}
