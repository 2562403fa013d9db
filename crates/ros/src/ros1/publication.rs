//! What this node publishes: its subscribers, each with a queue of its own, so that none waits for another, and nobody for any of them.

use std::collections::VecDeque;
use std::io::{self, BufWriter, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use bytes::Bytes;

use super::frame;
use super::graph::Graph;
use super::header::Header;
use super::net::{Timed, is_timeout};

/// What waits for a subscriber: no more messages, and no more bytes of them. The oldest make room, as anywhere in ROS.
const MOST: (usize, usize) = (1000, 16 << 20);
/// How long a subscriber may take to say what it wants.
const PATIENCE: Duration = Duration::from_secs(5);

/// A topic that this node publishes.
#[derive(Debug)]
pub(crate) struct Publication {
    pub topic: String,
    pub type_name: String,
    pub checksum: String,
    pub definition: String,
    pub is_latched: bool,
    out: Mutex<Out>,
}

#[derive(Debug, Default)]
struct Out {
    /// The last message, where it is kept for those who come late.
    last: Option<Bytes>,
    subscribers: Vec<Arc<Subscriber>>,
    is_closed: bool,
}

impl Publication {
    pub fn new(
        topic: String,
        type_name: String,
        checksum: String,
        definition: String,
        is_latched: bool,
    ) -> Publication {
        Publication { topic, type_name, checksum, definition, is_latched, out: Mutex::default() }
    }

    /// Puts a message into every queue.
    pub fn publish(&self, payload: &[u8]) {
        let framed = frame::write(payload);
        let mut out = self.lock();
        out.subscribers.iter().for_each(|subscriber| subscriber.push(framed.clone()));
        if self.is_latched {
            out.last = Some(framed);
        }
    }

    /// Lets all subscribers go, once they have what waits for them.
    pub fn close(&self) {
        let mut out = self.lock();
        out.is_closed = true;
        out.subscribers.drain(..).for_each(|subscriber| subscriber.close());
    }

    /// Who is connected.
    pub fn subscribers(&self) -> Vec<String> {
        self.lock().subscribers.iter().map(|subscriber| subscriber.node.clone()).collect()
    }

    fn join(&self, node: &str) -> Arc<Subscriber> {
        let subscriber =
            Arc::new(Subscriber { node: node.to_owned(), waiting: Mutex::default(), filled: Condvar::new() });
        let mut out = self.lock();
        if let Some(last) = out.last.clone() {
            subscriber.push(last);
        }
        if out.is_closed {
            subscriber.close();
        } else {
            out.subscribers.push(subscriber.clone());
        }
        subscriber
    }

    fn leave(&self, subscriber: &Arc<Subscriber>) {
        self.lock().subscribers.retain(|other| !Arc::ptr_eq(other, subscriber));
    }

    /// Why a subscriber that wants that is not served.
    fn objection(&self, wanted: &Header) -> Option<String> {
        let sum = wanted.get("md5sum").unwrap_or("*");
        (sum != "*" && sum != self.checksum).then(|| {
            let ty = wanted.get("type").unwrap_or("a type");
            format!("{} is {} with checksum {} here, not {ty} with {sum}", self.topic, self.type_name, self.checksum)
        })
    }

    fn lock(&self) -> MutexGuard<'_, Out> {
        self.out.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Serves who connected: reads what it wants, and gives it that until it leaves.
pub(crate) fn serve(graph: &Graph, stream: &TcpStream) {
    if let Err(error) = answer(graph, stream) {
        // It tried and left, or is no node: there is nobody whom it concerns but itself.
        let reason = Header::of(&[("error", &error.to_string())]);
        let mut timed = Timed { stream, deadline: Instant::now() + PATIENCE };
        drop(timed.write_all(&reason.bytes()));
    }
    drop(stream.shutdown(Shutdown::Both));
}

fn answer(graph: &Graph, stream: &TcpStream) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let mut timed = Timed { stream, deadline: Instant::now() + PATIENCE };
    let wanted = Header::read(&mut timed)?;
    let topic = wanted.need("topic")?;
    let found = graph.lock().publications.iter().find(|p| p.topic == topic).cloned();
    let publication =
        found.ok_or_else(|| io::Error::other(format!("{} does not publish {topic}", graph.names.node())))?;
    if let Some(objection) = publication.objection(&wanted) {
        graph.note(format!("{} wants {objection}", wanted.get("callerid").unwrap_or("somebody")));
        return Err(io::Error::other(objection));
    }
    let offered = Header::of(&[
        ("callerid", graph.names.node()),
        ("topic", topic),
        ("type", &publication.type_name),
        ("md5sum", &publication.checksum),
        ("message_definition", &publication.definition),
        ("latching", if publication.is_latched { "1" } else { "0" }),
    ]);
    timed.write_all(&offered.bytes())?;
    stream.set_write_timeout(None)?;
    let subscriber = publication.join(wanted.get("callerid").unwrap_or("somebody"));
    // How it ends is the subscriber's affair: it left, or is left.
    drop(subscriber.feed(stream, |dropped| {
        let node = &subscriber.node;
        graph.note(format!("{node} reads {topic} too slowly: {dropped} messages to it were dropped"));
    }));
    publication.leave(&subscriber);
    Ok(())
}

/// A subscriber and what waits for it.
#[derive(Debug)]
struct Subscriber {
    node: String,
    waiting: Mutex<Waiting>,
    filled: Condvar,
}

#[derive(Debug, Default)]
struct Waiting {
    messages: VecDeque<Bytes>,
    bytes: usize,
    dropped: u64,
    is_closed: bool,
}

impl Subscriber {
    fn push(&self, message: Bytes) {
        let mut waiting = self.lock();
        waiting.bytes += message.len();
        waiting.messages.push_back(message);
        while waiting.messages.len() > MOST.0 || (waiting.bytes > MOST.1 && waiting.messages.len() > 1) {
            let oldest = waiting.messages.pop_front().map_or(0, |m| m.len());
            waiting.bytes -= oldest;
            waiting.dropped += 1;
        }
        drop(waiting);
        self.filled.notify_one();
    }

    fn close(&self) {
        self.lock().is_closed = true;
        self.filled.notify_one();
    }

    /// Writes what waits, until it is closed or the connection breaks.
    fn feed(&self, stream: &TcpStream, mut dropped: impl FnMut(u64)) -> io::Result<()> {
        let mut writer = BufWriter::new(stream);
        loop {
            let idle = |w: &mut Waiting| w.messages.is_empty() && !w.is_closed;
            let waited = self.filled.wait_timeout_while(self.lock(), PATIENCE, idle);
            let (mut waiting, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
            if timeout.timed_out() {
                drop(waiting);
                if is_gone(stream)? {
                    return Ok(());
                }
                continue;
            }
            let (messages, lost) = (std::mem::take(&mut waiting.messages), std::mem::take(&mut waiting.dropped));
            (waiting.bytes, waiting.dropped) = (0, 0);
            drop(waiting);
            if messages.is_empty() {
                return Ok(());
            }
            for message in messages {
                writer.write_all(&message)?;
            }
            writer.flush()?;
            if lost > 0 {
                dropped(lost);
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether the other end has closed a connection: where nothing is published, no write would tell.
fn is_gone(stream: &TcpStream) -> io::Result<bool> {
    stream.set_nonblocking(true)?;
    let peeked = stream.peek(&mut [0]);
    stream.set_nonblocking(false)?;
    match peeked {
        Ok(bytes) => Ok(bytes == 0),
        Err(error) if is_timeout(&error) => Ok(false),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_make_room() {
        let publication = Publication::new("/a".into(), "p/T".into(), "1".into(), String::new(), true);
        publication.publish(&[9]);
        let late = publication.join("/late");
        let waiting = || {
            let waiting = late.lock();
            (waiting.messages.len(), waiting.bytes, waiting.dropped)
        };
        assert_eq!(waiting().0, 1, "the last message is kept");
        (0..MOST.0 + 5).for_each(|k| publication.publish(&[k as u8; 10]));
        assert_eq!((waiting().0, waiting().2), (MOST.0, 6));
        let big = vec![0; MOST.1 / 2];
        (0..3).for_each(|_| publication.publish(&big));
        let (messages, bytes, _) = waiting();
        assert!(bytes <= MOST.1 && messages <= 2, "{messages} messages of {bytes} bytes");
        publication.leave(&late);
        assert!(publication.subscribers().is_empty());
    }
}
