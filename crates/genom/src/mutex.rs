//! Which codels exclude each other, because both use a port or the same internal data.
//!
//! Within a component the relation is GenoM3's own, which is not symmetric: a codel does not conflict with those of services that interrupt its
//! own, but they may with it. Between components it is that of Foughali et al. (MEMOCODE 2020, section II-B1): two codels that use the same port
//! exclude each other wherever they run. What the automata use is [`Mutex::symmetric`].

use crate::model::{Codel, CodelId, Component, Direction, Model, Object, Owner, PortId, Role, Step};

/// A codel of a model: the number of its component, and its own.
pub type Which = (usize, CodelId);

/// The conflicts of a model.
#[derive(Clone, Debug, Default)]
pub struct Mutex {
    /// For each component and codel, the codels that it waits for.
    all: Vec<Vec<Vec<Which>>>,
}

/// What counts as a conflict.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Rules {
    /// Codels that only read a port do not exclude each other. GenoM3 lets them.
    pub readers_share: bool,
}

impl Mutex {
    /// The conflicts of a model, both ways.
    pub fn symmetric(model: &Model, rules: Rules) -> Mutex {
        let mut all: Vec<Vec<Vec<Which>>> = model.components.iter().map(|c| vec![Vec::new(); c.codels.len()]).collect();
        let mut join = |a: Which, b: Which| {
            for (from, to) in [(a, b), (b, a)] {
                if let Some(list) =
                    all.get_mut(from.0).and_then(|codels| codels.get_mut(from.1.0)).filter(|list| !list.contains(&to))
                {
                    list.push(to);
                }
            }
        };
        for (number, component) in model.components.iter().enumerate() {
            for (id, _) in component.codels() {
                for other in conflicts(component, id, rules) {
                    join((number, id), (number, other));
                }
            }
        }
        for (a, b) in across(model, rules) {
            join(a, b);
        }
        all.iter_mut().flatten().for_each(|list| list.sort());
        Mutex { all }
    }

    /// What a codel excludes.
    pub fn of(&self, codel: Which) -> &[Which] {
        self.all.get(codel.0).and_then(|codels| codels.get(codel.1.0)).map_or(&[], Vec::as_slice)
    }

    /// Whether a codel has to wait for others at all.
    pub fn is_unsafe(&self, codel: Which) -> bool {
        !self.of(codel).is_empty()
    }
}

/// The codels of its own component that a codel waits for, in the order of their numbers: GenoM3's relation.
pub fn conflicts(component: &Component, codel: CodelId, rules: Rules) -> Vec<CodelId> {
    let Some(one) = component.codels.get(codel.0) else { return Vec::new() };
    let against =
        |(id, other): &(CodelId, &Codel)| *id != codel && may_meet(component, one, other) && share(one, other, rules);
    component.codels().filter(against).map(|(id, _)| id).collect()
}

/// Whether two codels of a component may run at the same time.
fn may_meet(component: &Component, one: &Codel, other: &Codel) -> bool {
    let (task, other_task) = (component.task_of(one), component.task_of(other));
    match (&other.role, other.owner) {
        // The control task runs one thing after the other.
        (Role::Simple | Role::Validate | Role::Attribute, _) => one.is_state(),
        (Role::State { .. }, Owner::Task(_)) => task != other_task,
        (Role::State { .. }, Owner::Service(other)) => {
            let interrupts = match one.owner {
                Owner::Service(service) => {
                    component.services.get(other.0).is_some_and(|s| s.interrupts.contains(&service))
                }
                Owner::Task(_) => false,
            };
            task != other_task && !interrupts
        }
    }
}

/// Whether two codels use a port or data together.
fn share(one: &Codel, other: &Codel, rules: Rules) -> bool {
    let clash = |a: &crate::model::CodelParameter, b: &crate::model::CodelParameter| {
        let only_read = a.direction == Direction::In && b.direction == Direction::In;
        match (&a.object, &b.object) {
            (Object::Port(a), Object::Port(b)) => a == b && !(only_read && rules.readers_share),
            (Object::Ids(a), Object::Ids(b)) => !only_read && overlap(a, b),
            _ => false,
        }
    };
    one.parameters.iter().any(|a| other.parameters.iter().any(|b| clash(a, b)))
}

/// Whether one of two paths leads to a part of the other, or to the same.
fn overlap(a: &[Step], b: &[Step]) -> bool {
    a.iter().zip(b).all(|(a, b)| a == b)
}

/// Codels of different components that use the same port.
fn across(model: &Model, rules: Rules) -> Vec<(Which, Which)> {
    let mut users: Vec<(Which, (usize, PortId), bool)> = Vec::new();
    for (number, component) in model.components.iter().enumerate() {
        for (id, codel) in component.codels() {
            for parameter in &codel.parameters {
                if let Object::Port(port) = parameter.object {
                    users.push(((number, id), model.origin((number, port)), parameter.direction == Direction::In));
                }
            }
        }
    }
    users.sort_by_key(|(which, port, _)| (*port, *which));
    let mut pairs = Vec::new();
    for group in users.chunk_by(|a, b| a.1 == b.1) {
        for (at, (a, _, a_reads)) in group.iter().enumerate() {
            for (b, _, b_reads) in group.get(at + 1..).unwrap_or_default() {
                if a.0 != b.0 && !(rules.readers_share && *a_reads && *b_reads) {
                    pairs.push((*a, *b));
                }
            }
        }
    }
    pairs
}
