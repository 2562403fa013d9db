//! The BIP text and the automata are two ways to write one system (section III-B3 of the paper): what is possible in one is possible in the
//! other, at the same moments, and leads to the same places, clocks and variables.
//!
//! The text is written, parsed and run by the BIP engine; the automata are run by the explorer. Both go the same ways, breadth first, as far as the
//! bound says.

mod common;
mod explorer;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use common::{IMU, sound};
use explorer::{Explorer, State, Step};
use lapwing_bip::{Bound, Engine, FileId, Model, MoveId, Registry, Rules, Standing, Time, Value};
use lapwing_genom::automata::{MOST_CELLS, Settings, System, build};
use lapwing_genom::emit::{Input, Sharing, bip};

/// An edge, and how many units of time pass before it is taken.
type Move = (usize, usize, u64);

/// No state is left alone for longer.
const PATIENCE: u64 = 12;

struct Pair<'s> {
    system: &'s System,
    explorer: Explorer<'s>,
    sharing: Sharing,
    model: Arc<Model>,
    /// The edges by the paths of their connectors and ports.
    edges: BTreeMap<String, (usize, usize)>,
    /// The engine's number of each automaton.
    atoms: Vec<u32>,
}

impl<'s> Pair<'s> {
    fn new(system: &'s System, text: &str) -> Pair<'s> {
        let parsed = lapwing_bip::parse(FileId(0), text);
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        let checked = lapwing_bip::check(&parsed.package, &[]);
        assert!(checked.diagnostics.is_empty(), "{:?}", checked.diagnostics);
        let model = Arc::new(checked.model(Some("Root")).unwrap());
        let mut edges = BTreeMap::new();
        for (number, automaton) in system.automata.iter().enumerate() {
            for (place, edge) in automaton.edges.iter().enumerate() {
                edges.insert(format!("ROOT.{}_{}", automaton.name, edge.name), (number, place));
                edges.insert(format!("ROOT.{}.{}", automaton.name, edge.name), (number, place));
            }
        }
        let atoms = system.automata.iter().map(|a| model.atom(&format!("ROOT.{}", a.name)).unwrap()).collect();
        Pair { system, explorer: Explorer::new(system), sharing: Sharing::of(system), model, edges, atoms }
    }

    fn engine(&self) -> Engine<Bound<'static>> {
        Engine::new(Arc::clone(&self.model), Registry::default().bind(&self.model).unwrap(), Rules::default()).unwrap()
    }

    /// What the automata can do, and where that leads.
    fn of_automata(&self, state: &State) -> BTreeMap<Move, State> {
        let mut all = BTreeMap::new();
        let mut now = state.clone();
        for waited in 0..=PATIENCE {
            let steps = self.explorer.steps(&now);
            let mut later = None;
            for (step, next) in steps {
                match step {
                    Step::Edge(automaton, edge) => drop(all.insert((automaton, edge, waited), next)),
                    Step::Time => later = Some(next),
                }
            }
            let Some(next) = later else { break };
            now = next;
        }
        all
    }

    /// What the engine can do, at moments that are whole units away.
    fn of_engine(&self, engine: &mut Engine<Bound<'static>>) -> BTreeMap<Move, MoveId> {
        let standing = engine.look().unwrap();
        assert!(standing == Standing::Open, "{standing:?}");
        let mut all = BTreeMap::new();
        for offer in engine.offers() {
            let (automaton, edge) = self.edges[&engine.move_path(offer.id)];
            for waited in 0..=PATIENCE {
                if offer.window.holds(self.later(engine, waited).0) {
                    all.insert((automaton, edge, waited), offer.id);
                }
            }
        }
        all
    }

    fn later(&self, engine: &Engine<Bound<'static>>, waited: u64) -> Time {
        Time(engine.now().0 + (waited * self.explorer.unit_ns) as i64)
    }

    /// The same places, and every copy of a variable has its value.
    fn assert_alike(&self, state: &State, engine: &Engine<Bound<'static>>) {
        for (number, automaton) in self.system.automata.iter().enumerate() {
            let place = automaton.locations[state.places[number]].name.as_str();
            assert_eq!(engine.places(self.atoms[number]), [place], "{}", automaton.name);
            for id in self.sharing.held(number) {
                let variable = &self.system.variables[id.0];
                let value = match engine.variable(self.atoms[number], &variable.name).unwrap() {
                    Value::Bool(value) => i64::from(value),
                    Value::Int(value) => value,
                    other => panic!("{other:?}"),
                };
                assert_eq!(value, state.values[id.0], "{} of {}", variable.name, automaton.name);
            }
        }
    }

    /// Goes along with both through the first `most` states. Gives how many states and how many moves were compared.
    fn explore(&self, most: usize) -> (usize, usize) {
        let initial = self.explorer.initial();
        let mut seen = BTreeSet::from([initial.clone()]);
        let mut waiting: VecDeque<(State, Vec<Move>)> = VecDeque::from([(initial, Vec::new())]);
        let (mut states, mut moves) = (0, 0);
        while let Some((state, way)) = waiting.pop_front() {
            // The engine has no way back: it goes the whole way again.
            let mut engine = self.engine();
            for (automaton, edge, waited) in &way {
                let id = self.of_engine(&mut engine)[&(*automaton, *edge, *waited)];
                let at = self.later(&engine, *waited);
                engine.make(id, at).unwrap();
            }
            self.assert_alike(&state, &engine);
            let (ours, theirs) = (self.of_automata(&state), self.of_engine(&mut engine));
            let names = |moves: Vec<&Move>| -> Vec<String> {
                moves
                    .iter()
                    .map(|(a, e, t)| {
                        format!("{}.{} +{t}", self.system.automata[*a].name, self.system.automata[*a].edges[*e].name)
                    })
                    .collect()
            };
            assert_eq!(names(ours.keys().collect()), names(theirs.keys().collect()), "{}", self.explorer.shown(&state));
            states += 1;
            moves += ours.len();
            for (one, next) in ours {
                if seen.len() < most && seen.insert(next.clone()) {
                    waiting.push_back((next, way.iter().copied().chain([one]).collect()));
                }
            }
        }
        (states, moves)
    }
}

