//! This node's API: what the master and other nodes ask of it.

use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::graph::Graph;
use super::http;
use super::net::Timed;
use super::xml::{self, Value};

/// How long a question may take to come, and its answer to go.
const PATIENCE: Duration = Duration::from_secs(5);

/// Answers one question.
pub(crate) fn serve(graph: &Arc<Graph>, stream: &TcpStream) {
    let mut timed = Timed { stream, deadline: Instant::now() + PATIENCE };
    // What is no question gets no answer.
    let Ok((_, body)) = http::read(&mut timed) else { return };
    let answer = match xml::read_call(&body) {
        Ok((method, params)) => answer(graph, &method, &params),
        Err(what) => failure(&what),
    };
    drop(timed.write_all(http::answer(&xml::write_answer(&answer)).as_bytes()));
}

fn answer(graph: &Arc<Graph>, method: &str, params: &[Value]) -> Value {
    let text = |number: usize| params.get(number).and_then(Value::text);
    match method {
        "publisherUpdate" => match (text(1), params.get(2)) {
            (Some(topic), Some(publishers)) => {
                let publishers: Vec<String> = publishers.texts().map(str::to_owned).collect();
                graph.list(topic, &publishers, None);
                success(0.into())
            }
            _ => failure("a topic and its publishers are missing"),
        },
        "requestTopic" => text(1).map_or_else(|| failure("a topic is missing"), |topic| request(graph, topic)),
        "shutdown" => {
            graph.told_to_stop(text(0).unwrap_or("somebody"), text(1).unwrap_or("it does not say why"));
            success(0.into())
        }
        "paramUpdate" => {
            graph.stir();
            success(0.into())
        }
        "getPid" => success(i64::from(std::process::id()).into()),
        "getMasterUri" => success(format!("http://{}/", graph.master.endpoint()).as_str().into()),
        "getSubscriptions" => success(subscriptions(graph)),
        "getPublications" => {
            let pair = |(topic, ty): (String, String)| Value::Array(vec![topic.as_str().into(), ty.as_str().into()]);
            success(Value::Array(publications(graph).into_iter().map(pair).collect()))
        }
        "getBusStats" => success(Value::Array(vec![Vec::new().into(), Vec::new().into(), Vec::new().into()])),
        "getBusInfo" => success(connections(graph)),
        _ => failure("a node has no such method"),
    }
}

fn request(graph: &Graph, topic: &str) -> Value {
    if publications(graph).iter().all(|(name, _)| name != topic) {
        return Value::Array(vec![0.into(), format!("{topic} is not published here").as_str().into(), 0.into()]);
    }
    success(Value::Array(vec!["TCPROS".into(), graph.host.as_str().into(), i64::from(graph.port).into()]))
}

fn publications(graph: &Graph) -> Vec<(String, String)> {
    graph.lock().publications.iter().map(|p| (p.topic.clone(), p.type_name.clone())).collect()
}

fn subscriptions(graph: &Graph) -> Value {
    let state = graph.lock();
    let type_of = |topic: &str| state.streams.iter().find(|s| s.topic == topic).map_or("*", |s| s.type_name.as_str());
    let pair = |topic: &String| Value::Array(vec![topic.as_str().into(), type_of(topic).into()]);
    Value::Array(state.topics.keys().map(pair).collect())
}

/// Who is connected: number, node, direction, transport, topic, whether it is up.
fn connections(graph: &Graph) -> Value {
    let state = graph.lock();
    let mut all = Vec::new();
    for publication in &state.publications {
        for node in publication.subscribers() {
            let number = all.len() as i64;
            let (node, topic) = (node.as_str().into(), publication.topic.as_str().into());
            all.push(Value::Array(vec![number.into(), node, "o".into(), "TCPROS".into(), topic, 1.into()]));
        }
    }
    for (topic, known) in &state.topics {
        for uri in known.connections() {
            let number = all.len() as i64;
            all.push(Value::Array(vec![
                number.into(),
                uri.into(),
                "i".into(),
                "TCPROS".into(),
                topic.as_str().into(),
                1.into(),
            ]));
        }
    }
    Value::Array(all)
}

fn success(value: Value) -> Value {
    Value::Array(vec![1.into(), "".into(), value])
}

fn failure(why: &str) -> Value {
    Value::Array(vec![(-1).into(), why.into(), 0.into()])
}
