//! The wanted paths of one message, merged by their beginnings.

use lapwing_stream::Name;

use crate::path::{Part, Path, aliases};

/// What is wanted at one place of a message: its value, and what lies below.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// The slots that get the whole value of this place.
    pub whole: Vec<usize>,
    /// What is wanted of its fields.
    pub names: Vec<(Name, Tree)>,
    /// What is wanted of its elements.
    pub items: Vec<(usize, Tree)>,
}

impl Tree {
    /// The k-th path is wanted in the k-th slot.
    pub fn new(paths: &[Path]) -> Tree {
        let mut root = Tree::default();
        for (slot, path) in paths.iter().enumerate() {
            let place = path.parts().iter().fold(&mut root, |at, part| at.below(part));
            place.whole.push(slot);
        }
        root
    }

    fn below(&mut self, part: &Part) -> &mut Tree {
        match part {
            Part::Name(name) => entry(&mut self.names, name),
            Part::Index(index) => entry(&mut self.items, index),
        }
    }

    /// Whether something below this place is wanted by itself.
    pub fn is_deep(&self) -> bool {
        !self.names.is_empty() || !self.items.is_empty()
    }

    /// Every slot of this place and below.
    pub fn slots(&self) -> Vec<usize> {
        let mut all = self.whole.clone();
        for below in self.names.iter().map(|(_, t)| t).chain(self.items.iter().map(|(_, t)| t)) {
            all.extend(below.slots());
        }
        all
    }

    /// The names wanted here as `known` spells them: `secs` where it knows `sec` alone becomes `sec`.
    pub fn spelled(&self, known: impl Fn(&str) -> bool) -> Vec<(Name, &Tree)> {
        let spelled = |name: &Name| match aliases(name).iter().find(|alias| known(alias)) {
            Some(alias) if !known(name) => Name::from(*alias),
            _ => name.clone(),
        };
        self.names.iter().map(|(name, below)| (spelled(name), below)).collect()
    }
}

fn entry<'a, K: PartialEq + Clone>(list: &'a mut Vec<(K, Tree)>, key: &K) -> &'a mut Tree {
    let at = match list.iter().position(|(k, _)| k == key) {
        Some(at) => at,
        None => {
            list.push((key.clone(), Tree::default()));
            list.len() - 1
        }
    };
    &mut list[at].1
}
