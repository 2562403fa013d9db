//! Which definition the messages of a publisher follow: that of which the hash is the announced one, wherever it comes from; without a hash,
//! the one that the machine has under the name.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;

use lapwing_record::{Dialect, Library, MessageType, RawChannel};

use super::describe::Answer;
use super::description::{Description, TypeHash};
use super::{name, seek};
use crate::connector::Definition;

/// More definitions than these are not kept: a robot has a few dozen types.
const MAX_KNOWN: usize = 1 << 12;
/// A file of a service may not be longer than this, in bytes.
const MAX_FILE: u64 = 1 << 20;

/// A definition, with how to decode by it.
#[derive(Clone, Debug)]
pub struct Defined {
    /// Its text, as recorders write it.
    pub text: String,
    /// Its hash, where its text is one of a type.
    pub hash: Option<TypeHash>,
    /// How to decode.
    pub ty: Result<MessageType, String>,
}

impl Defined {
    fn new(library: &Library, type_name: &str, text: String, hash: Option<TypeHash>) -> Arc<Defined> {
        let layout = library.layout(Dialect::Ros2, type_name, &text);
        Arc::new(Defined { ty: layout.map(MessageType::Cdr).map_err(|e| e.to_string()), text, hash })
    }

    /// The channel of a topic whose messages follow it.
    pub fn channel(&self, topic: &str, type_name: &str) -> RawChannel {
        RawChannel {
            definition: self.text.clone().into_bytes(),
            ty: self.ty.clone(),
            ..undefined(topic, type_name, String::new())
        }
    }
}

/// The channel of a topic whose definition is not known, for that reason.
pub fn undefined(topic: &str, type_name: &str, why: String) -> RawChannel {
    RawChannel {
        topic: topic.to_owned(),
        type_name: type_name.to_owned(),
        encoding: "ros2msg".to_owned(),
        definition: Vec::new(),
        messages: "cdr".to_owned(),
        ty: Err(why),
    }
}

/// All definitions that were needed so far, and where to look for more.
#[derive(Debug)]
pub struct Definitions {
    library: Library,
    trees: Vec<PathBuf>,
    /// By type, and by the hash that was announced.
    known: BTreeMap<(String, Option<TypeHash>), Arc<Defined>>,
}

impl Definitions {
    /// Looks in share trees, the first of which is asked first, and then among the bundled definitions.
    pub fn new(trees: Vec<PathBuf>) -> Definitions {
        Definitions { library: Library::new(&trees), trees, known: BTreeMap::new() }
    }

    /// The definition that fits the hash, of those that are at hand. Without a hash, the one of that name.
    pub fn fitting(&mut self, type_name: &str, hash: Option<TypeHash>) -> Option<Arc<Defined>> {
        let key = (type_name.to_owned(), hash);
        if let Some(defined) = self.known.get(&key) {
            return Some(defined.clone());
        }
        let defined = self.local(type_name)?;
        if hash.is_some() && defined.hash != hash {
            return None;
        }
        self.keep(key, &defined);
        Some(defined)
    }

    /// Takes what a node answered, if it is what was asked for.
    pub fn learn(
        &mut self,
        type_name: &str,
        hash: TypeHash,
        node: &str,
        answer: &Answer,
    ) -> Result<Arc<Defined>, String> {
        if answer.description.root != type_name {
            return Err(format!("{node} described {} instead", answer.description.root));
        }
        let own = answer.description.hash();
        if own != hash {
            return Err(format!("{node} announces {hash}, and the type that it describes has {own}"));
        }
        let defined = Defined::new(&self.library, type_name, answer.text(), Some(hash));
        self.keep((type_name.to_owned(), Some(hash)), &defined);
        Ok(defined)
    }

    /// What there is to say when nothing that fits was found.
    pub fn mismatch(&self, type_name: &str, hash: Option<TypeHash>) -> String {
        match (self.local(type_name).and_then(|d| d.hash), hash) {
            (Some(own), Some(hash)) => format!(
                "messages of {type_name} have the type hash {hash}, and the definition that is installed or bundled has {own}"
            ),
            _ => seek::nowhere(type_name),
        }
    }

    /// The definition of a type by its name alone: `nav_msgs/msg/Odometry`, `std_srvs/srv/Trigger`.
    pub fn by_name(&self, type_name: &str) -> Option<Definition> {
        if let Some(text) = self.message(type_name) {
            return Some(Definition::Message(text));
        }
        let (package, service) = name::service_type(type_name)?;
        let (request, answer) = self.service_file(package, service).or_else(|| {
            let part = |end: &str| self.message(&format!("{package}/{service}_{end}"));
            Some((part("Request")?, part("Response")?))
        })?;
        let complete = |text: &str, end: &str| self.library.complete(&format!("{package}/{service}_{end}"), text).ok();
        Some(Definition::Service(complete(&request, "Request")?, complete(&answer, "Response")?))
    }

