//! The automata: their shape after the paper's rules, and what they do.

mod common;
mod explorer;

use common::{IMU, sound};
use explorer::Explorer;
use lapwing_genom::Loaded;
use lapwing_genom::automata::{
    Automaton, Class, Cond, EXCEPTION, Part, Settings, System, branch, branch_of_exception, build,
};
use lapwing_genom::model::{Codel, Role};
use lapwing_genom::mutex::{Mutex, Rules};

const ONE: Settings =
    Settings { instances: 1, rules: Rules { readers_share: false }, runtime: false, exceptions: false };

fn automaton<'s>(system: &'s System, name: &str) -> &'s Automaton {
    system.automata.iter().find(|a| a.name == name).unwrap_or_else(|| panic!("no `{name}`"))
}

fn places(automaton: &Automaton) -> Vec<&str> {
    automaton.locations.iter().map(|l| l.name.as_str()).collect()
}

/// The locations of the paper's figure 6 and listing 8.
#[test]
fn measure_is_that_of_the_paper() {
    let loaded = sound(IMU);
    let system = build(&loaded.model, ONE).unwrap();
    let measure = automaton(&system, "ImuDriver_Measure");
    assert_eq!(
        places(measure),
        ["ether", "start", "start_exec", "get", "get_pause", "write_p", "write_p_exec", "stop"]
    );
    let called = build(&loaded.model, Settings { runtime: true, ..ONE }).unwrap();
    let mut found = places(automaton(&called, "ImuDriver_Measure"));
    found.sort_unstable();
    let mut listed = [
        "ether",
        "start",
        "start_exec",
        "start_test",
        "get",
        "get_test",
        "get_pause",
        "write_p",
        "write_p_exec",
        "write_p_test",
        "stop",
    ];
    listed.sort_unstable();
    assert_eq!(found, listed);
    assert_eq!(places(automaton(&system, "ImuDriver_Connect")), ["ether", "start", "stop"]);
    assert_eq!(places(automaton(&system, "ImuDriver_update_timer")), ["tick"]);
    assert_eq!(places(automaton(&system, "ImuDriver_update_manager")), ["wait", "manage"]);
    let limits: Vec<Option<u64>> = measure.locations.iter().map(|l| l.invariant_ns).collect();
    assert_eq!(limits, [None, None, Some(1_000_000), Some(2_000_000), None, None, Some(1_500_000), Some(2_000_000)]);
}

/// What the rules add up to, for a component and its automata.
struct Counts {
    codels: usize,
    locks: usize,
    pauses: usize,
    paused_safe: usize,
    transitions: usize,
    open: usize,
}

fn counts(loaded: &Loaded, component: usize, codels: &[&Codel]) -> Counts {
    let mutex = Mutex::symmetric(&loaded.model, Rules::default());
    let all = &loaded.model.components[component];
    let id = |codel: &Codel| all.codels().find(|(_, c)| std::ptr::eq(*c, codel)).unwrap().0;
    let is_unsafe = |codel: &Codel| mutex.is_unsafe((component, id(codel)));
    let is_paused = |codel: &&&Codel| {
        codels.iter().flat_map(|c| c.yields()).any(|t| t.pause && codel.triggers().contains(&t.event))
    };
    let distinct = |codel: &Codel| {
        let mut targets: Vec<_> = codel.yields().iter().map(|t| (t.pause, t.to)).collect();
        targets.sort();
        targets.dedup();
        targets.len()
    };
    Counts {
        codels: codels.len(),
        locks: codels.iter().filter(|c| is_unsafe(c)).count(),
        pauses: codels.iter().filter(is_paused).count(),
        paused_safe: codels.iter().filter(is_paused).filter(|c| !is_unsafe(c)).count(),
        transitions: codels.iter().map(|c| distinct(c)).sum(),
        open: codels.iter().filter(|c| distinct(c) > 1).count(),
    }
}

