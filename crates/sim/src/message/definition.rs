//! The types of the messages: their names, their definitions, and the layouts that a decoder needs.

use std::sync::Arc;

use lapwing_record::{Dialect, Layout, Library, bundled_text};

/// The type of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// `geometry_msgs/Twist`
    Twist,
    /// `nav_msgs/Odometry`
    Odometry,
    /// `sensor_msgs/LaserScan`
    Scan,
    /// `sensor_msgs/Imu`
    Imu,
    /// `sensor_msgs/JointState`
    Joints,
    /// `sensor_msgs/BatteryState`
    Battery,
    /// `sensor_msgs/Range`
    Range,
    /// `std_msgs/Bool`
    Bool,
    /// `std_msgs/String`
    Text,
    /// `drone_mov/Vector3`
    Rotor,
    /// `gazebo_msgs/ModelStates`
    Models,
    /// `tf2_msgs/TFMessage`
    Transforms,
    /// `rosgraph_msgs/Clock`
    Clock,
}

/// A rotor's velocity has the name of a vector and the shape of a twist.
const ROTOR: &str = "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n";

impl Kind {
    /// The full name of the type, as ROS 2 spells it.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Twist => "geometry_msgs/msg/Twist",
            Kind::Odometry => "nav_msgs/msg/Odometry",
            Kind::Scan => "sensor_msgs/msg/LaserScan",
            Kind::Imu => "sensor_msgs/msg/Imu",
            Kind::Joints => "sensor_msgs/msg/JointState",
            Kind::Battery => "sensor_msgs/msg/BatteryState",
            Kind::Range => "sensor_msgs/msg/Range",
            Kind::Bool => "std_msgs/msg/Bool",
            Kind::Text => "std_msgs/msg/String",
            Kind::Rotor => "drone_mov/msg/Vector3",
            Kind::Models => "gazebo_msgs/msg/ModelStates",
            Kind::Transforms => "tf2_msgs/msg/TFMessage",
            Kind::Clock => "rosgraph_msgs/msg/Clock",
        }
    }
}

/// The definition of a type with those of all messages in it.
pub fn text(kind: Kind) -> Option<String> {
    match kind {
        Kind::Rotor => {
            let vector = bundled_text("geometry_msgs/Vector3")?;
            Some(format!("{ROTOR}{}\nMSG: geometry_msgs/Vector3\n{vector}", "=".repeat(80)))
        }
        _ => bundled_text(&lapwing_record::normal_name(kind.name())),
    }
}

/// What a decoder needs to know of a type.
pub fn layout(kind: Kind) -> Option<Arc<Layout>> {
    Library::default().layout(Dialect::Ros2, kind.name(), &text(kind)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_has_a_complete_definition() {
        let all = [
            Kind::Twist,
            Kind::Odometry,
            Kind::Scan,
            Kind::Imu,
            Kind::Joints,
            Kind::Battery,
            Kind::Range,
            Kind::Bool,
            Kind::Text,
            Kind::Rotor,
            Kind::Models,
            Kind::Transforms,
            Kind::Clock,
        ];
        for kind in all {
            assert!(layout(kind).is_some(), "{kind:?}");
            assert_eq!(lapwing_record::normal_name(kind.name()).split('/').count(), 2);
        }
        let odometry = text(Kind::Odometry).unwrap();
        for part in ["std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Quaternion", "geometry_msgs/Vector3"]
        {
            assert_eq!(odometry.matches(&format!("MSG: {part}\n")).count(), 1, "{part}");
        }
    }
}
