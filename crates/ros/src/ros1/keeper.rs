//! Keeps this node's registrations at the master: makes them, looks after them twice a second, makes them again where the master has forgotten
//! them, and takes them back at the end.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::graph::Graph;
use super::master::System;
use super::topic::MOST_LINKS;
use super::xml::Value;

/// How often the master is asked.
const EVERY: Duration = Duration::from_millis(500);
/// How often is looked whether something has become late.
const TICK: Duration = Duration::from_millis(100);

/// Does so until the graph ends.
pub(crate) fn run(graph: &Arc<Graph>) {
    let mut asked = None::<Instant>;
    loop {
        if asked.is_none_or(|at| at.elapsed() >= EVERY) {
            let result = if graph.lock().told_to_stop.is_some() { Ok(()) } else { look_after(graph) };
            note_master(graph, result.err());
            graph.was_asked();
            asked = Some(Instant::now());
        }
        graph.tell_all();
        if graph.rest(TICK) {
            asked = None;
        }
        if graph.lock().is_over {
            return take_back(graph);
        }
    }
}

/// Says once that the master is gone, and once that it is back.
fn note_master(graph: &Graph, failure: Option<String>) {
    let mut state = graph.lock();
    match (&state.no_master, &failure) {
        (None, Some(what)) => {
            graph.note(format!("{what}; what is connected stays so, and it is tried again twice a second"))
        }
        (Some(_), None) => graph.note(format!("the master at {} answers again", graph.master.endpoint())),
        _ => {}
    }
    state.no_master = failure;
}

fn look_after(graph: &Arc<Graph>) -> Result<(), String> {
    let system = graph.master.system()?;
    let types = graph.master.topic_types()?;
    graph.observe(&system, &types);
    subscribe(graph, &system)?;
    advertise(graph, &system)?;
    let sim_time = graph.master.param("/use_sim_time")?;
    graph.lock().sim_time = Some(sim_time.as_ref().and_then(Value::truth).unwrap_or(false));
    Ok(())
}

/// Registers what the master does not know, or of which it knows other publishers than this node does.
fn subscribe(graph: &Arc<Graph>, system: &System) -> Result<(), String> {
    let me = graph.names.node();
    let mut due = Vec::new();
    {
        let mut state = graph.lock();
        for (name, topic) in &mut state.topics {
            let is_known = system.subscribers.get(name).is_some_and(|nodes| nodes.iter().any(|node| node == me));
            if topic.is_registered && !is_known {
                topic.forget_listing();
            }
            let publishers = system.publishers.get(name).map_or(0, Vec::len).min(MOST_LINKS);
            if !is_known || topic.listed() != publishers {
                due.push((name.clone(), topic.updates));
            }
        }
    }
    for (name, updates) in due {
        let publishers = graph.master.register_subscriber(&name, &graph.slave)?;
        if let Some(topic) = graph.lock().topics.get_mut(&name) {
            topic.is_registered = true;
        }
        graph.list(&name, &publishers, Some(updates));
    }
    Ok(())
}

fn advertise(graph: &Graph, system: &System) -> Result<(), String> {
    let me = graph.names.node();
    let publications = graph.lock().publications.clone();
    for publication in publications {
        let is_known =
            system.publishers.get(&publication.topic).is_some_and(|nodes| nodes.iter().any(|node| node == me));
        if !is_known {
            graph.master.register_publisher(&publication.topic, &publication.type_name, &graph.slave)?;
        }
    }
    Ok(())
}

/// Takes all registrations back; where the master does not answer, it does not matter.
fn take_back(graph: &Graph) {
    let state = graph.lock();
    let topics: Vec<String> = state.topics.keys().cloned().collect();
    let publications: Vec<String> = state.publications.iter().map(|p| p.topic.clone()).collect();
    drop(state);
    let all = topics.iter().map(|topic| graph.master.unregister_subscriber(topic, &graph.slave));
    let all = all.chain(publications.iter().map(|topic| graph.master.unregister_publisher(topic, &graph.slave)));
    drop(all.collect::<Result<Vec<()>, String>>());
}
