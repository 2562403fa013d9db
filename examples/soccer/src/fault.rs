//! What can go wrong in a match. Each fault comes from outside of the mission: a hand on the field, a wrong setting, or a player that does one
//! step in its own way.

use std::fmt;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::field::{Deed, Hand, Kickoff, Moment};
use crate::robot::{Kicker, Mission, SensorPort, Settings};

/// Something that goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// The seeker's cable is not plugged in at the start.
    Unplugged,
    /// The ball is switched off for a while, as the robot comes near.
    BallOff,
    /// Somebody takes the ball to the side as soon as the robot turns to it.
    BallTakenAfterTurn,
    /// Somebody takes the ball to the side while the robot dribbles.
    BallTakenWhileDribbling,
    /// The robot goes to the goal, and does not kick.
    KickLeftOut,
    /// The robot kicks before it has looked for the ball.
    KickAtOnce,
    /// The robot believes to be in range when it is not.
    KickOutOfRange,
    /// The robot does not notice that it is in range, and goes on.
    RangeMissed,
    /// The sonar's cable is pulled as the robot comes near to the ball, and plugged in again.
    SonarUnplugged,
}

impl Fault {
    /// All of them.
    pub const ALL: [Fault; 9] = [
        Fault::Unplugged,
        Fault::BallOff,
        Fault::BallTakenAfterTurn,
        Fault::BallTakenWhileDribbling,
        Fault::KickLeftOut,
        Fault::KickAtOnce,
        Fault::KickOutOfRange,
        Fault::RangeMissed,
        Fault::SonarUnplugged,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.about().0
    }

    /// What happens, in words.
    pub fn what(self) -> &'static str {
        self.about().1
    }

    fn about(self) -> (&'static str, &'static str) {
        match self {
            Fault::Unplugged => ("unplugged", "the seeker's cable is not plugged in at the start"),
            Fault::BallOff => ("ball-off", "the ball is switched off for three seconds"),
            Fault::BallTakenAfterTurn => ("taken-after-turn", "the ball is taken to the side as the robot turns to it"),
            Fault::BallTakenWhileDribbling => {
                ("taken-while-dribbling", "the ball is taken to the side while the robot dribbles")
            }
            Fault::KickLeftOut => ("kick-left-out", "the robot does not kick"),
            Fault::KickAtOnce => ("kick-at-once", "the robot kicks before it has looked for the ball"),
            Fault::KickOutOfRange => ("kick-out-of-range", "the robot kicks from too far away"),
            Fault::RangeMissed => ("range-missed", "the robot goes on although it is in range"),
            Fault::SonarUnplugged => ("sonar-unplugged", "the sonar's cable is pulled for a second during the match"),
        }
    }

    /// What it does to the kickoff.
    pub fn spoil(self, kickoff: &mut Kickoff) {
        let after = |seconds| Moment::After(Duration::from_secs(seconds));
        let hands: &[(Moment, Deed)] = match self {
            Fault::Unplugged => {
                kickoff.unplugged.push(SensorPort::S3);
                &[]
            }
            Fault::BallOff => &[(Moment::Near(0.35), Deed::SwitchOff), (after(3), Deed::SwitchOn)],
            // The first ping is the one of the self-test, the second one that with which the match begins.
            Fault::BallTakenAfterTurn => &[(Moment::Pings(2), Deed::Carry { ahead: 0.25, left: 0.4 })],
            Fault::BallTakenWhileDribbling => &[(Moment::Carried(0.2), Deed::Carry { ahead: 0.1, left: 0.45 })],
            Fault::SonarUnplugged => {
                &[(Moment::Near(0.35), Deed::Unplug(SensorPort::S2)), (after(1), Deed::PlugIn(SensorPort::S2))]
            }
            Fault::KickLeftOut | Fault::KickAtOnce | Fault::KickOutOfRange | Fault::RangeMissed => &[],
        };
        kickoff.hands.extend(hands.iter().map(|&(moment, deed)| Hand { moment, deed }));
    }

    /// What it does to the robot's settings.
    pub fn misinform(self, settings: &mut Settings) {
        match self {
            Fault::KickOutOfRange => settings.goal_range = 0.95,
            Fault::RangeMissed => settings.goal_range = 0.5,
            _ => {}
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Fault {
    type Err = String;

    fn from_str(text: &str) -> Result<Fault, String> {
        let names = || Fault::ALL.map(Fault::name).join(", ");
        let found = Fault::ALL.into_iter().find(|fault| fault.name() == text);
        found.ok_or_else(|| format!("there is no fault `{text}`: there are {}", names()))
    }
}

/// Plays a match with a kicker, by a player that does one step in its own way where the fault asks for it.
pub fn play(kicker: &Kicker, fault: Option<Fault>) {
    match fault {
        Some(Fault::KickLeftOut) => LeavesOutTheKick(kicker).play(),
        Some(Fault::KickAtOnce) => KicksAtOnce { kicker, has_kicked: AtomicBool::new(false) }.play(),
        _ => kicker.play(),
    }
}

/// A player for whom a kick is nothing.
struct LeavesOutTheKick<'k>(&'k Kicker);

impl Mission for LeavesOutTheKick<'_> {
    fn kicker(&self) -> &Kicker {
        self.0
    }

    fn kick_ball(&self) {}
}

/// A player that kicks before it looks for the ball.
struct KicksAtOnce<'k> {
    kicker: &'k Kicker,
    has_kicked: AtomicBool,
}

impl Mission for KicksAtOnce<'_> {
    fn kicker(&self) -> &Kicker {
        self.kicker
    }

    fn find_ball(&self) -> bool {
        if !self.has_kicked.swap(true, Ordering::Relaxed) {
            self.kicker.kick_ball();
        }
        self.kicker.find_ball()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_faults_and_others_are_told_what_there_is() {
        for fault in Fault::ALL {
            assert_eq!(fault.to_string().parse(), Ok(fault));
        }
        let wrong = "ball-on".parse::<Fault>().unwrap_err();
        assert!(wrong.contains("`ball-on`") && wrong.contains("ball-off"), "{wrong}");
    }
}
