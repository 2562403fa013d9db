//! `lapwing sim … --ros1` and `--ros2`: a scenario as a node of a live graph, as fast as real time goes, or so many times as fast.
//!
//! The simulator makes messages as ROS 2 has them; for ROS 1 they are converted, by the definitions that ROS 1 has of the same types.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::{Duration, Instant};

use lapwing_record::{Converter, Decoder, Dialect, Encoding, Layout, Library, MessageType, RawChannel};
use lapwing_ros::connector::{Arrival, Connector, Definition, Happening, Offer, PublisherId, StreamId};
use lapwing_sim::message::Kind;
use lapwing_sim::{Recorder, Scenario, Simulation};
use lapwing_stream::Value;

use super::{Sim, options};
use crate::complain::{Complaint, say};
use crate::exit::Exit;
use crate::interrupt;

/// So long after an interrupt at the latest the run ends.
const TICK: Duration = Duration::from_millis(100);
/// So long a run waits for somebody to command its robots before it begins all the same, and so long after that.
const PATIENCE: Duration = Duration::from_secs(10);
const SETTLE: Duration = Duration::from_secs(1);
/// So many things that have come are heard when a message is due already: whoever floods the robot with commands does not stop its time.
const TURN: usize = 256;
/// A run that was late by less than this was on time.
const LATE: Duration = Duration::from_millis(100);

/// Runs a scenario on a graph, to its end or to an interrupt.
pub fn run(sim: &Sim, scenario: &Scenario, mut graph: Box<dyn Connector>) -> Result<Exit, Complaint> {
    let options = options(sim, sim.seed);
    let mut simulation = Simulation::new(scenario, &options);
    if sim.outside {
        simulation.obey_outside();
    }
    let mut node = Node::new(&mut *graph, &simulation, sim.quiet)?;
    let mut tape = match &sim.output {
        Some(path) => {
            Some((path, Recorder::new(scenario, &options, &simulation, create(path)?).map_err(|e| wrong(path, &e))?))
        }
        None => None,
    };
    interrupt::listen();
    let speed = sim.speed.unwrap_or(1.0);
    node.greet(scenario.name(), &simulation, speed);
    node.await_commands(&mut simulation);
    let (begin, mut latest) = (Instant::now(), Duration::ZERO);
    while let Some((time, topic)) = simulation.advance() {
        let due = begin + Duration::from_secs_f64(simulation.seconds() / speed);
        if !node.listen(due, &mut simulation) {
            break;
        }
        latest = latest.max(due.elapsed());
        let payload = simulation.payload();
        if let Some((path, tape)) = &mut tape {
            tape.write(time, topic, payload).map_err(|e| wrong(path, &e))?;
        }
        node.publish(topic, payload)?;
    }
    if latest > LATE && !sim.quiet {
        say(&format!(
            "the simulator was late by up to {:.1} s: this machine is too slow, or too busy, for this\n",
            latest.as_secs_f64()
        ));
    }
    if let Some((path, tape)) = tape {
        let count = tape.finish().map_err(|e| wrong(path, &e))?;
        if !sim.quiet {
            say(&format!("{}: {count} messages\n", path.display()));
        }
    }
    Ok(Exit::Good)
}

fn create(path: &Path) -> Result<BufWriter<File>, Complaint> {
    File::create(path).map(BufWriter::new).map_err(|e| wrong(path, &e))
}

fn wrong(path: &Path, error: &dyn std::fmt::Display) -> Complaint {
    Complaint::new(format!("{}: {error}", path.display()))
}

/// The simulator's node.
struct Node<'g> {
    graph: &'g mut dyn Connector,
    /// By the places of the topics; nothing for those that others publish.
    outlets: Vec<Option<Outlet>>,
    /// The topics of commands from outside: their places and names.
    ears: Vec<(usize, String)>,
    /// How to read what comes there.
    heard: BTreeMap<StreamId, (usize, Decoder)>,
    is_quiet: bool,
}

/// Where messages of a topic go out.
struct Outlet {
    publisher: PublisherId,
    /// Nothing where the graph takes them as they are.
    converter: Option<Converter>,
}

