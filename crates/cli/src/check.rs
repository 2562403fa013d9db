//! `lapwing check`: recordings against specifications.

use std::path::{Path, PathBuf};

use indicatif::MultiProgress;
use lapwing::{Options, Report, Session, Spec};
use lapwing_diag::Style;
use lapwing_page::Entry;
use lapwing_react::{Format, Standing, Tally, end, render};

use crate::args::Check;
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::onlooker::{Onlooker, Told};
use crate::page::Page;
use crate::sink::{Chunk, Sink};
use crate::words::{Words, recordings, specs};
use crate::{capsules, interrupt, jobs, progress};

/// Runs the command.
pub fn run(check: &Check) -> Result<Exit, Complaint> {
    let words = Words::sort(&check.words)?;
    let (stdout, stderr) = styles(check.color);
    let specs = specs(&words.specs, &check.reading.msgs, stderr)?;
    let mut traces = recordings(&words.traces)?;
    if let Some(shard) = check.shard {
        let mut number = 0..;
        traces.retain(|_| number.next().is_some_and(|n| shard.has(n)));
    }
    let plan = Plan {
        specs: &specs,
        traces: &traces,
        options: Options {
            recording: lapwing_record::Options { stopped: interrupt::is_stopped, ..check.reading.options() },
            until_first_violation: check.until_first_violation,
            margins: check.margins || check.report.is_some(),
            history: check.report.as_ref().map(|_| lapwing_page::points(traces.len())),
            open_limit: check.limits.open_limit,
        },
        capsules: check.capsules.as_deref(),
        format: check.format.into(),
        quiet: check.quiet,
        styles: (stdout, stderr),
    };
    if !check.quiet {
        specs.iter().for_each(|spec| say(&spec.findings().render(stderr)));
    }
    let page = check.report.as_deref().map(Page::create).transpose()?;
    interrupt::listen();
    Ok(plan.carry_out(jobs::threads(check.jobs), page))
}

/// Said before a wait whose reason nobody would guess.
const WAITING: &str = "\
warning: `for each … in topics` stands for all topics, and lines of NDJSON tell theirs only as they come: standard input is read
         to its end first, and judged then
  = help: to have robots judged as their messages come, name them: `for each r in (robot1, robot2): …`
";

/// What is to be checked, and how it is to be told.
struct Plan<'p> {
    specs: &'p [Spec],
    traces: &'p [PathBuf],
    options: Options,
    /// Where capsules go.
    capsules: Option<&'p Path>,
    format: Format,
    quiet: bool,
    /// Of stdout and of stderr.
    styles: (Style, Style),
}

impl Plan<'_> {
    fn carry_out(&self, threads: usize, page: Option<Page>) -> Exit {
        let bars = progress::bars(!self.quiet);
        let sink = Sink::new(self.format.between(), bars.clone());
        sink.frame(self.format.begin());
        let results = jobs::spread(self.traces.len(), threads, |number| {
            let one = self.one(number, &sink, &bars);
            sink.done(number);
            one
        });
        let mut tally = Tally::default();
        results.iter().for_each(|(_, (one, _))| tally.join(one));
        let is_silent = self.format == Format::Text && self.quiet && tally.standing() == Standing::Good;
        if !is_silent {
            sink.frame(&end(&tally, self.format, self.styles.0));
        }
        let unread = self.traces.len() - results.len();
        if unread > 0 {
            say(&format!("{unread} of {} recordings were not checked\n", self.traces.len()));
        }
        let is_written = page.is_none_or(|page| {
            let entries: Vec<Entry> = results.into_iter().filter_map(|(_, (_, entry))| entry).collect();
            let (what, is_written) = page.write(&entries);
            if !self.quiet || !is_written {
                say(&what);
            }
            is_written
        });
        Exit::of(tally.standing(), unread == 0 && is_written && !interrupt::was_heard())
    }

    /// Checks one recording, and says what is to be said of it. Its part of the page comes back, where there is to be one.
    fn one(&self, number: usize, sink: &Sink, bars: &MultiProgress) -> (Tally, Option<Entry>) {
        let trace = &self.traces[number];
        let bar = progress::bar(bars, trace);
        if !self.quiet && lapwing::waits_for_end(self.specs, trace) {
            sink.tell(number, Chunk::Note(WAITING.to_owned()));
        }
        let name = trace.to_string_lossy();
        let mut onlooker = Onlooker { told: Told::by(self.format, &name, number, sink), bar: Some(&bar) };
        let (report, histories) = match Session::open(self.specs, trace, &self.options) {
            Ok(session) => {
                if !self.quiet {
                    session.findings(self.styles.1).into_iter().for_each(|text| sink.tell(number, Chunk::Note(text)));
                }
                session.run_noting(&mut onlooker)
            }
            Err(why) => (lapwing::unopened(self.specs, trace, &why, &mut onlooker), Vec::new()),
        };
        bar.finish_and_clear();
        if !self.is_left_out(&report) {
            sink.tell(number, Chunk::Part(render(&report, self.format, self.styles.0)));
        }
        if let Some(folder) = self.capsules {
            let of = (number, self.traces.len());
            let told = capsules::write(folder, of, self.specs, trace, &self.options, &report);
            if !told.notes.is_empty() && (told.has_failed || !self.quiet) {
                sink.tell(number, Chunk::Note(told.notes));
            }
        }
        let mut tally = Tally::default();
        tally.add(&report);
        (tally, self.options.history.map(|_| lapwing_page::entry(&report, &histories)))
    }

    /// Whether nothing is said of a recording: all is well with it, and only what is not is wanted.
    fn is_left_out(&self, report: &Report) -> bool {
        self.quiet && self.format == Format::Text && report.standing() == Standing::Good
    }
}
