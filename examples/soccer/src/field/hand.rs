//! Hands that reach into the field: they take the ball away, switch it off and on, pull cables and plug them in.

use std::time::Duration;

use super::Inner;
use crate::robot::SensorPort;

/// What a hand does, and when. Each waits for the one before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hand {
    /// When.
    pub moment: Moment,
    /// What.
    pub deed: Deed,
}

/// When a hand reaches in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// So long after the hand before it.
    After(Duration),
    /// After so many pings of the sonar.
    Pings(u32),
    /// When the ball is so near to the robot, in metres.
    Near(f64),
    /// When the robot has had the ball for so many metres.
    Carried(f64),
}

/// What a hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deed {
    /// Switches the ball off.
    SwitchOff,
    /// Switches the ball on.
    SwitchOn,
    /// Puts the ball so many metres ahead of the robot and to its left.
    Carry {
        /// Ahead.
        ahead: f64,
        /// To the left.
        left: f64,
    },
    /// Pulls the cable of a sensor.
    Unplug(SensorPort),
    /// Plugs it in.
    PlugIn(SensorPort),
}

impl Inner {
    /// Lets the hands do whose moment has come.
    pub(super) fn reach_in(&mut self) {
        let here = self.world.pose(self.robot);
        self.taken = if self.has_ball() { self.taken.or(Some([here.x, here.y])) } else { None };
        while let Some(hand) = self.hands.front().filter(|hand| self.has_come(hand.moment)) {
            let deed = hand.deed;
            self.hands.pop_front();
            self.reached = self.now;
            self.act(deed);
        }
    }

    fn has_come(&self, moment: Moment) -> bool {
        let here = self.world.pose(self.robot);
        match moment {
            Moment::After(time) => self.now.saturating_sub(self.reached) >= time,
            Moment::Pings(count) => self.pings >= count,
            Moment::Near(distance) => here.towards(self.ball_at()).0 <= distance,
            Moment::Carried(far) => self.taken.is_some_and(|from| here.towards(from).0 >= far),
        }
    }

    fn act(&mut self, deed: Deed) {
        match deed {
            Deed::SwitchOff => self.shines = false,
            Deed::SwitchOn => self.shines = true,
            Deed::Carry { ahead, left } => {
                let to = self.world.pose(self.robot).point(ahead, left);
                self.world.carry(self.ball, to);
            }
            Deed::Unplug(port) => _ = self.unplugged.insert(port),
            Deed::PlugIn(port) => _ = self.unplugged.remove(&port),
        }
    }
}
