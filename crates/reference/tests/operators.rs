//! Every row of the table of *Temporal operators*, on traces short enough to be judged by hand.
//!
//! `rows("p pq -")` has a row a second from 0 s on, with the named columns true. Expected: verdict, obligations met/failed/open,
//! episodes `began>failed..until xcount`.

mod build;

use build::*;
use lapwing_check::checked::{Bound, Compare, Window};

#[test]
fn a_formula_without_future_operators_is_checked_at_every_position() {
    check(p(), "p p p", "holds 3/0/0");
    check(p(), "p - - p", "violated 2/2/0 1>1..2 x2");
    check(and(p(), q()), "pq p", "violated 1/1/0 1>1..1 x1");
}

#[test]
fn always_and_never_have_an_obligation_per_position() {
    check(always(p()), "p - p -", "violated 2/2/0 1>1..1 x1 3>3..3 x1");
    check(never(q()), "p p", "holds 2/0/0");
    check(never(q()), "q p", "violated 1/1/0 0>0..0 x1");
}

#[test]
fn a_bounded_always_has_obligations_where_its_bound_looks() {
    check(always_in(within(S), p()), "p p - -", "satisfied 2/0/0");
    check(always_in(within(2 * S), p()), "p p - -", "violated 2/1/0 2>2..2 x1");
    check(always_in(open(within(2 * S)), p()), "p p - -", "satisfied 2/0/0");
    check(always_in(from_to(2 * S, 3 * S), p()), "- - p p -", "satisfied 2/0/0");
    // At the deadline's own stamp another position may still come.
    check(always_in(within(2 * S), p()), "p p p", "holds 3/0/0");
    check(always_in(open(within(2 * S)), p()), "p p p", "satisfied 2/0/0");
}

#[test]
fn eventually_is_one_obligation_at_the_start() {
    check(eventually(q()), "p p q", "satisfied 1/0/0");
    check(eventually(q()), "p p p", "unmet 0/0/1");
}

#[test]
fn a_bounded_eventually_fails_at_its_deadline() {
    check(eventually_in(within(S), q()), "p q", "satisfied 1/0/0");
    check(eventually_in(within(S), q()), "p p p", "violated 0/1/0 0>1..1 x1");
    // A trace that ends with the deadline leaves it open: the bound does not reach beyond the end, so it is unmet.
    check(eventually_in(within(S), q()), "p p", "unmet 0/0/1");
    // One whose bound reaches beyond the end is cut off.
    check(eventually_in(within(2 * S), q()), "p p", "holds 0/0/1");
    // Without its upper end it is decided as soon as time reaches it, before the positions there.
    check(eventually_in(open(within(S)), q()), "p q", "violated 0/1/0 0>1..1 x1");
    check(eventually_in(from_to(S, 2 * S), q()), "q p p p", "violated 0/1/0 0>2..2 x1");
    check(eventually_in(from_to(S, 2 * S), q()), "p p q", "satisfied 1/0/0");
}

#[test]
fn next_looks_one_position_ahead() {
    check(next(q()), "p q", "satisfied 1/0/0");
    check(next(q()), "p p", "violated 0/1/0 0>1..1 x1");
    check(next(q()), "p", "holds 0/0/1");
    check(always(implies(p(), next(q()))), "p pq q -", "holds 4/0/0");
    check(always(implies(p(), next(q()))), "p p - -", "violated 2/2/0 0>1..2 x2");
    // Inside a segment there is nothing after its last position.
    check(until_scope(r(), next(next(q()))), "p p r", "violated 1/1/0 0>2..2 x1");
}

#[test]
fn until_needs_its_right_side() {
    check(until(p(), q()), "p p q -", "satisfied 1/0/0");
    check(until(p(), q()), "p - q", "violated 0/1/0 0>1..1 x1");
    check(until(p(), q()), "p p", "unmet 0/0/1");
    check(until(p(), q()), "q", "satisfied 1/0/0");
    check(until_in(within(S), p(), q()), "p p p", "violated 0/1/0 0>1..1 x1");
    check(until_in(within(2 * S), p(), q()), "p p", "holds 0/0/1");
    // The bound limits the right side only: the left one is needed from the beginning.
    check(until_in(from_to(2 * S, 3 * S), p(), q()), "p q pq -", "violated 0/1/0 0>1..1 x1");
    check(until_in(from_to(2 * S, 3 * S), p(), q()), "p pq q", "satisfied 1/0/0");
}