    fn message(&self, type_name: &str) -> Option<String> {
        self.library.text(type_name).ok().flatten()
    }

    /// The two halves of a `.srv` file in a share tree.
    fn service_file(&self, package: &str, service: &str) -> Option<(String, String)> {
        let folders = |tree: &PathBuf| {
            [tree.join(package), tree.join("share").join(package), tree.join(package).join("share").join(package)]
        };
        let files = self.trees.iter().flat_map(folders).map(|f| f.join("srv").join(format!("{service}.srv")));
        let text = files.into_iter().find_map(|file| {
            let mut text = String::new();
            fs::File::open(file).ok()?.take(MAX_FILE).read_to_string(&mut text).ok()?;
            Some(text)
        })?;
        halves(&text)
    }

    fn local(&self, type_name: &str) -> Option<Arc<Defined>> {
        let text = self.message(type_name)?;
        let hash = Description::of_text(type_name, &text).ok().map(|d| d.hash());
        Some(Defined::new(&self.library, type_name, text, hash))
    }

    fn keep(&mut self, key: (String, Option<TypeHash>), defined: &Arc<Defined>) {
        if self.known.len() < MAX_KNOWN {
            self.known.insert(key, defined.clone());
        }
    }
}

/// The request and the answer in the text of a service.
fn halves(text: &str) -> Option<(String, String)> {
    let ruler = text.lines().position(|line| line.trim() == "---")?;
    let half = |lines: &mut dyn Iterator<Item = &str>| lines.map(|line| format!("{line}\n")).collect::<String>();
    Some((half(&mut text.lines().take(ruler)), half(&mut text.lines().skip(ruler + 1))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_fits_by_its_hash() {
        let mut definitions = Definitions::new(Vec::new());
        let ty = "std_msgs/msg/Header";
        let hash = TypeHash::parse("RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01");
        let fitting = definitions.fitting(ty, hash).unwrap();
        assert_eq!(fitting.hash, hash);
        assert!(fitting.channel("/h", ty).ty.is_ok());
        assert!(definitions.fitting(ty, None).is_some());
        let other = TypeHash::parse(&format!("RIHS01_{}", "7".repeat(64)));
        assert!(definitions.fitting(ty, other).is_none());
        let said = definitions.mismatch(ty, other);
        assert!(said.contains("7777") && said.contains("f49fb3"), "{said}");
        assert!(definitions.mismatch("a/msg/B", other).contains("--msgs"));
    }

    #[test]
    fn only_the_type_that_was_asked_for_is_learnt() {
        let mut definitions = Definitions::new(Vec::new());
        let description = Description::of_text("p/T", "float64 x\nuint8 K=1").unwrap();
        let hash = description.hash();
        let answer = Answer { description, texts: BTreeMap::new() };
        assert!(definitions.learn("p/msg/U", hash, "/n", &answer).unwrap_err().contains("p/msg/T"));
        let other = TypeHash::parse(&format!("RIHS01_{}", "7".repeat(64))).unwrap();
        assert!(definitions.learn("p/msg/T", other, "/n", &answer).is_err());
        assert_eq!(definitions.learn("p/msg/T", hash, "/n", &answer).unwrap().text, "float64 x\n");
        assert!(definitions.fitting("p/msg/T", Some(hash)).is_some());
    }

    #[test]
    fn services_have_two_halves() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(dir.path().join("share/demo/srv")).unwrap();
        fs::write(dir.path().join("share/demo/srv/Go.srv"), "geometry_msgs/Point to\n---\nbool ok\n").unwrap();
        let definitions = Definitions::new(vec![dir.path().to_owned()]);
        let Some(Definition::Service(request, answer)) = definitions.by_name("demo/srv/Go") else { panic!() };
        assert!(request.contains("MSG: geometry_msgs/Point") && answer == "bool ok\n", "{request}{answer}");
        let trigger = definitions.by_name("std_srvs/Trigger");
        assert_eq!(trigger, Some(Definition::Service("\n".to_owned(), "bool success\nstring message\n".to_owned())));
        assert!(matches!(definitions.by_name("nav_msgs/Odometry"), Some(Definition::Message(_))));
        assert_eq!(definitions.by_name("demo/srv/Stay"), None);
    }
}
