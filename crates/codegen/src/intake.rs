//! What comes: signals, events, messages, and the silences that they end.

use lapwing_engine::program::{Clock, Read};

use crate::assemble::Writer;
use crate::code::{Block, Expr, Ty, field, local, since};
use crate::fold::rewrite;
use crate::interface::{From, Kind};
use crate::scene::{Scene, updated_slots};
use crate::value::View;

impl Writer<'_> {
    /// The latest of everything.
    pub fn world(&mut self) {
        let unit = &mut self.unit;
        unit.field("t0", Ty::I64, 0.into(), "The stamp of the first step.");
        unit.field("has_t0", Ty::Bool, false.into(), "Whether there was one.");
        unit.field("last", Ty::I64, 0.into(), "The latest stamp that counts.");
        unit.field("has_last", Ty::Bool, false.into(), "Whether there was one.");
        if let Clock::Rate(_) = self.program.clock {
            unit.field("tick", Ty::U64, 0.into(), "The number of the next instant.");
            unit.field("next_tick", Ty::I64, 0.into(), "When it is.");
        }
        for (&from, member) in &self.scene.members {
            let unit = &mut self.unit;
            match from {
                From::Input(slot) => self.signal(slot, member.ty, &member.doc),
                From::Event(event) => {
                    unit.field(&self.scene.event_field(event), Ty::Bool, false.into(), &member.doc);
                }
                From::EventField(event, f) => {
                    let name = self.scene.event_value(event, f);
                    let initial = match member.kind {
                        Kind::Truth => Expr::Bool(false),
                        Kind::Number => Expr::Float(0.0),
                        Kind::Text => Expr::Int(0),
                    };
                    unit.field(&name, member.ty, initial, &member.doc);
                    unit.field(&format!("{name}_there"), Ty::Bool, false.into(), "Whether it has that field.");
                }
                From::Topic(topic) => {
                    let name = self.scene.topic_field(topic);
                    unit.field(&name, Ty::Bool, false.into(), &member.doc);
                    unit.field(&format!("{name}_known"), Ty::Bool, false.into(), "Whether one ever came.");
                }
                From::Pose(_) | From::Twist(_) | From::Part(..) => {}
            }
        }
        for object in self.scene.objects() {
            for (_, slot) in self.scene.parts(object) {
                self.signal(slot, Ty::F64, &format!("`{}`.", self.scene.spec.inputs[slot].label));
            }
        }
        self.object_fields();
        for (event, name) in self.events_of_machines() {
            self.unit.field(
                &name,
                Ty::Bool,
                false.into(),
                &format!("Whether `{}` occurs.", self.scene.spec.events[event].name),
            );
        }
        for (property, _, of) in self.silences() {
            let (heard, has) = heard(self.scene, of);
            self.unit.field(
                &format!("stale{property}"),
                Ty::Bool,
                false.into(),
                "Whether a signal was silent for too long.",
            );
            self.unit.field(&heard, Ty::I64, 0.into(), "When a signal was heard last.");
            self.unit.field(&has, Ty::Bool, false.into(), "Whether it was heard.");
        }
        self.age_fields();
        self.frequency_fields();
    }

    /// The latest value of a signal.
    fn signal(&mut self, slot: usize, ty: Ty, doc: &str) {
        let name = self.scene.slot_field(slot);
        self.unit.field(&name, ty, self.scene.initial(slot), &format!("The latest value: {doc}"));
        if self.program.slots[slot].default.is_none() {
            self.unit.field(&format!("{name}_known"), Ty::Bool, false.into(), "Whether it ever had one.");
        }
    }

    /// The events that machines emit.
    pub fn events_of_machines(&self) -> Vec<(usize, String)> {
        let machines = self.scene.machines.iter().map(|&m| &self.program.machines[m]);
        let mut events: Vec<usize> =
            machines.flat_map(|m| &m.states).flat_map(|s| [s.entered, s.left]).flatten().collect();
        events.sort_unstable();
        events.dedup();
        events.into_iter().map(|e| (e, self.scene.event_field(e))).collect()
    }

    /// Properties, limits in nanoseconds, and of what the silence is.
    pub fn silences(&self) -> Vec<(usize, i64, Read)> {
        let all = self.program.properties.iter().enumerate();
        all.flat_map(|(p, property)| property.stale.iter().map(move |s| (p, s.limit.nanos(), s.of))).collect()
    }

    /// What came becomes the latest.
    pub fn take(&self, b: &mut Block) {
        for (&from, member) in &self.scene.members {
            let value = Expr::Input(member.name.clone());
            match from {
                From::Input(slot) => {
                    let has = Expr::Input(member.has.clone().unwrap_or_default());
                    b.when(has, |b| {
                        self.hear(b, Read::Slot(slot));
                        self.receive(b, slot, value);
                    });
                }
                From::Topic(topic) => b.when(value, |b| {
                    let name = self.scene.topic_field(topic);
                    self.hear(b, Read::Topic(topic));
                    self.count_message(b, topic);
                    b.set(&field(&name), true);
                    b.set(&field(format!("{name}_known")), true);
                }),
                From::Event(event) => b.when(value, |b| self.occur(b, event)),
                From::Pose(_) | From::Twist(_) | From::Part(..) | From::EventField(..) => {}
            }
        }
        self.scene.objects().into_iter().for_each(|object| self.take_object(b, object));
    }

    /// A signal has another value.
    pub fn receive(&self, b: &mut Block, slot: usize, value: Expr) {
        let name = self.scene.slot_field(slot);
        b.set(&field(&name), value);
        if self.program.slots[slot].default.is_none() {
            b.set(&field(format!("{name}_known")), true);
        }
        for &machine in &self.scene.machines {
            if updated_slots(&self.program.machines[machine].at).contains(&slot) {
                b.set(&field(format!("m{machine}_updated_{slot}")), true);
            }
        }
    }

    /// An event occurs, unless its condition says otherwise; its fields are those of this occurrence.
    fn occur(&self, b: &mut Block, event: usize) {
        let when = self.program.events[event].when.as_ref().map(|(at, node)| {
            let view = View { scene: self.scene, at, machine: None, is_early: true };
            in_inputs(view.truth(*node), self.scene, event)
        });
        b.when(when.unwrap_or(Expr::Bool(true)), |b| {
            for (&from, member) in &self.scene.members {
                if let From::EventField(of, f) = from
                    && of == event
                {
                    let name = self.scene.event_value(event, f);
                    b.set(&field(&name), Expr::Input(member.name.clone()));
                    b.set(&field(format!("{name}_there")), Expr::Input(member.has.clone().unwrap_or_default()));
                }
            }
            b.set(&field(self.scene.event_field(event)), true);
        });
    }

    /// A silence ends: it was too long, or not.
    fn hear(&self, b: &mut Block, of: Read) {
        let (heard, has) = heard(self.scene, of);
        let mut minded = false;
        if let Read::Topic(topic) = of {
            minded = self.has_age(topic);
            self.rejuvenate(b, topic);
        }
        for (property, limit, _) in self.silences().into_iter().filter(|(.., read)| *read == of) {
            minded = true;
            let from = field(&has).choose(field(&heard), field("t0"));
            b.when(since(&local("now"), &from).gt(limit), |b| b.set(&field(format!("stale{property}")), true));
        }
        if minded {
            b.set(&field(heard), local("now"));
            b.set(&field(has), true);
        }
    }
}

