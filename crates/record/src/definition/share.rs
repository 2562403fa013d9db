//! Looks definitions up: in the text at hand, in installed share trees, among the bundled ones.

use std::collections::BTreeMap;
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
    let field =
        |name: &str, prim| FieldDef { name: name.into(), ty: FieldType { base: Base::Prim(prim), arrays: Vec::new() } };
    let fields = vec![field("sec", seconds), field("nanosec", nanoseconds)];
    Some(Definition { name: name.to_owned(), fields, constants: Vec::new() })
}

fn installed_text(tree: &Path, dialect: Dialect, name: &str) -> Result<Option<(Dialect, String)>, DefinitionError> {
    let Some((package, ty)) = name.split_once('/') else { return Ok(None) };
    let plain = |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    if !plain(package) || !plain(ty) {
        return Ok(None);
    }
    let folders =
        [tree.join(package), tree.join("share").join(package), tree.join(package).join("share").join(package)];
    for folder in folders {
        for (dialect, end) in [(dialect, "msg"), (Dialect::Idl, "idl")] {
            let file = folder.join("msg").join(format!("{ty}.{end}"));
            if file.is_file() {
                return read(&file).map(|text| Some((dialect, text)));
            }
        }
    }
    Ok(None)
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
    }

    #[test]
    fn what_is_missing_is_named_with_what_to_do() {
        let error = Library::default().layout(Dialect::Ros2, "a/B", "c/D d").unwrap_err().to_string();
        assert!(error.contains("c/D") && error.contains("--msgs"), "{error}");
    }
}