/// Every instance of an activity of these specifications has as many locations and edges as the rules say.
#[test]
fn sizes_follow_the_rules() {
    for text in [IMU, STRESS] {
        let loaded = sound(text);
        for runtime in [false, true] {
            let system = build(&loaded.model, Settings { instances: 2, runtime, ..ONE }).unwrap();
            let activities = system.automata.iter().filter(|a| a.part == Part::Activity);
            let mut seen = 0;
            for found in activities {
                let component = &loaded.model.components[found.component];
                let service = component.services.iter().find(|s| s.span == found.span).unwrap();
                let codels: Vec<&Codel> = service.codels.iter().map(|id| &component.codels[id.0]).collect();
                let n = counts(&loaded, found.component, &codels);
                let open = if runtime { n.open } else { 0 };
                assert_eq!(found.locations.len(), 1 + n.codels + n.locks + n.paused_safe + open, "{}", found.name);
                // S, I from `ether` and every place of a pause, M, R; and the transitions, each after a call that is looked at.
                let additional = 1 + (1 + n.pauses) + n.locks + n.paused_safe;
                assert_eq!(found.edges.len(), n.transitions + open + additional, "{}", found.name);
                seen += 1;
            }
            assert!(seen >= 4, "{seen}");
        }
    }
}

/// Activities with every peculiarity: without `stop`, with pauses on the way from `stop`, several events for a codel, locks, and a permanent one.
const STRESS: &str = "
struct s { long m; };
component Robot {
  ids { long a, b; };
  port out s P;
  attribute Set(in a);
  function F() { codel f(out b); interrupts Go; };
  task slow { period 4 ms; codel<start> p0(out a) yield main wcet 1 ms; codel<main> p1(in b) yield pause::main wcet 1 ms; };
  task fast { period 2 ms; };
  activity Go() { task slow; validate v(in b);
    codel<start, again> g0(in a, out P) yield pause::again, more, ether wcet 1 ms;
    codel<more> g1() yield pause::more, again wcet 1 ms;
    codel<stop> g2(in a) yield rest wcet 1 ms;
    codel<rest> g3() yield pause::rest, ether wcet 1 ms;
    interrupts Go; };
  activity Try() { task fast; after Go;
    codel<start> t0(inout P) yield pause::start, ether wcet 1 ms; };
};";

/// Every edge that Definition 1 makes eager is, and only an edge out of a place with a limit waits for the clock.
#[test]
fn guards_and_urgencies() {
    let loaded = sound(STRESS);
    let system = build(&loaded.model, ONE).unwrap();
    for found in system.automata.iter().filter(|a| matches!(a.part, Part::Activity | Part::Permanent)) {
        for edge in &found.edges {
            let is_additional = matches!(edge.class, Class::Start | Class::Interruption | Class::Mutex | Class::Resume);
            assert_eq!(edge.eager, is_additional, "{}.{}", found.name, edge.name);
            assert_eq!(edge.clock.is_some(), !is_additional, "{}.{}", found.name, edge.name);
            let runs = |place: lapwing_genom::automata::LocId| found.locations[place.0].codel.is_some();
            assert_eq!(edge.resets, runs(edge.to), "{}.{}", found.name, edge.name);
            assert_eq!(edge.clock.is_some(), runs(edge.from), "{}.{}", found.name, edge.name);
        }
    }
}

