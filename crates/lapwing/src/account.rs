//! From the outcomes of the engine to what a report says of each property.

use std::collections::BTreeMap;

use lapwing_check::checked::{self, Body, Expr, Kind};
use lapwing_engine::{Episode, Outcome};
use lapwing_react::{Obligations, Property, Scope, Violation};
use lapwing_stream::{Time, Verdict};

use crate::hints;
use crate::instance::{self, Instance};
use crate::losses::Damage;
use crate::spec::Spec;
use crate::witness::Found;
use crate::words;

/// A property of which nothing is known yet but the text.
pub(crate) fn blank(spec: &Spec, meaning: &checked::Spec, property: &checked::Property) -> Property {
    let place = (property.line, spec.position(property.span).1);
    Property {
        cause: property.problem.clone(),
        scopes: scopes(spec, property),
        reactions: reactions(meaning, &property.name),
        ..Property::new(&property.name, spec.name(), place, &property.text)
    }
}

/// The failures that were noted, by what tells an episode from others.
pub(crate) struct Notes<'f> {
    by_episode: BTreeMap<(Instance, Time, Time), Vec<&'f Found>>,
}

impl<'f> Notes<'f> {
    /// Sorts the failures.
    pub fn new(found: &'f [Found]) -> Notes<'f> {
        let mut by_episode: BTreeMap<_, Vec<&Found>> = BTreeMap::new();
        for one in found.iter().rev() {
            let key = (Instance::of(one.property, &one.instance), one.violation.failed, one.violation.began);
            by_episode.entry(key).or_default().push(one);
        }
        Notes { by_episode }
    }

    /// What is known of an episode. Two that look alike get one note each.
    fn violation(&mut self, instance: &Instance, episode: Episode) -> Violation {
        let Episode { failed, began, until, count } = episode;
        let noted = self.by_episode.get_mut(&(instance.clone(), failed, began));
        let blank =
            Violation { began, failed, until, count, values: None, began_values: None, history: Vec::new(), why: None };
        match noted.and_then(|notes| if notes.len() > 1 { notes.pop() } else { notes.last().copied() }) {
            Some(found) => Violation { until, count, ..found.violation.clone() },
            None => blank,
        }
    }
}

/// What is said of a property, or of one of its instances.
pub(crate) fn property(blank: Property, outcome: &Outcome, notes: &mut Notes<'_>) -> Property {
    let instance = Instance::of(outcome.property, &outcome.instance);
    let mut property = Property {
        name: instance::name(&blank.name, &outcome.instance),
        verdict: outcome.verdict,
        cause: outcome.cause.clone().filter(|_| outcome.verdict == Verdict::Inconclusive),
        vacuous: outcome.vacuous,
        obligations: Obligations { met: outcome.met, failed: outcome.failed, open: outcome.open },
        margin: outcome.margin,
        violations: outcome.episodes.iter().map(|e| notes.violation(&instance, *e)).collect(),
        nans: outcome.nans,
        unmet_since: outcome.unmet_since.filter(|_| outcome.verdict == Verdict::Unmet),
        ..blank
    };
    property.scopes.iter_mut().zip(&outcome.entered).for_each(|(scope, entered)| scope.entered = *entered);
    property.reactions.retain(|_| outcome.verdict == Verdict::Violated);
    property
}

/// A verdict that rests on what could not be read is none: a hole may have held anything.
pub(crate) fn doubt(property: &mut Property, damage: &Damage) {
    let is_open = !matches!(property.verdict, Verdict::Violated | Verdict::Inconclusive);
    if let (true, Some(what)) = (is_open, &damage.hole) {
        let cause = format!("a part of the recording is lost: {what}");
        (property.verdict, property.cause, property.vacuous) = (Verdict::Inconclusive, Some(cause), false);
    }
}

/// Remarks that follow from the verdict.
pub(crate) fn remark(property: &mut Property) {
    let hints = hints::of(property);
    property.hints.extend(hints);
}

/// The scopes of a property in the order of the text, as they begin there.
fn scopes(spec: &Spec, property: &checked::Property) -> Vec<Scope> {
    let mut found = Vec::new();
    if let Body::Formula(formula) = &property.body {
        gather(spec, formula, &mut found);
    }
    found
}

fn gather(spec: &Spec, e: &Expr, found: &mut Vec<Scope>) {
    let text = |e: &Expr| spec.slice(e.span).split_whitespace().collect::<Vec<_>>().join(" ");
    let begins = match &e.kind {
        Kind::Scope(scope, x, _) => Some(format!("{} {}", words::scope(*scope), text(x))),
        Kind::AfterUntil(x, y, _) => Some(format!("after_until {}, {}", text(x), text(y))),
        _ => None,
    };
    found.extend(begins.map(|text| Scope { text, entered: 0 }));
    e.children().into_iter().for_each(|c| gather(spec, c, found));
}

/// What the specification wants done on a violation of a property, in words.
pub(crate) fn reactions(meaning: &checked::Spec, name: &str) -> Vec<String> {
    let base = name.split('[').next().unwrap_or(name);
    let of_property = meaning.reactions.iter().filter(|r| r.property == base);
    of_property
        .flat_map(|r| {
            let limit = r.at_most_every.map(|d| format!(", at most every {d}")).unwrap_or_default();
            r.actions.iter().map(move |action| format!("would {action}{limit}"))
        })
        .collect()
}
