//! Where the parameters of codels lead: worked out once, so that a call only follows numbers.

use std::sync::Arc;

use lapwing_genom::model::{Codel, CodelParameter, Component, Direction, Model, Object, PortId, Type};

use crate::types::Types;

/// A codel: its function, and its parameters in the order of the specification.
pub(crate) struct Access {
    pub function: Arc<str>,
    pub parameters: Vec<Parameter>,
}

/// A parameter, and where its value is kept.
pub(crate) struct Parameter {
    pub name: Arc<str>,
    pub direction: Direction,
    /// Of a port, that of what flows.
    pub ty: Arc<Type>,
    pub place: Place,
}

/// Where a value is kept. A way is the numbers of members and elements.
pub(crate) enum Place {
    /// In the internal data.
    Ids(Vec<usize>),
    /// In the data of the service, by the number among its parameters and locals.
    Local(usize, Vec<usize>),
    /// In a port: the codel's own, and that of the component in which its content is kept.
    Port { own: PortId, kept: (usize, PortId) },
    /// The same of many ports under one name.
    Ports { own: PortId, kept: (usize, PortId) },
    /// It is a service of another component.
    Remote,
    /// There is no way to it: it is a member of a union.
    Lost,
}

impl Access {
    /// That of a codel of a component, which has a number.
    pub fn new(model: &Model, types: &Types, (number, component): (usize, &Component), codel: &Codel) -> Access {
        let one = |parameter: &CodelParameter| {
            let found = place(model, types, (number, component), codel, &parameter.object);
            let (place, ty) = found.unwrap_or((Place::Lost, Type::Text(None)));
            Parameter { name: parameter.name.as_str().into(), direction: parameter.direction, ty: Arc::new(ty), place }
        };
        Access { function: codel.function.as_str().into(), parameters: codel.parameters.iter().map(one).collect() }
    }
}

fn place(
    model: &Model,
    types: &Types,
    (number, component): (usize, &Component),
    codel: &Codel,
    object: &Object,
) -> Option<(Place, Type)> {
    Some(match object {
        Object::Ids(steps) => {
            let ids = Type::Named(component.ids?);
            let (way, ty) = types.way(&ids, steps).ok()?;
            (Place::Ids(way), ty.clone())
        }
        Object::Local(name, steps) => {
            let service = component.service_of(codel.owner)?;
            let parameter = service.parameters.iter().position(|p| p.name == *name);
            let local = || service.locals.iter().position(|l| l.name == *name);
            let (place, whole) = match parameter {
                Some(place) => (place, service.parameters.get(place)?.ty.as_ref()?),
                None => local().and_then(|at| Some((service.parameters.len() + at, &service.locals.get(at)?.ty)))?,
            };
            let (way, ty) = types.way(whole, steps).ok()?;
            (Place::Local(place, way), ty.clone())
        }
        Object::Port(own) => {
            let (own, kept) = (*own, model.origin((number, *own)));
            let port = component.ports.get(own.0)?;
            let place = if port.multiple { Place::Ports { own, kept } } else { Place::Port { own, kept } };
            (place, port.ty.clone())
        }
        Object::Remote(_) | Object::Unknown => (Place::Remote, Type::Text(None)),
    })
}
