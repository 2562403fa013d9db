//! A component from what has been declared: its properties, tasks, services and codels.

use std::collections::BTreeMap;

use lapwing_diag::{Code, Diagnostic};

use super::Resolver;
use super::codel::Place;
use super::draft::{Draft, ServiceDraft, TaskDraft};
use super::properties::{Properties, Whose};
use crate::ast::{Order, ServiceKind, TimeProperty};
use crate::model::{
    Codel, CodelId, CodelParameter, Component, Field, Object, Owner, Role, Service, ServiceId, Step, Task, TaskId, Type,
};
use lapwing_diag::suggest::{listed, nearest};

impl<'a> Resolver<'a> {
    /// The component or interface.
    pub(super) fn component(&mut self, draft: &Draft<'a>) -> Component {
        let properties = self.properties(
            draft.scope,
            &draft.properties,
            if draft.is_interface { Whose::Interface } else { Whose::Component },
        );
        let mut component = Component {
            name: draft.name.clone(),
            span: draft.span,
            doc: properties.doc.join("\n"),
            version: properties.version.clone().unwrap_or_else(|| "0".to_owned()),
            lang: properties.lang.clone().unwrap_or_else(|| "c".to_owned()),
            email: properties.email.clone().unwrap_or_default(),
            requires: draft.requires.iter().chain(&properties.requires).cloned().collect(),
            codels_requires: properties.codels_requires.clone(),
            ids: Some(draft.ids),
            throws: properties.throws.clone(),
            ports: draft.ports.clone(),
            remotes: draft.remotes.clone(),
            ..Component::default()
        };
        for task in &draft.tasks {
            let owner = Owner::Task(TaskId(component.tasks.len()));
            let (task, properties) = self.task(draft, task);
            component.tasks.push(task);
            self.state_codels(draft, &mut component, owner, &properties);
        }
        for service in &draft.services {
            self.full_service(draft, &mut component, service);
        }
        self.same_functions(&component);
        self.clock(&mut component, &properties);
        component
    }

    fn task(&mut self, draft: &Draft<'a>, task: &TaskDraft<'a>) -> (Task, Properties<'a>) {
        let properties = self.properties(draft.scope, &task.properties, Whose::Task);
        let time =
            |which: TimeProperty| properties.times.iter().find(|(t, ..)| *t == which).map(|(_, ns, span)| (*ns, *span));
        let (period, delay) = (time(TimeProperty::Period), time(TimeProperty::Delay));
        if let Some((0, span)) = period {
            self.report(Diagnostic::new(
                Code::BadProperty,
                span,
                format!("the task `{}` has a period of no length", task.name),
            ));
        }
        if let Some((delay, span)) = delay {
            match period {
                None => self.report(Diagnostic::new(
                    Code::BadProperty,
                    span,
                    format!("the task `{}` has a delay and no period", task.name),
                )),
                Some((period, at)) if delay >= period => {
                    let message = format!("the delay of the task `{}` is not less than its period", task.name);
                    self.report(Diagnostic::new(Code::BadProperty, span, message).also(at, "the period"));
                }
                Some(_) => {}
            }
        }
        let task = Task {
            name: task.name.clone(),
            span: task.span,
            doc: properties.doc.join("\n"),
            period_ns: period.map(|(ns, _)| ns).filter(|ns| *ns > 0),
            delay_ns: delay.map(|(ns, _)| ns),
            priority: properties.priority,
            real_time: properties.real_time,
            stack: properties.stack,
            throws: properties.throws.clone(),
            codels: Vec::new(),
        };
        (task, properties)
    }

