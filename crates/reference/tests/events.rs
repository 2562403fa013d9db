//! *Events and state diagrams*: alphabets, fields, slices, machines.

mod build;

use build::*;
use lapwing_check::checked::*;
use lapwing_reference::{Arrival, Outcome, Trace};
use lapwing_stream::{Duration, Time, Type, Value, Verdict};

/// Events a and b without fields, kick with a number.
fn events() -> Spec {
    let power = EventField { path: vec![Step::Field("power".into())], wanted: None, ty: Type::Num { float: true } };
    let kick = Event { fields: vec![power], ..named_event("kick") };
    Spec { events: vec![named_event("a"), named_event("b"), kick], ..Spec::default() }
}

fn judge(property: Property, t: &Trace) -> Outcome {
    outcomes(events(), vec![property], t).remove(0)
}

#[test]
fn a_property_over_events_steps_only_where_one_occurs() {
    let t = trace(vec![occurs(0, 0), occurs(S, 2), occurs(2 * S, 1), other(3 * S)]);
    let outcome = judge(over(&[0, 1], always(event(0))), &t);
    assert_eq!((summary(&outcome), outcome.instants), ("violated 1/1/0 2>2..2 x1".into(), 2));
    // Without the other event it could never fail.
    assert_eq!(summary(&judge(over(&[0], always(event(0))), &t)), "holds 1/0/0");
    assert_eq!(summary(&judge(over(&[0, 1], next(event(1))), &t)), "satisfied 1/0/0");
}

#[test]
fn without_a_position_what_needs_something_is_unmet() {
    let t = trace(vec![other(0), other(S)]);
    let verdict = |f: Expr| judge(over(&[0, 1], f), &t).verdict;
    for unmet in [
        eventually(event(0)),
        eventually_in(within(100 * S), event(0)),
        next(event(0)),
        until(event(0), event(1)),
        until_scope(event(0), event(1)),
        and(event(0), always(event(1))),
    ] {
        assert_eq!(verdict(unmet.clone()), Verdict::Unmet, "{unmet:?}");
    }
    for holds in [
        event(0),
        always(event(0)),
        before(event(0), event(1)),
        after(event(0), event(1)),
        whenever(event(0), event(1)),
        not(eventually(event(0))),
        implies(event(0), eventually(event(1))),
    ] {
        assert_eq!(verdict(holds.clone()), Verdict::Holds, "{holds:?}");
    }
}

#[test]
fn a_field_is_there_only_with_its_event() {
    let strong = |op| compare(op, field(2, 0), num(3.0));
    let t = trace(vec![occurs_with(0, 2, 5.0), occurs(S, 0), occurs_with(2 * S, 2, 1.0)]);
    assert_eq!(summary(&judge(over(&[0, 2], strong(Compare::Gt)), &t)), "violated 1/2/0 1>1..2 x2");
    // Every comparison is false where the event does not occur.
    assert_eq!(summary(&judge(over(&[0, 2], strong(Compare::Ne)), &t)), "violated 2/1/0 1>1..1 x1");
    // Before the first position there is none.
    let before = compare(Compare::Ne, lookback(field(2, 0), 1), num(3.0));
    assert_eq!(summary(&judge(over(&[0, 2], before), &t)), "violated 1/2/0 0>0..0 x1 2>2..2 x1");
}

#[test]
fn an_event_occurs_only_under_its_condition() {
    let mut spec = events();
    spec.events[2].when = Some(compare(Compare::Gt, field(2, 0), num(3.0)));
    let t = trace(vec![occurs_with(0, 2, 5.0), occurs_with(S, 2, 1.0)]);
    let outcome = outcomes(spec, vec![over(&[2], event(2))], &t).remove(0);
    assert_eq!((summary(&outcome), outcome.instants), ("holds 1/0/0".into(), 1));
}

