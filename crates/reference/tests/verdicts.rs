//! *Verdicts*: splitting, deadlines, episodes, cut-off parts, vacuity.

mod build;

use build::*;
use lapwing_reference::Trace;
use lapwing_stream::Verdict;

/// Pairs of time in milliseconds and true columns.
fn at(rows: &[(i64, &str)]) -> Trace {
    trace(rows.iter().map(|(ms, letters)| row(ms * MS, letters)).collect())
}

#[test]
fn a_deadline_waits_for_all_positions_with_its_stamp() {
    let f = || eventually_in(within(S), q());
    let twice = at(&[(0, "p"), (1000, "p"), (1000, "q")]);
    assert_eq!(summary(&on(f(), &twice)), "satisfied 1/0/0");
    let left_out = eventually_in(open(within(S)), q());
    assert_eq!(summary(&on(left_out, &twice)), "violated 0/1/0 0>1..1 x1");
}

#[test]
fn any_later_sample_decides_a_deadline_and_it_is_reported_at_the_deadline() {
    let mut t = at(&[(0, "p"), (600, "p")]);
    t.samples.push(other(1000 * MS));
    assert_eq!(summary(&on(eventually_in(within(S), q()), &t)), "unmet 0/0/1");
    assert_eq!(summary(&on(eventually_in(open(within(S)), q()), &t)), "violated 0/1/0 0>1..1 x1");
    t.samples.push(other(1000 * MS + 1));
    assert_eq!(summary(&on(eventually_in(within(S), q()), &t)), "violated 0/1/0 0>1..1 x1");
}

#[test]
fn a_conjunction_with_a_future_operator_splits() {
    // A state part at the top is one obligation at position 0; one under `always` at each.
    check(and(p(), eventually(q())), "p q", "satisfied 2/0/0");
    check(and(p(), eventually(q())), "- q", "violated 1/1/0 0>0..0 x1");
    check(always(and(p(), next(q()))), "p pq q", "violated 4/1/1 2>2..2 x1");
    // One without stays one expression, and conjunctions are grouped to the left.
    check(and(and(p(), q()), eventually(r())), "p r", "violated 1/1/0 0>0..0 x1");
    check(and(and(eventually(r()), p()), q()), "- r", "violated 1/2/0 0>0..0 x1 0>0..0 x1");
}

#[test]
fn nothing_below_other_operators_splits() {
    check(always(always(p())), "p p -", "violated 0/3/0 0>2..2 x3");
    check(whenever(p(), and(q(), eventually(r()))), "pq p r", "violated 2/1/0 1>1..1 x1");
    check(or(always(p()), always(q())), "p q", "violated 0/1/0 0>1..1 x1");
    check(eventually(and(p(), next(q()))), "- p q", "satisfied 1/0/0");
}

#[test]
fn scopes_in_scopes_split_too() {
    // Inside each run of p: the stretch from q to r, in which s must hold.
    let f = || while_(p(), after_until(q(), r(), s()));
    check(f(), "pq p p pr -", "violated 0/3/0 0>0..2 x3");
    check(f(), "pqs ps - ps pq", "violated 2/1/0 4>4..4 x1");
    // An inner segment ends with the outer one, and its open obligations with it.
    check(while_(p(), after(q(), eventually(r()))), "p pq p - r", "violated 0/1/0 1>3..3 x1");
    check(after(p(), until_scope(r(), q())), "- pq q -", "violated 2/1/1 3>3..3 x1");
    check(while_(p(), until_scope(r(), q())), "pq pq - pqr", "violated 3/1/0 0>2..2 x1");
}

#[test]
fn under_before_every_failure_waits_for_x() {
    check(before(r(), while_(p(), q())), "p - p r", "violated 0/2/0 0>3..3 x1 2>3..3 x1");
    check(before(r(), while_(p(), q())), "p - p -", "holds 0/0/2");
    check(before(s(), before(r(), p())), "- r p s", "violated 0/1/0 0>3..3 x1");
    check(before(s(), before(r(), p())), "- p p s", "satisfied 3/0/0");
    check(before(r(), until_scope(s(), p())), "p - r", "violated 1/2/0 0>2..2 x1 1>2..2 x1");
}

