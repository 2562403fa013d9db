//! Codels: what runs one, what it is given, and what it answers.
//!
//! A codel sees its parameters as they were when it was called, and what it changes is there for others when it has returned. Its locks are
//! held all that time, so that nobody can tell the difference from working on the data itself.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use lapwing_genom::model::{Direction, Step, Type};
use lapwing_stream::{Duration, Time};

use crate::datum::{Datum, steps};
use crate::types::Types;

/// What a codel answers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Answer {
    /// A simple codel, or one that validates, is content.
    Ok,
    /// The event that a state yields, as the specification writes it: `main`, `pause::main`, `ether`.
    Event(String),
    /// An exception of the component, by its own name.
    Exception(String),
}

impl Answer {
    /// The event of that name.
    pub fn event(name: &str) -> Answer {
        Answer::Event(name.to_owned())
    }

    /// The exception of that name.
    pub fn exception(name: &str) -> Answer {
        Answer::Exception(name.to_owned())
    }
}

/// Why a codel could not be run to its end: the run ends with it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Trouble {
    /// What happened.
    pub kind: TroubleKind,
    /// In words.
    pub message: String,
}

/// The kinds of [`Trouble`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TroubleKind {
    /// It panicked, or its process died.
    Crashed,
    /// It does not return.
    Hung,
    /// It asked for what it is not given, or answered what cannot be understood.
    Wrong,
}

impl Trouble {
    /// It did something that it must not.
    pub fn wrong(message: impl Into<String>) -> Trouble {
        Trouble { kind: TroubleKind::Wrong, message: message.into() }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Trouble {}

/// Something that can be called as a codel. Codels of different tasks run at the same time.
pub trait Codel: Send + Sync {
    /// Does its work.
    ///
    /// # Errors
    ///
    /// It could not be run to its end; an exception is no such error, but an [`Answer`].
    fn call(&self, call: &mut Call) -> Result<Answer, Trouble>;
}

impl<F: Fn(&mut Call) -> Result<Answer, Trouble> + Send + Sync> Codel for F {
    fn call(&self, call: &mut Call) -> Result<Answer, Trouble> {
        self(call)
    }
}

/// The codels that somebody has written, by component and function. One that is not there only takes time.
#[derive(Clone, Default)]
pub struct Codels {
    all: BTreeMap<(String, String), Arc<dyn Codel>>,
}

impl Codels {
    /// None.
    pub fn new() -> Codels {
        Codels::default()
    }

    /// With one more: the function of a component, as the specification names it.
    pub fn on(mut self, component: &str, function: &str, codel: impl Codel + 'static) -> Codels {
        self.add(component, function, Arc::new(codel));
        self
    }

    /// Adds one; it takes the place of another.
    pub fn add(&mut self, component: &str, function: &str, codel: Arc<dyn Codel>) {
        self.all.insert((component.to_owned(), function.to_owned()), codel);
    }

    /// Adds all of others.
    pub fn join(&mut self, others: Codels) {
        self.all.extend(others.all);
    }

    /// The names of all: components and functions.
    pub fn names(&self) -> impl Iterator<Item = (&str, &str)> {
        self.all.keys().map(|(component, function)| (component.as_str(), function.as_str()))
    }

    /// The one of that name.
    pub fn get(&self, component: &str, function: &str) -> Option<&Arc<dyn Codel>> {
        self.all.get(&(component.to_owned(), function.to_owned()))
    }
}

impl fmt::Debug for Codels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.all.keys()).finish()
    }
}

/// A parameter of a call.
#[derive(Clone, Debug)]
pub struct Argument {
    /// Its name for the codel.
    pub name: Arc<str>,
    /// Which way it goes.
    pub direction: Direction,
    /// Its type; of a port, that of what flows.
    pub ty: Arc<Type>,
    /// What it holds.
    pub value: Held,
}