#[test]
fn a_message_can_be_an_event() {
    let mut spec = events();
    spec.topics = vec![Topic { fields: vec![vec![Step::Field("data".into())]], ..topic("/kick") }];
    let data = EventField { path: vec![Step::Field("data".into())], wanted: Some(0), ty: Type::Bool };
    spec.events[0] = Event {
        name: "kicked".into(),
        source: EventSource::Message { topic: 0 },
        fields: vec![data],
        when: Some(boolean(Kind::EventField { event: 0, field: 0 })),
    };
    let said = |ms: i64, b: bool| (Time(ms * MS), Arrival::Message { topic: 0, values: vec![Value::Bool(b)] });
    let t = trace(vec![said(0, false), said(100, true), occurs(S, 1)]);
    let outcome = outcomes(spec, vec![over(&[0, 1], eventually(and(event(0), next(event(1)))))], &t).remove(0);
    assert_eq!((summary(&outcome), outcome.instants), ("satisfied 1/0/0".into(), 2));
}

/// `for each k of kick.power: φ`
fn sliced(property: Property) -> Property {
    let slice = Slice { event: 2, field: vec![Step::Field("power".into())], fields: vec![(2, 0)] };
    Property { slices: vec![slice], ..property }
}

#[test]
fn a_slice_has_an_instance_per_value_and_starts_with_the_trace() {
    let t = trace(vec![occurs_with(0, 2, 1.0), occurs(S, 0), occurs_with(2 * S, 2, 2.5), occurs_with(3 * S, 2, 1.0)]);
    let all = outcomes(events(), vec![sliced(over(&[0, 2], whenever(event(2), next(event(0)))))], &t);
    let shown: Vec<(String, String)> = all.iter().map(|o| (o.name.clone(), summary(o))).collect();
    // Under 1: kick, a, kick. Under 2.5: a, kick.
    assert_eq!(
        shown,
        [("it[1]".to_string(), "holds 2/0/1".to_string()), ("it[2.5]".to_string(), "holds 1/0/1".to_string())]
    );
    let param = compare(Compare::Eq, field(2, 0), numeric(Kind::Param(0)));
    let same = outcomes(events(), vec![sliced(over(&[2], param))], &t);
    assert!(same.iter().all(|o| o.verdict == Verdict::Holds));
}

#[test]
fn no_value_is_one_inconclusive_result() {
    let t = trace(vec![occurs(0, 0)]);
    let all = outcomes(events(), vec![sliced(over(&[2], event(2)))], &t);
    assert_eq!(all.len(), 1);
    assert_eq!((all[0].name.as_str(), all[0].verdict), ("it", Verdict::Inconclusive));
}

/// States idle (no condition), go (when p), end (on event 0), edges idle -> go, go -> end.
fn machine(else_stay: bool) -> Spec {
    let state = |name: &str| State { name: name.into(), when: None, on: None, at_most: None, at_least: None };
    let edge = |from, to| Edge { from, to, on: None, when: None };
    let mut spec = columns();
    spec.events = vec![
        named_event("stop"),
        Event { source: EventSource::Entered { machine: 0, state: 1 }, ..named_event("entered") },
        Event { source: EventSource::Left { machine: 0, state: 1 }, ..named_event("left") },
    ];
    spec.machines = vec![Machine {
        name: "m".into(),
        sample: None,
        initial: 0,
        states: vec![state("idle"), State { when: Some(p()), ..state("go") }, State { on: Some(0), ..state("end") }],
        else_stay,
        edges: vec![edge(0, 1), edge(1, 2)],
        reads: vec![Read { what: ReadOf::Input(0), depth: 0 }],
        alphabet: None,
    }];
    spec
}

fn of_machine() -> Property {
    Property { body: Body::Machine(0), name: "m".into(), ..property(p()) }
}

fn in_state(state: Option<usize>) -> Expr {
    boolean(Kind::InState { machine: 0, state })
}

#[test]
fn a_move_along_an_edge_is_met_and_any_other_fails() {
    let t = trace(vec![row(0, "-"), row(S, "p"), row(2 * S, "p"), row(3 * S, "-"), occurs(4 * S, 0), row(5 * S, "p")]);
    // idle, go at 1 s; staying at 3 s; end at 4 s; from end to go there is no edge.
    let outcome = outcomes(machine(true), vec![of_machine()], &t).remove(0);
    assert_eq!(summary(&outcome), "violated 2/1/0 5>5..5 x1");
}

#[test]
fn without_else_stay_no_true_condition_is_undefined() {
    let t = trace(vec![row(0, "-"), row(S, "p"), row(2 * S, "-"), row(3 * S, "-"), row(4 * S, "p")]);
    let undefined = property(not(in_state(None)));
    let all = outcomes(machine(false), vec![of_machine(), Property { machines: vec![0], ..undefined }], &t);
    // Once per stretch, and the way out is neither met nor failed.
    assert_eq!(summary(&all[0]), "violated 1/1/0 2>2..2 x1");
    assert_eq!(all[1].failed, 2);
}

