//! Two ways to the same answer: the obligations of a formula, and the formula's own value on the whole trace.

use crate::course::{Course, Needs};
use crate::future::{End, View};
use crate::generate::{self, Case};
use crate::obligations;
use crate::piece::Piece;
use crate::truth::Truth;
use lapwing_check::checked::{Body, Expr, Spec};
use lapwing_check::{check, load};
use lapwing_diag::SourceMap;

fn spec_of(case: &Case) -> Spec {
    let mut sources = SourceMap::default();
    let text = case.text();
    let file = sources.add("case.rv", text.clone());
    let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
    check(&sources, &loaded, Some(&case.shape)).spec
}

/// `φ̂` at the first position, on a trace of which nothing more comes.
fn value(course: &Course<'_>, formula: &Expr, end: End) -> Truth {
    let view = View { end, ..course.whole() };
    if formula.has_future() {
        return course.truth(formula, 0, view);
    }
    (0..course.len()).fold(Truth::True, |all, k| all.and(course.truth(formula, k, view)))
}

#[test]
fn the_obligations_of_a_formula_say_what_the_formula_says() {
    let mut seen = 0;
    for seed in 0..600 {
        let case = generate::generate(seed, 16);
        let spec = spec_of(&case);
        for samples in case.trace(&spec).pieces(&spec) {
            let piece = Piece::new(&spec, samples);
            for property in &spec.properties {
                let Body::Formula(formula) = &property.body else { continue };
                if !property.machines.is_empty() || !property.slices.is_empty() {
                    continue;
                }
                let needs = Needs {
                    exprs: vec![formula],
                    reads: &property.reads,
                    machines: vec![],
                    alphabet: property.alphabet.as_deref(),
                    slices: vec![],
                };
                let course = Course::new(&piece, &[], &needs);
                if course.len() == 0 {
                    continue;
                }
                let judged = obligations::judge(&course, formula);
                let closed = value(&course, formula, End::At(course.len()));
                let cut = value(&course, formula, End::Cut);
                let shown = || format!("{}: {}", property.name, case.text());
                if judged.tally.failed > 0 {
                    assert_eq!(closed, Truth::False, "{}", shown());
                } else if judged.unmet {
                    assert_eq!((closed, cut), (Truth::False, Truth::False), "{}", shown());
                } else if judged.tally.open == 0 {
                    assert_eq!(closed, Truth::True, "{}", shown());
                } else {
                    assert_ne!(cut, Truth::False, "{}", shown());
                }
                seen += 1;
            }
        }
    }
    assert!(seen > 500);
}
