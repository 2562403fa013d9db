//! Looks definitions up: in the text at hand, in installed share trees, among the bundled ones.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{
    Base, Definition, DefinitionError, Dialect, FieldDef, FieldType, Layout, MAX_TEXT, Prim, bundled, layout, parse,
};

/// Where the definitions of messages come from that a recording or a connection does not carry.
#[derive(Clone, Debug, Default)]
pub struct Library {
    trees: Vec<PathBuf>,
}

impl Library {
    /// The bundled definitions, and before them those of some share trees: `DIR/<pkg>/msg/*.msg`, `DIR/share/<pkg>/msg/*.msg`
    /// or `DIR/<pkg>/share/<pkg>/msg/*.msg`.
    pub fn new(trees: &[PathBuf]) -> Library {
        Library { trees: trees.to_vec() }
    }

    /// The layout of a message whose definition is at hand. A type that the text uses and does not define is looked up in
    /// the share trees and, but for ROS 1, whose messages differ, among the bundled ones.
    pub fn layout(&self, dialect: Dialect, name: &str, text: &str) -> Result<Arc<Layout>, DefinitionError> {
        let name = super::normal_name(name);
        let mut known = BTreeMap::new();
        for definition in parse(dialect, &name, text)? {
            known.entry(definition.name.clone()).or_insert(definition);
        }
        layout::resolve(&name, &mut Lookup { library: self, dialect, known })
    }

    /// The layout of a message by its name alone: from the share trees, else bundled, in the shape of ROS 2.
    pub fn installed(&self, name: &str) -> Result<Arc<Layout>, DefinitionError> {
        let name = super::normal_name(name);
        layout::resolve(&name, &mut Lookup { library: self, dialect: Dialect::Ros2, known: BTreeMap::new() })
    }

    /// The full names of all messages that it has: those of the share trees, 65,536 of them at most, and the bundled ones. What a service is asked is
    /// the message `pkg/Name_Request`, what it answers `pkg/Name_Response`; those of an action are `pkg/action/Name_Goal`, `_Result`, `_Feedback`
    /// and `_FeedbackMessage`.
    pub fn names(&self) -> Vec<String> {
        let mut names = BTreeSet::new();
        for tree in &self.trees {
            for packages in [tree.clone(), tree.join("share")] {
                folders(&packages).for_each(|(package, folder)| {
                    list(&package, &folder, &mut names);
                    list(&package, &folder.join("share").join(&package), &mut names);
                });
            }
        }
        names.extend(bundled::names().map(str::to_owned));
        names.into_iter().collect()
    }

    /// The `.msg` text of a message by its name alone, and after it those of all messages in it: from the share trees, else
    /// bundled, in the shape of ROS 2. What a recorder writes beside the messages. `None` where there is no such text.
    pub fn text(&self, name: &str) -> Result<Option<String>, DefinitionError> {
        let name = super::normal_name(name);
        let Some(text) = self.written(&name)? else { return Ok(None) };
        self.complete(&name, &text).map(Some)
    }

    /// A `.msg` text, and after it those of all messages that it uses and does not define. A text that is nowhere is left out.
    pub fn complete(&self, name: &str, text: &str) -> Result<String, DefinitionError> {
        let name = super::normal_name(name);
        let mut open = parse(Dialect::Ros2, &name, text)?;
        let mut known: BTreeSet<String> = open.iter().map(|d| d.name.clone()).collect();
        let mut whole = text.trim_end().to_owned() + "\n";
        while let Some(definition) = open.pop() {
            for part in definition.parts().filter(|part| !known.contains(*part)).collect::<BTreeSet<_>>() {
                let Some(text) = self.written(part)? else { continue };
                whole.push_str(&format!("{}MSG: {part}\n{}\n", bundled::RULER, text.trim_end()));
                open.extend(parse(Dialect::Ros2, part, &text)?);
                known.insert(part.clone());
                if whole.len() > MAX_TEXT {
                    return Err(DefinitionError::new(format!("its definition is longer than {MAX_TEXT} bytes")));
                }
            }
        }
        Ok(whole)
    }