#[test]
fn a_machines_moves_are_events_and_its_state_is_seen_at_the_same_instant() {
    let t = trace(vec![row(0, "-"), row(S, "p"), row(2 * S, "-"), occurs(3 * S, 0), row(4 * S, "-")]);
    let entering = whenever(event(1), in_state(Some(1)));
    let all = outcomes(
        machine(true),
        vec![property(and(p(), entering)), over(&[1, 2], eventually(and(event(1), next(event(2)))))],
        &t,
    );
    assert_eq!(all[0].entered, [1]);
    // entered at 1 s, left at 3 s: two positions.
    assert_eq!((summary(&all[1]), all[1].instants), ("satisfied 1/0/0".into(), 2));
}

#[test]
fn stays_can_be_too_long_and_too_short() {
    let mut spec = machine(true);
    spec.machines[0].states[1].at_most = Some(Duration::from_nanos(2 * S));
    spec.machines[0].states[1].at_least = Some(Duration::from_nanos(S));
    let judged = |end| {
        let samples = vec![row(0, "-"), row(S, "p"), row(S + MS, "-"), end];
        summary(&outcomes(spec.clone(), vec![of_machine()], &trace(samples)).remove(0))
    };
    // go is entered at 1 s: leaving at 3 s is in time, later is not.
    assert_eq!(judged(occurs(3 * S, 0)), "holds 2/0/0");
    assert_eq!(judged(occurs(3 * S + 1, 0)), "violated 2/1/0 1>3..3 x1");
    assert_eq!(judged(other(3 * S)), "unmet 1/0/1");
    assert_eq!(judged(other(2 * S)), "holds 1/0/1");
    assert_eq!(judged(occurs(1500 * MS, 0)), "violated 2/1/0 1.5>1.5..1.5 x1");
}

#[test]
fn sampling_decides_when_a_machine_looks() {
    let mut spec = machine(true);
    // It looks only when both p and q got a value since the last look, which every row gives, and r holds.
    let updated = |n| boolean(Kind::Updated(vec![n]));
    spec.machines[0].sample = Some(and(and(updated(0), updated(1)), r()));
    spec.machines[0].reads.push(Read { what: ReadOf::Input(2), depth: 0 });
    let t = trace(vec![row(0, "-"), row(S, "p"), row(2 * S, "pr"), occurs(3 * S, 0)]);
    let outcome = outcomes(spec, vec![of_machine()], &t).remove(0);
    // At 3 s nothing got a value: the event goes unseen.
    assert_eq!(summary(&outcome), "holds 1/0/0");
}

#[test]
fn an_edge_needs_its_event_and_its_condition() {
    let mut spec = machine(true);
    spec.machines[0].edges[0].when = Some(q());
    spec.machines[0].reads.push(Read { what: ReadOf::Input(1), depth: 0 });
    let judged = |t: &Trace| outcomes(spec.clone(), vec![of_machine()], t).remove(0).verdict;
    assert_eq!(judged(&rows("- pq")), Verdict::Holds);
    assert_eq!(judged(&rows("- p")), Verdict::Violated);
}

#[test]
fn a_machine_over_an_age_steps_at_its_instants_and_so_do_its_readers() {
    let mut spec = machine(true);
    spec.topics = vec![topic("/a")];
    spec.machines[0].states[1].when = Some(compare(Compare::Gt, age(0), num(1.0)));
    spec.machines[0].reads = vec![Read { what: ReadOf::Topic(0), depth: 0 }];
    let t = trace(vec![message(0, 0), message(3 * S, 0), other(4 * S)]);
    let reader =
        Property { machines: vec![0], reads: spec.machines[0].reads.clone(), ..property(not(in_state(Some(1)))) };
    let all = outcomes(spec, vec![of_machine(), reader, over(&[1], event(1))], &t);
    assert_eq!(summary(&all[0]), "holds 1/0/0");
    assert_eq!(all[1].episodes[0].began, Time(S + 1));
    assert_eq!((all[2].met, all[2].instants), (1, 1));
}
