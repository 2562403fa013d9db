//! *Grammar*: the margin of a property.

mod build;

use build::*;
use lapwing_check::checked::{Bound, Compare, Dim, Expr, Kind};
use lapwing_reference::Trace;

const INF: f64 = f64::INFINITY;

fn xs(values: &[f64]) -> Trace {
    trace(values.iter().enumerate().map(|(n, &x)| row_x(n as i64 * S, x)).collect())
}

fn below(limit: f64) -> Expr {
    compare(Compare::Lt, x(), num(limit))
}

fn margin(formula: Expr, values: &[f64]) -> Option<f64> {
    on(formula, &xs(values)).margin
}

#[test]
fn the_worst_position_counts() {
    assert_eq!(margin(below(5.0), &[1.0, 4.5, 2.0]), Some(0.5));
    assert_eq!(margin(below(5.0), &[1.0, 6.0]), Some(-1.0));
    assert_eq!(margin(eventually(below(5.0)), &[9.0, 6.0, 7.0]), Some(-1.0));
    assert_eq!(margin(not(below(5.0)), &[9.0, 6.0]), Some(1.0));
    assert_eq!(margin(or(below(5.0), compare(Compare::Gt, x(), num(8.0))), &[9.0, 3.0]), Some(1.0));
}

#[test]
fn every_comparison_has_its_distance() {
    let with = |op, m: f64| {
        let margin = Some(Box::new(num(m)));
        boolean(Kind::Compare { op, margin, left: Box::new(x()), right: Box::new(num(2.0)) })
    };
    assert_eq!(margin(with(Compare::Eq, 0.5), &[2.25]), Some(0.25));
    assert_eq!(margin(with(Compare::Ne, 0.5), &[2.25]), Some(-0.25));
    assert_eq!(margin(with(Compare::Le, 0.5), &[2.25]), Some(0.25));
    assert_eq!(margin(with(Compare::Ge, 0.5), &[1.75]), Some(0.25));
}

#[test]
fn nan_is_skipped_and_booleans_are_infinite() {
    assert_eq!(margin(below(5.0), &[f64::NAN, 4.0]), Some(1.0));
    assert_eq!(margin(below(5.0), &[f64::NAN]), None);
    assert_eq!(on(p(), &rows("p p")).margin, Some(INF));
    assert_eq!(on(p(), &rows("p -")).margin, Some(-INF));
    assert_eq!(margin(whenever(compare(Compare::Gt, x(), num(1.0)), below(5.0)), &[0.0, 3.0]), Some(2.0));
}

#[test]
fn past_operators_take_part() {
    assert_eq!(margin(once(Bound::ALL, below(5.0)), &[3.0, 9.0]), Some(2.0));
    assert_eq!(margin(historically(Bound::ALL, below(5.0)), &[3.0, 4.0]), Some(1.0));
    assert_eq!(margin(implies(previously(below(5.0)), below(7.0)), &[3.0, 6.0]), Some(1.0));
}

#[test]
fn different_dimensions_have_none() {
    let of = |dim| Expr { dim: Dim(Some(dim)), ..below(5.0) };
    assert_eq!(margin(and(of([1, 0, 0]), of([1, 0, 0])), &[1.0]), Some(4.0));
    assert_eq!(margin(and(of([1, 0, 0]), of([0, 1, 0])), &[1.0]), None);
}