    /// A `.msg` text alone.
    fn written(&self, name: &str) -> Result<Option<String>, DefinitionError> {
        for tree in &self.trees {
            if let Some((Dialect::Ros2, text)) = installed_text(tree, Dialect::Ros2, name)? {
                return Ok(Some(text));
            }
        }
        Ok(bundled::text(name).map(str::to_owned))
    }

    fn find(&self, dialect: Dialect, name: &str) -> Result<Option<Definition>, DefinitionError> {
        for tree in &self.trees {
            if let Some((dialect, text)) = installed_text(tree, dialect, name)? {
                return Ok(parse(dialect, name, &text)?.into_iter().next());
            }
        }
        match dialect {
            Dialect::Ros1 => Ok(None),
            Dialect::Ros2 | Dialect::Idl => bundled::definition(name),
        }
    }
}

/// Finds the definitions that one message needs.
pub(super) struct Lookup<'a> {
    library: &'a Library,
    dialect: Dialect,
    known: BTreeMap<String, Definition>,
}

impl Lookup<'_> {
    pub(super) fn take(&mut self, name: &str) -> Result<Definition, DefinitionError> {
        if let Some(definition) = self.known.remove(name) {
            return Ok(definition);
        }
        if let Some(definition) = ros1_stamp(name) {
            return Ok(definition);
        }
        let found = self.library.find(self.dialect, name)?;
        found.ok_or_else(|| {
            DefinitionError::new(format!(
                "no definition of {name} is in the recording, installed or bundled; name the share folder of its package by --msgs DIR"
            ))
        })
    }
}

/// ROS 1's `time` and `duration`, as the messages that ROS 2 made of them.
fn ros1_stamp(name: &str) -> Option<Definition> {
    let (seconds, nanoseconds) = match name {
        "time" => (Prim::U32, Prim::U32),
        "duration" => (Prim::I32, Prim::I32),
        _ => return None,
    };
    let field = |name: &str, prim| FieldDef {
        name: name.into(),
        ty: FieldType { base: Base::Prim(prim), arrays: Vec::new() },
        default: None,
    };
    let fields = vec![field("sec", seconds), field("nanosec", nanoseconds)];
    Some(Definition { name: name.to_owned(), fields, constants: Vec::new() })
}

/// So many names of share trees are listed.
const MOST: usize = 1 << 16;

/// What follows the name of a service in those of its two messages.
const HALVES: [&str; 2] = ["_Request", "_Response"];

/// What follows the name of an action in those of its messages: the three parts of its definition, and what a server publishes while it is at work.
const PARTS: [&str; 4] = ["_Goal", "_Result", "_Feedback", FEEDBACK_MESSAGE];
const FEEDBACK_MESSAGE: &str = "_FeedbackMessage";

fn installed_text(tree: &Path, dialect: Dialect, name: &str) -> Result<Option<(Dialect, String)>, DefinitionError> {
    let Some((package, ty)) = name.split_once('/') else { return Ok(None) };
    let of_action = ty.strip_prefix("action/");
    if !is_plain(package) || !is_plain(of_action.unwrap_or(ty)) {
        return Ok(None);
    }
    let folders =
        [tree.join(package), tree.join("share").join(package), tree.join(package).join("share").join(package)];
    for folder in folders {
        if let Some(ty) = of_action {
            match part_of_action(&folder, package, ty)? {
                Some(text) => return Ok(Some((Dialect::Ros2, text))),
                None => continue,
            }
        }
        for (dialect, file) in [(dialect, format!("msg/{ty}.msg")), (Dialect::Idl, format!("msg/{ty}.idl"))] {
            let file = folder.join(file);
            if file.is_file() {
                return read(&file).map(|text| Some((dialect, text)));
            }
        }
        for (half, suffix) in HALVES.iter().enumerate() {
            let file = ty.strip_suffix(suffix).map(|service| folder.join(format!("srv/{service}.srv")));
            if let Some(file) = file.filter(|file| file.is_file()) {
                return read(&file).map(|text| Some((dialect, part_of(&text, half))));
            }
        }
    }
    Ok(None)
}

