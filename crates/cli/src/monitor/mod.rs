//! `lapwing monitor`: specifications over a robot that runs.

pub mod args;
mod audience;
#[cfg(feature = "foxglove")]
mod foxglove;
mod lines;
mod onlooker;
mod screen;
mod serve;
mod signals;
mod widgets;

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use lapwing::live::{Ended, Latency, LiveOptions, Outcome, Reach, Station, Touch, touches};
use lapwing::{Options, Spec};
use lapwing_diag::Style;
use lapwing_react::{Format, Report, Standing, Tally, end};
use lapwing_ros::connector::Connector;

use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::page::Page;
use crate::{capsules, interrupt, words};
use args::{Look, Monitor};
use audience::Audience;
use onlooker::{Looker, Texts};
use serve::Server;
use signals::Signals;

/// Runs the command.
pub fn run(monitor: &Monitor) -> Result<Exit, Complaint> {
    let (stdout, stderr) = styles(monitor.color);
    let paths = paths(monitor)?;
    let specs = words::specs(&paths, &monitor.reading.msgs, stderr)?;
    if !monitor.quiet {
        specs.iter().for_each(|spec| say(&spec.findings().render(stderr)));
    }
    say(&touched(&touches(&specs), monitor.dry_run));
    let page = monitor.report.as_deref().map(Page::create).transpose()?;
    let audiences = audiences(monitor)?;
    let station = Station::new(join(monitor)?, options(monitor));
    let signals = Signals::listen().map_err(|e| Complaint::new(format!("signals cannot be heard: {e}")))?;
    interrupt::listen();
    let watch = Watch { monitor, format: monitor.format.into(), styles: (stdout, stderr), paths, page, signals };
    watch.carry_out(station, specs, audiences)
}

/// To whom the command line shows what happens, besides the terminal.
fn audiences(monitor: &Monitor) -> Result<Vec<Box<dyn Audience>>, Complaint> {
    let mut audiences: Vec<Box<dyn Audience>> = Vec::new();
    if let Some(at) = monitor.serve.as_deref() {
        let server = Server::start(at)?;
        say(&format!("showing how things stand at http://{}/\n", server.address()));
        audiences.push(Box::new(server));
    }
    #[cfg(feature = "foxglove")]
    if let Some(at) = monitor.foxglove.as_deref() {
        let foxglove = foxglove::Foxglove::start(at)?;
        say(&format!("showing what happens to Foxglove at ws://{}/\n", foxglove.address()));
        audiences.push(Box::new(foxglove));
    }
    Ok(audiences)
}

/// The graph that the command line names.
fn join(monitor: &Monitor) -> Result<Box<dyn Connector>, Complaint> {
    let joined = monitor.graph.join_with(&monitor.node, &monitor.reading.msgs)?;
    joined.ok_or_else(|| {
        let complaint = Complaint::new("no robot is named");
        complaint
            .help("add --ros2, or --ros1 for a robot with a ROS 1 master")
            .help("recordings are checked by `lapwing check`")
    })
}

/// The files of the specifications: nothing else can be given.
fn paths(monitor: &Monitor) -> Result<Vec<PathBuf>, Complaint> {
    if let Some(other) = monitor.specs.iter().find(|word| !words::is_spec(word)) {
        let complaint = Complaint::new(format!("{other}: this is no specification: its name does not end in .rv"));
        return Err(complaint.help("recordings are checked by `lapwing check`"));
    }
    Ok(monitor.specs.iter().map(PathBuf::from).collect())
}

fn options(monitor: &Monitor) -> LiveOptions {
    let draws = monitor.report.is_some();
    LiveOptions {
        checking: Options {
            recording: monitor.reading.options(),
            until_first_violation: monitor.until_first_violation,
            margins: monitor.margins || draws,
            history: draws.then(|| lapwing_page::points(1)),
            open_limit: monitor.limits.open_limit,
        },
        clock: monitor.clock.into(),
        record: monitor.record.clone(),
        reach: Reach { dry: monitor.dry_run, allowed: (!monitor.allow.is_empty()).then(|| monitor.allow.clone()) },
        herald: (!monitor.no_diagnostics && !monitor.dry_run).then(|| monitor.node.clone()),
    }
}

/// What specifications may do to the robot, in words.
fn touched(touches: &[Touch], is_dry: bool) -> String {
    if touches.is_empty() {
        return "the robot is only watched: no specification reacts to anything\n".to_owned();
    }
    let may = if is_dry { "would" } else { "may" };
    let line = |touch: &Touch| {
        let ty = if touch.type_name.is_empty() { String::new() } else { format!(" ({})", touch.type_name) };
        format!("  {may} {} {}{ty} by {}\n", touch.how.verb(), touch.name, touch.property)
    };
    format!("what is done to the robot:\n{}", touches.iter().map(line).collect::<String>())
}

/// A command that is being carried out.
struct Watch<'m> {
    monitor: &'m Monitor,
    format: Format,
    /// Of stdout and of stderr.
    styles: (Style, Style),
    paths: Vec<PathBuf>,
    page: Option<Page>,
    signals: Signals,
}

