//! What people do to a robot, and how it answers: the emergency stop, the mode, the reset of the odometry.

use crate::clock::RATE;
use crate::fault::Fault;
use crate::message::{Kind, Message};
use crate::outbox::{Content, Topics};
use crate::pose::Pose;
use crate::random::Random;
use crate::scenario::{Action, Event};
use crate::sensor::Ticker;

use super::{Robot, Step};

/// How long an answer to a request takes, in steps, and how long until the mode is another.
const ANSWER: u64 = RATE / 10;
const CHANGE: u64 = RATE / 5;

/// What people will do, and what they have done.
#[derive(Clone, Debug)]
pub struct People {
    /// What is still to come, the last first.
    events: Vec<(f64, Action)>,
    stop: bool,
    mode: String,
    /// The mode that is changed to, and at which step.
    change: Option<(u64, String)>,
    tells_stop: Ticker,
    tells_mode: Ticker,
    topics: Wires,
}

/// The topics by which people speak to a robot.
#[derive(Clone, Debug)]
struct Wires {
    stop: usize,
    enable: usize,
    reset: usize,
    request: usize,
    reply: usize,
    mode: usize,
}

impl People {
    /// With the events of a scenario.
    pub fn new(events: &[Event], prefix: &str, topics: &mut Topics, random: &mut Random) -> People {
        let mut events: Vec<_> = events.iter().map(|e| (e.at.draw(random), e.action.clone())).collect();
        events.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut topic = |name: &str, kind| topics.add(format!("{prefix}/{name}"), kind);
        People {
            events,
            stop: false,
            mode: "manual".to_owned(),
            change: None,
            tells_stop: Ticker::new(10.0, 20),
            tells_mode: Ticker::new(5.0, 40),
            topics: Wires {
                stop: topic("e_stop", Kind::Bool),
                enable: topic("enable", Kind::Bool),
                reset: topic("reset_odometry", Kind::Bool),
                request: topic("set_mode/request", Kind::Text),
                reply: topic("set_mode/reply", Kind::Bool),
                mode: topic("mode", Kind::Text),
            },
        }
    }
}

impl Robot {
    /// People do what they have planned for this step.
    pub(super) fn meet_people(&mut self, step: &mut Step<'_>) {
        let now = step.clock.seconds();
        while self.people.events.last().is_some_and(|(at, _)| *at <= now) {
            if let Some((_, action)) = self.people.events.pop() {
                self.undergo(action, step);
            }
        }
        if let Some((_, mode)) = self.people.change.take_if(|(at, _)| *at <= step.clock.step()) {
            self.people.mode = mode;
        }
        let nanos = step.clock.nanos();
        if self.people.tells_stop.is_due(nanos) {
            step.outbox.send(self.people.topics.stop, Message::Bool(self.people.stop));
        }
        if self.people.tells_mode.is_due(nanos) {
            step.outbox.send(self.people.topics.mode, Message::Text(self.people.mode.clone()));
        }
    }

    fn undergo(&mut self, action: Action, step: &mut Step<'_>) {
        match action {
            Action::PressStop => self.set_stop(true, step),
            Action::ReleaseStop => {
                self.set_stop(false, step);
                if self.faults.has(Fault::EstopIgnored, step.clock.seconds()) {
                    self.base.enable();
                }
            }
            Action::Enable => {
                step.outbox.send(self.people.topics.enable, Message::Bool(true));
                self.base.enable();
            }
            Action::ResetOdometry => self.reset(step),
            Action::SetMode(mode) => self.set_mode(mode, step),
        }
    }

    fn set_stop(&mut self, pressed: bool, step: &mut Step<'_>) {
        self.people.stop = pressed;
        step.outbox.send(self.people.topics.stop, Message::Bool(pressed));
        self.base.set_stop(pressed);
    }

    fn reset(&mut self, step: &mut Step<'_>) {
        step.outbox.send(self.people.topics.reset, Message::Bool(true));
        let is_half = self.faults.has(Fault::HalfReset, step.clock.seconds());
        let yaw = if is_half { self.encoders.pose().yaw } else { 0.0 };
        self.encoders.set_pose(Pose { yaw, ..Pose::default() });
    }

    fn set_mode(&mut self, mode: String, step: &mut Step<'_>) {
        let now = step.clock.seconds();
        step.outbox.send(self.people.topics.request, Message::Text(mode.clone()));
        if self.faults.has(Fault::NoReply, now) {
            return;
        }
        step.outbox.send_later(self.people.topics.reply, Content::Message(Message::Bool(true)), ANSWER);
        if !self.faults.has(Fault::ModeLies, now) {
            self.people.change = Some((step.clock.step() + CHANGE, mode));
        }
    }
}
