//! *Traces, instants, values*: clocks, instants of ages, starts, jumps, timeouts, silence.

mod build;

use build::*;
use lapwing_check::checked::{Bound, Clock, Compare, Expr, Input, InputSource, Spec};
use lapwing_reference::{Outcome, Trace};
use lapwing_stream::{Duration, Value, Verdict};

fn timed(rows: &[(i64, &str)]) -> Trace {
    trace(rows.iter().map(|(ms, letters)| row(ms * MS, letters)).collect())
}

fn under(spec: Spec, formula: Expr, trace: &Trace) -> Outcome {
    outcomes(spec, vec![property(formula)], trace).remove(0)
}

#[test]
fn rows_with_equal_stamps_are_instants_of_their_own() {
    let outcome = on(p(), &timed(&[(0, "p"), (0, "-"), (0, "p")]));
    assert_eq!(summary(&outcome), "violated 2/1/0 0>0..0 x1");
    assert_eq!(outcome.instants, 3);
}

#[test]
fn values_hold_until_replaced() {
    let above = compare(Compare::Gt, x(), num(1.0));
    let t = trace(vec![row(0, "p"), row_x(S, 2.0), row(2 * S, "p"), row_x(3 * S, 0.0)]);
    // It starts at 1 s with the first value of x.
    assert_eq!(summary(&on(above, &t)), "violated 2/1/0 3>3..3 x1");
}

#[test]
fn a_default_is_a_value_before_the_first() {
    let mut spec = columns();
    spec.inputs[4].default = Some(Value::Num(7.0));
    let above = compare(Compare::Gt, x(), num(1.0));
    assert_eq!(summary(&under(spec, above, &rows("p p"))), "holds 2/0/0");
}

#[test]
fn a_rate_makes_instants_of_its_own() {
    let spec = || Spec { clock: Clock::Rate(2), ..columns() };
    // Instants at 0.1, 0.6, 1.1, 1.6 s; the last row lies between two of them and goes unseen.
    let t = timed(&[(100, "p"), (300, "-"), (550, "p"), (1600, "p"), (1700, "-")]);
    let outcome = under(spec(), p(), &t);
    assert_eq!((summary(&outcome), outcome.instants), ("holds 4/0/0".into(), 4));
    // All rows with the stamp of an instant are seen by it.
    let t = timed(&[(0, "-"), (0, "p"), (500, "p"), (500, "-")]);
    assert_eq!(summary(&under(spec(), p(), &t)), "violated 1/1/0 0.5>0.5..0.5 x1");
    // Thirds of a second are rounded down.
    let thirds =
        under(Spec { clock: Clock::Rate(3), ..columns() }, not(p()), &timed(&[(0, "-"), (600, "p"), (1000, "p")]));
    assert_eq!(thirds.episodes[0].began.0, 666_666_666);
    assert_eq!(thirds.failed, 2);
}

#[test]
fn between_two_instants_of_a_rate_a_deadline_is_reported_at_its_time() {
    let spec = Spec { clock: Clock::Rate(1), ..columns() };
    let f = eventually_in(within(1500 * MS), q());
    assert_eq!(summary(&under(spec, f, &timed(&[(0, "p"), (1600, "p")]))), "violated 0/1/0 0>1.5..1.5 x1");
}

#[test]
fn at_a_rate_events_count_since_the_instant_before() {
    let mut spec = Spec { clock: Clock::Rate(1), ..columns() };
    spec.events = vec![named_event("kick")];
    let t = trace(vec![row(0, "p"), occurs(200 * MS, 0), occurs(300 * MS, 0), row(2 * S, "p")]);
    let kicked = outcomes(spec.clone(), vec![property(and(p(), event(0)))], &t).remove(0);
    assert_eq!(summary(&kicked), "violated 1/2/0 0>0..0 x1 2>2..2 x1");
    let alone = outcomes(spec, vec![over(&[0], event(0))], &t).remove(0);
    assert_eq!((summary(&alone), alone.instants), ("holds 1/0/0".into(), 1));
}

/// A specification that reads the topics /a and /b, without fields.
fn topics() -> Spec {
    Spec { topics: vec![topic("/a"), topic("/b")], ..Spec::default() }
}

#[test]
fn an_age_makes_the_instant_at_which_its_comparison_changes() {
    let young = |op| compare(op, age(0), num(1.0));
    let t = trace(vec![message(0, 0), message(3 * S, 0), other(9 * S)]);
    // At the first nanosecond after 1 s, and again after the second message.
    let outcome = under(topics(), young(Compare::Le), &t);
    assert_eq!(outcome.failed, 2);
    let began: Vec<i64> = outcome.episodes.iter().map(|e| e.began.0).collect();
    assert_eq!(began, [S + 1, 4 * S + 1]);
    assert_eq!(outcome.instants, 4);
    // Strictly: at 1 s itself.
    assert_eq!(under(topics(), young(Compare::Lt), &t).episodes[0].began.0, S);
    // An equality is true for one nanosecond.
    let equal = under(topics(), young(Compare::Eq), &t);
    assert_eq!((equal.instants, equal.met), (6, 2));
}

#[test]
fn no_instant_is_made_where_there_is_one_or_where_the_trace_ends() {
    let young = || compare(Compare::Lt, num(1.0), age(0));
    // /b has that very stamp.
    let taken = trace(vec![message(0, 0), message(S + 1, 1), message(2 * S, 1)]);
    assert_eq!(under(topics(), not(young()), &taken).instants, 3);
    let ends = trace(vec![message(0, 0), other(S + 1)]);
    assert_eq!(under(topics(), not(young()), &ends).instants, 1);
    let goes_on = trace(vec![message(0, 0), other(S + 1), other(S + 2)]);
    assert_eq!(under(topics(), not(young()), &goes_on).instants, 2);
}