#[track_caller]
fn are_bisimilar(source: &str, instances: usize, most: usize) -> (usize, usize) {
    let loaded = sound(source);
    let system = build(&loaded.model, Settings { instances, ..Settings::default() }).unwrap();
    let text = lapwing_bip::print(&bip(Input { system: &system, sources: &loaded.sources }));
    Pair::new(&system, &text).explore(most)
}

#[test]
fn one_activity_with_two_instances() {
    let source = "component C { function Stop() { interrupts Go; }; task t { period 3 ms; };
        activity Go() { task t; codel<start> g0() yield pause::start, ether wcet 1 ms; codel<stop> g1() yield ether wcet 1 ms; interrupts Go; }; };";
    let (states, moves) = are_bisimilar(source, 2, 2500);
    assert!(states >= 300 && moves > states, "{states} {moves}");
}

#[test]
fn locks_between_components() {
    let (states, moves) = are_bisimilar(IMU, 1, 1500);
    assert!(states >= 300 && moves > states, "{states} {moves}");
}

#[test]
fn permanent_activities_and_delays() {
    let source = "component C { ids { long a; }; attribute Set(in a);
        task t { period 3 ms; codel<start> p(out a) yield pause::start, main wcet 1 ms; codel<main> q() yield pause::start wcet 1 ms; };
        task u { period 2 ms; delay 1 ms; codel<start> r(in a) yield ether wcet 1 ms; }; };";
    let (states, moves) = are_bisimilar(source, 1, 1500);
    assert!(states >= 300 && moves > states, "{states} {moves}");
}

#[test]
fn pauses_on_the_way_from_stop_and_tasks_without_a_period() {
    let source = "component C { ids { long a; }; task t { period 2 ms; }; task u;
        activity Go() { task t; codel<start> g(in a) yield pause::start wcet 1 ms; codel<stop> h() yield pause::rest wcet 1 ms;
          codel<rest> k() yield ether wcet 1 ms; interrupts Go; };
        activity Wait() { task u; after Go; async codel<start> w() yield pause::start, ether wcet 1 ms; }; };";
    let (states, moves) = are_bisimilar(source, 2, 1500);
    assert!(states >= 300 && moves > states, "{states} {moves}");
}

/// With codels that are called: a lock is held from the call until the edge that leaves `…_test`, and what a codel returns decides.
#[test]
fn codels_that_are_called_decide() {
    let loaded = sound(IMU);
    let system = build(&loaded.model, Settings { instances: 1, runtime: true, ..Settings::default() }).unwrap();
    let text = lapwing_bip::print(&bip(Input { system: &system, sources: &loaded.sources }));
    let checked = lapwing_bip::check(&lapwing_bip::parse(FileId(0), &text).package, &[]);
    assert!(checked.diagnostics.is_empty(), "{:?}", checked.diagnostics);
    let model = Arc::new(checked.model(Some("Root")).unwrap());
    let mut registry = Registry::default();
    for function in model.functions() {
        // The first event: `Measure` goes on from state to state, and pauses.
        registry = registry.with(&function.name, |_| Ok(Value::Int(0)));
    }
    let mut engine = Engine::new(Arc::clone(&model), registry.bind(&model).unwrap(), Rules::default()).unwrap();
    let measure = model.atom("ROOT.ImuDriver_Measure").unwrap();
    let mut taken: Vec<String> = Vec::new();
    for _ in 0..200 {
        assert_eq!(engine.look().unwrap(), Standing::Open);
        // One request, and then what comes first.
        let is_wanted = |path: &str| {
            !path.contains("_request_") || (path.ends_with("request_Measure") && !taken.iter().any(|t| t == path))
        };
        let offers = engine.offers().iter().filter(|o| is_wanted(&engine.move_path(o.id)));
        let offer = *offers
            .min_by_key(|o| (o.window.first.max(engine.now().0), !engine.move_path(o.id).contains("request")))
            .unwrap();
        taken.push(engine.move_path(offer.id));
        engine.make(offer.id, Time(offer.window.first.max(engine.now().0))).unwrap();
        assert_eq!(engine.settle(engine.now(), 0).unwrap(), []);
        if engine.places(measure) == ["start_test"] {
            assert_eq!(engine.variable(measure, "ImuDriver_r_Measure_start"), Some(Value::Bool(true)));
        }
    }
    for edge in [
        "start_exec_to_start_test",
        "start_test_to_get",
        "get_to_get_test",
        "get_test_to_write_p",
        "write_p_test_to_get_pause",
    ] {
        assert!(taken.iter().any(|t| t.contains("Measure") && t.ends_with(edge)), "{edge}: {taken:?}");
    }
    assert!(!taken.iter().any(|t| t.ends_with("get_test_to_ether")), "{taken:?}");
}

#[test]
fn a_table_has_a_size_that_can_be_written_out() {
    let loaded = sound(IMU);
    let wanted = Settings { instances: MOST_CELLS, ..Settings::default() };
    let error = build(&loaded.model, wanted).unwrap_err();
    assert_eq!((error.task.as_str(), error.cells), ("ImuDriver.update", 2 * MOST_CELLS + 1));
}