impl<'g> Node<'g> {
    fn new(graph: &'g mut dyn Connector, simulation: &Simulation, is_quiet: bool) -> Result<Node<'g>, Complaint> {
        let places = simulation.ears();
        let mut outlets = Vec::new();
        for (place, topic) in simulation.topics().iter().enumerate() {
            let is_heard = places.contains(&place);
            outlets.push(if is_heard { None } else { Some(outlet(graph, &topic.name, topic.kind)?) });
        }
        let name = |place: usize| simulation.topics().get(place).map(|topic| (place, topic.name.clone()));
        let ears: Vec<(usize, String)> = places.into_iter().filter_map(name).collect();
        graph.subscribe(&ears.iter().map(|(_, name)| name.clone()).collect::<Vec<_>>());
        Ok(Node { graph, outlets, ears, heard: BTreeMap::new(), is_quiet })
    }

    fn greet(&self, scenario: &str, simulation: &Simulation, speed: f64) {
        let topics = self.outlets.iter().flatten().count();
        let (_, steps) = simulation.progress();
        let ears: Vec<&str> = self.ears.iter().map(|(_, name)| name.as_str()).collect();
        let commands =
            if ears.is_empty() { String::new() } else { format!(", commands come from {}", ears.join(", ")) };
        self.tell(&format!(
            "{scenario} on {}: {topics} topics{commands}; {steps} steps of 5 ms, {}",
            self.graph.name(),
            if speed == 1.0 { "in real time".to_owned() } else { format!("{speed} times as fast as real time") },
        ));
    }

    fn tell(&self, text: &str) {
        if !self.is_quiet {
            say(&format!("{text}\n"));
        }
    }

    /// Waits until commands can be heard wherever they are to come from, and a moment longer: who gives them has to hear the robot, too.
    fn await_commands(&mut self, simulation: &mut Simulation) {
        let begin = Instant::now();
        while self.is_deaf() && begin.elapsed() < PATIENCE && self.listen(Instant::now() + TICK, simulation) {}
        if !self.ears.is_empty() {
            self.listen(Instant::now() + SETTLE, simulation);
        }
    }

    fn is_deaf(&self) -> bool {
        self.ears.iter().any(|(ear, _)| self.heard.values().all(|(place, _)| place != ear))
    }

    /// Listens until a message is due, and then to what has come, a turn of it. Whether the run goes on.
    fn listen(&mut self, due: Instant, simulation: &mut Simulation) -> bool {
        let mut turn = 0;
        while turn < TURN {
            if interrupt::is_stopped() {
                return false;
            }
            let left = due.saturating_duration_since(Instant::now());
            turn += usize::from(left.is_zero());
            match self.graph.next(left.min(TICK)) {
                Some(arrival) => self.hear(&arrival, simulation),
                None if left.is_zero() => return true,
                None => {}
            }
        }
        true
    }

    fn hear(&mut self, arrival: &Arrival, simulation: &mut Simulation) {
        match &arrival.what {
            Happening::Stream(offer) => self.take_up(offer),
            Happening::Message { stream, payload } => {
                let Some((place, decoder)) = self.heard.get_mut(stream) else { return };
                let mut values = decoder.slots();
                match decoder.decode(payload, &mut values) {
                    Ok(()) => {
                        if let [Value::Num(ahead), Value::Num(turn)] = values[..] {
                            simulation.command(*place, ahead, turn);
                        }
                    }
                    Err(error) => self.tell(&format!("a command cannot be read: {error}")),
                }
            }
            Happening::Blind { topic, cause } => self.tell(&format!("{topic}: {cause}")),
            Happening::Sees { topic, .. } => self.tell(&format!("{topic} can be heard")),
            Happening::Note(text) => self.tell(text),
            Happening::Lost { .. } | Happening::Publishers { .. } | Happening::Reply { .. } => {}
        }
    }

    /// Finds out how to read the commands of a stream.
    fn take_up(&mut self, offer: &Offer) {
        let Some((place, _)) = self.ears.iter().find(|(_, name)| *name == offer.channel.topic) else { return };
        // Without a definition it comes again, with one.
        let Ok(ty) = &offer.channel.ty else { return };
        let fields =
            [lapwing_record::Path::of_names(["linear", "x"]), lapwing_record::Path::of_names(["angular", "z"])];
        match Decoder::new(ty, &fields, 1) {
            Ok(decoder) => drop(self.heard.insert(offer.stream, (*place, decoder))),
            Err(error) => {
                self.tell(&format!("{} is {}, and no command: {error}", offer.channel.topic, offer.channel.type_name))
            }
        }
    }

    fn publish(&mut self, topic: usize, payload: &[u8]) -> Result<(), Complaint> {
        let Some(Some(outlet)) = self.outlets.get_mut(topic) else { return Ok(()) };
        let done = match &mut outlet.converter {
            None => self.graph.publish(outlet.publisher, payload),
            Some(converter) => {
                let converted = converter.convert(payload).map_err(|e| Complaint::new(e.to_string()))?;
                self.graph.publish(outlet.publisher, &converted)
            }
        };
        done.map_err(|refused| Complaint::new(refused.to_string()))
    }
}

/// Announces a topic on the graph.
fn outlet(graph: &mut dyn Connector, topic: &str, kind: Kind) -> Result<Outlet, Complaint> {
    let complain = |what: String| Complaint::new(format!("{topic}: {what}"));
    let own = kind.definition().map_err(|missing| complain(missing.to_string()))?;
    let (definition, to) = match graph.encoding() {
        Encoding::Cdr => (own.text.clone(), None),
        Encoding::Ros1 => {
            let (definition, layout) = as_ros1(graph, kind, &own.text).map_err(complain)?;
            (definition, Some(layout))
        }
    };
    let ty = to.clone().map_or_else(|| MessageType::Cdr(own.layout.clone()), MessageType::Ros1);
    let channel = RawChannel {
        topic: topic.to_owned(),
        type_name: kind.name().to_owned(),
        encoding: if to.is_some() { "ros1msg" } else { "ros2msg" }.to_owned(),
        definition: definition.into_bytes(),
        messages: if to.is_some() { "ros1" } else { "cdr" }.to_owned(),
        ty: Ok(ty),
    };
    let converter = to.map(|to| Converter::new(&MessageType::Cdr(own.layout.clone()), to, Encoding::Ros1)).transpose();
    let publisher = graph.advertise(&channel, false).map_err(|refused| complain(refused.to_string()))?;
    Ok(Outlet { publisher, converter: converter.map_err(|e| complain(e.to_string()))? })
}

/// The definition that ROS 1 has of a type; of one that only the simulator knows, the simulator's.
fn as_ros1(graph: &mut dyn Connector, kind: Kind, own: &str) -> Result<(String, std::sync::Arc<Layout>), String> {
    let definition = match graph.definition(kind.name()) {
        Ok(Definition::Message(definition)) => definition,
        _ => own.to_owned(),
    };
    let layout = Library::default().layout(Dialect::Ros1, kind.name(), &definition).map_err(|e| e.to_string())?;
    Ok((definition, layout))
}

#[cfg(test)]
mod tests {
    use lapwing_ros::connector::{CallId, Refused};
    use lapwing_stream::Time;

