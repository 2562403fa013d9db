//! The functions of the monitor: what a step does, in the order in which the engine does it.

use std::collections::BTreeMap;

use lapwing_engine::program::{Clock, Node, Op, Positions, Program};

use crate::code::{Bin, Block, Expr, Helper, Ty, Unit, call, field, local, since};
use crate::formula::Beyond;
use crate::interface::From;
use crate::machines;
use crate::obligations::Obligations;
use crate::past::{Past, looks_back};
use crate::positions::enter;
use crate::prune::without_unread;
use crate::scene::{Scene, emitter};
use crate::segments::Segments;
use crate::verdict::End;

/// The fields that callers read.
const KEPT: &[&str] = &["verdict", "cause", "met", "failed", "open", "first_began", "first_failed"];

/// Why a property of that number cannot be written.
pub(crate) type Failed = (usize, Beyond);

/// Writes the whole monitor.
pub(crate) fn assemble(scene: &Scene<'_>, capacity: usize) -> Result<Unit, Failed> {
    let mut writer = Writer {
        scene,
        program: scene.program,
        capacity,
        unit: Unit::default(),
        ends: Vec::new(),
        spoils: BTreeMap::new(),
    };
    writer.kept();
    writer.world();
    writer.fail();
    for &machine in &scene.machines {
        let full = machines::machine(scene, machine, capacity, &mut writer.unit);
        let full = full.into_iter().chain(writer.spoils_of(&scene.program.machines[machine].at)).collect();
        writer.spoils.insert(machine, full);
    }
    let mut expiring = Vec::new();
    for number in 0..scene.program.groups.len() {
        writer.group(number, &mut expiring)?;
    }
    writer.pass(&expiring);
    writer.instant();
    writer.find_flip();
    writer.pass_time();
    writer.end();
    writer.restart();
    writer.advance();
    writer.step();
    Ok(without_unread(writer.unit, KEPT))
}

/// The monitor, as it is written.
pub(crate) struct Writer<'a> {
    pub scene: &'a Scene<'a>,
    pub program: &'a Program,
    pub capacity: usize,
    pub unit: Unit,
    /// For each property: what its verdict is worked out from.
    pub ends: Vec<End>,
    /// For each machine, the fields that say that where it stands means nothing.
    pub spoils: BTreeMap<usize, Vec<String>>,
}

impl<'a> Writer<'a> {
    pub fn properties(&self) -> usize {
        self.program.properties.len()
    }

    /// The fields that say that what some code reads of machines means nothing.
    fn spoils_of(&self, at: &Positions) -> Vec<String> {
        let mut full: Vec<String> = Vec::new();
        let mut machine = |m: usize| full.extend(self.spoils.get(&m).into_iter().flatten().cloned());
        let of_event = |event: usize| emitter(self.program, event);
        for op in &at.ops {
            if let Op::Event(e) = op {
                of_event(*e).into_iter().for_each(&mut machine);
            }
        }
        for node in &at.nodes {
            match node {
                Node::InState { machine: m, .. } => machine(*m),
                Node::Event(e) => of_event(*e).into_iter().for_each(&mut machine),
                _ => {}
            }
        }
        at.alphabet.iter().flatten().filter_map(|e| of_event(*e)).for_each(machine);
        full.sort();
        full.dedup();
        full
    }

    fn group(&mut self, number: usize, expiring: &mut Vec<String>) -> Result<(), Failed> {
        let (scene, group) = (self.scene, &self.program.groups[number]);
        let prefix = format!("g{number}");
        let mut b = Block::default();
        let walked =
            self.unit.field(&format!("{prefix}_walked"), Ty::Bool, false.into(), "Whether there was a position.");
        let last = self.unit.field(&format!("{prefix}_last"), Ty::I64, 0.into(), "The stamp of the latest.");
        let running = enter(scene, &group.at, &prefix, &mut self.unit, &mut b);
        let (at, capacity) = (&group.at, self.capacity);
        let overflows = Vec::new();
        let mut past = Past { scene, at, prefix: prefix.clone(), machine: None, capacity, running, overflows };
        past.run(&mut self.unit, &mut b);
        b.when(!past.running.clone(), Block::leave);
        let segments = Segments::of(group, &prefix);
        segments.step(&mut self.unit, &mut b);
        let full: Vec<String> = past.overflows.into_iter().chain(self.spoils_of(at)).collect();
        let spoilt = full.iter().map(field).fold(Expr::Bool(false), |a, b| a | b);
        let mut at_once = Vec::new();
        for (t, tracker) in group.trackers.iter().enumerate() {
            let name = format!("{prefix}_t{t}");
            let obligations = Obligations::new(group, tracker, &segments, name, self.capacity)
                .map_err(|beyond| (tracker.property, beyond))?;
            obligations.fields(&mut self.unit);
            obligations.position(&mut self.unit, &mut b, spoilt.clone());
            if let Some(name) = obligations.expire(&mut self.unit) {
                if obligations.may_expire_at_once() {
                    at_once.push(name.clone());
                }
                expiring.push(name);
            }
            self.end_of(group, &obligations, tracker.property, &prefix, spoilt.clone());
        }
        at_once.into_iter().for_each(|name| b.call(name, vec![local("now")]));
        b.set(&walked, true);
        b.set(&last, local("now"));
        self.unit.function(&prefix, "An instant, for the properties of a group.", &[("now", Ty::I64)], b);
        Ok(())
    }

    /// Time has come to `now`: what ended before is over.
    fn pass(&mut self, expiring: &[String]) {
        let body = Block::of(|b| {
            for &machine in &self.scene.machines {
                machines::expire(&self.program.machines[machine], machine, b);
            }
            expiring.iter().for_each(|name| b.call(name, vec![local("now")]));
        });
        self.unit.function(
            "expire",
            "Time has come so far: bounds that ended before are over.",
            &[("now", Ty::I64)],
            body,
        );
    }