    fn full_service(&mut self, draft: &Draft<'a>, component: &mut Component, service: &ServiceDraft<'a>) {
        let whose = Whose::Service(service.kind);
        let properties = self.properties(draft.scope, &service.properties, whose);
        let id = ServiceId(component.services.len());
        let mut parameters = service.parameters.clone();
        let mut accesses = Vec::new();
        for member in &service.members {
            let Some((parameter, steps)) = self.attribute_parameter(draft, member) else { continue };
            // What goes into the attribute is written to the internal data.
            accesses.push(CodelParameter {
                name: parameter.name.clone(),
                direction: parameter.direction.inverted(),
                object: Object::Ids(steps),
                span: parameter.span,
            });
            self.add_parameter(&mut parameters, parameter);
        }
        component.services.push(Service {
            name: service.name.clone(),
            kind: service.kind,
            span: service.span,
            doc: properties.doc.join("\n"),
            parameters,
            locals: self.locals(service, &properties),
            task: self.task_of(draft, service, &properties),
            validate: None,
            codels: Vec::new(),
            throws: properties.throws.clone(),
            interrupts: self.services(draft, id, &properties, Order::Interrupts),
            after: self.services(draft, id, &properties, Order::After),
            before: self.services(draft, id, &properties, Order::Before),
        });
        if service.kind == ServiceKind::Attribute && !accesses.is_empty() {
            component.codels.push(Codel {
                function: service.name.clone(),
                span: service.span,
                owner: Owner::Service(id),
                role: Role::Attribute,
                parameters: accesses,
                wcet_ns: None,
                is_async: false,
            });
            self.attach(component, Owner::Service(id));
        }
        let place = Place { draft, owner: Owner::Service(id), is_control: true };
        if let Some((scope, codel)) = properties.validate {
            let codel = self.codel(&place, component, scope, codel, Role::Validate);
            component.codels.push(codel);
            let number = CodelId(component.codels.len() - 1);
            if let Some(service) = component.services.last_mut() {
                service.validate = Some(number);
            }
        }
        if service.kind == ServiceKind::Activity {
            return self.state_codels(draft, component, Owner::Service(id), &properties);
        }
        for (scope, codel) in &properties.codels {
            let codel = self.codel(&place, component, *scope, codel, Role::Simple);
            component.codels.push(codel);
            self.attach(component, Owner::Service(id));
        }
    }

    /// The codels of a state machine, and what is wrong with the machine.
    fn state_codels(
        &mut self,
        draft: &Draft<'a>,
        component: &mut Component,
        owner: Owner,
        properties: &Properties<'a>,
    ) {
        let place = Place { draft, owner, is_control: false };
        let first = component.codels.len();
        for (scope, codel) in &properties.codels {
            let role = Role::State {
                triggers: codel.triggers.iter().map(|t| t.name.name.clone()).collect(),
                yields: Vec::new(),
            };
            let codel = self.codel(&place, component, *scope, codel, role);
            component.codels.push(codel);
            self.attach(component, owner);
        }
        // An interface may leave states to the components that provide it.
        if !draft.is_interface {
            let codels: Vec<_> = properties.codels.iter().map(|(_, codel)| *codel).collect();
            self.machine(component, owner, first, &codels);
        }
    }

    /// Gives the last codel to its owner.
    fn attach(&mut self, component: &mut Component, owner: Owner) {
        let number = CodelId(component.codels.len().saturating_sub(1));
        match owner {
            Owner::Task(task) => component.tasks.get_mut(task.0).map(|t| t.codels.push(number)),
            Owner::Service(service) => component.services.get_mut(service.0).map(|s| s.codels.push(number)),
        };
    }

    fn locals(&mut self, service: &ServiceDraft<'a>, properties: &Properties<'a>) -> Vec<Field> {
        let mut locals = Vec::new();
        for (_, ty, declarators) in &properties.locals {
            for declarator in *declarators {
                let ty = self.declared(service.scope, ty, declarator);
                let ty = ty.unwrap_or(crate::model::Type::Basic(crate::ast::Basic::Any));
                self.add_field(
                    &mut locals,
                    Field { name: declarator.name.name.clone(), ty, span: declarator.name.span },
                );
            }
        }
        locals
    }

    fn task_of(
        &mut self,
        draft: &Draft<'a>,
        service: &ServiceDraft<'a>,
        properties: &Properties<'a>,
    ) -> Option<TaskId> {
        let Some(name) = properties.task else {
            if service.kind == ServiceKind::Activity && !draft.is_interface && !properties.codels.is_empty() {
                let message = format!("the activity `{}` does not say which task runs it", service.name);
                let names = listed(draft.tasks.iter().map(|t| t.name.as_str()));
                self.report(
                    Diagnostic::new(Code::MissingTask, service.span, message)
                        .help(format!("add `task NAME;`; the tasks are {names}")),
                );
            }
            return None;
        };
        let found = draft.tasks.iter().position(|t| t.name == name.name);
        if found.is_none() {
            let names = || draft.tasks.iter().map(|t| t.name.as_str());
            let help = match nearest(&name.name, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the tasks of `{}` are {}", draft.name, listed(names())),
            };
            self.report(
                Diagnostic::new(Code::UnknownTask, name.span, format!("no task is called `{}`", name.name)).help(help),
            );
        }
        found.map(TaskId)
    }

