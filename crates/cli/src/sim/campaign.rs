//! Runs of a scenario that are checked while they go on: one, or thousands.

use std::path::Path;
use std::time::Instant;

use lapwing::{Options, Session, Spec};
use lapwing_react::{Tally, end, render};
use lapwing_sim::{DefinitionMissing, Scenario, recording, run_name};

use super::summary::{Run, Summary};
use super::{Sim, options, short, write};
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::onlooker::{Onlooker, Told};
use crate::sink::{Chunk, Sink};
use crate::words::specs;
use crate::{args, interrupt, jobs, progress};

/// Carries a campaign out.
pub fn run(sim: &Sim, scenario: &Scenario) -> Result<Exit, Complaint> {
    let (stdout, stderr) = styles(sim.color);
    let specs = specs(&sim.check, &[], stderr)?;
    if !sim.quiet {
        specs.iter().for_each(|spec| say(&spec.findings().render(stderr)));
    }
    interrupt::listen();
    let campaign = Campaign { sim, scenario, specs: &specs, is_summed_up: is_summed_up(sim), style: stdout };
    let begin = Instant::now();
    let runs = campaign.carry_out()?;
    let taken = begin.elapsed().as_secs_f64();
    let summary = Summary::of(&runs);
    if campaign.is_summed_up {
        campaign.sum_up(&summary, &runs, taken);
    }
    if let Some(output) = &sim.output {
        campaign.keep(&runs, output)?;
    }
    let all = runs.len() as u64 == sim.runs.get() && !interrupt::was_heard();
    Ok(Exit::of(summary.tally.standing(), all))
}

/// Several runs are summed up; one is reported like a recording, and so are all where a program reads the report.
fn is_summed_up(sim: &Sim) -> bool {
    sim.format == args::Format::Text && sim.runs.get() > 1
}

struct Campaign<'c> {
    sim: &'c Sim,
    scenario: &'c Scenario,
    specs: &'c [Spec],
    is_summed_up: bool,
    style: lapwing_diag::Style,
}

impl Campaign<'_> {
    /// All runs, in the order of their seeds.
    fn carry_out(&self) -> Result<Vec<Run>, Complaint> {
        let format: lapwing_react::Format = self.sim.format.into();
        let bars = progress::bars(!self.sim.quiet);
        let bar = progress::bar(&bars, Path::new(self.scenario.name()));
        bar.set_length(self.sim.runs.get());
        let sink = Sink::new(format.between(), bars.clone());
        if !self.is_summed_up {
            sink.frame(format.begin());
        }
        let count = usize::try_from(self.sim.runs.get()).unwrap_or(usize::MAX);
        let runs = jobs::spread(count, jobs::threads(self.sim.jobs), |number| {
            let run = self.one(number, &sink);
            bar.inc(1);
            sink.done(number);
            run
        });
        bar.finish_and_clear();
        let runs = runs.into_iter().map(|(_, run)| run).collect::<Result<Vec<Run>, _>>();
        let runs = runs.map_err(|e| Complaint::new(e.to_string()))?;
        if !self.is_summed_up {
            let mut tally = Tally::default();
            runs.iter().for_each(|run| tally.join(&run.tally));
            sink.frame(&end(&tally, format, self.style));
        }
        Ok(runs)
    }

    /// One run, with what is to be said of it at once.
    fn one(&self, number: usize, sink: &Sink) -> Result<Run, DefinitionMissing> {
        let seed = self.sim.seed.wrapping_add(number as u64);
        let name = run_name(self.scenario, seed);
        let recording = recording(self.scenario, &options(self.sim, seed))?;
        let session = Session::over(self.specs, recording, &name, &Options::default());
        if !self.sim.quiet && !self.is_summed_up {
            session.findings(self.style).into_iter().for_each(|text| sink.tell(number, Chunk::Note(text)));
        }
        let format = self.sim.format.into();
        let called = name.to_string_lossy();
        let mut onlooker = Onlooker { told: Told::by(format, &called, number, sink), bar: None };
        let report = session.run(&mut onlooker);
        if !self.is_summed_up {
            sink.tell(number, Chunk::Part(render(&report, format, self.style)));
        }
        Ok(Run::of(seed, &report))
    }

    fn sum_up(&self, summary: &Summary, runs: &[Run], taken: f64) {
        let again = |seed: u64| self.command(seed);
        let head = format!("{}: {} runs from seed {} on\n\n", self.scenario.name(), runs.len(), self.sim.seed);
        // Where nobody reads it there is nothing to be done.
        drop(std::io::Write::write_all(&mut std::io::stdout(), (head + &summary.text(&again)).as_bytes()));
        let simulated: f64 = runs.iter().map(|r| r.seconds).sum();
        if !self.sim.quiet {
            say(&format!(
                "{simulated:.0} s were simulated and checked in {taken:.1} s: {:.0} a second\n",
                simulated / taken
            ));
        }
    }

    /// The command that shows one of the runs.
    fn command(&self, seed: u64) -> String {
        let mut command = format!("lapwing sim {} --seed {seed}", self.scenario.name());
        self.sim.faults.iter().for_each(|fault| command += &format!(" --fault {fault}"));
        if let Some(duration) = self.sim.duration {
            command += &format!(" --duration {}", duration.to_string().replace(' ', ""));
        }
        self.sim.check.iter().for_each(|spec| command += &format!(" --check {}", spec.display()));
        command
    }

    /// Records runs: the only one, or those that failed, each of which is run once more.
    fn keep(&self, runs: &[Run], output: &Path) -> Result<(), Complaint> {
        if self.sim.runs.get() == 1 {
            return write(self.scenario, &options(self.sim, self.sim.seed), output).map(|_| ());
        }
        std::fs::create_dir_all(output).map_err(|e| Complaint::new(format!("{}: {e}", output.display())))?;
        for run in runs.iter().filter(|r| r.failed()) {
            let path = output.join(format!("{}-{}.mcap", short(self.scenario), run.seed));
            write(self.scenario, &options(self.sim, run.seed), &path)?;
        }
        Ok(())
    }
}
