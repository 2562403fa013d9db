//! What can go wrong. Faults come from outside of a robot's own code: between its program and its base, or at a sensor.
//!
//! Each is a bug that real robots had, where one is named: the identifiers are those of the ROBUST collection of bugs in ROS, or of an issue on
//! GitHub.

mod link;
mod order;

pub use link::Link;
pub use order::{Faults, Order, OrderError};

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the table below says what each is")]
pub enum Fault {
    DirectionInverted,
    DockingStuck,
    Backwards,
    Sluggish,
    NoSmoothing,
    CommandTimeout,
    CommandLost,
    CrossTalk,
    Overspeed,
    EstopIgnored,
    FrozenScan,
    SilentScan,
    LateScan,
    ZeroStamp,
    StampAhead,
    YawFrozen,
    OdomJump,
    OdomDrift,
    HalfReset,
    JointsSwapped,
    BumperDead,
    ChargedEarly,
    ModeLies,
    NoReply,
    SignUnseen,
    LeaderFar,
    RotorWeak,
    ClockJump,
}

/// What is to be known of a fault.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// The fault.
    pub fault: Fault,
    /// Its name in scenarios and on the command line.
    pub name: &'static str,
    /// What it does, in one line.
    pub what: &'static str,
    /// The bug that it comes from; empty where it comes from none in particular.
    pub bug: &'static str,
}

const fn about(fault: Fault, name: &'static str, what: &'static str, bug: &'static str) -> About {
    About { fault, name, what, bug }
}

/// All faults.
#[rustfmt::skip]
pub const ALL: &[About] = &[
    about(Fault::DirectionInverted, "direction-inverted", "below 0.012 m/s the base turns the other way", "kobuki e964bbb"),
    about(Fault::DockingStuck, "docking-stuck", "below 0.015 m/s the base does not move forwards", "kobuki 0416c81"),
    about(Fault::Backwards, "backwards", "above 0.03 m/s the base drives backwards", "kobuki 1c141a5"),
    about(Fault::Sluggish, "sluggish", "the base does half of what it is told", "kobuki af7946f"),
    about(Fault::NoSmoothing, "no-smoothing", "the base changes its speed as fast as the tyres allow", "kobuki ad906f0"),
    about(Fault::CommandTimeout, "command-timeout", "the base goes on for 2 s after the last command", "kobuki d9aa656"),
    about(Fault::CommandLost, "command-lost", "commands do not reach the base", "kobuki 35682ec"),
    about(Fault::CrossTalk, "cross-talk", "the robot also hears what the others are told", "turtlebot 9ffffca"),
    about(Fault::Overspeed, "overspeed", "the base does one and a half times what it is told", ""),
    about(Fault::EstopIgnored, "estop-ignored", "after an emergency stop the base moves without being enabled", "motoman 3f260cb"),
    about(Fault::FrozenScan, "frozen-scan", "the scanner repeats one scan, with new stamps", ""),
    about(Fault::SilentScan, "silent-scan", "the scanner falls silent", "turtlebot 3e32933"),
    about(Fault::LateScan, "late-scan", "scans arrive 1 s late", ""),
    about(Fault::ZeroStamp, "zero-stamp", "the joints' stamp is never filled in", "mavros 753226d"),
    about(Fault::StampAhead, "stamp-ahead", "stamps are 3 s ahead of the clock", "mavros fcf9cd9"),
    about(Fault::YawFrozen, "yaw-frozen", "the heading of the odometry stays as it is", "kobuki 4115400"),
    about(Fault::OdomJump, "odom-jump", "the odometry jumps by 0.5 m, once", "universal_robot b3c2c21"),
    about(Fault::OdomDrift, "odom-drift", "the odometry takes one wheel to be 5 % too large", ""),
    about(Fault::HalfReset, "half-reset", "a reset of the odometry leaves the heading as it was", "kobuki 2f647af"),
    about(Fault::JointsSwapped, "joints-swapped", "the joints' names come in another order than their values", "confidential 96e2c6c"),
    about(Fault::BumperDead, "bumper-dead", "the bumper is never pressed", "kobuki acd5bfb"),
    about(Fault::ChargedEarly, "charged-early", "the battery says `full` as soon as the robot is docked", "kobuki 841720a"),
    about(Fault::ModeLies, "mode-lies", "a change of mode is granted and does not happen", "mavros 599c588"),
    about(Fault::NoReply, "no-reply", "a request for another mode is not answered", "mavros de2cc36"),
    about(Fault::SignUnseen, "sign-unseen", "the camera does not see signs", ""),
    about(Fault::LeaderFar, "leader-far", "the leader seems to be 1 m farther away than it is", ""),
    about(Fault::RotorWeak, "rotor-weak", "the second rotor turns at 97 % of what it should", ""),
    about(Fault::ClockJump, "clock-jump", "the clock jumps back by 5 s, once", "ros_comm#156"),
];

impl Fault {
    /// What is to be known of it.
    pub fn about(self) -> &'static About {
        // The table has the order of the enumeration, which a test holds.
        &ALL[self as usize]
    }

    /// Whether it happens once rather than being there for a while.
    pub fn is_sudden(self) -> bool {
        matches!(self, Fault::OdomJump | Fault::ClockJump)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_stands_in_the_table_at_its_place() {
        assert!(ALL.iter().enumerate().all(|(k, about)| about.fault as usize == k));
        // The last of the enumeration tells how many there are.
        assert_eq!(ALL.len(), Fault::ClockJump as usize + 1);
        let mut names: Vec<&str> = ALL.iter().map(|a| a.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), ALL.len());
    }
}