/// What a parameter holds.
#[derive(Clone, Debug)]
pub enum Held {
    /// Internal data, or data of the service.
    Data(Datum),
    /// A port: what was last written there, if anything was, and what the codel writes.
    Port {
        /// Its content; of a port out, where the next writing is prepared.
        content: Option<Datum>,
        /// What was written, in order.
        written: Vec<Datum>,
    },
    /// Ports under one name, each with a name of its own.
    Ports {
        /// Their contents.
        content: BTreeMap<String, Datum>,
        /// What was written, in order.
        written: Vec<(String, Datum)>,
    },
    /// A service of another component, which codels cannot call here.
    Remote,
}

/// A call of a codel: its parameters, by name.
#[derive(Clone, Debug)]
pub struct Call {
    /// The component.
    pub component: Arc<str>,
    /// The function.
    pub function: Arc<str>,
    /// When it was called, counted from the beginning of the run.
    pub now: Time,
    /// What it is given, in the order of the specification.
    pub arguments: Vec<Argument>,
    /// How long it says that it is busy beyond what it would take anyway.
    pub busy: Duration,
    /// Whether time is only counted.
    pub is_logical: bool,
    pub(crate) types: Types,
}

impl Call {
    /// A call in logical time.
    pub fn new(component: Arc<str>, function: Arc<str>, now: Time, arguments: Vec<Argument>, types: Types) -> Call {
        Call { component, function, now, arguments, busy: Duration::ZERO, is_logical: true, types }
    }

    /// The types of its parameters.
    pub fn types(&self) -> &Types {
        &self.types
    }

    /// Seconds since the beginning of the run.
    pub fn seconds(&self) -> f64 {
        self.now.seconds()
    }

    /// A value by its way, which begins with the name of a parameter: `pose.x`, `scan.ranges`; of a port, its content.
    ///
    /// # Errors
    ///
    /// There is no such thing, or the port is empty: [`Call::has`] says so beforehand.
    pub fn get(&self, path: &str) -> Result<&Datum, Trouble> {
        let (_, argument, way, _) = self.find(path)?;
        let whole = match &argument.value {
            Held::Data(datum) | Held::Port { content: Some(datum), .. } => datum,
            Held::Port { content: None, .. } => return Err(self.wrong(path, "nothing has been written to the port")),
            Held::Ports { .. } => return Err(self.wrong(path, "it is many ports: take `contents`")),
            Held::Remote => return Err(self.wrong(path, "it is a service")),
        };
        whole.part(&way).ok_or_else(|| self.wrong(path, "there are fewer elements"))
    }

    /// A number.
    ///
    /// # Errors
    ///
    /// As for [`Call::get`], or it is no number.
    pub fn number(&self, path: &str) -> Result<f64, Trouble> {
        self.get(path)?.number().ok_or_else(|| self.wrong(path, "it is no number"))
    }

    /// A truth value.
    ///
    /// # Errors
    ///
    /// As for [`Call::get`], or it is none.
    pub fn flag(&self, path: &str) -> Result<bool, Trouble> {
        match self.get(path)? {
            Datum::Bool(b) => Ok(*b),
            _ => Err(self.wrong(path, "it is no truth value")),
        }
    }

    /// A text.
    ///
    /// # Errors
    ///
    /// As for [`Call::get`], or it is none.
    pub fn text(&self, path: &str) -> Result<&str, Trouble> {
        match self.get(path)? {
            Datum::Text(text) => Ok(text),
            _ => Err(self.wrong(path, "it is no text")),
        }
    }

    /// The numbers of an array or a sequence.
    ///
    /// # Errors
    ///
    /// As for [`Call::get`], or there are others than numbers.
    pub fn numbers(&self, path: &str) -> Result<Vec<f64>, Trouble> {
        let numbers = match self.get(path)? {
            Datum::List(items) => items.iter().map(Datum::number).collect(),
            _ => None,
        };
        numbers.ok_or_else(|| self.wrong(path, "it is no list of numbers"))
    }

    /// Whether something has ever been written to a port.
    pub fn has(&self, port: &str) -> bool {
        self.arguments.iter().any(|a| *a.name == *port && matches!(a.value, Held::Port { content: Some(_), .. }))
    }

    /// What was last written to each of many ports under one name.
    pub fn contents(&self, port: &str) -> Option<&BTreeMap<String, Datum>> {
        self.arguments.iter().find(|a| *a.name == *port).and_then(|a| match &a.value {
            Held::Ports { content, .. } => Some(content),
            _ => None,
        })
    }

