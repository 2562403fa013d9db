//! A run as a recording that is read while it happens: no file lies between the simulator and a monitor.

use std::path::PathBuf;

use lapwing_record::{MessageType, Messages, Options as Reading, Path, Recording};
use lapwing_stream::{Time, Value};

use crate::message::DefinitionMissing;
use crate::outbox::Topic;
use crate::scenario::Scenario;
use crate::simulation::{Options, Simulation};

impl Messages for Simulation {
    fn advance(&mut self) -> Option<(Time, usize)> {
        Simulation::advance(self)
    }

    fn payload(&mut self) -> &[u8] {
        Simulation::payload(self)
    }

    fn tells(&mut self, topic: usize, fields: &[Path]) -> bool {
        Simulation::tells(self, topic, fields.iter().map(|path| path.to_string()))
    }

    fn tell(&mut self, values: &mut [Value]) {
        Simulation::tell(self, values);
    }

    fn progress(&self) -> (u64, u64) {
        Simulation::progress(self)
    }
}

/// What a run of a scenario is called in reports: its name and its seed.
pub fn run_name(scenario: &Scenario, seed: u64) -> PathBuf {
    PathBuf::from(format!("{}#{seed}", scenario.name()))
}

/// A run, to be read as a recording is.
pub fn recording(scenario: &Scenario, options: &Options) -> Result<Recording, DefinitionMissing> {
    let simulation = Simulation::new(scenario, options);
    let typed = |topic: &Topic| Ok((topic.name.clone(), MessageType::Cdr(topic.kind.definition()?.layout.clone())));
    let topics = simulation.topics().iter().map(typed).collect::<Result<_, _>>()?;
    Ok(Recording::of(&run_name(scenario, options.seed), topics, Box::new(simulation), Reading::default()))
}
