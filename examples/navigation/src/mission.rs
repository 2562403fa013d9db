//! A mission: all components are set going, the robot is sent to a position, and monitors watch it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lapwing::{Report, Spec};
use lapwing_components::{Happening, Outcome, Recorder, Run, Setup, Teller, Watch, What, request, stamp};
use lapwing_diag::Style;
use lapwing_genom::{Disk, Options, load};
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
            ..Setup::default()
        };
        let mut run = Run::new(model.clone(), setup, codels).map_err(|e| e.to_string())?;
        self.plan(&mut run)?;
        let specs = self.spec.iter().map(|path| Spec::load(path).map_err(|e| e.to_string()));
        let specs = specs.collect::<Result<Vec<_>, _>>()?;
        let mut watch = Watch::new(specs, &run, Style::Plain).map_err(|e| e.0)?;
        let types = run.types().clone();
        let teller = Teller { model: &model, types: &types, sources: &loaded.sources, is_verbose: false };
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
        self.watched(run, &mut watch, &teller, &field, went)
            .map(|went| Went { report: self.spec.is_some().then(|| watch.finish(None)), ..went })
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

    fn watched(
        &self,
        mut run: Run,
        watch: &mut Watch,
        teller: &Teller<'_>,
        field: &Field,
        mut went: Went,
    ) -> Result<Went, String> {
        let mut recorder = self.record.as_deref().map(|path| Recorder::create(path, watch.signals())).transpose()?;
        let mut stops = false;
        let goto = run.plain_request("Navigation.Stop")?.component;
        while let Some(happening) = run.advance() {
            let messages = watch.see(&mut run, &happening);
            if let Some(recorder) = &mut recorder {
                messages.iter().try_for_each(|m| recorder.write(happening.time, m)).map_err(|e| e.to_string())?;
            }
            went.log.extend(teller.line(&happening).or_else(|| noteworthy(teller, &happening, &mut stops)));
            while let Some(news) = watch.news() {
                went.log.push(format!("{} violation {}", stamp(happening.time), news.property.name));
            }
            if let What::Ended { whose, outcome, .. } = &happening.what
                && whose.component == goto
            {
                went.goto = Some(outcome.clone());
                // A moment to come to rest, and then it is over.
                run.stop_at(happening.time, Duration::from_nanos(1_000_000_000));
            }
        }
        if let Some(recorder) = recorder {
            recorder.finish().map_err(|e| e.to_string())?;
        }
        let end = run.now().seconds();
        let figures = run.figures();
        (went.pose, went.bump, went.speed) = (field.pose(end), field.bump(), field.motions(end).linear);
        (went.missed, went.overruns) = (figures.all_missed(), figures.overruns.values().map(|c| c.times).sum());
        Ok(went)
    }
}

/// Of all codels, the log has SafetyPilot's `stop`, and what that writes.
fn noteworthy(teller: &Teller<'_>, happening: &Happening, stops: &mut bool) -> Option<String> {
    let all = Teller { is_verbose: true, ..*teller };
    match &happening.what {
        What::Called { .. } | What::Returned { .. } => {
            let line = all.line(happening)?;
            *stops = line.contains(".stop ZeroSpeed");
            stops.then_some(line)
        }
        What::Written { .. } if *stops => all.line(happening),
        _ => None,
    }
}
