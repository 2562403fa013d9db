//! The page of a capsule: what failed, and how to see it again.

use std::path::Path;

use lapwing_diag::Style;
use lapwing_react::{Property, explanation};
use lapwing_stream::Time;

use super::Subject;
use super::window::Window;

/// The text of `README.md`.
pub(super) fn readme(subject: &Subject<'_>, window: &Window, replays: bool, folder: &Path) -> String {
    let Subject { report, property, violation, .. } = subject;
    let alone = Property { violations: vec![(*violation).clone()], ..(*property).clone() };
    let explained = explanation(report, &alone, Style::Plain);
    let (name, trace) = (&property.name, &report.trace);
    let mut out = format!(
        "# {name} was violated\n\n{}\n\n```text\n{}```\n\n## Replay\n\n```console\n$ lapwing replay {}\n```\n\n",
        sentence(violation.began, violation.failed, trace),
        explained,
        folder.display()
    );
    out += &match replays {
        true => "This was tried when the capsule was written: it gives the same violation, with the same beginning and failure.\n".to_owned(),
        false => format!(
            "**The clip does not give the same violation.** It was tried with all of the recording up to two seconds after the failure. \
             What the property needs is outside of the messages that the specification reads, or its definitions are: check `{trace}` itself.\n"
        ),
    };
    out +=
        &format!("\n## What is here\n\n- `clip.mcap`: {}. Foxglove and other viewers of MCAP open it.\n", clip(window));
    if matches!(subject.options.recording.time, lapwing_record::TimeSource::Header) {
        out += "- Times are those of the messages' headers; `lapwing replay` knows that.\n";
    }
    out += "- `clip.csv` or `clip.ndjson`, where the recording was one: the same as text, which is what replays.\n\
            - `spec.rv`: the specification, with the files that it uses.\n\
            - `verdict.json`: the violation as data, as `lapwing check --format ndjson` tells it.\n";
    out
}

fn sentence(began: Time, failed: Time, trace: &str) -> String {
    match began == failed {
        true => format!("It failed at {failed} in `{trace}`."),
        false => format!("What failed began at {began}, and failed at {failed}, in `{trace}`."),
    }
}

fn clip(window: &Window) -> String {
    let part = match window.from {
        Some(from) => format!("what the specification reads, from {from} to {}", window.to),
        None => format!(
            "what the specification reads, from the beginning to {}, because less does not give the same verdict",
            window.to
        ),
    };
    match window.carries {
        true => format!(
            "{part}; it begins with the latest message of each topic before that, stamped with the clip's beginning, because without \
             them the verdict is another"
        ),
        false => part,
    }
}