#[test]
fn a_scope_with_a_future_x_is_one_obligation() {
    // X at 0 s is known at 1 s.
    check(after(next(p()), q()), "- pq q -", "violated 0/1/0 0>1..1 x1");
    check(after(next(p()), q()), "q pq q -", "violated 0/1/0 0>3..3 x1");
    check(until_scope(next(r()), p()), "p - r", "satisfied 1/0/0");
    check(until_scope(next(r()), p()), "p - - r", "violated 0/1/0 0>2..2 x1");
    check(while_(eventually_in(within(S), p()), q()), "q - - -", "holds 0/0/1");
    check(while_(eventually_in(within(S), p()), q()), "- q p - -", "violated 0/1/0 0>2..2 x1");
}

#[test]
fn whenever_with_a_future_x_still_splits() {
    // At the end X is unknown, but q is true all the same.
    check(whenever(next(p()), q()), "q p q", "holds 3/0/0");
    check(whenever(next(p()), q()), "- p -", "violated 1/1/1 0>1..1 x1");
}

#[test]
fn episodes_are_runs_of_consecutive_positions_of_one_conjunct() {
    let f = always(and(p(), eventually_in(within(S), q())));
    check(f, "p - - p q q", "violated 5/7/0 0>1..3 x3 1>1..2 x2 4>4..5 x2");
}

#[test]
fn an_episode_begins_with_the_obligation_that_failed_first() {
    // Where p holds q must come within 3 s, elsewhere within 1 s: what began at 1 s fails before what began at 0 s.
    let patient = and(p(), eventually_in(within(3 * S), q()));
    let hasty = and(not(p()), eventually_in(within(S), q()));
    check(always(or(patient, hasty)), "p - - - -", "violated 0/3/2 1>2..3 x3");
}

#[test]
fn what_is_cut_off_is_not_unmet() {
    check(eventually(q()), "p", "unmet 0/0/1");
    check(and(eventually(q()), eventually_in(within(S), r())), "p", "unmet 0/0/2");
    check(or(eventually_in(within(S), q()), always(p())), "-", "holds 0/0/1");
    check(not(eventually_in(within(S), q())), "-", "holds 0/0/1");
    check(next(next(p())), "- -", "holds 0/0/1");
    // The bound of the inner operator reaches beyond the end, the outer one has none.
    check(eventually(eventually_in(within(S), q())), "p", "holds 0/0/1");
    check(eventually(and(p(), eventually(q()))), "p", "unmet 0/0/1");
}

#[test]
fn a_recording_that_broke_off_is_never_unmet() {
    let broken = Trace { broke_off: Some("the file ends within a chunk".into()), ..rows("p p") };
    let outcome = on(eventually(q()), &broken);
    assert_eq!(outcome.verdict, Verdict::Inconclusive);
    assert_eq!(outcome.cause.as_deref(), Some("the file ends within a chunk"));
    assert_eq!(on(p(), &broken).verdict, Verdict::Holds);
    assert_eq!(on(q(), &broken).verdict, Verdict::Violated);
}

#[test]
fn satisfied_means_that_nothing_can_be_added() {
    let verdict = |f, text: &str| on(f, &rows(text)).verdict;
    assert_eq!(verdict(before(r(), p()), "p"), Verdict::Holds);
    assert_eq!(verdict(before(r(), eventually(p())), "p"), Verdict::Satisfied);
    assert_eq!(verdict(after(r(), eventually(p())), "p"), Verdict::Holds);
    assert_eq!(verdict(after(r(), eventually(p())), "r p"), Verdict::Satisfied);
    assert_eq!(verdict(while_(r(), eventually(p())), "rp -"), Verdict::Holds);
    assert_eq!(verdict(and(eventually(p()), next(q())), "p q"), Verdict::Satisfied);
    assert_eq!(verdict(and(eventually(p()), always(q())), "pq q"), Verdict::Holds);
}