/// Whatever clients ask for and however long codels take: locks exclude each other, the control is in one place, and something can always happen.
#[test]
fn nothing_goes_wrong_in_any_run() {
    for (text, instances) in [(SMALL, 2), (PERMANENT, 1), (APERIODIC, 1), (ASYNCHRONOUS, 1)] {
        let loaded = sound(text);
        let system = build(&loaded.model, Settings { instances, ..ONE }).unwrap();
        let mutex = Mutex::symmetric(&loaded.model, Rules::default());
        let explorer = Explorer::new(&system);
        let states = explorer.all(60_000);
        assert!(states.len() > 100, "{}", states.len());
        for state in &states {
            assert!(!explorer.is_stuck(state), "{}", explorer.shown(state));
            let mut running = Vec::new();
            for (automaton, place) in system.automata.iter().zip(&state.places) {
                running.extend(automaton.locations[*place].codel.map(|codel| (automaton.component, codel)));
            }
            for (number, one) in running.iter().enumerate() {
                let clash = running.iter().skip(number + 1).find(|other| mutex.of(*one).contains(other));
                assert!(clash.is_none(), "{}", explorer.shown(state));
            }
            for (variable, value) in system.variables.iter().zip(&state.values) {
                assert!(
                    (variable.range.0..=variable.range.1).contains(value),
                    "{} in {}",
                    variable.name,
                    explorer.shown(state)
                );
            }
        }
        // Every place is reached, but for those that wait for what never comes.
        for (number, automaton) in system.automata.iter().enumerate() {
            for (place, location) in automaton.locations.iter().enumerate() {
                assert!(
                    states.iter().any(|s| s.places[number] == place),
                    "{}.{} is never reached",
                    automaton.name,
                    location.name
                );
            }
        }
    }
}

/// Two activities that exclude each other, over shared data, in one task.
const SMALL: &str = "
component C {
  ids { long a; };
  function Stop() { interrupts Go; };
  task t { period 3 ms; };
  activity Go() { task t;
    codel<start> g0() yield pause::start, ether wcet 1 ms;
    codel<stop> g1() yield ether wcet 1 ms;
    interrupts Go; };
};";

const PERMANENT: &str = "
component C {
  ids { long a; };
  attribute Set(in a);
  task t { period 3 ms; codel<start> p(out a) yield pause::start, main wcet 1 ms; codel<main> q() yield pause::start wcet 1 ms; };
  task u { period 2 ms; delay 1 ms; codel<start> r(in a) yield ether wcet 1 ms; };
};";

const APERIODIC: &str = "
component C {
  ids { long a; };
  task t { period 2 ms; };
  task u;
  activity Go() { task t; codel<start> g(in a) yield ether wcet 1 ms; };
  activity Wait() { task u; codel<start> w(out a) yield pause::start, ether wcet 1 ms; codel<stop> z() yield ether wcet 1 ms; };
  activity Halt() { task t; codel<start> h() yield ether wcet 1 ms; interrupts Wait; };
};";

const ASYNCHRONOUS: &str = "
component C {
  ids { long a; };
  function Stop() { interrupts Poll; };
  task t { period 2 ms; };
  activity Poll() { task t;
    codel<start> p() yield wait wcet 1 ms;
    async codel<wait> q() yield start, ether wcet 3 ms;
    codel<stop> z() yield ether wcet 1 ms;
    interrupts Poll; };
};";

/// What a codel holds it holds until it has ended: its lock is free again only on the edge by which it leaves.
#[test]
fn locks_last_until_the_codel_has_returned() {
    let loaded = sound(IMU);
    for runtime in [false, true] {
        let system = build(&loaded.model, Settings { runtime, ..ONE }).unwrap();
        let measure = automaton(&system, "ImuDriver_Measure");
        let lock = system.variables.iter().position(|v| v.name == "ImuDriver_r_Measure_start").unwrap();
        for edge in &measure.edges {
            let mut releases = false;
            for action in &edge.actions {
                releases |= *action == lapwing_genom::automata::Action::Set(lapwing_genom::automata::VarId(lock), 0);
            }
            let from = measure.locations[edge.from.0].name.as_str();
            assert_eq!(releases, from == if runtime { "start_test" } else { "start_exec" }, "{}", edge.name);
        }
    }
}

