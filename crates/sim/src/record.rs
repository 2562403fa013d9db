//! Writes a run to an MCAP file, with the definitions of its messages: Foxglove, rosbags and Lapwing open it.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use lapwing_stream::Time;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, WriteOptions, Writer};

use crate::message::DefinitionMissing;
use crate::outbox::Topic;
use crate::scenario::Scenario;
use crate::simulation::{Options, Simulation};

/// Why a run cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// Nothing can be written there.
    #[error(transparent)]
    Mcap(#[from] mcap::McapError),
    /// A message has no definition.
    #[error(transparent)]
    Definition(#[from] DefinitionMissing),
}

/// Runs a scenario to its end, and writes what is published. Gives how many messages that were. The same scenario, seed and faults give the
/// same bytes.
pub fn record(scenario: &Scenario, options: &Options, to: impl Write + Seek) -> Result<u64, RecordError> {
    let mut simulation = Simulation::new(scenario, options);
    let mut recorder = Recorder::new(scenario, options, &simulation, to)?;
    while let Some((time, topic)) = simulation.advance() {
        recorder.write(time, topic, simulation.payload())?;
    }
    Ok(recorder.finish()?)
}

/// A recording that is being written, message by message.
pub struct Recorder<W: Write + Seek> {
    writer: Writer<W>,
    /// By the places of the topics.
    channels: Vec<u16>,
    count: u64,
}

impl<W: Write + Seek> Recorder<W> {
    /// Begins one of a run.
    pub fn new(
        scenario: &Scenario,
        options: &Options,
        simulation: &Simulation,
        to: W,
    ) -> Result<Recorder<W>, RecordError> {
        // The library's usual name carries its version, which would make the bytes others.
        let how = WriteOptions::new().profile("ros2").library("lapwing sim").compression(Some(Compression::Zstd));
        let mut writer = how.create(to)?;
        writer.write_metadata(&Metadata { name: "lapwing-sim".to_owned(), metadata: about(scenario, options) })?;
        let channels = channels(simulation, &mut writer)?;
        Ok(Recorder { writer, channels, count: 0 })
    }

    /// Writes a message of the topic at that place.
    pub fn write(&mut self, time: Time, topic: usize, payload: &[u8]) -> mcap::McapResult<()> {
        let stamp = u64::try_from(time.0).unwrap_or_default();
        let header = MessageHeader {
            channel_id: self.channels[topic],
            sequence: u32::try_from(self.count).unwrap_or(u32::MAX),
            log_time: stamp,
            publish_time: stamp,
        };
        self.count += 1;
        self.writer.write_to_known_channel(&header, payload)
    }

    /// Ends it. Gives how many messages are in it.
    pub fn finish(mut self) -> mcap::McapResult<u64> {
        self.writer.finish()?;
        Ok(self.count)
    }
}

fn channels<W: Write + Seek>(simulation: &Simulation, writer: &mut Writer<W>) -> Result<Vec<u16>, RecordError> {
    let mut channel = |topic: &Topic| {
        let definition = &topic.kind.definition()?.text;
        let schema = writer.add_schema(topic.kind.name(), "ros2msg", definition.as_bytes())?;
        Ok(writer.add_channel(schema, &topic.name, "cdr", &BTreeMap::new())?)
    };
    simulation.topics().iter().map(&mut channel).collect()
}

/// What it takes to run it again.
fn about(scenario: &Scenario, options: &Options) -> BTreeMap<String, String> {
    let faults: Vec<String> = options.faults.iter().map(|f| f.to_string()).collect();
    let entries = [
        ("scenario", scenario.name().to_owned()),
        ("scenario_text", scenario.text().to_owned()),
        ("seed", options.seed.to_string()),
        ("faults", faults.join(" ")),
    ];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