    use super::*;

    /// A graph on which so many things have come already.
    struct Flood(usize);

    impl Connector for Flood {
        fn name(&self) -> String {
            "a flood".to_owned()
        }

        fn encoding(&self) -> Encoding {
            Encoding::Cdr
        }

        fn now(&self) -> Time {
            Time(0)
        }

        fn subscribe(&mut self, _: &[String]) {}

        fn next(&mut self, _: Duration) -> Option<Arrival> {
            self.0 = self.0.checked_sub(1)?;
            Some(Arrival { at: Time(0), what: Happening::Lost { stream: StreamId(0), count: 1 } })
        }

        fn advertise(&mut self, _: &RawChannel, _: bool) -> Result<PublisherId, Refused> {
            Ok(PublisherId(0))
        }

        fn publish(&mut self, _: PublisherId, _: &[u8]) -> Result<(), Refused> {
            Ok(())
        }

        fn call(&mut self, _: &str, _: &str, _: &[u8], _: Duration) -> Result<CallId, Refused> {
            Err(Refused("there are no services here".to_owned()))
        }

        fn definition(&mut self, type_name: &str) -> Result<Definition, Refused> {
            Err(Refused(format!("nobody knows {type_name} here")))
        }
    }

    fn listening(graph: &mut dyn Connector) -> Node<'_> {
        Node { graph, outlets: Vec::new(), ears: Vec::new(), heard: BTreeMap::new(), is_quiet: true }
    }

    #[test]
    fn a_flood_of_messages_does_not_stop_the_time_of_the_simulator() {
        let scenario = Scenario::bundled("docking").unwrap().unwrap();
        let mut simulation = Simulation::new(&scenario, &lapwing_sim::Options::default());
        let mut flood = Flood(TURN + 100);
        assert!(listening(&mut flood).listen(Instant::now(), &mut simulation));
        assert_eq!(flood.0, 100, "a turn was heard");
        assert!(listening(&mut flood).listen(Instant::now(), &mut simulation));
        assert_eq!(flood.0, 0, "and the rest of what had come");
    }
}
