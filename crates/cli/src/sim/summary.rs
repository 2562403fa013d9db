//! What became of each property over many runs.

use lapwing_react::{Report, Standing, Tally};
use lapwing_stream::Verdict;

/// So many seeds are named of those with which a property failed.
const NAMED: usize = 8;

/// What is kept of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its seed.
    pub seed: u64,
    /// How long it was, in simulated seconds.
    pub seconds: f64,
    /// Its verdicts, counted.
    pub tally: Tally,
    /// The properties with their verdicts, and whether they were vacuous.
    properties: Vec<(String, Verdict, bool)>,
}

impl Run {
    /// What is kept of the run that was reported on.
    pub fn of(seed: u64, report: &Report) -> Run {
        let mut tally = Tally::default();
        tally.add(report);
        let several = report.specs.len() > 1;
        let name =
            |p: &lapwing_react::Property| if several { format!("{}: {}", p.file, p.name) } else { p.name.clone() };
        Run {
            seed,
            seconds: report.span.map_or(0.0, |(start, end)| end.since(start).seconds()),
            tally,
            properties: report.properties.iter().map(|p| (name(p), p.verdict, p.vacuous)).collect(),
        }
    }

    /// Whether a property failed.
    pub fn failed(&self) -> bool {
        self.tally.standing() == Standing::Failed
    }
}

/// What became of each property.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// All verdicts of all runs, counted.
    pub tally: Tally,
    /// In the order in which they were first met.
    lines: Vec<Line>,
}

#[derive(Clone, Debug, Default)]
struct Line {
    name: String,
    /// As [`Tally::VERDICTS`] lists them.
    verdicts: [u64; 5],
    vacuous: u64,
    /// The seeds with which it did not come out well.
    bad: Vec<u64>,
}

impl Summary {
    /// Of all runs.
    pub fn of(runs: &[Run]) -> Summary {
        let mut summary = Summary::default();
        for run in runs {
            summary.tally.join(&run.tally);
            for (name, verdict, vacuous) in &run.properties {
                let line = summary.line(name);
                line.vacuous += u64::from(*vacuous);
                if let Some(kind) = Tally::VERDICTS.iter().position(|v| v == verdict) {
                    line.verdicts[kind] += 1;
                }
                if !verdict.is_success() {
                    line.bad.push(run.seed);
                }
            }
        }
        summary
    }

    fn line(&mut self, name: &str) -> &mut Line {
        let at = self.lines.iter().position(|l| l.name == name).unwrap_or_else(|| {
            self.lines.push(Line { name: name.to_owned(), ..Line::default() });
            self.lines.len() - 1
        });
        &mut self.lines[at]
    }

    /// A table, the seeds of what failed, and how to see one of them again.
    pub fn text(&self, again: &dyn Fn(u64) -> String) -> String {
        let width = self.lines.iter().map(|l| l.name.chars().count()).max().unwrap_or_default().max(8);
        let heads: Vec<String> = Tally::VERDICTS.iter().map(|v| format!("{:>13}", v.word())).collect();
        let mut text = format!("  {:<width$}{}{:>13}\n", "property", heads.concat(), "vacuous");
        for line in &self.lines {
            let counts: Vec<String> = line.verdicts.iter().map(|n| format!("{n:>13}")).collect();
            text += &format!("  {:<width$}{}{:>13}\n", line.name, counts.concat(), line.vacuous);
        }
        let bad: Vec<&Line> = self.lines.iter().filter(|l| !l.bad.is_empty()).collect();
        for line in &bad {
            text += &format!("\n{} did not come out well with the seeds {}", line.name, seeds(&line.bad));
        }
        if let Some(seed) = bad.first().and_then(|l| l.bad.first()) {
            text += &format!("\n\nTo see one of them:\n  {}\n", again(*seed));
        }
        text
    }
}

fn seeds(all: &[u64]) -> String {
    let named: Vec<String> = all.iter().take(NAMED).map(u64::to_string).collect();
    let more = if all.len() > NAMED { format!(" and {} more", all.len() - NAMED) } else { String::new() };
    named.join(", ") + &more
}
