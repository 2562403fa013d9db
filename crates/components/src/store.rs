//! What components keep: internal data, contents of ports, and the data of services that are being served.

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_genom::model::{Component, Direction, Model, PortId, Service, Type, TypeId};
use lapwing_stream::{Duration, Time};

use crate::access::{Access, Place};
use crate::codel::{Argument, Call, Held};
use crate::datum::Datum;
use crate::types::Types;

/// What a codel has written to a port: whose, which one of several under its name, and the value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Written {
    pub port: PortId,
    pub name: Option<String>,
    pub value: Datum,
}

/// The data of a service that is being served: its parameters, and after them its locals.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Locals {
    values: Vec<Datum>,
}

impl Locals {
    /// Those of a service, with the values of a request.
    pub fn new(types: &Types, service: &Service, values: &[Datum]) -> Locals {
        let locals = service.locals.iter().map(|local| types.initial(&local.ty));
        Locals { values: values.iter().cloned().chain(locals).collect() }
    }

    /// The values of the first so many: of the parameters.
    pub fn parameters(&self, count: usize) -> &[Datum] {
        self.values.get(..count).unwrap_or(&self.values)
    }
}

/// What was last written to a port, or to each of many under one name.
#[derive(Clone, Debug, Default)]
struct Content {
    one: Option<Datum>,
    many: BTreeMap<String, Datum>,
}

/// All data of a system.
pub(crate) struct Store {
    pub types: Types,
    names: Vec<Arc<str>>,
    /// By component and codel.
    codels: Vec<Vec<Access>>,
    ids: Vec<Option<(Type, Datum)>>,
    ports: Vec<Vec<Content>>,
}

impl Store {
    /// Everything as at first.
    ///
    /// # Errors
    ///
    /// A type is too large to be kept.
    pub fn new(model: &Model) -> Result<Store, String> {
        let types = Types::new(model)?;
        let first = |ids: TypeId| (Type::Named(ids), types.initial(&Type::Named(ids)));
        let accesses = |(number, component): (usize, &Component)| {
            component.codels.iter().map(|codel| Access::new(model, &types, (number, component), codel)).collect()
        };
        Ok(Store {
            ids: model.components.iter().map(|c| c.ids.map(first)).collect(),
            ports: model.components.iter().map(|c| vec![Content::default(); c.ports.len()]).collect(),
            names: model.components.iter().map(|c| c.name.as_str().into()).collect(),
            codels: model.components.iter().enumerate().map(accesses).collect(),
            types,
        })
    }

    /// What a codel is given when it is called now.
    pub fn prepare(&self, at: (usize, usize), locals: Option<&Locals>, now: Time, is_logical: bool) -> Option<Call> {
        let access = self.codels.get(at.0)?.get(at.1)?;
        let arguments = access.parameters.iter().map(|parameter| Argument {
            name: parameter.name.clone(),
            direction: parameter.direction,
            ty: parameter.ty.clone(),
            value: self.held(at.0, &parameter.place, &parameter.ty, locals),
        });
        Some(Call {
            component: self.names.get(at.0)?.clone(),
            function: access.function.clone(),
            now,
            arguments: arguments.collect(),
            busy: Duration::default(),
            is_logical,
            types: self.types.clone(),
        })
    }

    fn held(&self, component: usize, place: &Place, ty: &Type, locals: Option<&Locals>) -> Held {
        let part = |whole: Option<&Datum>, way: &[usize]| {
            let found = whole.and_then(|whole| whole.part(way)).cloned();
            Held::Data(found.unwrap_or_else(|| self.types.initial(ty)))
        };
        match place {
            Place::Ids(way) => part(self.ids.get(component).and_then(Option::as_ref).map(|(_, ids)| ids), way),
            Place::Local(number, way) => part(locals.and_then(|l| l.values.get(*number)), way),
            Place::Port { kept, .. } => {
                Held::Port { content: self.content(*kept).and_then(|c| c.one.clone()), written: Vec::new() }
            }
            Place::Ports { kept, .. } => Held::Ports {
                content: self.content(*kept).map(|c| c.many.clone()).unwrap_or_default(),
                written: Vec::new(),
            },
            Place::Remote => Held::Remote,
            Place::Lost => Held::Data(Datum::Text(String::new())),
        }
    }

