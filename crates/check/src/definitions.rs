//! The definitions of the messages that reactions write. A specification alone does not know them: whoever embeds the check
//! may, and a trace brings those of its own topics.

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_stream::Schema;
use lapwing_syntax::ast::{Action, File, Guard, ItemKind, Reaction, TypePath};

use crate::load::Loaded;
use crate::trace::is_type;

/// Message types that are known without a trace, by their full names: `geometry_msgs/Twist`; what a service is asked
/// is `std_srvs/Trigger_Request`.
pub trait MessageTypes {
    /// All names.
    fn names(&self) -> Vec<String>;
    /// The definition of that full name.
    fn schema(&self, name: &str) -> Option<Arc<Schema>>;
}

/// What is known of the messages that one specification writes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Definitions {
    /// The definitions of the types that are written, by their full names.
    schemas: BTreeMap<String, Arc<Schema>>,
    /// The names of all types that are known.
    names: Vec<String>,
}

impl Loaded {
    /// Looks up the messages that the reactions write, so that their fields can be checked.
    pub fn define(&mut self, types: &dyn MessageTypes) {
        let written = written(&self.file);
        if written.is_empty() {
            return;
        }
        let names = types.names();
        let wanted = |name: &&String| written.iter().any(|(ty, half)| fits(ty, *half, name));
        let schemas =
            names.iter().filter(wanted).filter_map(|name| Some((name.clone(), types.schema(name)?))).collect();
        self.definitions = Definitions { schemas, names };
    }
}

/// What is made of a type: a message as it is, or the half of a service that is sent to it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Half {
    Whole,
    Request,
}

impl Half {
    fn suffix(self) -> &'static str {
        match self {
            Half::Whole => "",
            Half::Request => "_Request",
        }
    }

    /// The name of the type that this is a half of.
    pub fn of(self, full: &str) -> Option<&str> {
        full.strip_suffix(self.suffix())
    }
}

/// The types that the reactions and guards of a file write.
fn written(file: &File) -> Vec<(&TypePath, Half)> {
    let mut types = Vec::new();
    for item in &file.items {
        match &item.kind {
            ItemKind::Reaction(Reaction { actions, .. }) => types.extend(actions.iter().filter_map(|a| match a {
                Action::Publish(_, ty, _) => Some((ty, Half::Whole)),
                Action::Call(_, ty, _) => Some((ty, Half::Request)),
                _ => None,
            })),
            ItemKind::Guard(Guard { instead: Some((ty, _)), .. }) => types.push((ty, Half::Whole)),
            _ => {}
        }
    }
    types
}

fn fits(ty: &TypePath, half: Half, full: &str) -> bool {
    let package = ty.package.as_ref().map(|p| p.name.as_str());
    half.of(full).is_some_and(|name| is_type(package, &ty.name.name, name))
}

impl Definitions {
    /// The definitions that a type as it is written may mean: several where it is written without its package.
    pub fn of(&self, ty: &TypePath, half: Half) -> Vec<&Arc<Schema>> {
        self.schemas.iter().filter(|(name, _)| fits(ty, half, name)).map(|(_, schema)| schema).collect()
    }

    /// Whether the types of that package are known, so that another of it cannot exist.
    pub fn knows_package(&self, package: &str) -> bool {
        self.names.iter().any(|name| name.split_once('/').is_some_and(|(p, _)| p == package))
    }

    /// The names of the types that could be meant in place of one, as they would be written.
    pub fn names(&self, half: Half) -> impl Iterator<Item = &str> {
        self.names.iter().filter_map(move |name| half.of(name))
    }
}
