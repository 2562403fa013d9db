//! What is known of a codel before it is called, kept together: a call looks at nothing else of the model.

use std::sync::Arc;

use lapwing_genom::automata;
use lapwing_genom::model::{Codel as Declared, Component, Role};
use lapwing_stream::Duration;

use crate::codel::{Answer, Codel, Codels};

/// A codel of the components that run.
pub(super) struct Known {
    /// What somebody has written for it. The work of an attribute is nobody's.
    pub written: Option<Arc<dyn Codel>>,
    /// What it answers where nobody has written it: `ether` only where there is nothing else.
    pub answers: Vec<Answer>,
    /// Its worst case execution time.
    pub wcet: Option<Duration>,
    /// Whether it is a state of an activity, which yields events.
    pub is_state: bool,
    /// Whether it is the work of an attribute.
    pub is_attribute: bool,
    /// Whether its task does not wait for it.
    pub is_async: bool,
    /// The events that it may yield, and where each leads among what a call of it can return.
    branches: Vec<(Arc<str>, usize)>,
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
            wcet: codel.wcet_ns.map(|ns| Duration::from_nanos(i64::try_from(ns).unwrap_or(i64::MAX))),
            is_state: codel.is_state(),
            is_attribute: codel.role == Role::Attribute,
            is_async: codel.is_async,
            thrown: automata::branch_of_exception(codel),
            branches: all.into_iter().filter_map(|e| Some((e.as_str().into(), automata::branch(codel, &e)?))).collect(),
        }
    }

    /// Where an event leads; `None` where the codel does not declare it.
    pub fn branch(&self, event: &str) -> Option<usize> {
        self.branches.iter().find(|(known, _)| **known == *event).map(|(_, branch)| *branch)
    }

    /// An answer in words.
    pub fn words(&self, answer: &Answer) -> Arc<str> {
        match answer {
            Answer::Ok => "ok".into(),
            Answer::Event(event) => {
                let declared = self.branches.iter().find(|(known, _)| **known == **event);
                declared.map_or_else(|| event.as_str().into(), |(known, _)| known.clone())
            }
            Answer::Exception(name) => format!("exception {name}").into(),
        }
    }
}