#[test]
fn entries_are_counted_where_the_table_looks() {
    let entered = |f, text: &str| {
        let outcome = on(f, &rows(text));
        (outcome.vacuous, outcome.entered)
    };
    assert_eq!(entered(whenever(p(), q()), "- - -"), (true, vec![0]));
    assert_eq!(entered(whenever(p(), q()), "pq - pq"), (false, vec![2]));
    assert_eq!(entered(after(p(), q()), "- - -"), (true, vec![0]));
    assert_eq!(entered(before(r(), p()), "p p"), (true, vec![0]));
    assert_eq!(entered(before(r(), p()), "r"), (false, vec![1]));
    assert_eq!(entered(after_until(p(), r(), q()), "pr - pq r pr"), (false, vec![3]));
    assert_eq!(entered(while_(p(), q()), "pq pq - pq"), (false, vec![2]));
    // A scope inside one that was never entered was not triggered either.
    assert_eq!(entered(after(p(), whenever(q(), r())), "q q"), (true, vec![0, 0]));
    assert_eq!(entered(after(p(), whenever(q(), r())), "q p -"), (true, vec![1, 0]));
    assert_eq!(entered(after(p(), whenever(q(), r())), "q p qr"), (false, vec![1, 1]));
    // Below `next`, one position on; under a bound, where the bound looks; past the decision too.
    assert_eq!(entered(next(whenever(p(), q())), "p -"), (true, vec![0]));
    assert_eq!(entered(always_in(within(S), after(p(), q())), "- - pq"), (false, vec![1]));
    assert_eq!(entered(or(eventually(q()), whenever(p(), q())), "q - p"), (false, vec![1]));
    // A violation is not vacuous.
    assert_eq!(entered(and(q(), whenever(p(), q())), "- -"), (false, vec![0]));
}

#[test]
fn what_never_starts_is_inconclusive_and_says_why() {
    let outcome = on(compare(lapwing_check::checked::Compare::Gt, x(), num(1.0)), &rows("p p"));
    assert_eq!(outcome.verdict, Verdict::Inconclusive);
    assert_eq!(outcome.cause.as_deref(), Some("no value of x"));
    assert_eq!(on(lookback(p(), 3), &rows("p p")).verdict, Verdict::Inconclusive);
    let nothing = on(p(), &Trace::default());
    assert_eq!((nothing.verdict, nothing.instants), (Verdict::Inconclusive, 0));
}

#[test]
fn a_problem_is_inconclusive_from_the_start() {
    let mut broken = property(p());
    broken.problem = Some("no topic /scna; there is /scan".into());
    let outcome = outcomes(columns(), vec![broken], &rows("-")).remove(0);
    assert_eq!(summary(&outcome), "inconclusive 0/0/0");
    assert_eq!(outcome.cause.as_deref(), Some("no topic /scna; there is /scan"));
}

#[test]
fn from_a_text_where_a_number_belongs_on_nothing_is_judged() {
    use lapwing_check::checked::Compare;
    let low = || compare(Compare::Lt, x(), num(5.0));
    let text = trace(vec![row_x(0, 1.0), row_x(S, "three")]);
    assert_eq!(on(low(), &text).verdict, Verdict::Inconclusive);
    let high_before = trace(vec![row_x(0, 9.0), row_x(S, "three")]);
    assert_eq!(on(low(), &high_before).verdict, Verdict::Violated);
    assert_eq!(on(not(compare(Compare::Gt, x(), num(5.0))), &text).verdict, Verdict::Inconclusive);
    assert_eq!(on(or(low(), not(low())), &text).verdict, Verdict::Inconclusive);
}
