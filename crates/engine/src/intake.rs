//! What a sample brings becomes the latest: signals, topics, events, and the silences that it ends.

use lapwing_stream::{Sample, Time, Value, What};

use crate::node::{Notes, View};
use crate::piece::Piece;
use crate::program::{Column, Program, Read, Silence};
use crate::skim::Row;

impl Piece {
    /// The sample's values become the latest.
    #[inline]
    pub(crate) fn take_in(&mut self, program: &Program, sample: Sample<'_>) {
        match sample.what {
            What::Message { topic, values } => {
                self.message(program, topic, values, sample.time.0);
                self.make_instances(program);
            }
            What::Row { cells } => {
                self.inputs.set_row(program, cells);
                self.inputs.row = Row::NONE;
                if program.skim.is_some() {
                    self.note_row(program, cells);
                }
                if self.minds_slots {
                    self.hear(program, cells, sample.time.0);
                }
            }
            What::Event { event, values } => {
                self.inputs.occur(event, values.iter());
                self.filter_event(program, event);
                self.make_instances(program);
            }
            What::Other => {}
        }
    }

    /// Signals of a row whose silence something minds.
    fn hear(&mut self, program: &Program, cells: &[Value], now: i64) {
        for &Column { cell, slot, .. } in &program.columns {
            if cells.get(cell).is_some_and(|value| !matches!(value, Value::Missing)) {
                self.note_silence(program, Read::Slot(slot), now);
                self.heard[slot] = Some(now);
            }
        }
    }

    /// Values of slices may have been seen for the first time.
    fn make_instances(&mut self, program: &Program) {
        if !self.is_sliced {
            return;
        }
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            if !plan.at.slices.is_empty() {
                instances.make(&plan.at, &self.inputs);
            }
        }
    }

    fn message(&mut self, program: &Program, topic: usize, values: &[Value], now: i64) {
        let Some(plan) = program.topics.get(topic) else { return };
        for (slots, value) in plan.fields.iter().zip(values) {
            slots.iter().for_each(|&slot| self.inputs.set(program, slot, value));
        }
        if self.minds_topics[topic] {
            self.note_silence(program, Read::Topic(topic), now);
        }
        self.inputs.stir(&plan.wakes);
        let state = &mut self.inputs.topics[topic];
        self.messages[topic].0 += 1;
        // A message that comes before the instant after the one before it makes that one unseen.
        self.messages[topic].1 += u64::from(state.fresh);
        (state.last, state.fresh) = (Some(now), true);
        if let Some(window) = plan.window {
            state.stamps.push_back(now);
            while state.stamps.front().is_some_and(|&t| t <= now.saturating_sub(window.nanos())) {
                state.stamps.pop_front();
            }
        }
        for &object in &plan.objects {
            let plan = &program.objects[object];
            self.objects[object].message(program, plan, topic, values, now, &mut self.inputs);
        }
        for &event in &plan.events {
            if let Some(from) = &program.events[event].from_message {
                self.inputs.occur(event, from.iter().map(|&f| values.get(f).unwrap_or(&Value::Missing)));
                self.filter_event(program, event);
            }
        }
    }

    /// Takes the latest occurrence of an event back where its condition does not hold.
    fn filter_event(&mut self, program: &Program, event: usize) {
        let Some((at, when)) = program.events.get(event).and_then(|e| e.when.as_ref()) else { return };
        let notes = Notes::default();
        let view =
            View { at, inputs: &self.inputs, bits: &[], values: &[], params: &[], now: 0, notes: &notes, seen: &[] };
        let holds = view.holds(*when);
        let state = &mut self.inputs.events[event];
        state.is_unclear |= notes.fault.get();
        if !holds || notes.fault.get() {
            state.count -= 1;
        }
    }

    /// Marks the properties for which this topic or signal has been silent for too long.
    pub(crate) fn note_silence(&mut self, program: &Program, of: Read, now: i64) {
        let heard = match of {
            Read::Topic(topic) => self.inputs.topics[topic].last,
            Read::Slot(slot) => self.heard[slot],
        };
        let since = heard.or(self.t0).unwrap_or(now);
        for (property, stale) in program.properties.iter().zip(&mut self.stale) {
            let too_long = |s: &Silence| s.of == of && Time(now).since(Time(since)) > s.limit;
            if stale.is_none() {
                *stale = property.stale.iter().position(too_long).map(|i| (i, since, now));
            }
        }
    }
}
