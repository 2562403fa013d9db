//! The bundled definitions of the packages that nearly every robot uses, in the shape of ROS 2.
//!
//! ROS 1 shapes are not here (its `std_msgs/Header` has one field more): ROS 1 recordings always carry their own.

use super::{Definition, DefinitionError, Dialect, parse};

/// One text per package: many definitions, each after a line `MSG: pkg/Type`.
const PACKAGES: &[(&str, &str)] = &[
    ("action_msgs", include_str!("../../definitions/action_msgs.txt")),
    ("actionlib_msgs", include_str!("../../definitions/actionlib_msgs.txt")),
    ("builtin_interfaces", include_str!("../../definitions/builtin_interfaces.txt")),
    ("diagnostic_msgs", include_str!("../../definitions/diagnostic_msgs.txt")),
    ("gazebo_msgs", include_str!("../../definitions/gazebo_msgs.txt")),
    ("geometry_msgs", include_str!("../../definitions/geometry_msgs.txt")),
    ("nav_msgs", include_str!("../../definitions/nav_msgs.txt")),
    ("rosgraph_msgs", include_str!("../../definitions/rosgraph_msgs.txt")),
    ("sensor_msgs", include_str!("../../definitions/sensor_msgs.txt")),
    ("std_msgs", include_str!("../../definitions/std_msgs.txt")),
    ("std_srvs", include_str!("../../definitions/std_srvs.txt")),
    ("tf2_msgs", include_str!("../../definitions/tf2_msgs.txt")),
    ("trajectory_msgs", include_str!("../../definitions/trajectory_msgs.txt")),
    ("unique_identifier_msgs", include_str!("../../definitions/unique_identifier_msgs.txt")),
];

/// The bundled definition of that full name, where there is one.
pub(super) fn definition(name: &str) -> Result<Option<Definition>, DefinitionError> {
    let Some(text) = text(name) else { return Ok(None) };
    Ok(parse(Dialect::Ros2, name, text)?.into_iter().next())
}

/// What stands between two definitions of a text, as ROS's own tools write it.
pub(super) const RULER: &str = "================================================================================\n";

/// The bundled definition of that full name, and after it those of all messages in it: what a recorder writes beside the messages.
pub fn text_with_parts(name: &str) -> Option<String> {
    let mut whole = text(name)?.to_owned();
    let (mut known, mut next) = (vec![name.to_owned()], 0);
    while let Some(current) = known.get(next).cloned() {
        next += 1;
        for part in definition(&current).ok().flatten().iter().flat_map(Definition::parts).cloned() {
            if !known.contains(&part) {
                whole.push_str(&format!("{RULER}MSG: {part}\n{}", text(&part)?));
                known.push(part);
            }
        }
    }
    Some(whole)
}

/// The full names of all bundled definitions.
pub fn names() -> impl Iterator<Item = &'static str> {
    PACKAGES.iter().flat_map(|(_, all)| sections(all)).map(|(name, _)| name)
}

/// The bundled text of that full name, alone.
pub(super) fn text(name: &str) -> Option<&'static str> {
    let (package, _) = name.split_once('/')?;
    let (_, all) = PACKAGES.iter().find(|(p, _)| *p == package)?;
    sections(all).find(|(n, _)| *n == name).map(|(_, text)| text)
}

/// The names and texts of a package's definitions.
fn sections(package: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    package.split("MSG: ").skip(1).filter_map(|section| section.split_once('\n'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::Library;

    #[test]
    fn every_bundled_definition_is_complete() {
        let library = Library::default();
        let names: Vec<_> = PACKAGES.iter().flat_map(|(_, text)| sections(text)).map(|(name, _)| name).collect();
        assert!(names.len() > 120, "{}", names.len());
        for name in &names {
            let layout = library.installed(name).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(layout.schema().name, *name);
        }
        for name in ["nav_msgs/Odometry", "sensor_msgs/LaserScan", "gazebo_msgs/ModelStates", "tf2_msgs/TFMessage"] {
            assert!(names.contains(&name), "{name}");
        }
    }
}
