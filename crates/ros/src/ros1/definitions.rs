//! Where the definition of a type comes from that no publisher has sent: from installed packages, else bundled.
//!
//! The bundled ones are in the shape of ROS 1, which is not that of ROS 2: headers have a sequence number, some messages other fields.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::checksum::parts;
use crate::connector::Definition;

/// One text per package: many definitions, each after a line `MSG: pkg/Type`; of services, `pkg/TypeRequest` and `pkg/TypeResponse`.
const BUNDLED: &[(&str, &str)] = &[
    ("actionlib_msgs", include_str!("../../definitions/actionlib_msgs.txt")),
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
];

/// What stands between two definitions of a text.
const RULER: &str = "================================================================================\n";
/// A file of an installed package is not longer, in bytes.
const MOST_BYTES: u64 = 1 << 20;
/// One message is not made of more types.
const MOST_TYPES: usize = 1024;

/// The definitions on this machine.
#[derive(Clone, Debug, Default)]
pub(crate) struct Definitions {
    /// Folders in which there are packages, or which are one.
    folders: Vec<PathBuf>,
}

impl Definitions {
    /// Those of the packages in the folders, and after them the bundled ones.
    pub fn new(folders: Vec<PathBuf>) -> Definitions {
        Definitions { folders }
    }

    /// The definition of a message, as `pkg/Type` or `pkg/msg/Type`, or of a service, as `pkg/srv/Type` or, where no message has that
    /// name, as `pkg/Type`.
    pub fn find(&self, type_name: &str) -> Option<Definition> {
        let (package, kind, name) = split(type_name)?;
        let plain = format!("{package}/{name}");
        let message = || self.whole(&plain, self.own(package, "msg", name)?).map(Definition::Message);
        let service = || {
            let (request, answer) = self.halves(package, name)?;
            Some(Definition::Service(self.whole(&plain, request)?, self.whole(&plain, answer)?))
        };
        match kind {
            Some("msg") => message(),
            Some("srv") => service(),
            _ => message().or_else(service),
        }
    }

    /// A definition, and behind it those of all messages in it; nothing where one of them is missing.
    fn whole(&self, name: &str, own: String) -> Option<String> {
        let (mut waiting, mut seen) = (parts(name, &own), vec![name.to_owned()]);
        let mut text = own;
        while let Some(part) = waiting.pop() {
            if seen.contains(&part) {
                continue;
            }
            let (package, name) = part.split_once('/')?;
            let own = self.own(package, "msg", name)?;
            if seen.len() > MOST_TYPES {
                return None;
            }
            if !text.ends_with('\n') && !text.is_empty() {
                text.push('\n');
            }
            text += &format!("{RULER}MSG: {part}\n{own}");
            waiting.extend(parts(&part, &own));
            seen.push(part);
        }
        Some(text)
    }

    fn own(&self, package: &str, kind: &str, name: &str) -> Option<String> {
        let installed = self.folders.iter().find_map(|folder| installed(folder, package, kind, name));
        installed.or_else(|| bundled(package, name).map(str::to_owned))
    }

    /// The request and the answer of a service.
    fn halves(&self, package: &str, name: &str) -> Option<(String, String)> {
        if let Some(text) = self.folders.iter().find_map(|folder| installed(folder, package, "srv", name)) {
            let lines: Vec<&str> = text.lines().collect();
            let ruler = lines.iter().position(|line| line.trim() == "---")?;
            return Some((lines[..ruler].join("\n"), lines[ruler + 1..].join("\n")));
        }
        let half = |end: &str| bundled(package, &format!("{name}{end}")).map(str::to_owned);
        Some((half("Request")?, half("Response")?))
    }
}

/// The package, the kind where it is said, and the name of a type; nothing where it is none: it may become part of a path.
fn split(type_name: &str) -> Option<(&str, Option<&str>, &str)> {
    let is_word = |word: &&str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    let words: Vec<&str> = type_name.split('/').collect();
    match words[..] {
        _ if !words.iter().all(is_word) => None,
        [package, kind @ ("msg" | "srv"), name] => Some((package, Some(kind), name)),
        [package, name] => Some((package, None, name)),
        _ => None,
    }
}

fn installed(folder: &Path, package: &str, kind: &str, name: &str) -> Option<String> {
    let file = format!("{name}.{kind}");
    let places = [folder.join(package), folder.join("share").join(package), folder.to_owned()];
    let is_it = |place: &&PathBuf| place.file_name().is_some_and(|f| f == package);
    let path = places.iter().filter(is_it).map(|place| place.join(kind).join(&file)).find(|path| path.is_file())?;
    let mut text = String::new();
    File::open(path).ok()?.take(MOST_BYTES).read_to_string(&mut text).ok()?;
    Some(text)
}

fn bundled(package: &str, name: &str) -> Option<&'static str> {
    let (_, all) = BUNDLED.iter().find(|(p, _)| *p == package)?;
    let full = format!("{package}/{name}");
    all.split("MSG: ").filter_map(|section| section.split_once('\n')).find(|(n, _)| *n == full).map(|(_, text)| text)
}

/// The names of all bundled definitions.
#[cfg(test)]
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let sections = |(_, all): &(&str, &'static str)| all.split("MSG: ").collect::<Vec<_>>();
    BUNDLED.iter().flat_map(sections).filter_map(|section| section.split_once('\n')).map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use lapwing_record::{Dialect, Library};

    use super::super::checksum;
    use super::*;

    #[test]
    fn every_bundled_definition_is_complete() {
        let definitions = Definitions::default();
        let mut count = 0;
        for name in names() {
            let Some(Definition::Message(text)) = definitions.find(name) else { panic!("{name} is not complete") };
            Library::default().layout(Dialect::Ros1, name, &text).unwrap_or_else(|e| panic!("{name}: {e}"));
            checksum::of_message(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"));
            count += 1;
        }
        assert!(count > 120, "{count}");
    }

    #[test]
    fn the_checksums_are_those_of_ros() {
        let definitions = Definitions::default();
        for (name, sum) in [
            ("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"),
            ("sensor_msgs/msg/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"),
            ("gazebo_msgs/ModelStates", "48c080191eb15c41858319b4d8a609c2"),
            ("tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"),
            ("rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47"),
        ] {
            let Some(Definition::Message(text)) = definitions.find(name) else { panic!("{name}") };
            assert_eq!(checksum::of_message(name, &text).as_deref(), Ok(sum), "{name}");
        }
        let Some(Definition::Service(request, answer)) = definitions.find("std_srvs/srv/SetBool") else { panic!() };
        let sum = checksum::of_service("std_srvs/SetBool", &request, &answer);
        assert_eq!(sum.as_deref(), Ok("09fb03525b03e7ea1fd3992bafd87e16"));
    }

    #[test]
    fn installed_packages_come_first() {
        let dir = tempfile::tempdir().unwrap();
        for (file, text) in [
            ("share/mine/msg/A.msg", "B b\nHeader h"),
            ("share/mine/msg/B.msg", "int8 x"),
            ("share/mine/srv/S.srv", "B b\n---\n# nothing"),
        ] {
            let path = dir.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let definitions = Definitions::new(vec![dir.path().to_owned()]);
        let Some(Definition::Message(text)) = definitions.find("mine/A") else { panic!() };
        assert!(text.contains("MSG: mine/B\nint8 x") && text.contains("MSG: std_msgs/Header\nuint32 seq"), "{text}");
        assert!(matches!(definitions.find("mine/S"), Some(Definition::Service(..))));
        assert!(definitions.find("mine/../A").is_none() && definitions.find("mine/C").is_none());
    }
}
