//! What is known of a codel before it is called.

use std::sync::Arc;

use lapwing_genom::automata;
use lapwing_genom::model::{Codel as Declared, Component, Role};

use crate::codel::{Answer, Codel, Codels};

/// A codel of the components that run.
pub(super) struct Known {
    /// What somebody has written for it. The work of an attribute is nobody's.
    pub written: Option<Arc<dyn Codel>>,
    /// What it answers where nobody has written it: `ether` only where there is nothing else.
    pub answers: Vec<Answer>,
    /// The events that it may yield, and where each leads among what a call of it can return.
    branches: Vec<(String, usize)>,
    /// Where an exception leads.
    pub thrown: usize,
}

impl Known {
    pub fn new(codels: &Codels, component: &Component, codel: &Declared) -> Known {
        let written = codels.get(&component.name, &codel.function).filter(|_| codel.role != Role::Attribute);
        let all: Vec<String> = codel.yields().iter().map(|t| t.text()).collect();
        let goes_on = all.iter().any(|event| event != "ether");
        let answers = all.iter().filter(|event| !goes_on || *event != "ether").map(|event| Answer::event(event));
        Known {
            written: written.cloned(),
            answers: answers.collect(),
            thrown: automata::branch_of_exception(codel),
            branches: all.into_iter().filter_map(|e| Some((e.clone(), automata::branch(codel, &e)?))).collect(),
        }
    }

    /// Where an event leads; `None` where the codel does not declare it.
    pub fn branch(&self, event: &str) -> Option<usize> {
        self.branches.iter().find(|(known, _)| known == event).map(|(_, branch)| *branch)
    }
}
