//! The master, as a node asks it.

use std::collections::BTreeMap;
use std::io;
use std::time::{Duration, Instant};

use super::http;
use super::net::{Endpoint, words};
use super::xml::{self, Value};

/// How long an answer may take.
const PATIENCE: Duration = Duration::from_secs(3);

/// The master, with the name of the node that asks it.
#[derive(Clone, Debug)]
pub(crate) struct Master {
    endpoint: Endpoint,
    caller: String,
}

/// Who publishes, who subscribes: topics with the names of nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct System {
    pub publishers: BTreeMap<String, Vec<String>>,
    pub subscribers: BTreeMap<String, Vec<String>>,
}

type Asked<T> = Result<T, String>;

impl Master {
    pub fn new(endpoint: Endpoint, caller: &str) -> Master {
        Master { endpoint, caller: caller.to_owned() }
    }

    /// Where it is.
    pub fn endpoint(&self) -> &Endpoint {
        &self.endpoint
    }

    /// Asks for the messages of a topic, whatever their type. Gives where its publishers are.
    pub fn register_subscriber(&self, topic: &str, slave: &str) -> Asked<Vec<String>> {
        let publishers = self.ask("registerSubscriber", &[topic.into(), "*".into(), slave.into()])?;
        Ok(publishers.texts().map(str::to_owned).collect())
    }

    pub fn unregister_subscriber(&self, topic: &str, slave: &str) -> Asked<()> {
        self.ask("unregisterSubscriber", &[topic.into(), slave.into()]).map(|_| ())
    }

    /// Offers messages of a topic.
    pub fn register_publisher(&self, topic: &str, type_name: &str, slave: &str) -> Asked<()> {
        self.ask("registerPublisher", &[topic.into(), type_name.into(), slave.into()]).map(|_| ())
    }

    pub fn unregister_publisher(&self, topic: &str, slave: &str) -> Asked<()> {
        self.ask("unregisterPublisher", &[topic.into(), slave.into()]).map(|_| ())
    }

    /// The topics with their types, as far as a node has said them.
    pub fn topic_types(&self) -> Asked<BTreeMap<String, String>> {
        let all = self.ask("getTopicTypes", &[])?;
        let pair = |item: &Value| match item.items() {
            [topic, ty] => Some((topic.text()?.to_owned(), ty.text()?.to_owned())),
            _ => None,
        };
        Ok(all.items().iter().filter_map(pair).filter(|(_, ty)| ty != "*").collect())
    }

    pub fn system(&self) -> Asked<System> {
        let all = self.ask("getSystemState", &[])?;
        let part = |number: usize| all.items().get(number).map(nodes_of).unwrap_or_default();
        Ok(System { publishers: part(0), subscribers: part(1) })
    }

    /// Where a service is: `rosrpc://host:port`.
    pub fn lookup_service(&self, service: &str) -> Asked<String> {
        let uri = self.ask("lookupService", &[service.into()])?;
        uri.text().map(str::to_owned).ok_or_else(|| "the master's answer is no address".to_owned())
    }

    /// A parameter, where it is set.
    pub fn param(&self, name: &str) -> Asked<Option<Value>> {
        if self.ask("hasParam", &[name.into()])?.truth() != Some(true) {
            return Ok(None);
        }
        self.ask("getParam", &[name.into()]).map(Some)
    }

    fn ask(&self, method: &str, params: &[Value]) -> Asked<Value> {
        let mut all = vec![self.caller.as_str().into()];
        all.extend_from_slice(params);
        let answer = call(&self.endpoint, method, &all, PATIENCE);
        answer.map_err(|failure| format!("the master at {} {failure}", self.endpoint))
    }
}

fn nodes_of(all: &Value) -> BTreeMap<String, Vec<String>> {
    let entry = |item: &Value| match item.items() {
        [topic, nodes] => Some((topic.text()?.to_owned(), nodes.texts().map(str::to_owned).collect())),
        _ => None,
    };
    all.items().iter().filter_map(entry).collect()
}

/// Why a call of a node or of the master did not go well.
#[derive(Debug)]
pub(crate) enum Failure {
    /// It was not reached, or broke off.
    Unreached(io::Error),
    /// It answered that it could not, or something that is no answer.
    Refused(String),
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Failure::Unreached(error) => write!(f, "does not answer: {}", words(error)),
            Failure::Refused(why) => write!(f, "refuses: {why}"),
        }
    }
}

/// Calls a method, of the master or of a node, and takes the value out of the answer: a status, a text, and the value.
pub(crate) fn call(to: &Endpoint, method: &str, params: &[Value], patience: Duration) -> Result<Value, Failure> {
    let deadline = Instant::now() + patience;
    let body = http::post(to, &xml::write_call(method, params), deadline).map_err(Failure::Unreached)?;
    let answer =
        xml::read_answer(&body).map_err(|what| Failure::Refused(format!("its answer cannot be read: {what}")))?;
    match answer.items() {
        [Value::Int(1), _, value] => Ok(value.clone()),
        [Value::Int(_), why, ..] => Err(Failure::Refused(why.text().unwrap_or("it does not say why").to_owned())),
        _ => Err(Failure::Refused("its answer is not a status, a text and a value".to_owned())),
    }
}
