//! What C codels are compiled with: headers with GenoM3's names for types, events, ports and codels, and the glue between them and Lapwing.
//!
//! Lapwing never looks into C's memory. The glue takes the parameters of a call as a sequence of bytes, lays them out as the compiler does, calls
//! the codel, and gives back as bytes what has changed. So there is nothing to guess about alignments and calling conventions, and a codel
//! can be called in another process as well as in this one. [`wire`](self#bytes) says what the bytes are.
//!
//! # Bytes
//!
//! Numbers are in the machine's order. A truth value, a character and an octet are 1 byte, integers and floating-point numbers as many as C has, an
//! enumerator 4, what only codels know 8. A text or a sequence is its length in 4 bytes and what is in it; an optional value is 0 or 1 and
//! the value; a union is what tells its members apart in 8 bytes and the member; arrays and structures are their parts.
//!
//! A call: whether time is logical (1), when (8), and each parameter: data, or of a port whether it has a content and that; of many ports how many
//! have, and name and content of each. The answer: 0 for an event, 1 for an exception, 2 for `genom_ok`; its name; by how many nanoseconds it says
//! that it took longer (8); and each parameter that is not `in`: data, or of a port how many values were written and those, of many ports each with
//! its name.

mod glue;
mod types;

use std::fmt;

use crate::model::{Codel, Component, Model, Object, Role, TypeDefKind};

use types::Names;

/// A file that is to be written.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CFile {
    /// Its name.
    pub name: String,
    /// What is in it.
    pub text: String,
}

/// Something that C codels cannot be given.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NotInC(pub String);

