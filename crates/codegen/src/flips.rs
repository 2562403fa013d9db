//! How old the latest message of a topic is. A comparison of an age changes between messages, at distances from the latest that are known
//! beforehand: those moments are instants of their own, for the machines and groups that compare it, where instants are not those of a rate.

use lapwing_engine::program::{AgeFlips, Clock, Node, Positions, Read};

use crate::assemble::Writer;
use crate::code::{Block, Expr, Helper, Ty, call, field, local};
use crate::intake::heard;

/// The comparisons of one machine or group with one topic's age.
pub(crate) struct Flips<'a> {
    /// The name of the function of the machine or the group.
    owner: String,
    of: &'a AgeFlips,
    /// The field that counts how many of them are over since the latest message.
    over: String,
}

/// Whether the age of a topic is asked for.
pub(crate) fn asks_age(at: &Positions, topic: usize) -> bool {
    at.nodes.iter().any(|node| matches!(node, Node::Age(of) if *of == topic))
        || at.ages.iter().any(|a| a.topic == topic)
}

impl<'a> Writer<'a> {
    /// Those whose ages count, with the names of their functions.
    fn agers(&self) -> Vec<(String, &'a Positions)> {
        let program = self.program;
        let machines = self.scene.machines.iter().map(|&m| (format!("m{m}"), &program.machines[m].at));
        machines.chain(program.groups.iter().enumerate().map(|(g, group)| (format!("g{g}"), &group.at))).collect()
    }

    /// Whether anybody asks for the age of a topic.
    pub fn has_age(&self, topic: usize) -> bool {
        self.agers().iter().any(|(_, at)| asks_age(at, topic))
    }

    /// All comparisons that make instants.
    pub fn flips(&self) -> Vec<Flips<'a>> {
        if self.program.clock != Clock::Events {
            return Vec::new();
        }
        let of = |(owner, at): (String, &'a Positions)| {
            let name = move |(k, of)| Flips { over: format!("{owner}_flips{k}"), owner: owner.clone(), of };
            // A comparison that never changes makes no instants.
            at.ages.iter().filter(|of| !of.after.is_empty()).enumerate().map(name).collect::<Vec<_>>()
        };
        self.agers().into_iter().flat_map(of).collect()
    }

    /// What is remembered of them.
    pub fn age_fields(&mut self) {
        let aged: Vec<usize> = (0..self.program.topics.len()).filter(|&topic| self.has_age(topic)).collect();
        for topic in aged {
            let (heard, has) = heard(self.scene, Read::Topic(topic));
            self.unit.field(&heard, Ty::I64, 0.into(), "When a signal was heard last.");
            self.unit.field(&has, Ty::Bool, false.into(), "Whether it was heard.");
        }
        for flips in self.flips() {
            let doc = "How many changes of a comparison of an age are over since the latest message.";
            self.unit.field(&flips.over, Ty::U32, 0.into(), doc);
        }
        if !self.flips().is_empty() {
            self.unit.field("flip", Ty::I64, i64::MAX.into(), "When a comparison of an age changes next.");
            self.unit.field("instant_at", Ty::I64, 0.into(), "The stamp of the latest instant.");
            self.unit.field("has_instant", Ty::Bool, false.into(), "Whether there was one.");
        }
    }

    /// A message comes: what is told of its topic's age begins anew, unless the one before has the same stamp.
    pub fn rejuvenate(&self, b: &mut Block, topic: usize) {
        let (heard, has) = heard(self.scene, Read::Topic(topic));
        let own = || self.flips().into_iter().filter(|flips| flips.of.topic == topic);
        if own().next().is_some() {
            b.when(!(field(has) & field(heard).eq(local("now"))), |b| own().for_each(|f| b.set(&field(f.over), 0)));
        }
    }

    /// Writes the function that finds the next change.
    pub fn find_flip(&mut self) {
        let all = self.flips();
        if all.is_empty() {
            return;
        }
        let next = field("flip");
        let body = Block::of(|b| {
            b.set(&next, i64::MAX);
            for flips in &all {
                b.when(self.is_pending(flips) & self.at(flips).lt(&next), |b| b.set(&next, self.at(flips)));
            }
        });
        self.unit.function("find_flip", "When a comparison of an age changes next.", &[], body);
    }

    /// The changes before `now`, each an instant of its own unless there was one with that stamp.
    pub fn pass_flips(&self, b: &mut Block) {
        let all = self.flips();
        if all.is_empty() {
            return;
        }
        b.call("find_flip", Vec::new());
        b.repeat(field("flip").lt(local("now")), |b| {
            let at = b.bind("at", Ty::I64, field("flip"));
            let is_new = b.bind("is_new", Ty::Bool, !(field("has_instant") & field("instant_at").eq(&at)));
            if self.has("expire") {
                b.when(is_new.clone(), |b| b.call("expire", vec![at.clone()]));
            }
            for (owner, _) in self.agers() {
                let own = || all.iter().filter(|flips| flips.owner == owner);
                let changes = own().map(|f| self.is_pending(f) & self.at(f).eq(&at)).reduce(|a, b| a | b);
                let Some(changes) = changes else { continue };
                b.when(changes, |b| {
                    for flips in own() {
                        b.repeat(self.is_pending(flips) & self.at(flips).le(&at), |b| b.add(&field(&flips.over), 1));
                    }
                    b.when(is_new.clone(), |b| b.call(&owner, vec![at.clone()]));
                });
            }
            self.end_instant(b);
            b.call("find_flip", Vec::new());
        });
    }

    /// Whether there is another change after the latest message.
    fn is_pending(&self, flips: &Flips<'_>) -> Expr {
        let (_, has) = heard(self.scene, Read::Topic(flips.of.topic));
        field(has) & field(&flips.over).lt(flips.of.after.len() as i64)
    }

    /// When it is.
    fn at(&self, flips: &Flips<'_>) -> Expr {
        let (heard, _) = heard(self.scene, Read::Topic(flips.of.topic));
        let mut after = flips.of.after.iter().enumerate().rev().map(|(i, after)| (i as i64, Expr::Int(after.nanos())));
        let last = after.next().map_or(Expr::Int(0), |(_, after)| after);
        let after = after.fold(last, |later, (i, after)| field(&flips.over).eq(i).choose(after, later));
        call(Helper::Later, vec![field(heard), after])
    }
}
