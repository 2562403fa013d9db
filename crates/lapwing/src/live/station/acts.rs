//! What a run does besides judging: reactions, guards, and telling how things stand.

use std::time::Duration;

use bytes::Bytes;
use lapwing_react::Event;
use lapwing_record::TimeSource;
use lapwing_stream::Time;

use super::{Duty, Station};
use crate::live::course::{Alarm, Course, Seen, Sight};
use crate::live::herald::{DIAGNOSTICS, Herald};
use crate::live::view::View;
use crate::status::Status;

impl Station {
    /// Gets the herald ready, where one is wanted and would not talk to its own specifications.
    pub(super) fn speak_up(&mut self, duty: &mut Duty<'_, '_>) {
        let Some(node) = self.options.herald.clone().filter(|_| self.herald.is_none()) else { return };
        if duty.course.wanted().iter().any(|topic| topic == DIAGNOSTICS) {
            return duty.watch.note("nothing is published on /diagnostics: a specification reads that topic");
        }
        match Herald::new(&node, &mut *self.connector) {
            Ok(herald) => self.herald = Some(herald),
            Err(why) => duty.watch.note(&format!("nothing is said on the graph: {why}")),
        }
    }

    /// Carries out what the latest violations ask for.
    pub(super) fn react(&mut self, arrived: Option<Time>, duty: &mut Duty<'_, '_>) {
        let alarms = duty.course.take_alarms();
        if alarms.is_empty() {
            return;
        }
        self.proclaim(&alarms, duty);
        let now = self.connector.now();
        let done = duty.reactions.carry_out(&alarms, now, &mut *self.connector);
        if let Some(took) = arrived.filter(|_| done.sent > 0).and_then(|arrived| self.since(arrived)) {
            self.figures.reacted.note(took);
        }
        duty.stops |= done.stops;
        // At the moment of the violation: what came with it is over.
        let at = duty.course.last().unwrap_or(now);
        for property in done.resets {
            duty.take(Sight { at, what: Seen::Status(Status::Reset(property)) });
        }
        done.notes.iter().for_each(|note| duty.watch.note(note));
    }

    /// Says on the graph what is violated.
    fn proclaim(&mut self, alarms: &[Alarm], duty: &mut Duty<'_, '_>) {
        let Some(herald) = &mut self.herald else { return };
        for Alarm { property, violation, .. } in alarms {
            let line = lapwing_react::line(duty.course.source(), Event::Violation { property, violation });
            if let Err(why) = herald.say(&line, &mut *self.connector) {
                return duty.watch.note(&format!("a violation could not be said on the graph: {why}"));
            }
        }
    }

    /// Decides on a message that a guard stands in the way of.
    pub(super) fn guard(&mut self, topic: &str, payload: &Bytes, arrived: Option<Time>, duty: &mut Duty<'_, '_>) {
        let Duty { guards, course, watch, .. } = duty;
        let mut sent = false;
        for guard in guards.iter_mut().filter(|guard| guard.is_from(topic)) {
            let decision = guard.decide(course, payload, &mut *self.connector);
            sent |= decision.is_sent;
            decision.note.into_iter().for_each(|note| watch.note(&note));
        }
        if let Some(took) = arrived.filter(|_| sent).and_then(|arrived| self.since(arrived)) {
            self.figures.guarded.note(took);
        }
    }

    /// Tells those who look on, and the graph, how things stand, where it is time to.
    pub(super) fn show(&mut self, duty: &mut Duty<'_, '_>) {
        let now = self.connector.now();
        let is_due = |pause: Duration, last: Option<Time>| {
            last.is_none_or(|last| u128::from(now.since(last).nanos().unsigned_abs()) >= pause.as_nanos())
        };
        let looks = duty.watch.pause().is_some_and(|pause| is_due(pause, duty.shown));
        let tells = self.herald.as_ref().is_some_and(|herald| herald.is_due(now));
        if !looks && !tells {
            return;
        }
        let mut view = self.view(&duty.course);
        if looks {
            duty.course.fill_strips(&mut view);
            duty.shown = Some(now);
            duty.watch.look(&view);
        }
        if let Some(herald) = self.herald.as_mut().filter(|_| tells)
            && let Err(why) = herald.tell(&view, now, &mut *self.connector)
        {
            duty.watch.note(&format!("nothing is said on the graph any more: {why}"));
            self.herald = None;
        }
    }

    pub(super) fn view(&mut self, course: &Course<'_>) -> View {
        let mut view = View { figures: self.figures.clone(), ..course.view() };
        let now = self.connector.now();
        // Where nothing is seen, time goes on all the same.
        if self.clock.is_wall() && self.options.checking.recording.time != TimeSource::Header {
            view.now = view.now.max(now);
        }
        self.rates.fill(&mut view, now);
        view
    }

    /// How long ago something arrived, once the two clocks have been compared.
    pub(super) fn since(&self, arrived: Time) -> Option<Duration> {
        let (instant, time) = self.epoch?;
        let then = arrived.0.saturating_sub(time.0);
        let apart = Duration::from_nanos(then.unsigned_abs());
        let elapsed = instant.elapsed();
        Some(if then < 0 { elapsed + apart } else { elapsed.saturating_sub(apart) })
    }
}
