//! What components keep: internal data, contents of ports, and the data of services that are being served.

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_genom::model::{CodelParameter, Component, Direction, Model, Object, PortId, Service, Step, Type, TypeId};
use lapwing_stream::{Duration, Time};

use crate::codel::{Argument, Call, Held, Trouble};
use crate::datum::Datum;
use crate::types::Types;

/// What a codel has written to a port: whose, which one of several under its name, and the value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Written {
    pub port: PortId,
    pub name: Option<String>,
    pub value: Datum,
}

/// The data of a service that is being served: its parameters and locals.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Locals {
    values: BTreeMap<String, (Type, Datum)>,
}

impl Locals {
    /// Those of a service, with the values of a request.
    pub fn new(types: &Types, service: &Service, values: &[Datum]) -> Locals {
        let parameters = service.parameters.iter().zip(values);
        let parameters = parameters.filter_map(|(p, value)| Some((p.name.clone(), (p.ty.clone()?, value.clone()))));
        let locals = service.locals.iter().map(|l| (l.name.clone(), (l.ty.clone(), types.initial(&l.ty))));
        Locals { values: parameters.chain(locals).collect() }
    }

    /// A value by its name.
    pub fn get(&self, name: &str) -> Option<&Datum> {
        self.values.get(name).map(|(_, datum)| datum)
    }
}

/// All data of a system.
pub(crate) struct Store {
    pub types: Types,
    model: Arc<Model>,
    names: Vec<Arc<str>>,
    functions: Vec<Vec<Arc<str>>>,
    ids: Vec<Option<(Type, Datum)>>,
    ports: Vec<Vec<BTreeMap<String, Datum>>>,
}

impl Store {
    /// Everything as at first.
    ///
    /// # Errors
    ///
    /// A type is too large to be kept.
    pub fn new(model: Arc<Model>) -> Result<Store, String> {
        let types = Types::new(&model)?;
        let first = |ids: TypeId| (Type::Named(ids), types.initial(&Type::Named(ids)));
        let ids = model.components.iter().map(|c| c.ids.map(first)).collect();
        Ok(Store {
            ids,
            ports: model.components.iter().map(|c| vec![BTreeMap::new(); c.ports.len()]).collect(),
            names: model.components.iter().map(|c| c.name.as_str().into()).collect(),
            functions: model
                .components
                .iter()
                .map(|c| c.codels.iter().map(|codel| codel.function.as_str().into()).collect())
                .collect(),
            types,
            model,
        })
    }

    /// What a codel is given when it is called now.
    pub fn prepare(&self, at: (usize, usize), locals: Option<&Locals>, now: Time, is_logical: bool) -> Option<Call> {
        let component = self.model.components.get(at.0)?;
        let codel = component.codels.get(at.1)?;
        let arguments = codel.parameters.iter().map(|parameter| self.argument(at.0, component, parameter, locals));
        Some(Call {
            component: self.names.get(at.0)?.clone(),
            function: self.functions.get(at.0)?.get(at.1)?.clone(),
            now,
            arguments: arguments.collect(),
            busy: Duration::default(),
            is_logical,
            types: self.types.clone(),
        })
    }

    fn argument(
        &self,
        number: usize,
        component: &Component,
        parameter: &CodelParameter,
        locals: Option<&Locals>,
    ) -> Argument {
        let (ty, value) = match &parameter.object {
            Object::Ids(steps) => {
                let whole = self.ids.get(number).and_then(Option::as_ref);
                let found = whole.and_then(|(ty, datum)| self.part(ty, datum, steps));
                self.data(found)
            }
            Object::Local(name, steps) => {
                let whole = locals.and_then(|l| l.values.get(name));
                let found = whole.and_then(|(ty, datum)| self.part(ty, datum, steps));
                self.data(found)
            }
            Object::Port(port) => {
                let declared = component.ports.get(port.0);
                let content = self.content(number, *port);
                let held = match declared.is_some_and(|p| p.multiple) {
                    true => Held::Ports { content: content.cloned().unwrap_or_default(), written: Vec::new() },
                    false => Held::Port { content: content.and_then(|c| c.get("")).cloned(), written: Vec::new() },
                };
                (declared.map_or(Type::Text(None), |p| p.ty.clone()), held)
            }
            Object::Remote(_) | Object::Unknown => (Type::Text(None), Held::Remote),
        };
        Argument { name: parameter.name.clone(), direction: parameter.direction, ty, value }
    }

