//! The engine equals the reference on every operator with every bound up to 3 on all boolean traces up to a length.

use xtask::agree::{Drive, agree};
use xtask::exhaustive::{around, operators, show, spec, traces};

#[test]
fn every_operator_on_every_trace_up_to_length_6() {
    for formula in operators() {
        let spec = spec(formula.clone());
        for length in 0..=6 {
            for trace in traces(length) {
                if let Err(difference) = agree(&spec, &trace, &Drive::QUICK) {
                    panic!("{}\n{trace:?}\n{difference}", show(&formula));
                }
            }
        }
    }
}

#[test]
fn every_operator_in_every_surrounding_on_every_trace_up_to_length_4() {
    for formula in operators().into_iter().flat_map(around) {
        let spec = spec(formula.clone());
        for length in 0..=4 {
            for trace in traces(length) {
                if let Err(difference) = agree(&spec, &trace, &Drive::QUICK) {
                    panic!("{}\n{trace:?}\n{difference}", show(&formula));
                }
            }
        }
    }
}