/// Attributes and functions are the control task's, and attributes need no codel.
#[test]
fn the_control_task_serves() {
    let loaded = sound(STRESS);
    let system = build(&loaded.model, ONE).unwrap();
    let control = automaton(&system, "Robot_control");
    assert_eq!(control.part, Part::Control);
    let requests: Vec<&str> =
        control.edges.iter().filter(|e| e.class == Class::Request).map(|e| e.name.as_str()).collect();
    assert_eq!(requests, ["request_Set", "request_F", "request_Go", "request_Try"]);
    assert!(loaded.model.components[0].codels.iter().any(|c| c.role == Role::Attribute));
    // `Try` is refused until `Go` has succeeded once.
    let tried = control.edges.iter().find(|e| e.name == "request_Try").unwrap();
    let mut initial: Vec<i64> = system.variables.iter().map(|v| v.initial).collect();
    assert!(!tried.guard.holds(&initial));
    initial[system.variables.iter().position(|v| v.name == "Robot_done_Go").unwrap()] = 1;
    assert!(tried.guard.holds(&initial));
}

/// With exceptions every codel that is called may throw one; that ends its activity, gives its lock back, and is no success.
#[test]
fn an_exception_ends_an_activity_and_is_no_success() {
    let loaded = sound(STRESS);
    let settings = Settings { runtime: true, exceptions: true, ..ONE };
    let (system, without) = (
        build(&loaded.model, settings).unwrap(),
        build(&loaded.model, Settings { exceptions: false, ..settings }).unwrap(),
    );
    let done =
        system.variables.iter().position(|v| v.name == "Robot_done_Go").map(lapwing_genom::automata::VarId).unwrap();
    let mut calls = 0;
    for automaton in &system.automata {
        for (place, edge) in automaton.edges.iter().enumerate() {
            let Some(call) = &edge.call else { continue };
            calls += 1;
            let (next, events) = call.result.as_ref().unwrap();
            assert_eq!(events.last().map(String::as_str), Some(EXCEPTION), "{}.{}", automaton.name, edge.name);
            let codel = &loaded.model.components[automaton.component].codels[call.codel.0];
            assert_eq!(branch_of_exception(codel), events.len() - 1);
            assert!(events[..events.len() - 1].iter().enumerate().all(|(n, event)| branch(codel, event) == Some(n)));
            // The edge that is taken then leads to the end, and says of nobody that it has succeeded.
            let thrown = Cond::Is(*next, events.len() as i64 - 1);
            let holds = |cond: &Cond| *cond == thrown || matches!(cond, Cond::All(parts) if parts.contains(&thrown));
            let ends: Vec<_> =
                automaton.edges.iter().filter(|e| e.from == automaton.edges[place].to && holds(&e.guard)).collect();
            let [end] = ends.as_slice() else { panic!("{}.{}: {ends:?}", automaton.name, edge.name) };
            assert_eq!((end.class, automaton.locations[end.to.0].name.as_str()), (Class::Termination, "ether"));
            end.actions.iter().for_each(|action| action.writes(&mut |var| assert_ne!(var, done)));
        }
    }
    assert!(calls > 5, "{calls}");
    let refusals = |system: &System| system.automata.iter().flat_map(|a| &a.edges).filter(|e| e.is_refusal).count();
    assert!(refusals(&system) > refusals(&without), "functions may throw as well");
}

/// What is said of cells and tasks is what the automata are.
#[test]
fn cells_and_tasks_name_their_automata() {
    let loaded = sound(STRESS);
    let system = build(&loaded.model, Settings { instances: 2, ..ONE }).unwrap();
    let is = |part: &Part| system.automata.iter().filter(|a| a.part == *part).count();
    assert_eq!(system.cells.len(), is(&Part::Activity) + is(&Part::Permanent));
    assert_eq!(
        (system.tasks.len(), system.tasks.iter().filter(|t| t.timer.is_some()).count()),
        (is(&Part::Manager), is(&Part::Timer))
    );
    for cell in &system.cells {
        let automaton = &system.automata[cell.automaton];
        assert_eq!(automaton.part == Part::Permanent, cell.activity.is_none());
        assert!(
            system.variables[cell.status.0].meaning.contains(&format!("`{}`", automaton.name)),
            "{}",
            automaton.name
        );
    }
    for task in &system.tasks {
        assert_eq!(system.automata[task.manager].part, Part::Manager);
        assert!(task.timer.is_none_or(|timer| system.automata[timer].part == Part::Timer));
    }
}
