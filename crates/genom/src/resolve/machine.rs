//! State machines: where each transition leads, and whether every state makes sense.

use std::collections::BTreeMap;

use lapwing_diag::{Code, Diagnostic};

use super::Resolver;
use crate::ast;
use crate::model::{Codel, CodelId, Component, Owner, Role, Target, Transition};
use lapwing_diag::suggest::{listed, nearest};

impl Resolver<'_> {
    /// Looks up what the codels from `first` on yield. `written` are the same codels as they were written.
    pub(super) fn machine(&mut self, component: &mut Component, owner: Owner, first: usize, written: &[&ast::Codel]) {
        let states = self.states(component, first, written);
        let mut complete = true;
        for (number, codel) in written.iter().enumerate() {
            let transitions: Vec<Transition> =
                codel.yields.iter().filter_map(|event| self.transition(&states, event)).collect();
            complete &= transitions.len() == codel.yields.len();
            if let Some(Codel { role: Role::State { yields, .. }, .. }) = component.codels.get_mut(first + number) {
                *yields = transitions;
            }
        }
        let codels: Vec<&Codel> = component.codels.iter().skip(first).collect();
        let start = states.get("start").copied();
        if let (Owner::Service(service), None, false) = (owner, start, codels.is_empty()) {
            let service = component.services.get(service.0);
            let span = service.map(|s| s.span).unwrap_or_default();
            let message =
                format!("the activity `{}` has no codel for `start`, where it begins", service.map_or("", |s| &s.name));
            self.report(
                Diagnostic::new(Code::MissingStart, span, message).help("write `codel<start> function(…) yield …;`"),
            );
        }
        // Where a transition leads nowhere, or there is no beginning, what cannot be reached says nothing new.
        if complete && (start.is_some() || matches!(owner, Owner::Task(_))) {
            self.reached(&codels, first, &states);
        }
        if let Some(stop) = states.get("stop").filter(|_| complete) {
            self.ends(&codels, first, *stop);
        }
    }

    /// The codel of each event.
    fn states(&mut self, component: &Component, first: usize, written: &[&ast::Codel]) -> BTreeMap<String, CodelId> {
        let mut states: BTreeMap<String, CodelId> = BTreeMap::new();
        for (number, codel) in written.iter().enumerate() {
            let id = CodelId(first + number);
            for trigger in &codel.triggers {
                let name = &trigger.name;
                if trigger.pause || name.name == "ether" {
                    let what = if trigger.pause { "a pause" } else { "`ether`, the end," };
                    let message = format!("{what} is no event upon which a codel is called");
                    self.report(Diagnostic::new(Code::UnknownEvent, name.span, message));
                } else if let Some(other) = states.get(&name.name).and_then(|other| component.codels.get(other.0)) {
                    let message = format!("two codels are called upon `{}`", name.name);
                    self.report(
                        Diagnostic::new(Code::DuplicateName, name.span, message).also(other.span, "the other one"),
                    );
                } else {
                    states.insert(name.name.clone(), id);
                }
            }
        }
        states
    }

    fn transition(&mut self, states: &BTreeMap<String, CodelId>, event: &ast::Event) -> Option<Transition> {
        let (name, span) = (&event.name.name, event.name.span);
        if name == "ether" && event.pause {
            let message = "an activity cannot pause and end at once";
            self.report(
                Diagnostic::new(Code::PauseEther, span, message)
                    .help("write `ether`; or pause in a state that yields `ether`"),
            );
            return None;
        }
        let to = match states.get(name) {
            _ if name == "ether" => Target::Ether,
            Some(codel) => Target::Codel(*codel),
            None => {
                let names = || states.keys().map(String::as_str).chain(["ether"]);
                let help = match nearest(name, names()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("the events are {}", listed(names())),
                };
                self.report(
                    Diagnostic::new(Code::UnknownEvent, span, format!("no codel is called upon `{name}`")).help(help),
                );
                return None;
            }
        };
        Some(Transition { pause: event.pause, event: name.clone(), to, span })
    }

    /// Every state can be reached from `start` or `stop`.
    fn reached(&mut self, codels: &[&Codel], first: usize, states: &BTreeMap<String, CodelId>) {
        let roots = ["start", "stop"].iter().filter_map(|name| states.get(*name)).copied();
        let mut reached = vec![false; codels.len()];
        let mut waiting: Vec<CodelId> = roots.collect();
        while let Some(next) = waiting.pop() {
            let Some(mark) = next.0.checked_sub(first).and_then(|n| reached.get_mut(n)).filter(|mark| !**mark) else {
                continue;
            };
            *mark = true;
            waiting.extend(targets(codels, first, next));
        }
        for (number, codel) in codels.iter().enumerate().filter(|(number, _)| reached.get(*number) == Some(&false)) {
            // That one has no event of its own was said.
            if !states.values().any(|state| state.0 == first + number) {
                continue;
            }
            let message = format!("no way leads to `{}` from `start` or `stop`", codel.label());
            let help = "let a codel yield it, or remove it";
            self.report(Diagnostic::new(Code::UnreachableCodel, codel.span, message).help(help));
        }
    }

    /// A way leads from `stop` to `ether`: without one an interrupted activity would never end.
    fn ends(&mut self, codels: &[&Codel], first: usize, stop: CodelId) {
        let mut seen = vec![false; codels.len()];
        let mut waiting = vec![stop];
        while let Some(next) = waiting.pop() {
            let Some(mark) = next.0.checked_sub(first).and_then(|n| seen.get_mut(n)).filter(|mark| !**mark) else {
                continue;
            };
            *mark = true;
            let Some(codel) = codels.get(next.0 - first) else { continue };
            if codel.yields().iter().any(|t| t.to == Target::Ether) {
                return;
            }
            waiting.extend(targets(codels, first, next));
        }
        if let Some(codel) = codels.get(stop.0 - first) {
            let message = "no way leads from `stop` to `ether`: once interrupted, this would never end";
            let help = "let `stop`, or a state that it leads to, yield `ether`";
            self.report(Diagnostic::new(Code::StopWithoutEther, codel.span, message).help(help));
        }
    }
}

fn targets(codels: &[&Codel], first: usize, from: CodelId) -> Vec<CodelId> {
    let codel = from.0.checked_sub(first).and_then(|n| codels.get(n));
    let yields = codel.map_or(&[][..], |c| c.yields());
    let target = |transition: &Transition| match transition.to {
        Target::Codel(codel) => Some(codel),
        Target::Ether => None,
    };
    yields.iter().filter_map(target).collect()
}