#[test]
fn other_properties_do_not_see_the_instants_of_an_age() {
    let t = trace(vec![message(0, 0), message(0, 1), message(3 * S, 0)]);
    let fresh = || boolean(lapwing_check::checked::Kind::Fresh(1));
    let both = outcomes(
        topics(),
        vec![property(compare(Compare::Le, age(0), num(1.0))), property(once(Bound::ALL, fresh()))],
        &t,
    );
    assert_eq!((both[0].instants, both[1].instants), (4, 2));
}

#[test]
fn frequency_counts_a_half_open_window() {
    let hz = |n| {
        let kind = lapwing_check::checked::Kind::Frequency(0, Duration::from_nanos(2 * S));
        compare(Compare::Eq, numeric(kind), num(n))
    };
    // At 2 s the message at 0 s is exactly two seconds old and no longer counts.
    let t = trace(vec![message(0, 0), message(S, 0), message(2 * S, 0)]);
    assert_eq!(summary(&under(topics(), hz(1.0), &t)), "violated 2/1/0 0>0..0 x1");
}

#[test]
fn a_jump_back_in_time_starts_everything_anew() {
    let t = timed(&[(5000, "p"), (6000, "p"), (0, "p"), (1000, "p")]);
    assert_eq!(summary(&on(p(), &t)), "holds 4/0/0");
    // What was awaited before the jump can no longer be judged.
    let awaited = on(eventually(q()), &timed(&[(5000, "p"), (0, "q")]));
    assert_eq!((awaited.verdict, awaited.cause.as_deref()), (Verdict::Inconclusive, Some("time jumped")));
    // A violation on one side is one.
    assert_eq!(on(p(), &timed(&[(5000, "-"), (0, "p")])).verdict, Verdict::Violated);
    // The past is not carried over.
    assert_eq!(on(once(Bound::ALL, p()), &timed(&[(5000, "p"), (0, "-")])).failed, 1);
    // Nor are values.
    let mixed = trace(vec![row_x(5 * S, 1.0), row(0, "p")]);
    assert_eq!(on(compare(Compare::Gt, x(), num(0.0)), &mixed).verdict, Verdict::Inconclusive);
}

#[test]
fn after_the_timeout_nothing_is_there() {
    let spec = || Spec { timeout: Some(Duration::from_nanos(2 * S)), ..columns() };
    let mut t = timed(&[(1000, "p"), (3000, "p"), (3001, "-")]);
    t.samples.insert(0, other(0));
    // t0 is that of the first row that is read.
    assert_eq!(summary(&under(spec(), p(), &t)), "holds 2/0/0");
    assert_eq!(summary(&under(spec(), eventually_in(within(2 * S), q()), &t)), "unmet 0/0/1");
}

#[test]
fn silence_for_too_long_is_inconclusive() {
    let mut spec = topics();
    spec.topics[0].fields = vec![vec![]];
    spec.inputs = vec![Input {
        label: "a".into(),
        source: InputSource::Field { topic: 0, field: 0 },
        ty: lapwing_stream::Type::Bool,
        dim: Default::default(),
        default: None,
        stale: Some(Duration::from_nanos(2 * S)),
    }];
    let heard = |at: &[i64], end: i64| {
        let message = |ms: &i64| {
            let values = vec![Value::Bool(true)];
            (lapwing_stream::Time(ms * MS), lapwing_reference::Arrival::Message { topic: 0, values })
        };
        let mut samples: Vec<_> = at.iter().map(message).collect();
        samples.push(other(end * MS));
        trace(samples)
    };
    let a = || boolean(lapwing_check::checked::Kind::Input(0));
    assert_eq!(under(spec.clone(), a(), &heard(&[0, 2000], 4000)).verdict, Verdict::Holds);
    assert_eq!(under(spec.clone(), a(), &heard(&[0, 2001], 4000)).verdict, Verdict::Inconclusive);
    assert_eq!(under(spec.clone(), a(), &heard(&[0, 2000], 4001)).verdict, Verdict::Inconclusive);
    assert_eq!(under(spec.clone(), not(a()), &heard(&[0], 4001)).verdict, Verdict::Violated);
    let lost = Trace { lost: vec![(0, "a chunk of /a is damaged".into())], ..heard(&[0], 1) };
    assert_eq!(under(spec, a(), &lost).cause.as_deref(), Some("a chunk of /a is damaged"));
}

#[test]
fn what_reads_a_lost_topic_is_inconclusive_however_it_reads_it() {
    let t = Trace { lost: vec![(1, "two chunks are damaged".into())], ..trace(vec![message(0, 0), message(0, 1)]) };
    let young = |n| compare(Compare::Lt, age(n), num(9.0));
    assert_eq!(under(topics(), young(0), &t).verdict, Verdict::Holds);
    assert_eq!(under(topics(), young(1), &t).verdict, Verdict::Inconclusive);
    let mut spec = topics();
    let source = lapwing_check::checked::EventSource::Message { topic: 1 };
    spec.events = vec![lapwing_check::checked::Event { source, ..named_event("b") }];
    assert_eq!(outcomes(spec, vec![over(&[0], event(0))], &t).remove(0).verdict, Verdict::Inconclusive);
}
