//! Writes a run to an MCAP file, with the definitions of its messages: Foxglove, rosbags and Lapwing open it.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, WriteOptions, Writer};

use crate::message::text;
use crate::scenario::Scenario;
use crate::simulation::{Options, Simulation};

/// Runs a scenario to its end, and writes what is published. Gives how many messages that were. The same scenario, seed and faults give the
/// same bytes.
pub fn record(scenario: &Scenario, options: &Options, to: impl Write + Seek) -> mcap::McapResult<u64> {
    let mut simulation = Simulation::new(scenario, options);
    // The library's usual name carries its version, which would make the bytes others.
    let how = WriteOptions::new().profile("ros2").library("lapwing sim").compression(Some(Compression::Zstd));
    let mut writer = how.create(to)?;
    writer.write_metadata(&Metadata { name: "lapwing-sim".to_owned(), metadata: about(scenario, options) })?;
    let channels = channels(&simulation, &mut writer)?;
    let mut count = 0;
    while let Some((time, topic)) = simulation.advance() {
        let stamp = u64::try_from(time.0).unwrap_or_default();
        let header = MessageHeader {
            channel_id: channels[topic],
            sequence: u32::try_from(count).unwrap_or(u32::MAX),
            log_time: stamp,
            publish_time: stamp,
        };
        writer.write_to_known_channel(&header, simulation.payload())?;
        count += 1;
    }
    writer.finish()?;
    Ok(count)
}

fn channels<W: Write + Seek>(simulation: &Simulation, writer: &mut Writer<W>) -> mcap::McapResult<Vec<u16>> {
    let mut channel = |topic: &crate::outbox::Topic| {
        let definition = text(topic.kind).unwrap_or_default();
        let schema = writer.add_schema(topic.kind.name(), "ros2msg", definition.as_bytes())?;
        writer.add_channel(schema, &topic.name, "cdr", &BTreeMap::new())
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