    fn services(
        &mut self,
        draft: &Draft<'a>,
        own: ServiceId,
        properties: &Properties<'a>,
        order: Order,
    ) -> Vec<ServiceId> {
        let mut found = Vec::new();
        for (_, name) in properties.services.iter().filter(|(o, _)| *o == order) {
            if name.name == "all" {
                // A service that waited for itself would never be granted.
                let is_meant = |s: &&ServiceId| order == Order::Interrupts || **s != own;
                let all: Vec<ServiceId> = (0..draft.services.len()).map(ServiceId).collect();
                found.extend(all.iter().filter(is_meant));
                continue;
            }
            match draft.services.iter().position(|s| s.name == name.name) {
                Some(number) => found.push(ServiceId(number)),
                None => {
                    let names = || draft.services.iter().map(|s| s.name.as_str());
                    let help = match nearest(&name.name, names()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("the services of `{}` are {}", draft.name, listed(names())),
                    };
                    let message = format!("no service is called `{}`", name.name);
                    self.report(Diagnostic::new(Code::UnknownService, name.span, message).help(help));
                }
            }
        }
        found.sort();
        found.dedup();
        found
    }

    /// A function has one signature, however many codels call it: directions and types. What its parameters are called is each codel's own.
    fn same_functions(&mut self, component: &Component) {
        let mut known: BTreeMap<&str, &Codel> = BTreeMap::new();
        for codel in component.codels.iter().filter(|c| c.role != Role::Attribute) {
            let before = *known.entry(&codel.function).or_insert(codel);
            let same = |(a, b): (&CodelParameter, &CodelParameter)| {
                a.direction == b.direction
                    && self.same_object(component, (before.owner, &a.object), (codel.owner, &b.object))
            };
            let is_same = before.parameters.len() == codel.parameters.len()
                && before.parameters.iter().zip(&codel.parameters).all(same);
            if !is_same {
                let message = format!("the function `{}` is given other parameters here", codel.function);
                let help = "one function has one list of parameters: give one of the two codels another function";
                self.report(
                    Diagnostic::new(Code::CodelClash, codel.span, message).also(before.span, "than here").help(help),
                );
            }
        }
    }

    /// Whether a function can be given either of two things: data of one type, or one and the same port or service.
    fn same_object(&self, component: &Component, a: (Owner, &Object), b: (Owner, &Object)) -> bool {
        match (a.1, b.1) {
            (Object::Ids(_) | Object::Local(..), Object::Ids(_) | Object::Local(..)) => {
                match (self.data_type(component, a), self.data_type(component, b)) {
                    (Some(a), Some(b)) => self.same_type(&a, &b),
                    // What could not be found has been said.
                    _ => true,
                }
            }
            (Object::Unknown, _) | (_, Object::Unknown) => true,
            (a, b) => a == b,
        }
    }

    /// The type of internal data, or of a parameter or local of a service.
    fn data_type(&self, component: &Component, (owner, object): (Owner, &Object)) -> Option<Type> {
        let (whole, steps) = match object {
            Object::Ids(steps) => (Type::Named(component.ids?), steps),
            Object::Local(name, steps) => {
                let Owner::Service(service) = owner else { return None };
                let service = component.services.get(service.0)?;
                let parameter = service.parameters.iter().find(|p| p.name == *name).map(|p| p.ty.clone());
                let local = || service.locals.iter().find(|l| l.name == *name).map(|l| Some(l.ty.clone()));
                (parameter.or_else(local)??, steps)
            }
            Object::Port(_) | Object::Remote(_) | Object::Unknown => return None,
        };
        steps.iter().try_fold(whole, |ty, step| match step {
            Step::Member(name) => self.members_of(&ty)?.into_iter().find(|f| f.name == *name).map(|f| f.ty.clone()),
            Step::Element(_) => match ty.behind(&self.types) {
                Type::Array(inner, _) | Type::Sequence(inner, _) => Some((**inner).clone()),
                _ => None,
            },
        })
    }

    /// The base clock: what all periods and delays are multiples of.
    fn clock(&mut self, component: &mut Component, properties: &Properties<'a>) {
        let times = component.tasks.iter().flat_map(|t| [t.period_ns, t.delay_ns]).flatten();
        let common = times.clone().fold(0, common);
        let given = properties.times.iter().find(|(which, ..)| *which == TimeProperty::ClockRate);
        component.clock_ns = (common > 0).then_some(common);
        if let Some((_, ns, span)) = given {
            component.clock_ns = Some(*ns);
            if *ns == 0 || times.clone().any(|time| time % ns != 0) {
                let message = "the clock rate does not divide every period and delay";
                self.report(Diagnostic::new(Code::BadProperty, *span, message));
            }
        }
    }
}

/// The greatest common divisor.
fn common(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
