//! What is known of the common message types without their definitions: the physical dimension of their fields by REP 103, the
//! types inside them, and a few constants. A definition in the trace overrules it in everything but dimensions.

use crate::checked::Dim;

/// What a field of a known message is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Known {
    /// Its dimension; a vector's is that of its parts.
    pub dim: Dim,
    /// The short name of its type, where that is known as well.
    pub message: Option<&'static str>,
}

/// Type, fields, what they are.
type Row = (&'static str, &'static [&'static str], Dim, Option<&'static str>);

const fn row(message: &'static str, fields: &'static [&'static str], dim: Dim, inner: Option<&'static str>) -> Row {
    (message, fields, dim, inner)
}

/// The parts of a vector have the vector's own dimension, see [`field`].
const INHERITED: &[&str] = &["Vector3", "Vector3Stamped"];

#[rustfmt::skip]
const FIELDS: &[Row] = &[
    row("Twist", &["linear"], Dim::SPEED, Some("Vector3")),
    row("Twist", &["angular"], Dim::TURNING, Some("Vector3")),
    row("TwistStamped", &["twist"], Dim::UNKNOWN, Some("Twist")),
    row("TwistWithCovariance", &["twist"], Dim::UNKNOWN, Some("Twist")),
    row("TwistWithCovarianceStamped", &["twist"], Dim::UNKNOWN, Some("TwistWithCovariance")),
    row("Accel", &["linear"], Dim::ACCELERATION, Some("Vector3")),
    row("Accel", &["angular"], Dim(Some([0, -2, 1])), Some("Vector3")),
    row("AccelStamped", &["accel"], Dim::UNKNOWN, Some("Accel")),
    row("Point", &["x", "y", "z"], Dim::LENGTH, None),
    row("Point32", &["x", "y", "z"], Dim::LENGTH, None),
    row("PointStamped", &["point"], Dim::LENGTH, Some("Point")),
    row("Pose", &["position"], Dim::LENGTH, Some("Point")),
    row("Pose", &["orientation"], Dim::PLAIN, Some("Quaternion")),
    row("Pose2D", &["x", "y"], Dim::LENGTH, None),
    row("Pose2D", &["theta"], Dim::ANGLE, None),
    row("PoseStamped", &["pose"], Dim::UNKNOWN, Some("Pose")),
    row("PoseWithCovariance", &["pose"], Dim::UNKNOWN, Some("Pose")),
    row("PoseWithCovarianceStamped", &["pose"], Dim::UNKNOWN, Some("PoseWithCovariance")),
    row("Quaternion", &["x", "y", "z", "w"], Dim::PLAIN, None),
    row("QuaternionStamped", &["quaternion"], Dim::PLAIN, Some("Quaternion")),
    row("Transform", &["translation"], Dim::LENGTH, Some("Vector3")),
    row("Transform", &["rotation"], Dim::PLAIN, Some("Quaternion")),
    row("TransformStamped", &["transform"], Dim::UNKNOWN, Some("Transform")),
    row("Odometry", &["pose"], Dim::UNKNOWN, Some("PoseWithCovariance")),
    row("Odometry", &["twist"], Dim::UNKNOWN, Some("TwistWithCovariance")),
    row("LaserScan", &["ranges", "range_min", "range_max"], Dim::LENGTH, None),
    row("LaserScan", &["angle_min", "angle_max", "angle_increment"], Dim::ANGLE, None),
    row("LaserScan", &["time_increment", "scan_time"], Dim::TIME, None),
    row("Range", &["range", "min_range", "max_range"], Dim::LENGTH, None),
    row("Range", &["field_of_view"], Dim::ANGLE, None),
    row("Imu", &["orientation"], Dim::PLAIN, Some("Quaternion")),
    row("Imu", &["angular_velocity"], Dim::TURNING, Some("Vector3")),
    row("Imu", &["linear_acceleration"], Dim::ACCELERATION, Some("Vector3")),
    row("NavSatFix", &["altitude"], Dim::LENGTH, None),
    row("OccupancyGrid", &["info"], Dim::UNKNOWN, Some("MapMetaData")),
    row("MapMetaData", &["resolution"], Dim::LENGTH, None),
    row("MapMetaData", &["origin"], Dim::UNKNOWN, Some("Pose")),
    row("Header", &["stamp"], Dim::TIME, Some("Time")),
];

/// What a field is, of a message of this short type name whose own dimension is `of`.
pub(crate) fn field(message: Option<&str>, of: Dim, name: &str) -> Known {
    let unknown = Known { dim: Dim::UNKNOWN, message: None };
    let Some(message) = message else { return unknown };
    if name == "header" {
        return Known { dim: Dim::UNKNOWN, message: Some("Header") };
    }
    if INHERITED.contains(&message) {
        return Known { dim: of, message: (name == "vector").then_some("Vector3") };
    }
    let found = FIELDS.iter().find(|(m, fields, ..)| *m == message && fields.contains(&name));
    found.map_or(unknown, |&(_, _, dim, message)| Known { dim, message })
}

/// The short name, `Odometry` of `nav_msgs/Odometry`, where the type is one that is known here.
pub(crate) fn known_type(package: Option<&str>, short: &str) -> Option<&'static str> {
    let ours = |p: &str| ["geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs"].contains(&p);
    if package.is_some_and(|p| !ours(p)) {
        return None;
    }
    let rows = FIELDS.iter().map(|(message, ..)| *message);
    rows.chain(INHERITED.iter().copied()).find(|m| *m == short)
}

/// Constants of messages that specifications name most.
#[rustfmt::skip]
const CONSTANTS: &[(&str, &[(&str, f64)])] = &[
    ("BatteryState", &[
        ("POWER_SUPPLY_STATUS_UNKNOWN", 0.0), ("POWER_SUPPLY_STATUS_CHARGING", 1.0), ("POWER_SUPPLY_STATUS_DISCHARGING", 2.0),
        ("POWER_SUPPLY_STATUS_NOT_CHARGING", 3.0), ("POWER_SUPPLY_STATUS_FULL", 4.0),
        ("POWER_SUPPLY_HEALTH_UNKNOWN", 0.0), ("POWER_SUPPLY_HEALTH_GOOD", 1.0), ("POWER_SUPPLY_HEALTH_OVERHEAT", 2.0),
        ("POWER_SUPPLY_HEALTH_DEAD", 3.0), ("POWER_SUPPLY_HEALTH_OVERVOLTAGE", 4.0),
    ]),
    ("DiagnosticStatus", &[("OK", 0.0), ("WARN", 1.0), ("ERROR", 2.0), ("STALE", 3.0)]),
    ("NavSatStatus", &[("STATUS_NO_FIX", -1.0), ("STATUS_FIX", 0.0), ("STATUS_SBAS_FIX", 1.0), ("STATUS_GBAS_FIX", 2.0)]),
];

/// The constants of a message that are known without its definition.
pub(crate) fn constants(message: &str) -> &'static [(&'static str, f64)] {
    CONSTANTS.iter().find(|(m, _)| *m == message).map_or(&[], |(_, constants)| constants)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_follow_the_way_into_a_message() {
        let mut known = Known { dim: Dim::UNKNOWN, message: known_type(None, "Odometry") };
        for name in ["twist", "twist", "linear", "x"] {
            known = field(known.message, known.dim, name);
        }
        assert_eq!(known.dim, Dim::SPEED);
        assert_eq!(known_type(Some("my_msgs"), "Odometry"), None);
    }
}
