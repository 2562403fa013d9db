//! `lapwing replay`: a violation capsule, to the same verdict.

use std::io::{self, Write};

use lapwing::capsule::{self, Replayed};
use lapwing_react::explanation;

use crate::args::Replay;
use crate::complain::{Complaint, styles};
use crate::exit::Exit;

/// Runs the command: 1 where the clip gives the violation of the capsule again, 3 where it does not.
pub fn run(replay: &Replay) -> Result<Exit, Complaint> {
    let folder = &replay.capsule;
    if !folder.is_dir() {
        let what = format!("{}: there is no such folder", folder.display());
        return Err(Complaint::new(what).help("`lapwing check SPEC RECORDING --capsules DIR` writes capsules into DIR"));
    }
    let replayed = capsule::replay(folder).map_err(|e| Complaint::new(e.to_string()))?;
    let (style, _) = styles(replay.color);
    let mut text = String::new();
    if let Some(property) = replayed.property.as_ref().filter(|p| p.has_failed()) {
        text += &format!("{}\n", explanation(&replayed.report, property, style));
    }
    text += &format!("{}\n", conclusion(&replayed));
    // Where nobody reads it there is nothing to be done.
    drop(io::stdout().write_all(text.as_bytes()));
    Ok(if replayed.is_same { Exit::Failed } else { Exit::Open })
}

fn conclusion(replayed: &Replayed) -> String {
    let Replayed { name, began, failed, property, .. } = replayed;
    let was = format!("{name} violated, begun at {began}, failed at {failed}");
    if replayed.is_same {
        return format!("the same verdict as in the recording: {was}");
    }
    let now = match property {
        None => "it has no such property now".to_owned(),
        Some(property) => match (property.violations.first(), &property.cause) {
            (Some(first), _) => format!("now it begins at {} and fails at {}", first.began, first.failed),
            (None, Some(cause)) => format!("now it is {}: {cause}", property.verdict),
            (None, None) => format!("now it is {}", property.verdict),
        },
    };
    let known = if replayed.was_same { "" } else { "; this was known when the capsule was written, see its README.md" };
    format!("another verdict than in the recording ({was}): {now}{known}")
}