/// The definition of a message of an action that is in the folder of its package.
fn part_of_action(folder: &Path, package: &str, ty: &str) -> Result<Option<String>, DefinitionError> {
    let of_part = |(part, end): (usize, &&str)| Some((ty.strip_suffix(end)?.to_owned(), part));
    let Some((action, part)) = PARTS.iter().enumerate().find_map(of_part) else { return Ok(None) };
    let file = folder.join(format!("action/{action}.action"));
    if !file.is_file() {
        return Ok(None);
    }
    if ty.ends_with(FEEDBACK_MESSAGE) {
        // As `rosidl` makes it: whose goal it is about, and the third part.
        let fields = format!("unique_identifier_msgs/UUID goal_id\n{package}/action/{action}_Feedback feedback\n");
        return Ok(Some(fields));
    }
    read(&file).map(|text| Some(part_of(&text, part)))
}

/// Whether a word can be a name of ROS, and no path.
fn is_plain(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// What stands in the definition of a service or an action between its lines of dashes.
fn part_of(text: &str, part: usize) -> String {
    let lines = text.split_inclusive('\n').collect::<Vec<_>>();
    let mut parts = lines.split(|line| line.trim() == "---");
    parts.nth(part).unwrap_or_default().concat()
}

/// The folders in a folder, by name; none where it cannot be read.
fn folders(folder: &Path) -> impl Iterator<Item = (String, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let named = entries.filter_map(|entry| Some((entry.file_name().into_string().ok()?, entry.path())));
    named.filter(|(name, path)| is_plain(name) && path.is_dir())
}

/// Adds the names of the messages that the folder of a package defines.
fn list(package: &str, folder: &Path, names: &mut BTreeSet<String>) {
    let files = |kind: &str| fs::read_dir(folder.join(kind)).into_iter().flatten().filter_map(Result::ok);
    let named = |entry: fs::DirEntry| {
        let file = entry.file_name().into_string().ok()?;
        let (stem, end) = file.rsplit_once('.')?;
        is_plain(stem).then(|| (stem.to_owned(), end.to_owned()))
    };
    let messages = files("msg").filter_map(named).filter(|(_, end)| matches!(end.as_str(), "msg" | "idl"));
    let services = files("srv").filter_map(named).filter(|(_, end)| end == "srv");
    let halves = services.flat_map(|(stem, _)| HALVES.map(|half| stem.clone() + half));
    let actions = files("action").filter_map(named).filter(|(_, end)| end == "action");
    let parts = actions.flat_map(|(stem, _)| PARTS.map(|part| format!("action/{stem}{part}")));
    for ty in messages.map(|(stem, _)| stem).chain(halves).chain(parts) {
        if names.len() < MOST {
            names.insert(format!("{package}/{ty}"));
        }
    }
}

fn read(file: &Path) -> Result<String, DefinitionError> {
    let error = |what: &dyn std::fmt::Display| DefinitionError::new(format!("{}: {what}", file.display()));
    let mut text = String::new();
    let opened = fs::File::open(file).map_err(|e| error(&e))?;
    opened.take(MAX_TEXT as u64 + 1).read_to_string(&mut text).map_err(|e| error(&e))?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn share_trees_come_before_the_bundled_definitions() {
        let dir = tempfile::tempdir().unwrap();
        for (layout, name) in [("mine/msg", "A"), ("share/other/msg", "B"), ("third/share/third/msg", "C")] {
            fs::create_dir_all(dir.path().join(layout)).unwrap();
            fs::write(dir.path().join(layout).join(format!("{name}.msg")), "float64 x\nstd_msgs/Header header\n")
                .unwrap();
        }
        let library = Library::new(&[dir.path().to_owned()]);
        for name in ["mine/A", "other/msg/B", "third/C"] {
            assert_eq!(library.installed(name).unwrap().schema().fields.len(), 2, "{name}");
        }
        assert!(library.installed("../etc/passwd").is_err());
        let names = library.names();
        for name in ["mine/A", "other/B", "third/C", "nav_msgs/Odometry"] {
            assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
        }
    }

    #[test]
    fn a_service_is_two_messages() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(dir.path().join("mine/srv")).unwrap();
        fs::write(dir.path().join("mine/srv/Stop.srv"), "bool hard\nfloat64 within\n---\nstring why\n").unwrap();
        let library = Library::new(&[dir.path().to_owned()]);
        let fields = |name: &str| library.installed(name).unwrap().schema().fields.len();
        assert_eq!([fields("mine/Stop_Request"), fields("mine/Stop_Response")], [2, 1]);
        let mine: Vec<String> = library.names().into_iter().filter(|name| name.starts_with("mine/")).collect();
        assert_eq!(mine, ["mine/Stop_Request", "mine/Stop_Response"]);
    }

    #[test]
    fn an_action_is_messages_and_what_is_published_of_it() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(dir.path().join("mine/action")).unwrap();
        let text = "geometry_msgs/Pose goal\nbool hard\n---\n---\nfloat32 left # metres\n";
        fs::write(dir.path().join("mine/action/Dock.action"), text).unwrap();
        let library = Library::new(&[dir.path().to_owned()]);
        let fields = |part: &str| {
            let layout = library.installed(&format!("mine/action/Dock{part}")).unwrap();
            layout.schema().fields.iter().map(|f| f.name.to_string()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(PARTS.map(fields), ["goal hard", "", "left", "goal_id feedback"]);
        let written = library.text("mine/action/Dock_FeedbackMessage").unwrap().unwrap();
        for part in ["MSG: mine/action/Dock_Feedback\nfloat32 left", "MSG: unique_identifier_msgs/UUID\n"] {
            assert!(written.contains(part), "{part} in\n{written}");
        }
        let names = library.names().into_iter().filter(|name| name.starts_with("mine/")).collect::<Vec<_>>();
        assert_eq!(names.len(), PARTS.len(), "{names:?}");
        for name in ["mine/action/Sail_Goal", "mine/action/Dock", "mine/action/../x_Goal", "mine/Dock_Goal"] {
            assert!(library.installed(name).is_err(), "{name}");
        }
    }

    #[test]
    fn a_text_is_completed_by_what_it_uses() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(dir.path().join("mine/msg")).unwrap();
        fs::write(dir.path().join("mine/msg/A.msg"), "B[3] b\nstd_msgs/Header header").unwrap();
        fs::write(dir.path().join("mine/msg/B.msg"), "float64 K=2\nbuiltin_interfaces/Time t\ngone/Away x").unwrap();
        let library = Library::new(&[dir.path().to_owned()]);
        let text = library.text("mine/msg/A").unwrap().unwrap();
        for part in ["MSG: mine/B\nfloat64 K=2\n", "MSG: std_msgs/Header\n", "MSG: builtin_interfaces/Time\n"] {
            assert_eq!(text.matches(part).count(), 1, "{part} in\n{text}");
        }
        assert!(text.starts_with("B[3] b\n") && !text.contains("MSG: gone/Away"), "{text}");
        assert_eq!(library.text("mine/C"), Ok(None));
        let odometry = library.text("nav_msgs/Odometry").unwrap().unwrap();
        assert_eq!(
            library.layout(Dialect::Ros2, "nav_msgs/Odometry", &odometry).unwrap().schema(),
            library.installed("nav_msgs/Odometry").unwrap().schema()
        );
    }

    #[test]
    fn what_is_missing_is_named_with_what_to_do() {
        let error = Library::default().layout(Dialect::Ros2, "a/B", "c/D d").unwrap_err().to_string();
        assert!(error.contains("c/D") && error.contains("--msgs"), "{error}");
    }
}