impl Watch<'_> {
    /// What the specifications are read from.
    fn texts(&self) -> Texts {
        Texts { paths: self.paths.clone(), msgs: self.monitor.reading.msgs.clone() }
    }

    /// Runs until it is to end; each time the specifications are read again there is a report of its own.
    fn carry_out(
        self,
        mut station: Station,
        mut specs: Vec<Spec>,
        audiences: Vec<Box<dyn Audience>>,
    ) -> Result<Exit, Complaint> {
        let looks = self.looks();
        let mut looker =
            Looker::new(self.format, self.monitor.quiet, self.styles, looks, self.signals.clone(), self.texts());
        looker.show_to(audiences);
        looker.out(self.format.begin());
        let mut tally = Tally { is_live: true, ..Tally::default() };
        let (mut number, mut is_complete) = (1, true);
        let mut entries = Vec::new();
        let mut before: Option<Vec<Spec>> = None;
        let ended = loop {
            let record = self.monitor.record.as_deref().map(|path| numbered(path, number));
            station.record_to(record.clone());
            let mut outcome = match station.run(&specs, &mut looker) {
                Ok(outcome) => outcome,
                Err(why) => match before.take() {
                    // What was read again cannot be run: what ran before goes on.
                    Some(again) => {
                        say(&format!("error: {why}\n  help: what ran before goes on\n"));
                        specs = again;
                        continue;
                    }
                    None => return Err(Complaint::new(why).help("nothing was watched")),
                },
            };
            looker.close_screen();
            if number > 1 {
                looker.out(self.format.between());
            }
            if !self.monitor.dry_run {
                carried_out(&mut outcome.report);
            }
            looker.report(&outcome.report);
            tally.add(&outcome.report);
            is_complete &= outcome.unrecorded.is_none();
            is_complete &= self.capsules(&specs, record.as_deref(), &outcome);
            entries.extend(self.page.as_ref().map(|_| lapwing_page::entry(&outcome.report, &outcome.histories)));
            match (outcome.ended, outcome.next.take()) {
                (Ended::Reloaded, Some(again)) => before = Some(std::mem::replace(&mut specs, again)),
                (ended, _) => break ended,
            }
            number += 1;
        };
        let is_silent = self.format == Format::Text && self.monitor.quiet && tally.standing() == Standing::Good;
        if !is_silent {
            looker.out(&end(&tally, self.format, self.styles.0));
        }
        if !self.monitor.quiet {
            say(&figures(&station));
        }
        if let Some(page) = self.page {
            let (what, is_written) = page.write(&entries);
            say(&what);
            is_complete &= is_written;
        }
        // Whoever says `stop` has seen a violation, also where another specification is what stands at the end.
        Ok(if ended == Ended::ByReaction { Exit::Failed } else { Exit::of(tally.standing(), is_complete) })
    }

    /// Whether a screen is drawn.
    fn looks(&self) -> bool {
        match self.monitor.view {
            Look::Screen => true,
            Look::Lines => false,
            Look::Auto => self.format == Format::Text && !self.monitor.quiet && std::io::stdout().is_terminal(),
        }
    }

    /// Writes the capsules of a run that was recorded. Whether all could be.
    fn capsules(&self, specs: &[Spec], record: Option<&Path>, outcome: &Outcome) -> bool {
        let (Some(folder), Some(trace)) = (self.monitor.capsules.as_deref(), record) else { return true };
        let options = options(self.monitor).checking;
        let told = capsules::write(folder, (0, 1), specs, trace, &options, &outcome.report);
        if told.has_failed || !self.monitor.quiet {
            say(&told.notes);
        }
        !told.has_failed
    }
}

/// The file of the `number`-th run: `run.mcap`, `run.2.mcap`.
fn numbered(path: &Path, number: usize) -> PathBuf {
    match number {
        1 => path.to_owned(),
        _ => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let end = path.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
            path.with_file_name(format!("{stem}.{number}{end}"))
        }
    }
}

/// What a recording would have led to on a live robot was done on this one.
fn carried_out(report: &mut Report) {
    for reaction in report.properties.iter_mut().flat_map(|property| &mut property.reactions) {
        if let Some(done) = reaction.strip_prefix("would ") {
            *reaction = done.to_owned();
        }
    }
}

/// What the run has measured of itself, in words.
fn figures(station: &Station) -> String {
    let figures = station.figures();
    let of = |what: &str, latency: &Latency| {
        let ms = |share: f64| latency.quantile(share).map(|d| format!("{:.3} ms", d.as_secs_f64() * 1e3));
        let (p50, p99) = (ms(0.5)?, ms(0.99)?);
        Some(format!("{what}: p50 {p50}, p99 {p99}, at most {:.3} ms\n", latency.most().as_secs_f64() * 1e3))
    };
    let messages = if figures.messages == 1 { "message" } else { "messages" };
    let mut text = format!("{} {messages} came, {} lost\n", figures.messages, figures.lost);
    text.extend(of("from arrival to verdict", &figures.judged));
    text.extend(of("from arrival to reaction", &figures.reacted));
    text.extend(of("delay of guarded messages", &figures.guarded));
    text
}

#[cfg(test)]
mod tests {
    use lapwing::live::How;

    use super::*;

    #[test]
    fn each_run_is_recorded_into_a_file_of_its_own() {
        assert_eq!(numbered(Path::new("a/run.mcap"), 1), Path::new("a/run.mcap"));
        assert_eq!(numbered(Path::new("a/run.mcap"), 2), Path::new("a/run.2.mcap"));
        assert_eq!(numbered(Path::new("run"), 3), Path::new("run.3"));
    }

    #[test]
    fn what_may_be_touched_is_said() {
        let touch =
            |how| Touch { name: "/x".to_owned(), how, type_name: "a/B".to_owned(), property: "calm".to_owned() };
        let text = touched(&[touch(How::Publish), touch(How::Call), touch(How::Guard)], false);
        assert!(
            text.contains("may publish /x (a/B) by calm")
                && text.contains("may call /x")
                && text.contains("may guard /x")
        );
        assert!(touched(&[], true).contains("only watched"));
    }
}
