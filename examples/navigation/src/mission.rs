//! A mission: all components are set going, the robot is sent to a position, and monitors watch it.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lapwing::{Report, Spec};
use lapwing_components::{
    Happening, Observer, Outcome, Recorder, Run, Setup, Teller, Types, Watch, What, request, stamp,
};
use lapwing_diag::{SourceMap, Style};
use lapwing_genom::{Disk, Model, Options, load};
use lapwing_sim::Pose;
use lapwing_stream::Duration;

use crate::field::Field;
use crate::{drive, drivers, native, pom};

/// What is asked of the components before the robot drives.
const BEFORE: &str = include_str!("../mission.txt");

/// A mission.
#[derive(Clone, Debug)]
pub struct Mission {
    /// The specification that watches, if one does.
    pub spec: Option<PathBuf>,
    /// By how many seconds scans are held back, and from when on.
    pub delay: Option<(f64, f64)>,
    /// Whether time is the machine's.
    pub is_real: bool,
    /// What chance depends on.
    pub seed: u64,
    /// How many seconds it takes at most.
    pub seconds: f64,
    /// Where it is recorded: MCAP, or NDJSON by the name.
    pub record: Option<PathBuf>,
    /// A file of execution times.
    pub wcet: Option<PathBuf>,
}

/// How a mission went.
#[derive(Debug)]
pub struct Went {
    /// What was said of it, line by line.
    pub log: Vec<String>,
    /// What became of the properties.
    pub report: Option<Report>,
    /// How the way to the position ended, if it did.
    pub goto: Option<Outcome>,
    /// Where the robot stood at the end.
    pub pose: Pose,
    /// When it ran into something, in seconds.
    pub bump: Option<f64>,
    /// How fast it was at the end, in m/s.
    pub speed: f64,
    /// Turns of tasks that were left out.
    pub missed: u64,
    /// Codels that took longer than they may.
    pub overruns: u64,
}

impl Default for Mission {
    fn default() -> Mission {
        Mission { spec: None, delay: None, is_real: false, seed: 1, seconds: 40.0, record: None, wcet: None }
    }
}

impl Mission {
    /// Carries it out.
    ///
    /// # Errors
    ///
    /// A file is not there or wrong, or the codels in C cannot be compiled.
    pub fn fly(&self) -> Result<Went, String> {
        let own = Path::new(env!("CARGO_MANIFEST_DIR"));
        let options = Options { wcet: self.wcet.clone(), ..Options::default() };
        let loaded = load(&Disk, &[own.join("robot_navigation.gen")], &options);
        let loaded = loaded.map_err(|(path, e)| format!("{}: {e}", path.display()))?;
        let model = Arc::new(loaded.model);
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let field = Field::new(self.seed);
        let mut codels = drivers::codels(&field);
        codels.join(pom::codels());
        codels.join(drive::codels());
        codels.join(native::codels(&model, folder.path())?);
        let setup = Setup {
            is_real: self.is_real,
            seed: self.seed,
            duration: Some(Duration::from_nanos((self.seconds * 1e9) as i64)),
            // A scan that is held back does not hang: `SetDelay` takes up to 10 s.
            patience: Duration::from_nanos(15_000_000_000),
            ..Setup::default()
        };
        let mut run = Run::new(model.clone(), setup, codels).map_err(|e| e.to_string())?;
        self.plan(&mut run)?;
        let specs = self.spec.iter().map(|path| Spec::load(path).map_err(|e| e.to_string()));
        let specs = specs.collect::<Result<Vec<_>, _>>()?;
        let watch = Watch::new(specs, &run, Style::Plain).map_err(|e| e.0)?;
        let recorder = self.record.as_deref().map(|path| Recorder::create(path, watch.signals())).transpose()?;
        let went = Went {
            log: Vec::new(),
            report: None,
            goto: None,
            pose: Pose::default(),
            bump: None,
            speed: 0.0,
            missed: 0,
            overruns: 0,
        };
        let navigation = run.plain_request("Navigation.Stop")?.component;
        let types = run.types().clone();
        let sources = loaded.sources;
        let logbook = Logbook { model, types, sources, watch, recorder, navigation, is_stopping: false, went };
        let (run, logbook) = run.carry_out(logbook);
        logbook.close(&run, &field, self.spec.is_some())
    }

    /// What is requested, and when.
    fn plan(&self, run: &mut Run) -> Result<(), String> {
        let delay = self.delay.map(|(delay, from)| format!("@{from:.9}s LaserDriver.SetDelay(delay={delay:?})\n"));
        let text = format!("{BEFORE}{}", delay.unwrap_or_default());
        let requests = request::file(run.model(), run.types(), &text)
            .map_err(|errors| errors.iter().map(|e| e.to_string()).collect::<Vec<_>>().join("\n"))?;
        requests.into_iter().for_each(|(time, request)| run.schedule(time, request));
        Ok(())
    }
}

/// Who writes down how a mission goes, and sees to it that it is watched.
struct Logbook {
    model: Arc<Model>,
    types: Types,
    sources: SourceMap,
    watch: Watch,
    recorder: Option<Recorder<File>>,
    /// The number of the component that drives to positions.
    navigation: usize,
    /// Whether SafetyPilot's `stop` is what happens.
    is_stopping: bool,
    went: Went,
}

impl Observer for Logbook {
    fn see(&mut self, run: &mut Run, happening: &Happening) {
        let messages = self.watch.see(run, happening);
        if let Some(recorder) = &mut self.recorder
            && !recorder.write(happening.time, &messages)
        {
            run.stop();
        }
        let line = self.line(happening);
        self.went.log.extend(line);
        while let Some(news) = self.watch.news() {
            self.went.log.push(format!("{} violation {}", stamp(happening.time), news.property.name));
        }
        if let What::Ended { whose, outcome, .. } = &happening.what
            && whose.component == self.navigation
        {
            self.went.goto = Some(outcome.clone());
            // A moment to come to rest, and then it is over.
            run.stop_at(happening.time, Duration::from_nanos(1_000_000_000));
        }
    }
}

impl Logbook {
    /// What the log says of something: of all codels, it has SafetyPilot's `stop`, and what that writes.
    fn line(&mut self, happening: &Happening) -> Option<String> {
        let all = Teller { model: &self.model, types: &self.types, sources: &self.sources, is_verbose: true };
        let told = Teller { is_verbose: false, ..all }.line(happening);
        if told.is_some() {
            return told;
        }
        match &happening.what {
            What::Called { .. } | What::Returned { .. } => {
                let line = all.line(happening)?;
                self.is_stopping = line.contains(".stop ZeroSpeed");
                self.is_stopping.then_some(line)
            }
            What::Written { .. } if self.is_stopping => all.line(happening),
            _ => None,
        }
    }

    /// How it went, now that it is over.
    fn close(mut self, run: &Run, field: &Field, is_watched: bool) -> Result<Went, String> {
        if let Some(recorder) = self.recorder.take() {
            recorder.finish().map_err(|e| e.to_string())?;
        }
        let (end, figures) = (run.now().seconds(), run.figures());
        Ok(Went {
            report: is_watched.then(|| self.watch.finish(None)),
            pose: field.pose(end),
            bump: field.bump(),
            speed: field.motions(end).linear,
            missed: figures.all_missed(),
            overruns: figures.overruns.values().map(|c| c.times).sum(),
            ..self.went
        })
    }
}
