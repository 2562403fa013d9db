//! Ground truth in a trace, as a program would hand it over: the pose of an object, and its velocities where its source tells of them.

use std::collections::BTreeMap;

use lapwing_check::checked::{ObjectSource, Part, Spec};
use lapwing_codegen::{From, Object, Setter, Vector};
use lapwing_reference::{Arrival, Delivery, Tracked};
use lapwing_stream::{Time, Value};

/// What is known of the objects of a trace so far.
#[derive(Default)]
pub struct Objects {
    tracked: BTreeMap<usize, Tracked>,
    /// What the latest arrival says of them.
    said: BTreeMap<usize, Said>,
}

struct Said {
    delivery: Delivery,
    /// Velocities as the source has them.
    twist: Option<[f64; 6]>,
}

const POSE: [Part; 7] = [
    Part::PositionX,
    Part::PositionY,
    Part::PositionZ,
    Part::QuaternionX,
    Part::QuaternionY,
    Part::QuaternionZ,
    Part::QuaternionW,
];

const TWIST: [Part; 6] = [Part::LinearX, Part::LinearY, Part::LinearZ, Part::AngularX, Part::AngularY, Part::AngularZ];

impl Objects {
    /// Something arrives.
    pub fn take(&mut self, spec: &Spec, objects: &[Object], time: Time, arrival: &Arrival) {
        self.said.clear();
        let Arrival::Message { topic, values } = arrival else { return };
        for number in objects.iter().map(|object| object.object) {
            let object = &spec.objects[number];
            let tracked = self.tracked.entry(number).or_default();
            if let Some(delivery) = tracked.deliver(object, time, *topic, values) {
                let twist = twist(&object.source, values, &delivery);
                self.said.insert(number, Said { delivery, twist });
            }
        }
    }

    /// What a function is called with, if it is called.
    pub fn handed(&self, object: &Object, setter: &Setter) -> Option<Vec<f64>> {
        let said = self.said.get(&object.object)?;
        let pose = POSE.map(|part| said.delivery.part(part));
        let twist: Vec<Option<f64>> = match setter.came {
            From::Twist(_) => said.twist?.map(Some).to_vec(),
            _ => Vec::new(),
        };
        let all: Vec<Option<f64>> = pose.into_iter().chain(twist).collect();
        setter.vectors.iter().flat_map(|vector| &all[vector.first()..vector.first() + vector.len()]).copied().collect()
    }
}

fn twist(source: &ObjectSource, values: &[Value], delivery: &Delivery) -> Option<[f64; 6]> {
    match source {
        // The reference has turned it into the world's frame.
        ObjectSource::Odometry { twist, .. } => {
            let twist = values.get(*twist)?;
            let number = |vector: &str, letter: &str| match twist.field(vector)?.field(letter)? {
                Value::Num(x) => Some(*x),
                _ => None,
            };
            let mut of = [0.0; 6];
            for (i, x) in of.iter_mut().enumerate() {
                *x = number(["linear", "angular"][i / 3], ["x", "y", "z"][i % 3])?;
            }
            Some(of)
        }
        ObjectSource::ModelStates { .. } => {
            let parts: Option<Vec<f64>> = TWIST.iter().map(|part| delivery.part(*part)).collect();
            parts?.try_into().ok()
        }
        ObjectSource::Pose { .. } | ObjectSource::Tf { .. } => None,
    }
}

/// Where each vector of a function begins among its numbers.
pub fn places(setter: &Setter) -> impl Iterator<Item = (Vector, usize)> {
    setter.vectors.iter().scan(0, |next, vector| {
        let place = *next;
        *next += vector.len();
        Some((*vector, place))
    })
}
