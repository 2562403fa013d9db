//! Which of the words on a command line are specifications, which recordings, and what to say of the others.

use std::path::{Path, PathBuf};

use lapwing::{Spec, SpecError};
use lapwing_diag::Style;
use lapwing_record::OpenError;

use crate::complain::Complaint;

/// A file larger than this is not taken for a specification, in bytes.
const LARGEST_SPEC: u64 = 1 << 16;

/// The words of `check`, told apart.
#[derive(Debug, PartialEq)]
pub struct Words {
    /// Those that end in `.rv`.
    pub specs: Vec<PathBuf>,
    /// The others.
    pub traces: Vec<String>,
}

impl Words {
    /// Tells words apart; both kinds must be there.
    pub fn sort(words: &[String]) -> Result<Words, Complaint> {
        let (specs, traces): (Vec<String>, Vec<String>) = words.iter().cloned().partition(|w| is_spec(w));
        if specs.is_empty() {
            let complaint = Complaint::new("no specification is given: one of the arguments must end in .rv");
            return Err(complaint.help("`lapwing new RECORDING -o robot.rv` writes one to start from"));
        }
        if traces.is_empty() {
            let complaint = Complaint::new("no recording is given");
            return Err(complaint
                .help("add the path of an MCAP file, a rosbag2 folder, a ROS 1 bag, a CSV or NDJSON file, or - for standard input")
                .help("without a recording, `lapwing explain` checks a specification and says what it means"));
        }
        if traces.iter().filter(|t| *t == "-").count() > 1 {
            return Err(Complaint::new("standard input (-) can be read only once"));
        }
        Ok(Words { specs: specs.into_iter().map(PathBuf::from).collect(), traces })
    }
}

/// Whether a word names a specification.
pub fn is_spec(word: &str) -> bool {
    word.ends_with(".rv")
}

/// Reads all specifications, with message definitions from those folders. What is wrong with any of them is said of all.
pub fn specs(paths: &[PathBuf], msgs: &[PathBuf], style: Style) -> Result<Vec<Spec>, Complaint> {
    let (mut specs, mut faults) = (Vec::new(), String::new());
    for path in paths {
        if !path.exists() {
            return Err(missing(path));
        }
        match Spec::load_with(path, msgs) {
            Ok(spec) => specs.push(spec),
            Err(SpecError::Wrong(findings)) => faults += &findings.render(style),
            Err(unreadable) => return Err(Complaint::new(unreadable.to_string())),
        }
    }
    if faults.is_empty() { Ok(specs) } else { Err(Complaint::rendered(faults)) }
}

/// The recordings that words name.
pub fn recordings(words: &[String]) -> Result<Vec<PathBuf>, Complaint> {
    for word in words.iter().filter(|w| *w != "-" && !w.contains(['*', '?', '['])) {
        let path = Path::new(word);
        if !path.exists() {
            return Err(missing(path));
        }
        if looks_like_spec(path) {
            let complaint =
                Complaint::new(format!("{word}: this is a specification, but its name does not end in .rv"));
            return Err(complaint.help("rename it: what does not end in .rv is taken for a recording"));
        }
    }
    lapwing_record::expand(words).map_err(|error| match error {
        OpenError::Unrecognised { path, .. } => Complaint::new(format!("{}: it names no recording", path.display()))
            .help("in a folder, files that end in .mcap, .db3, .bag, .csv, .ndjson or .jsonl are looked for, and rosbag2 folders"),
        other => Complaint::new(other.to_string()),
    })
}

/// The one recording that a word names.
pub fn recording(word: &str) -> Result<PathBuf, Complaint> {
    let found = recordings(&[word.to_owned()])?;
    match found.as_slice() {
        [one] => Ok(one.clone()),
        several => Err(Complaint::new(format!("{word}: {} recordings, where one is wanted", several.len()))),
    }
}

/// What to say of a path that is not there.
fn missing(path: &Path) -> Complaint {
    let complaint = Complaint::new(format!("{}: there is no such file", path.display()));
    match similar(path) {
        Some(other) => complaint.help(format!("did you mean `{}`?", other.display())),
        None => complaint,
    }
}

/// Whether a small file reads as a specification with something in it.
fn looks_like_spec(path: &Path) -> bool {
    let is_small = std::fs::metadata(path).is_ok_and(|about| about.is_file() && about.len() < LARGEST_SPEC);
    let text = if is_small { std::fs::read_to_string(path).ok() } else { None };
    text.is_some_and(|text| {
        let parsed = lapwing_syntax::parse(lapwing_syntax::FileId(0), &text);
        !parsed.file.items.is_empty() && !lapwing_diag::has_errors(&parsed.diagnostics)
    })
}

/// The name beside a path that is most like it.
fn similar(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let names = entries.filter_map(|e| e.ok()?.file_name().into_string().ok());
    let close = names.map(|name| (strsim::damerau_levenshtein(wanted, &name), name)).filter(|(far, name)| {
        let stem = |n: &str| n.rsplit_once('.').map_or(n.to_owned(), |(stem, _)| stem.to_owned());
        *far <= 1 + wanted.chars().count() / 4 || stem(wanted) == stem(name)
    });
    let (_, name) = close.min()?;
    Some(folder.map_or_else(|| PathBuf::from(&name), |f| f.join(&name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(list: &[&str]) -> Result<Words, Complaint> {
        Words::sort(&list.iter().map(|w| w.to_string()).collect::<Vec<_>>())
    }

    #[test]
    fn words_are_told_apart_in_any_order() {
        let sorted = words(&["run.mcap", "a.rv", "-", "b.rv"]).unwrap();
        assert_eq!(sorted.specs, [PathBuf::from("a.rv"), PathBuf::from("b.rv")]);
        assert_eq!(sorted.traces, ["run.mcap", "-"]);
        assert!(words(&["run.mcap"]).is_err() && words(&["a.rv"]).is_err() && words(&["a.rv", "-", "-"]).is_err());
    }
}
