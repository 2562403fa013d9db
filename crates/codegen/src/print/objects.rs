//! Functions that take the pose of an object, or its velocities.

use crate::Interface;
use crate::interface::From;
use crate::objects::{Object, Setter};

use super::c::C;
use super::rust::Rust;
use super::{Syntax, Writer};

/// Each function beside the object that it takes.
fn setters(interface: &Interface) -> impl Iterator<Item = (&Object, &Setter)> {
    interface.objects.iter().flat_map(|object| object.setters.iter().map(move |setter| (object, setter)))
}

/// What a function sets: members, and the elements of its vectors that they get.
fn sets(interface: &Interface, object: &Object, setter: &Setter) -> Vec<(String, String)> {
    let name = |from: From| interface.members.iter().find(|m| m.from == from).map(|m| m.name.clone());
    let mut sets = Vec::new();
    for vector in &setter.vectors {
        for index in 0..vector.len() {
            if let Some(member) = name(From::Part(object.object, vector.first() + index)) {
                sets.push((member, format!("{}[{index}]", vector.name())));
            }
        }
    }
    sets.extend(name(setter.came).map(|came| (came, "true".to_owned())));
    sets
}

/// As methods of what comes with a step.
pub(super) fn rust(w: &mut Writer<'_, Rust>, interface: &Interface) {
    for (number, (object, setter)) in setters(interface).enumerate() {
        if number > 0 {
            w.line("");
        }
        w.comment("///", &setter.doc);
        let params = setter.vectors.iter().map(|v| format!(", {}: [f64; {}]", v.name(), v.len()));
        w.line(&format!("pub fn {}(&mut self{}) {{", setter.name, params.collect::<String>()));
        w.inside(|w| {
            sets(interface, object, setter).iter().for_each(|(to, of)| w.line(&format!("self.{to} = {of};")));
        });
        w.line("}");
    }
}

/// As functions on what comes with a step: their declarations for the header.
pub(super) fn c_header(w: &mut Writer<'_, C>, interface: &Interface) {
    for (_, setter) in setters(interface) {
        w.line("");
        w.comment("//", &setter.doc);
        let line = format!("{};", c_signature(w, setter));
        w.line(&line);
    }
}

/// See [`c_header`]: the functions.
pub(super) fn c_source(w: &mut Writer<'_, C>, interface: &Interface) {
    for (object, setter) in setters(interface) {
        w.line("");
        let line = format!("{} {{", c_signature(w, setter));
        w.line(&line);
        w.inside(|w| {
            for (to, of) in sets(interface, object, setter) {
                let line = format!("{} = {of};", w.syntax.input(&to));
                w.line(&line);
            }
        });
        w.line("}");
    }
}

fn c_signature(w: &Writer<'_, C>, setter: &Setter) -> String {
    let prefix = &w.syntax.prefix;
    let params = setter.vectors.iter().map(|v| format!(", const double {}[{}]", v.name(), v.len()));
    format!("void {prefix}_{}({prefix}_inputs *in{})", setter.name, params.collect::<String>())
}