    /// Gives a value to something that the codel may change. What is set of a port is not there for others before [`Call::write`].
    ///
    /// # Errors
    ///
    /// There is no such thing, it is only to be read, or the value does not fit.
    pub fn set(&mut self, path: &str, value: impl Into<Datum>) -> Result<(), Trouble> {
        let (number, argument, way, ty) = self.find(path)?;
        if argument.direction == Direction::In {
            return Err(self.wrong(path, "it is `in`, and only to be read"));
        }
        let fitted = self.types.fit(ty, value.into()).map_err(|why| self.wrong(path, &why))?;
        let Call { arguments, types, .. } = self;
        let place = arguments.get_mut(number).and_then(|Argument { ty, value, .. }| match value {
            Held::Data(datum) => datum.part_mut(&way),
            Held::Port { content, .. } => content.get_or_insert_with(|| types.initial(ty)).part_mut(&way),
            _ => None,
        });
        match place {
            Some(place) => {
                *place = fitted;
                Ok(())
            }
            None => Err(self.wrong(path, "there is no such place")),
        }
    }

    /// Gives all of a parameter to another: `call.copy("wanted", "safe")`.
    ///
    /// # Errors
    ///
    /// As for [`Call::get`] and [`Call::set`].
    pub fn copy(&mut self, from: &str, to: &str) -> Result<(), Trouble> {
        let value = self.get(from)?.clone();
        self.set(to, value)
    }

    /// Writes to a port what has been set of it.
    ///
    /// # Errors
    ///
    /// There is no such port out.
    pub fn write(&mut self, port: &str) -> Result<(), Trouble> {
        let Call { arguments, types, .. } = self;
        let found = arguments.iter_mut().find(|a| *a.name == *port && a.direction != Direction::In);
        match found.map(|a| (&a.ty, &mut a.value)) {
            Some((ty, Held::Port { content, written })) => {
                written.push(content.get_or_insert_with(|| types.initial(ty)).clone());
                Ok(())
            }
            _ => Err(self.wrong(port, "it is no port that the codel may write")),
        }
    }

    /// Is busy for a while: sleeps in real time, and counts as so much longer in logical time.
    pub fn take(&mut self, duration: Duration) {
        if self.is_logical {
            self.busy = Duration::from_nanos(self.busy.nanos().saturating_add(duration.nanos().max(0)));
        } else {
            std::thread::sleep(std::time::Duration::from_nanos(u64::try_from(duration.nanos()).unwrap_or(0)));
        }
    }

    /// The parameter that a way begins with, by its number too, and where the way leads in it.
    fn find(&self, path: &str) -> Result<(usize, &Argument, Vec<usize>, &Type), Trouble> {
        let end = path.find(['.', '[']).unwrap_or(path.len());
        let (name, rest) = path.split_at(end);
        // PERF: most ways are a name alone (`examples/rate.rs`).
        let rest = if rest.is_empty() { Vec::new() } else { self.steps_after(path)? };
        let found = self.arguments.iter().enumerate().find(|(_, a)| *a.name == *name);
        let (number, argument) = found.ok_or_else(|| {
            let names: Vec<&str> = self.arguments.iter().map(|a| &*a.name).collect();
            self.wrong(path, &format!("the codel is given {}", listed(&names)))
        })?;
        let (way, ty) = self.types.way(&argument.ty, &rest).map_err(|why| self.wrong(path, &why))?;
        Ok((number, argument, way, ty))
    }

    /// The steps of a way after its name.
    fn steps_after(&self, path: &str) -> Result<Vec<Step>, Trouble> {
        let mut all = steps(path).unwrap_or_default();
        if all.is_empty() {
            return Err(self.wrong(path, "that is no way to a value"));
        }
        all.remove(0);
        Ok(all)
    }

    fn wrong(&self, path: &str, why: &str) -> Trouble {
        Trouble::wrong(format!("`{}` asked for `{path}`: {why}", self.function))
    }
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "nothing".to_owned() } else { format!("`{}`", names.join("`, `")) }
}
