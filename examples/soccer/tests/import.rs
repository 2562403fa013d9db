//! The monitors of JavaMOP in `javamop`, imported, judge matches as `soccer.rv` does, which says the same by hand.

mod common;

use std::fs;
use std::path::Path;

use common::{checked, player};
use lapwing_diag::SourceMap;
use lapwing_import::{Format, Options, import};
use soccer::fault::Fault;
use soccer::watch::{DIAGRAM, Happening};

/// A monitor's file, its property once it is imported, and that of `soccer.rv`.
const PROPERTIES: [(&str, &str, &str); 6] = [
    ("Init", "init", "init"),
    ("BallInFrontAfterTurnUntilKick", "ball_in_front_after_turn_until_kick", "ball_in_front_until_kick"),
    ("BallCloseAtKick", "ball_close_at_kick", "ball_close_at_kick"),
    ("AlwaysIR", "always_ir", "always_ir"),
    ("GoToGoalUntilInRange", "go_to_goal_until_in_range", "goto_goal_until_in_range"),
    ("EventuallyKicksToGoal", "eventually_kicks_to_goal", "eventually_kicks"),
];

/// What a monitor calls an event of `soccer.rv`: there the diagram says what states are entered, in the thesis a call of a condition of its class
/// `StateCheck` does.
fn in_the_thesis(name: &str) -> Vec<String> {
    let states = [
        ("turn_to_ball", "turn_to_ball_state_true"),
        ("turn_to_goal", "turn_to_goal_state_true"),
        ("dribble_to_goal", "dribble_ball_state_true"),
        ("kick_ball_to_goal", "kick_ball_state_true"),
    ];
    match states.iter().find(|(state, _)| format!("entered({DIAGRAM}.{state})") == name) {
        Some((_, event)) => vec![(*event).to_owned()],
        // Appendix M calls it `kick_ball`.
        None if name == "kick_ball_after" => vec![name.to_owned(), "kick_ball".to_owned()],
        None => vec![name.to_owned()],
    }
}

/// A match as a recording of the events of the monitors, by their names, with what the functions returned.
fn recording(happenings: &[Happening]) -> String {
    let events = happenings.iter().flat_map(|h| in_the_thesis(&h.name).into_iter().map(|name| (h.time, name)));
    let line = |(time, name): (i64, String)| {
        let result = match name.rsplit('_').next() {
            Some(result @ ("true" | "false")) => format!(",\"result\":{result}"),
            _ => String::new(),
        };
        format!("{{\"t_ns\":{time},\"event\":\"{name}\"{result}}}\n")
    };
    events.filter(|(_, name)| !name.starts_with('!')).map(line).collect()
}

#[test]
fn imported_monitors_judge_every_match_as_the_properties_do() {
    let monitors = Path::new(env!("CARGO_MANIFEST_DIR")).join("javamop");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("events.ndjson");
    let imported = PROPERTIES.map(|(name, ..)| {
        let mut sources = SourceMap::default();
        let text = fs::read_to_string(monitors.join(name).with_extension("mop")).unwrap();
        let file = sources.add(format!("{name}.mop"), text);
        let imported = import(&sources, file, Format::JavaMop, Options::default());
        assert!(!imported.lacks_something(), "{name}: {:?}", imported.diagnostics);
        imported.text
    });
    let mut violated = 0;
    for fault in std::iter::once(None).chain(Fault::ALL.map(Some)) {
        let account = player(1).play(fault, None).unwrap();
        fs::write(&path, recording(&account.happenings)).unwrap();
        for ((file, own, by_hand), text) in PROPERTIES.iter().zip(&imported) {
            let judged = checked(&format!("{file}.rv"), text, &path);
            let wanted = account.rejudged.iter().find(|j| j.name == *by_hand).unwrap();
            let [judged] = &judged[..] else { panic!("{file}: {judged:?}") };
            assert_eq!(judged.name, *own);
            assert_eq!((&judged.verdict, &judged.failed), (&wanted.verdict, &wanted.failed), "{file} with {fault:?}");
            violated += usize::from(judged.verdict == "violated");
        }
    }
    assert!(violated >= 6, "{violated} violations");
}
