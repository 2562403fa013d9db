//! Values of expressions at moments that are made up.

use lapwing_check::checked::{self, Body, Expr, Kind};
use lapwing_stream::{Time, Value};

use super::{condition, eval};
use crate::moment::{Fixed, Kept, Moment};
use crate::ring::{Ring, Source};
use crate::trail::{Positions, Trail};

/// The condition of a property `never CONDITION` over the columns `a` and `b`.
struct Judged {
    condition: Expr,
    positions: Positions,
    /// The columns in the order of the signals: `a` is 0.
    columns: Vec<usize>,
}

fn judged(text: &str) -> Judged {
    let spec = crate::Spec::parse("t.rv", &format!("event kick\nnever {text}\n"), &|_| None).unwrap();
    let columns = vec!["a".to_owned(), "b".to_owned()];
    let shape = lapwing_check::TraceShape { columns, schemaless: true, ..Default::default() };
    let meaning = spec.against(&shape).spec;
    let property = &meaning.properties[0];
    let Body::Formula(formula) = &property.body else { panic!("{text} is no formula") };
    let Kind::Always(_, not) = &formula.kind else { panic!("{text} is not judged always") };
    let Kind::Not(condition) = &not.kind else { panic!("{text} is not negated") };
    let columns = meaning.inputs.iter().map(|i| usize::from(i.label == "b")).collect();
    Judged { condition: (**condition).clone(), positions: Positions::of(&meaning, property), columns }
}

fn row(values: &[f64]) -> Fixed {
    Fixed { values: values.iter().copied().map(Value::Num).collect(), ..Fixed::default() }
}

/// The value of `never`'s condition at the last of these moments, a second apart, of which the first ones are in a ring.
fn at_the_end(text: &str, rows: &[Fixed]) -> Option<Value> {
    let Judged { condition, positions, columns } = judged(text);
    let order = |row: &Fixed| Fixed {
        values: columns.iter().map(|&c| row.value(c).clone()).collect(),
        events: row.events.clone(),
        ..Fixed::default()
    };
    let rows: Vec<Fixed> = rows.iter().map(order).collect();
    let mut kept = Kept::default();
    kept.add(&condition);
    positions.keep(&mut kept);
    let mut ring = Ring::new(kept, 0, |_| Source::Any);
    let (last, before) = rows.split_last().unwrap();
    let time = |k: usize| Time(k as i64 * 1_000_000_000);
    before.iter().enumerate().for_each(|(k, row)| ring.push(time(k), row));
    let end = time(before.len());
    let trail = Trail::new(&ring, &positions, &[], Some((last, end)));
    eval(&condition, &trail.present(last, end))
}

#[test]
fn conditions_are_true_false_or_unknown() {
    let at = row(&[3.0, -4.0]);
    for text in
        ["a > 2 and b < 0", "norm(a, b) == 5", "a - abs(b) =={0.1} -1", "a < 0 implies b > 0", "not (a < b) iff a > b"]
    {
        assert_eq!(condition(&judged(text).condition, &at), Some(true), "{text}");
    }
    let unknown = row(&[3.0]);
    assert_eq!(condition(&judged("a > 2 or a > b").condition, &unknown), Some(true));
    assert_eq!(condition(&judged("a > 2 and (a + 0 > 0 implies a > 0)").condition, &unknown), Some(true));
    assert_eq!(condition(&judged("a > 2 and b > 2").condition, &unknown), None);
}

#[test]
fn operators_over_the_past_are_worth_what_their_definitions_say() {
    let rows: Vec<Fixed> = [[0.0, 0.0], [5.0, 0.0], [1.0, 2.0], [2.0, 7.0]].iter().map(|r| row(r)).collect();
    for (text, expected) in [
        ("previously a > 0.5 and b >= 0", Some(true)),
        ("becomes b > 5", Some(true)),
        ("becomes a > 0.5", Some(false)),
        ("once a > 4 and b >= 0", Some(true)),
        ("once within 1 s a > 4", Some(false)),
        ("once within [2 s, 2 s] a > 4", Some(true)),
        ("historically a >= 0 and b >= 0", Some(true)),
        ("historically within 2 s a > 1", Some(false)),
        ("(a > 0.5) since (a > 4)", Some(true)),
        ("(b > 5) since (a > 4)", Some(false)),
        ("held for 2 s (a > 0.5)", Some(true)),
        ("held for 3 s (a > 0.5)", Some(false)),
        ("held for 4 s (a >= 0)", Some(false)),
        ("@{a, -2} == 5", Some(true)),
        ("delta(b) == 5 and rate(a) == 1", Some(true)),
        ("max_over(a, 2 s) == 5 and min_over(a, 1 s) == 1", Some(true)),
        ("mean_over(b, 1 s) == 4.5", Some(true)),
        ("count(a > 0.5, 10 s) == 3", Some(true)),
    ] {
        assert_eq!(at_the_end(text, &rows), expected.map(Value::Bool), "{text}");
    }
}

#[test]
fn what_is_no_longer_kept_is_not_guessed() {
    let rows: Vec<Fixed> = (0..1500).map(|k| row(&[f64::from(u8::from(k == 0)), 1.0])).collect();
    assert_eq!(at_the_end("once a > 0", &rows), None);
    assert_eq!(at_the_end("historically b > 0", &rows), None);
    assert_eq!(at_the_end("historically b > 2", &rows), Some(Value::Bool(false)));
    assert_eq!(at_the_end("held for 20 s (b > 0)", &rows), Some(Value::Bool(true)));
}

#[test]
fn what_an_event_carries_is_there_only_when_it_occurs() {
    let with = |kick: Option<f64>| Fixed { events: vec![kick.map(|p| vec![Value::Num(p)])], ..row(&[1.0, 1.0]) };
    assert_eq!(at_the_end("kick and kick.power > 2", &[with(Some(3.0))]), Some(Value::Bool(true)));
    assert_eq!(at_the_end("kick.power < 2 or kick", &[with(Some(3.0)), with(None)]), Some(Value::Bool(false)));
    // Positions of a property over events alone are those at which they occur.
    let rows = [with(Some(1.0)), with(None), with(Some(3.0))];
    assert_eq!(at_the_end("previously kick.power == 1", &rows), Some(Value::Bool(true)));
}

#[test]
fn a_machine_has_a_state() {
    let at = Fixed { states: vec![Some(1)], ..Fixed::default() };
    let is = |state| Expr {
        kind: Kind::InState { machine: 0, state },
        ty: lapwing_stream::Type::Bool,
        dim: checked::Dim::default(),
        span: Default::default(),
    };
    assert_eq!([Some(1), Some(0), None].map(|s| condition(&is(s), &at)), [true, false, false].map(Some));
}
