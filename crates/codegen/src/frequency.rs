//! How many messages of a topic came in a window that ends now: the stamps of those that did, in a queue for each window.

use lapwing_engine::program::{Node, Positions};
use lapwing_stream::Duration;

use crate::assemble::Writer;
use crate::code::{Block, Expr, Ty, field, local, since};
use crate::kinds::each_positions;
use crate::ring::Ring;
use crate::scene::Scene;

/// The stamps of the messages of a topic in a window.
pub(crate) struct Window {
    ring: Ring,
    topic: usize,
    length: i64,
}

/// The windows that some positions ask for, each once. Their fields are those of [`Writer::frequency_fields`].
pub(crate) fn rings(scene: &Scene<'_>, at: &Positions, capacity: usize) -> Vec<Window> {
    let mut all: Vec<Window> = Vec::new();
    for node in &at.nodes {
        if let Node::Frequency(topic, window) = node
            && !all.iter().any(|w| (w.topic, w.length) == (*topic, window.nanos()))
        {
            let ring = Ring { name: name(scene, *topic, *window), len: capacity };
            all.push(Window { ring, topic: *topic, length: window.nanos() });
        }
    }
    all
}

/// The number of messages in a window, over its length in seconds.
pub(crate) fn frequency(scene: &Scene<'_>, topic: usize, window: Duration) -> Expr {
    field(format!("{}_count", name(scene, topic, window))).cast(Ty::F64).div(window.seconds())
}

fn name(scene: &Scene<'_>, topic: usize, window: Duration) -> String {
    format!("{}_within_{}", scene.topic_field(topic), window.nanos())
}

impl Window {
    /// What came before the window leaves it: it is open where it begins.
    pub fn shorten(&self, b: &mut Block) {
        let oldest = since(&local("now"), &self.ring.at(0.into()));
        b.repeat(self.ring.count().gt(0) & oldest.ge(self.length), |b| self.ring.pop(b));
    }

    /// The field that says that there were too many.
    pub fn full(&self) -> String {
        self.ring.full()
    }
}

impl Writer<'_> {
    /// Adds what is remembered of messages.
    pub fn frequency_fields(&mut self) {
        for window in self.windows() {
            let ring = Ring::new(&mut self.unit, window.ring.name, window.ring.len);
            let doc = "Whether more messages came in a window than there is room for.";
            self.unit.field(&ring.full(), Ty::Bool, false.into(), doc);
        }
    }

    /// A message of a topic comes.
    pub fn count_message(&self, b: &mut Block, topic: usize) {
        for window in self.windows().into_iter().filter(|w| w.topic == topic) {
            window.shorten(b);
            window.ring.push(b, &local("now"), true);
        }
    }

    fn windows(&self) -> Vec<Window> {
        let mut all: Vec<Window> = Vec::new();
        each_positions(self.program, |at| {
            for window in rings(self.scene, at, self.capacity) {
                if !all.iter().any(|known| known.ring.name == window.ring.name) {
                    all.push(window);
                }
            }
        });
        all
    }
}