impl fmt::Display for NotInC {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for NotInC {}

/// The files for all components of a model.
///
/// # Errors
///
/// A codel is given a value of a type that C has nothing for.
pub fn c_files(model: &Model) -> Result<Vec<CFile>, NotInC> {
    let names = Names { model };
    let types = names.all()?;
    let mut files = vec![
        CFile { name: "genom3_c_types.h".to_owned(), text: SUPPORT.to_owned() + &types + "#endif\n" },
        CFile { name: "lapwing_wire.h".to_owned(), text: glue::WIRE.to_owned() },
    ];
    for component in model.components.iter().filter(|c| c.codels.iter().any(is_written)) {
        let header = header(&names, component)?;
        let name = &component.name;
        files.push(CFile { name: format!("{name}_c_types.h"), text: header });
        let own = format!("/* What codels of {name} include. */\n#include \"{name}_c_types.h\"\n");
        files.push(CFile { name: format!("ac{name}.h"), text: own });
        files.push(CFile { name: format!("{name}_glue.c"), text: glue::glue(&names, component)? });
    }
    Ok(files)
}

/// What a library says of itself, so that one that was compiled for another specification is not called: a hash over everything that its
/// codels are given.
pub fn fingerprint(model: &Model, component: &Component) -> Result<String, NotInC> {
    let names = Names { model };
    let text = names.all()? + &header(&names, component)?;
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    Ok(format!("{hash:016x}"))
}

/// Whether somebody writes a codel, which nobody does for the work of an attribute.
fn is_written(codel: &Codel) -> bool {
    codel.role != Role::Attribute
}

/// The codels of a component, each function once, with the number by which the glue knows it.
pub fn c_codels(component: &Component) -> Vec<(u32, &Codel)> {
    let mut all: Vec<(u32, &Codel)> = Vec::new();
    for (number, codel) in (0_u32..).zip(&component.codels).filter(|(_, c)| is_written(c)) {
        if !all.iter().any(|(_, known)| known.function == codel.function) {
            all.push((number, codel));
        }
    }
    all
}

fn header(names: &Names<'_>, component: &Component) -> Result<String, NotInC> {
    let name = &component.name;
    let guard = format!("LAPWING_{}_C_TYPES_H", name.to_uppercase());
    let mut out = format!(
        "/* Events, ports and codels of {name}. Made by a program. */\n#ifndef {guard}\n#define {guard}\n\n#include \"genom3_c_types.h\"\n\n"
    );
    out += "/* Events. */\n";
    let mut events: Vec<String> = vec!["ether".to_owned()];
    for transition in component.codels.iter().flat_map(Codel::yields) {
        let text = transition.text();
        if !events.contains(&text) {
            events.push(text);
        }
    }
    for event in &events {
        out += &format!("#define {name}_{} ((genom_event)\"{event}\")\n", event.replace("::", "_"));
    }
    out += "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n/* Exceptions. */\n";
    out += &exceptions(names, component)?;
    out += "\n/* Ports. */\n";
    for port in &component.ports {
        let own = format!("{name}_{}", port.name);
        let element = format!("{own}_element");
        let ty = names.pointer(&port.ty, &element)?;
        let (id, first) = if port.multiple { ("const char *id, ", "const char *id, ") } else { ("", "") };
        out += &names.element(&port.ty, &element)?;
        out += &format!("typedef struct {own} {{\n  {ty} (*data)({id}genom_context self);\n");
        if port.multiple {
            out += &format!(
                "  genom_event (*open)({first}genom_context self);\n  genom_event (*close)({first}genom_context self);\n"
            );
        }
        out += &format!("  genom_event (*read)({first}genom_context self);\n");
        if port.is_out {
            out += &format!("  genom_event (*write)({first}genom_context self);\n");
        }
        out += &format!("}} {own};\n");
    }
    for remote in &component.remotes {
        out += &format!("typedef struct {name}_{0} {name}_{0};\n", remote.name);
    }
    out += "\n/* Codels. */\n";
    for (_, codel) in c_codels(component) {
        out += &prototype(names, component, codel)?;
        out += ";\n";
    }
    Ok(out + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n")
}

/// Every exception that a codel may throw is a function that says so.
fn exceptions(names: &Names<'_>, component: &Component) -> Result<String, NotInC> {
    let mut thrown: Vec<_> = component.throws.clone();
    thrown.extend(component.services.iter().flat_map(|s| &s.throws));
    thrown.extend(component.tasks.iter().flat_map(|t| &t.throws));
    thrown.sort();
    thrown.dedup();
    let mut out = String::new();
    for id in thrown {
        let Some(def) = names.model.types.get(id.0) else { continue };
        let (path, short) = (def.path.join("_"), def.path.last().map_or("", String::as_str));
        let has_detail = matches!(&def.kind, TypeDefKind::Exception(fields) if !fields.is_empty());
        let (parameter, detail) = match has_detail {
            true => (format!("const {path}_detail *detail, "), "detail, sizeof(*detail)"),
            false => (String::new(), "0, 0"),
        };
        // One text for all files that include this, so that what is thrown can be compared with it.
        out += &format!(
            "#ifndef LAPWING_{path}\n#define LAPWING_{path}\n\
             extern const char {path}_id[] __attribute__((weak));\nconst char {path}_id[] = \"{short}\";\n\
             static inline genom_event {path}({parameter}genom_context self) {{ return self->raise({path}_id, {detail}, self); }}\n#endif\n"
        );
    }
    Ok(out)
}

/// A codel as C declares it.
fn prototype(names: &Names<'_>, component: &Component, codel: &Codel) -> Result<String, NotInC> {
    let mut parameters = Vec::new();
    for parameter in &codel.parameters {
        parameters.push(match &parameter.object {
            Object::Port(port) => {
                let port = component.ports.get(port.0).map_or("", |p| &p.name);
                format!("const {}_{port} *{}", component.name, parameter.name)
            }
            Object::Remote(remote) => {
                let remote = component.remotes.get(*remote).map_or("", |r| &r.name);
                format!("const {}_{remote} *{}", component.name, parameter.name)
            }
            Object::Unknown => format!("const void *{}", parameter.name),
            Object::Ids(_) | Object::Local(..) => {
                let ty = names.of(component, codel, parameter)?;
                names.parameter(&ty, &parameter.name, parameter.direction)?
            }
        });
    }
    parameters.push("const genom_context self".to_owned());
    Ok(format!("genom_event {}({})", codel.function, parameters.join(", ")))
}

const SUPPORT: &str = r#"/* What all components share. Made by a program. */
#ifndef LAPWING_GENOM3_C_TYPES_H
#define LAPWING_GENOM3_C_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <wchar.h>

/* What a codel returns: an event of its component, an exception, or genom_ok. */
typedef const char *genom_event;
typedef struct genom_context_data *genom_context;

struct genom_context_data {
  genom_event (*raise)(genom_event what, const void *detail, size_t size, genom_context self);
  genom_event raised;
  bool is_logical;      /* whether time is only counted */
  uint64_t now_ns;      /* since the beginning of the run */
  uint64_t elapsed_ns;  /* see lapwing_elapse */
};

#define genom_ok ((genom_event)0)

/* Is busy for a while: sleeps in real time, and counts as so much longer in logical time. */
static inline void lapwing_elapse(uint64_t ns, genom_context self) {
  if (self->is_logical) {
    self->elapsed_ns += ns;
  } else {
    struct timespec left = { (time_t)(ns / 1000000000u), (long)(ns % 1000000000u) };
    while (nanosleep(&left, &left) != 0) {}
  }
}

/* Makes room for elements in a sequence. Returns 0, or -1 where there can be no room. */
#define genom_sequence_reserve(sequence, length) \
  lapwing_reserve((void **)&(sequence)->_buffer, &(sequence)->_maximum, &(sequence)->_release, \
                  sizeof(*(sequence)->_buffer), (length))

static inline int lapwing_reserve(void **buffer, uint32_t *maximum, void (**release)(void *), size_t size,
                                  uint32_t length) {
  void *larger;
  if (length <= *maximum) return 0;
  larger = calloc(length, size);
  if (!larger) return -1;
  if (*buffer) memcpy(larger, *buffer, size * *maximum);
  if (*release) (*release)(*buffer);
  *buffer = larger;
  *release = free;
  *maximum = length;
  return 0;
}

/* Types. */
"#;