/// The fields that say when something was heard last, and whether it was.
pub(crate) fn heard(scene: &Scene<'_>, of: Read) -> (String, String) {
    let name = match of {
        Read::Slot(slot) => scene.slot_field(slot),
        Read::Topic(topic) => scene.topic_field(topic),
    };
    (format!("{name}_heard"), format!("{name}_was_heard"))
}

/// A condition on an event's fields, over what has just come.
fn in_inputs(e: Expr, scene: &Scene<'_>, event: usize) -> Expr {
    rewrite(e, &|leaf| match leaf {
        Expr::Field(name) if name == scene.event_field(event) => Expr::Bool(true),
        Expr::Field(name) => input_of(&name, scene, event).unwrap_or(Expr::Field(name)),
        leaf => leaf,
    })
}

/// What comes, of an event, that a field of the monitor is the latest of.
fn input_of(name: &str, scene: &Scene<'_>, event: usize) -> Option<Expr> {
    let mut members = scene.members.iter();
    let member = members.find_map(|(from, member)| match from {
        From::EventField(of, f) if *of == event => match name.strip_prefix(&scene.event_value(event, *f))? {
            "" => Some(member.name.clone()),
            "_there" => member.has.clone(),
            _ => None,
        },
        _ => None,
    });
    member.map(Expr::Input)
}
