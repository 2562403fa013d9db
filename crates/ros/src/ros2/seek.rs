//! Definitions that somebody asked for by name, before any message: looked for at the nodes that use the type.

use std::sync::mpsc::Sender;
use std::time::Instant;

use super::describe::Answer;
use super::description::TypeHash;
use super::graph::Gid;
use super::name;
use super::wire::Endpoint;
use crate::connector::{Definition, Refused};

/// Who asked, for what, and until when.
pub struct Seeker {
    /// The type of a message.
    pub type_name: String,
    /// When to give up.
    pub deadline: Instant,
    /// Where the answer goes.
    pub reply: Sender<Result<Definition, Refused>>,
}

impl Seeker {
    /// Says that nobody has it.
    pub fn give_up(self) {
        let why = format!("{}, and no node was found that uses it", nowhere(&self.type_name));
        // Whoever asked may be gone by now.
        let _ = self.reply.send(Err(Refused(why)));
    }
}

/// That a definition is not at hand, and what to do.
pub fn nowhere(type_name: &str) -> String {
    format!("no definition of {type_name} is installed or bundled (name the share folder of its package by --msgs DIR)")
}

/// An endpoint with the type, whose node can describe it. A service's endpoints announce the hashes of request and answer, and nodes describe
/// services by another: so of services nobody can be asked.
pub fn endpoint(type_name: &str, readers: &[Endpoint], writers: &[Endpoint]) -> Option<(Gid, TypeHash)> {
    let on_wire = name::type_on_wire(type_name)?;
    let mut users = readers.iter().chain(writers).filter(|e| e.type_name == on_wire);
    users.find_map(|e| Some((e.guid.to_bytes(), TypeHash::announced(&e.user_data)?)))
}

/// The definition in a node's answer.
pub fn definition(type_name: &str, hash: TypeHash, answer: &Answer) -> Result<Definition, String> {
    let own = answer.description.hash();
    if own != hash {
        return Err(format!("{type_name} is announced with {hash}, and described with {own}"));
    }
    Ok(Definition::Message(answer.text()))
}