    fn content(&self, port: (usize, PortId)) -> Option<&Content> {
        self.ports.get(port.0)?.get(port.1.0)
    }

    /// Takes in what a codel has changed. Gives what it has written to ports, in the order of the ports and then of the writing.
    pub fn commit(&mut self, at: (usize, usize), call: Call, mut locals: Option<&mut Locals>) -> Vec<Written> {
        let Some(access) = self.codels.get(at.0).and_then(|all| all.get(at.1)) else { return Vec::new() };
        let mut all = Vec::new();
        for (parameter, argument) in access.parameters.iter().zip(call.arguments) {
            if parameter.direction == Direction::In {
                continue;
            }
            match (&parameter.place, argument.value) {
                (Place::Ids(way), Held::Data(datum)) => {
                    let ids = self.ids.get_mut(at.0).and_then(Option::as_mut);
                    put(ids.map(|(_, ids)| ids), way, datum);
                }
                (Place::Local(number, way), Held::Data(datum)) => {
                    put(locals.as_deref_mut().and_then(|l| l.values.get_mut(*number)), way, datum);
                }
                (Place::Port { own, .. }, Held::Port { written, .. }) => {
                    all.extend(written.into_iter().map(|value| Written { port: *own, name: None, value }));
                }
                (Place::Ports { own, .. }, Held::Ports { written, .. }) => {
                    all.extend(written.into_iter().map(|(name, value)| Written {
                        port: *own,
                        name: Some(name),
                        value,
                    }));
                }
                _ => {}
            }
        }
        for Written { port, name, value } in &all {
            let Some(content) = self.ports.get_mut(at.0).and_then(|p| p.get_mut(port.0)) else { continue };
            match name {
                Some(name) => _ = content.many.insert(name.clone(), value.clone()),
                None => content.one = Some(value.clone()),
            }
        }
        all
    }

    /// What a codel comes to that nobody has written: it leaves data as they are, and writes to its ports what is there.
    pub fn rewrite(&mut self, at: (usize, usize)) -> Vec<Written> {
        let Some(access) = self.codels.get(at.0).and_then(|all| all.get(at.1)) else { return Vec::new() };
        let mut all = Vec::new();
        for parameter in access.parameters.iter().filter(|p| p.direction != Direction::In) {
            let Place::Port { own, .. } = parameter.place else { continue };
            let Some(content) = self.ports.get_mut(at.0).and_then(|p| p.get_mut(own.0)) else { continue };
            let value = content.one.get_or_insert_with(|| self.types.initial(&parameter.ty)).clone();
            all.push(Written { port: own, name: None, value });
        }
        all
    }

    /// An attribute reads and writes the internal data: each of its parameters is one of the service.
    pub fn attribute(&mut self, at: (usize, usize), service: &Service, locals: &mut Locals) {
        let Some(access) = self.codels.get(at.0).and_then(|all| all.get(at.1)) else { return };
        let Some(Some((_, ids))) = self.ids.get_mut(at.0) else { return };
        for parameter in &access.parameters {
            let number = service.parameters.iter().position(|p| *p.name == *parameter.name);
            let (Place::Ids(way), Some(local)) = (&parameter.place, number.and_then(|n| locals.values.get_mut(n)))
            else {
                continue;
            };
            if parameter.direction != Direction::In {
                put(Some(ids), way, local.clone());
            }
            if parameter.direction != Direction::Out
                && let Some(found) = ids.part(way)
            {
                *local = found.clone();
            }
        }
    }

    /// The value of a part of the internal data, as it is written: `delay`, `filter.state[3]`.
    pub fn ids(&self, component: usize, path: &str) -> Option<Datum> {
        let (ty, whole) = self.ids.get(component)?.as_ref()?;
        let (way, _) = self.types.way(ty, &crate::datum::steps(path)?).ok()?;
        whole.part(&way).cloned()
    }
}

fn put(whole: Option<&mut Datum>, way: &[usize], datum: Datum) {
    if let Some(place) = whole.and_then(|whole| whole.part_mut(way)) {
        *place = datum;
    }
}