#[test]
fn after_latches() {
    check(after(p(), q()), "- - -", "holds 0/0/0");
    check(after(p(), q()), "- pq - q", "violated 2/1/0 2>2..2 x1");
    check(after(p(), eventually(q())), "- p - q", "satisfied 1/0/0");
    check(after(p(), eventually(q())), "q p -", "unmet 0/0/1");
}

#[test]
fn the_until_scope_needs_its_end() {
    check(until_scope(r(), p()), "p p r", "satisfied 3/0/0");
    // A failing body fails at once.
    check(until_scope(r(), p()), "p - r", "violated 2/1/0 1>1..1 x1");
    check(until_scope(r(), p()), "p p p", "unmet 3/0/1");
    check(until_scope(r(), p()), "r - -", "satisfied 1/0/0");
    // What is open in the segment fails when it closes.
    check(until_scope(r(), eventually(q())), "p p r q", "violated 1/1/0 0>2..2 x1");
}

#[test]
fn the_before_scope_fails_only_when_its_end_comes() {
    check(before(r(), p()), "p p r", "satisfied 2/0/0");
    check(before(r(), p()), "p - p r", "violated 2/1/0 1>3..3 x1");
    check(before(r(), p()), "p - p", "holds 2/0/1");
    check(before(r(), eventually(q())), "p p", "holds 0/0/1");
    check(before(r(), eventually(q())), "p q", "satisfied 1/0/0");
    check(before(r(), p()), "r", "satisfied 0/0/0");
}

#[test]
fn after_until_opens_and_closes() {
    check(after_until(p(), r(), q()), "- pq q r - pq", "holds 3/0/0");
    check(after_until(p(), r(), q()), "- pq - r p - q", "violated 2/3/0 2>2..2 x1 4>4..5 x2");
    // A further X does nothing; an empty segment counts as true, and the search goes on after it.
    check(after_until(p(), r(), eventually(q())), "pr p p q r", "holds 1/0/0");
    check(after_until(p(), r(), eventually(q())), "p - r", "violated 0/1/0 0>2..2 x1");
    check(after_until(p(), r(), eventually(q())), "p - -", "unmet 0/0/1");
    check(after_until(p(), r(), always(next(q()))), "p q r", "violated 1/1/0 1>2..2 x1");
}

#[test]
fn while_follows_each_run() {
    check(while_(p(), q()), "pq pq - pq p -", "violated 3/1/0 4>4..4 x1");
    check(while_(p(), eventually(q())), "p pq - p p - -", "violated 1/1/0 3>5..5 x1");
    check(while_(p(), eventually(q())), "p p", "unmet 0/0/1");
    check(while_(p(), q()), "- -", "holds 0/0/0");
}

#[test]
fn whenever_is_always_implies() {
    check(whenever(p(), q()), "- pq p q", "violated 3/1/0 2>2..2 x1");
    check(whenever(p(), eventually_in(within(S), q())), "p - q p q", "violated 4/1/0 0>1..1 x1");
    // One outage, one episode.
    check(whenever(p(), eventually_in(within(S), q())), "p p p - -", "violated 2/3/0 0>1..3 x3");
    // With the trigger shortly before the end the answer is cut off.
    check(whenever(p(), eventually_in(within(2 * S), q())), "- p -", "holds 2/0/1");
}

#[test]
fn previously_looks_one_position_back() {
    check(implies(q(), previously(p())), "p q", "holds 2/0/0");
    check(implies(q(), previously(p())), "q q", "violated 0/2/0 0>0..1 x2");
}

#[test]
fn becomes_is_true_where_it_begins() {
    check(implies(becomes(p()), q()), "pq p - pq p", "holds 5/0/0");
    check(implies(becomes(p()), q()), "p p - p", "violated 2/2/0 0>0..0 x1 3>3..3 x1");
}

