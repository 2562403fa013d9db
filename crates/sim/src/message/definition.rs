//! The types of the messages: their names, their definitions, and the layouts that a decoder needs.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use lapwing_record::{Dialect, Layout, Library, bundled_text, normal_name};

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

/// The definition of a type.
#[derive(Debug)]
pub struct Definition {
    /// As a recording carries it: with those of all messages in it.
    pub text: String,
    /// What a decoder needs to know of it.
    pub layout: Arc<Layout>,
}

/// A type without a definition that can be used: a test holds that there is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the definition of {name} cannot be used: {what}")]
pub struct DefinitionMissing {
    name: &'static str,
    what: String,
}

/// Every definition. They are looked up once: a campaign has thousands of runs.
static DEFINITIONS: LazyLock<BTreeMap<Kind, Result<Definition, DefinitionMissing>>> =
    LazyLock::new(|| Kind::ALL.iter().map(|kind| (*kind, kind.look_up())).collect());

impl Kind {
    /// All types.
    pub const ALL: [Kind; 13] = [
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

    /// Its definition.
    pub fn definition(self) -> Result<&'static Definition, DefinitionMissing> {
        match DEFINITIONS.get(&self) {
            Some(found) => found.as_ref().map_err(DefinitionMissing::clone),
            None => Err(self.missing("it is not listed")),
        }
    }

    fn look_up(self) -> Result<Definition, DefinitionMissing> {
        let text = self.text().ok_or_else(|| self.missing("it is not bundled"))?;
        let layout = Library::default().layout(Dialect::Ros2, self.name(), &text);
        Ok(Definition { layout: layout.map_err(|e| self.missing(&e.to_string()))?, text })
    }

    fn text(self) -> Option<String> {
        match self {
            Kind::Rotor => {
                let vector = bundled_text("geometry_msgs/Vector3")?;
                Some(format!("{ROTOR}{}\nMSG: geometry_msgs/Vector3\n{vector}", "=".repeat(80)))
            }
            _ => bundled_text(&normal_name(self.name())),
        }
    }

    fn missing(self, what: &str) -> DefinitionMissing {
        DefinitionMissing { name: self.name(), what: what.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_has_a_complete_definition() {
        // The last of the enumeration tells how many there are.
        assert_eq!(Kind::ALL.len(), Kind::Clock as usize + 1);
        for kind in Kind::ALL {
            assert!(kind.definition().is_ok(), "{kind:?}");
            assert_eq!(normal_name(kind.name()).split('/').count(), 2);
        }
        let odometry = &Kind::Odometry.definition().unwrap().text;
        for part in ["std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Quaternion", "geometry_msgs/Vector3"]
        {
            assert_eq!(odometry.matches(&format!("MSG: {part}\n")).count(), 1, "{part}");
        }
    }
}
