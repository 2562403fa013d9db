//! What is shown while a run goes on: how things stand, and what the signals did since the look before.

use lapwing::live::{ClockChoice, LiveOptions, StateNow, View};
use lapwing_react::history::Shape;
use lapwing_stream::Time;

use crate::script::{Over, Script, at, watch_as};

const CALM: &str = "decl speed /speed Float64.data\ncalm: never speed > 2\n";

fn watched(spec: &str, script: Script) -> Over {
    watch_as(spec, script, LiveOptions { clock: ClockChoice::Wall, ..LiveOptions::default() })
}

/// All points that the views have shown of the first signal.
fn points(views: &[View]) -> Vec<(Time, f64)> {
    let curves = views.iter().flat_map(|view| &view.tracks).filter_map(|track| match &track.track.shape {
        Shape::Curve(points) => Some(points.clone()),
        _ => None,
    });
    curves.flatten().collect()
}

#[test]
fn every_view_shows_what_the_signals_did_since_the_one_before() {
    // A thousand messages a second, and one of them stands out.
    let script = Script::of(4.0).offers(0.1, 1, "/speed").keeps_saying(0.5, 3.5, 0.001, 1, 1.0).says(2.0005, 1, 7.5);
    let over = watched(CALM, script);
    let seen = points(&over.told.views);
    assert!(seen.contains(&(at(2.0005), 7.5)), "the greatest value of a stretch is kept where it was");
    assert!(seen.is_sorted_by_key(|(time, _)| *time), "nothing is shown twice");
    assert!(over.told.views.iter().all(|view| points(std::slice::from_ref(view)).len() <= 8), "a view is small");
    let last = over.told.views.last().unwrap();
    assert_eq!(last.tracks[0].id, (0, 0, 0));
    let plot = &last.properties[0].plots[0];
    assert_eq!((plot.tracks.as_slice(), plot.limits[0].value), (&[0][..], 2.0));
    over.agrees();
}

#[test]
fn views_say_how_properties_stand_and_time_goes_on_in_silence() {
    let script = Script::of(6.0).offers(0.1, 1, "/speed").says(1.0, 1, 1.0).says(2.0, 1, 3.0).says(3.0, 1, 1.0);
    let over = watched(CALM, script);
    let state = |from: f64, to: f64| {
        let views = over.told.views.iter().filter(|view| at(from) <= view.now && view.now <= at(to));
        views.map(|view| (view.properties[0].state, view.properties[0].failed)).collect::<Vec<_>>()
    };
    assert!(state(0.2, 0.9).iter().all(|s| *s == (StateNow::Waiting, 0)) && !state(0.2, 0.9).is_empty());
    assert!(state(1.3, 1.9).iter().all(|s| *s == (StateNow::Good, 0)) && !state(1.3, 1.9).is_empty());
    // It stays violated, and the number of failures says when it was.
    assert!(state(2.3, 6.0).iter().all(|s| *s == (StateNow::Violated, 1)) && state(4.0, 6.0).len() >= 4);
}

#[test]
fn a_silence_that_is_too_long_is_shown_as_blind_for_as_long_as_it_lasts() {
    let spec = CALM.replace("Float64.data", "Float64.data stale after 1 s");
    let script = Script::of(6.0).offers(0.1, 1, "/speed").says(1.0, 1, 1.0).says(4.0, 1, 1.0);
    let over = watched(&spec, script);
    let shown = |from: f64, to: f64| {
        let views: Vec<&View> =
            over.told.views.iter().filter(|view| at(from) <= view.now && view.now <= at(to)).collect();
        assert!(!views.is_empty());
        views
            .into_iter()
            .map(|view| (view.properties[0].state, view.properties[0].cause.clone(), view.topics[0].causes.clone()))
    };
    let well = (StateNow::Good, None, Vec::new());
    assert!(shown(1.3, 1.9).chain(shown(4.3, 4.9)).all(|s| s == well));
    let cause = "nothing came for longer than 1 s, its `stale after`".to_owned();
    let blind = (StateNow::Blind, Some(format!("/speed: {cause}")), vec![cause]);
    assert!(shown(2.3, 3.9).chain(shown(5.3, 5.9)).all(|s| s == blind));
}