#[test]
fn once_and_historically_look_at_the_whole_past() {
    check(once(Bound::ALL, p()), "p - -", "holds 3/0/0");
    check(once(Bound::ALL, p()), "- p -", "violated 2/1/0 0>0..0 x1");
    check(once(within(S), p()), "p - - -", "violated 2/2/0 2>2..3 x2");
    check(historically(Bound::ALL, p()), "p - p", "violated 1/2/0 1>1..2 x2");
    check(historically(within(S), p()), "- p p p", "violated 2/2/0 0>0..1 x2");
    check(once(open(within(S)), p()), "p -", "violated 1/1/0 1>1..1 x1");
    check(once(from_to(S, 2 * S), p()), "p - - -", "violated 2/2/0 0>0..0 x1 3>3..3 x1");
}

#[test]
fn since_needs_its_left_side_after_its_right() {
    check(since(Bound::ALL, p(), q()), "q p p", "holds 3/0/0");
    check(since(Bound::ALL, p(), q()), "q p - p", "violated 2/2/0 2>2..3 x2");
    check(since(within(S), p(), q()), "q p p", "violated 2/1/0 2>2..2 x1");
    check(since(Bound::ALL, p(), q()), "p q", "violated 1/1/0 0>0..0 x1");
}

#[test]
fn held_needs_its_time() {
    // True from 2 s on: at 3 s it has held for a second.
    check(implies(held(S, p()), q()), "- - p pq pq", "holds 5/0/0");
    check(implies(held(S, p()), q()), "- - p p", "violated 3/1/0 3>3..3 x1");
    // Running for less than that long is not enough.
    check(not(held(2 * S, p())), "p p", "holds 2/0/0");
    check(not(held(2 * S, p())), "p p p", "violated 2/1/0 2>2..2 x1");
    // Between two samples the value before the window counts.
    check(not(held(1500 * MS, p())), "- p p p", "violated 3/1/0 3>3..3 x1");
    check(not(held(1500 * MS, p())), "p - p p", "holds 4/0/0");
}

#[test]
fn past_operators_see_the_whole_past_inside_a_scope_too() {
    check(after(p(), once(Bound::ALL, q())), "q - p", "holds 1/0/0");
    check(while_(p(), previously(q())), "q p p", "violated 1/1/0 2>2..2 x1");
}

#[test]
fn lookback_starts_late_and_windows_see_positions_only() {
    // The property starts where what it looks at is defined: at 2 s.
    check(lookback(p(), 2), "p - -", "holds 1/0/0");
    // At its position 0 the past is empty also for what looks back before it.
    check(lookback(once(Bound::ALL, p()), 1), "p p p", "violated 1/1/0 1>1..1 x1");
    let values = trace(vec![row_x(0, 3.0), row_x(S, f64::NAN), row_x(2 * S, 5.0), row_x(5 * S, f64::NAN)]);
    let is = |e, n| compare(Compare::Eq, e, num(n));
    assert_eq!(summary(&on(eventually(is(window(Window::Mean, x(), 2 * S), 4.0)), &values)), "satisfied 1/0/0");
    assert_eq!(summary(&on(eventually(is(window(Window::Max, x(), S), 5.0)), &values)), "satisfied 1/0/0");
    // At 5 s the window holds NaN alone.
    let none = compare(Compare::Ne, window(Window::Min, x(), S), window(Window::Min, x(), S));
    assert_eq!(summary(&on(none, &values)), "violated 1/3/0 0>0..2 x3");
    let positive = compare(Compare::Gt, x(), num(0.0));
    assert_eq!(summary(&on(is(window(Window::Count, positive, 2 * S), 1.0), &values)), "violated 2/2/0 2>2..5 x2");
}

#[test]
fn kleene_decides_part_by_part() {
    check(or(always(p()), eventually(q())), "p - q", "satisfied 1/0/0");
    check(or(always(p()), eventually(q())), "p - -", "unmet 0/0/1");
    check(not(eventually(q())), "p q", "violated 0/1/0 0>1..1 x1");
    check(not(eventually(q())), "p p", "holds 0/0/1");
    check(and(next(q()), next(not(q()))), "p q", "violated 1/1/0 0>1..1 x1");
}