    fn part(&self, ty: &Type, datum: &Datum, steps: &[Step]) -> Option<(Type, Datum)> {
        let (way, ty) = self.types.way(ty, steps).ok()?;
        let value = datum.part(&way).cloned().unwrap_or_else(|| self.types.initial(&ty));
        Some((ty, value))
    }

    fn data(&self, found: Option<(Type, Datum)>) -> (Type, Held) {
        let (ty, datum) = found.unwrap_or((Type::Text(None), Datum::Text(String::new())));
        (ty, Held::Data(datum))
    }

    /// What the port of a component holds: of one that reads, what the port that it reads holds.
    fn content(&self, component: usize, port: PortId) -> Option<&BTreeMap<String, Datum>> {
        let (component, port) = self.model.origin((component, port));
        self.ports.get(component)?.get(port.0)
    }

    /// Takes in what a codel has changed. Gives what it has written to ports, in the order of the ports and then of the writing.
    ///
    /// # Errors
    ///
    /// A value is none of its type.
    pub fn commit(
        &mut self,
        at: (usize, usize),
        call: Call,
        mut locals: Option<&mut Locals>,
    ) -> Result<Vec<Written>, Trouble> {
        let model = self.model.clone();
        let Some(codel) = model.components.get(at.0).and_then(|c| c.codels.get(at.1)) else { return Ok(Vec::new()) };
        let mut all = Vec::new();
        for (parameter, argument) in codel.parameters.iter().zip(call.arguments) {
            if parameter.direction == Direction::In {
                continue;
            }
            match (&parameter.object, argument.value) {
                (Object::Ids(steps), Held::Data(datum)) => {
                    let Some(Some((ty, whole))) = self.ids.get_mut(at.0) else { continue };
                    put(&self.types, ty, whole, steps, datum);
                }
                (Object::Local(name, steps), Held::Data(datum)) => {
                    let place = locals.as_deref_mut().and_then(|l| l.values.get_mut(name));
                    if let Some((ty, whole)) = place {
                        put(&self.types, ty, whole, steps, datum);
                    }
                }
                (Object::Port(port), Held::Port { written, .. }) => {
                    all.extend(written.into_iter().map(|value| Written { port: *port, name: None, value }));
                }
                (Object::Port(port), Held::Ports { written, .. }) => {
                    all.extend(written.into_iter().map(|(name, value)| Written {
                        port: *port,
                        name: Some(name),
                        value,
                    }));
                }
                _ => {}
            }
        }
        for Written { port, name, value } in &all {
            if let Some(ports) = self.ports.get_mut(at.0).and_then(|p| p.get_mut(port.0)) {
                ports.insert(name.clone().unwrap_or_default(), value.clone());
            }
        }
        Ok(all)
    }

    /// An attribute reads and writes the internal data.
    pub fn attribute(&mut self, at: (usize, usize), locals: &mut Locals) {
        let model = self.model.clone();
        let Some(codel) = model.components.get(at.0).and_then(|c| c.codels.get(at.1)) else { return };
        let Some(Some((ty, whole))) = self.ids.get_mut(at.0) else { return };
        for parameter in &codel.parameters {
            let (Object::Ids(steps), Some((_, local))) = (&parameter.object, locals.values.get_mut(&parameter.name))
            else {
                continue;
            };
            if parameter.direction != Direction::In {
                put(&self.types, ty, whole, steps, local.clone());
            }
            if parameter.direction != Direction::Out
                && let Ok((way, _)) = self.types.way(ty, steps)
                && let Some(found) = whole.part(&way)
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

fn put(types: &Types, ty: &Type, whole: &mut Datum, steps: &[Step], datum: Datum) {
    if let Ok((way, _)) = types.way(ty, steps)
        && let Some(place) = whole.part_mut(&way)
    {
        *place = datum;
    }
}