    pub fn has(&self, function: &str) -> bool {
        self.unit.functions.iter().any(|f| f.name == function)
    }

    fn instant(&mut self) {
        let body = Block::of(|b| {
            let machines = self.scene.machines.iter().map(|m| format!("m{m}"));
            let groups = (0..self.program.groups.len()).map(|g| format!("g{g}"));
            for name in machines.chain(groups).filter(|name| self.has(name)) {
                b.call(name, vec![local("now")]);
            }
            if !self.flips().is_empty() {
                b.set(&field("instant_at"), local("now"));
                b.set(&field("has_instant"), true);
            }
            self.end_instant(b);
        });
        self.unit.function("instant", "An instant: the machines look, then the properties.", &[("now", Ty::I64)], body);
    }

    /// What holds for one instant is over.
    pub fn end_instant(&self, b: &mut Block) {
        b.comment("Events and messages end with the instant.");
        for &from in self.scene.members.keys() {
            match from {
                From::Event(event) => b.set(&field(self.scene.event_field(event)), false),
                From::Topic(topic) => b.set(&field(self.scene.topic_field(topic)), false),
                _ => {}
            }
        }
        for (_, name) in self.events_of_machines() {
            b.set(&field(name), false);
        }
    }

    /// Everything that happens before what has the stamp `now`.
    fn pass_time(&mut self) {
        let now = local("now");
        let body = Block::of(|b| {
            if let Clock::Rate(rate) = self.program.clock {
                b.repeat(field("has_t0") & field("next_tick").lt(&now), |b| self.tick(b, rate));
            }
            self.pass_flips(b);
            if self.has("expire") {
                b.call("expire", vec![now.clone()]);
            }
        });
        self.unit.function("pass_time", "Everything that happens by itself before a time.", &[("now", Ty::I64)], body);
    }

    /// An instant of a rate.
    pub fn tick(&self, b: &mut Block, rate: u32) {
        let (tick, next, rate) = (field("tick"), field("next_tick"), i64::from(rate.max(1)));
        for name in ["expire", "instant"].into_iter().filter(|name| self.has(name)) {
            b.call(name, vec![next.clone()]);
        }
        b.add(&tick, 1);
        let whole = tick.clone().div(rate).mul(1_000_000_000);
        let part = tick.bin(Bin::Rem, rate).mul(1_000_000_000).div(rate);
        b.set(&next, call(Helper::Later, vec![field("t0"), whole + part]));
    }

    /// What every call begins with.
    fn arrive(&self, b: &mut Block) {
        let now = local("now");
        let mut back = now.clone().lt(field("newest"));
        if let Clock::Rate(rate) = self.program.clock {
            // More instants than anyone could want lie between: as a jump back.
            let longest = 10_000_000 * 1_000_000_000 / i64::from(rate.max(1));
            back = back | (field("has_last") & field("has_t0") & since(&now, &field("last")).gt(longest));
        }
        b.when(field("has_newest") & back, |b| b.call("restart", vec![]));
        b.set(&field("newest"), now.clone());
        b.set(&field("has_newest"), true);
        if let Some(timeout) = self.program.timeout {
            b.when(field("has_t0") & since(&now, &field("t0")).gt(timeout.nanos()), Block::leave);
        }
        if self.has("pass_time") {
            b.call("pass_time", vec![now.clone()]);
        }
        b.set(&field("last"), now);
        b.set(&field("has_last"), true);
    }

    fn advance(&mut self) {
        let body = Block::of(|b| self.arrive(b));
        self.unit.function("advance", "Time has come so far, and nothing came.", &[("now", Ty::I64)], body);
    }

    fn step(&mut self) {
        let (now, primes) = (local("now"), self.prime());
        let body = Block::of(|b| {
            self.arrive(b);
            b.when(!field("has_t0"), |b| {
                b.set(&field("t0"), now.clone());
                b.set(&field("has_t0"), true);
                if let Clock::Rate(_) = self.program.clock {
                    b.set(&field("next_tick"), now.clone());
                }
                primes.iter().for_each(|name| b.call(name, vec![now.clone()]));
            });
            self.take(b);
            if self.program.clock == Clock::Events && self.has("instant") {
                b.call("instant", vec![now.clone()]);
            }
        });
        self.unit.function("step", "Something came at a time, in nanoseconds: an instant.", &[("now", Ty::I64)], body);
        if let Some(step) = self.unit.functions.last_mut() {
            step.takes_inputs = true;
        }
    }

    /// What looks back further than there are instants finds defaults. Gives the functions that see to it.
    fn prime(&mut self) -> Vec<String> {
        let program = self.program;
        let machines = self.scene.machines.iter().map(|&m| (format!("m{m}"), &program.machines[m].at, Some(m)));
        let groups = program.groups.iter().enumerate().map(|(g, group)| (format!("g{g}"), &group.at, None));
        let mut names = Vec::new();
        for (prefix, at, machine) in machines.chain(groups).filter(|(_, at, _)| looks_back(at)) {
            let name = format!("{prefix}_prime");
            let (capacity, overflows) = (self.capacity, Vec::new());
            let past = Past { scene: self.scene, at, prefix, machine, capacity, running: false.into(), overflows };
            let body = Block::of(|b| past.prime(b));
            if self.unit.function(
                &name,
                "Before the first instant signals have their defaults.",
                &[("now", Ty::I64)],
                body,
            ) {
                names.push(name);
            }
        }
        names
    }
}
