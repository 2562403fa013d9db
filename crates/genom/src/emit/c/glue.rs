//! The glue: a C function for each component that takes the bytes of a call, calls the codel, and gives the bytes of its answer.

use std::fmt::Write as _;

use super::types::{Names, Passing, labels};
use super::{NotInC, c_codels, fingerprint};
use crate::model::{Codel, Component, Direction, Object, Port, Type, TypeDefKind, TypeId};

/// Arrays, sequences and optional values stand inside one another no deeper than this; structures have functions of their own.
const MOST_DEPTH: usize = 64;

/// What reads and writes bytes, the same for all components.
pub(super) const WIRE: &str = r#"/* Bytes of calls and answers. Made by a program. */
#ifndef LAPWING_WIRE_H
#define LAPWING_WIRE_H

#include "genom3_c_types.h"

#define LAPWING_UNUSED __attribute__((unused))

struct lapwing_in { const unsigned char *at, *end; bool is_bad; };
struct lapwing_out { unsigned char *data; size_t length, room; bool is_bad; };

LAPWING_UNUSED static void lapwing_take(struct lapwing_in *in, void *to, size_t size) {
  if (in->is_bad || (size_t)(in->end - in->at) < size) {
    in->is_bad = true;
    memset(to, 0, size);
    return;
  }
  memcpy(to, in->at, size);
  in->at += size;
}

LAPWING_UNUSED static void lapwing_give(struct lapwing_out *out, const void *from, size_t size) {
  if (out->is_bad) return;
  if (out->room - out->length < size) {
    size_t room = 2 * (out->length + size) + 64;
    unsigned char *larger = realloc(out->data, room);
    if (!larger) {
      out->is_bad = true;
      return;
    }
    out->data = larger;
    out->room = room;
  }
  memcpy(out->data + out->length, from, size);
  out->length += size;
}

LAPWING_UNUSED static uint32_t lapwing_take_length(struct lapwing_in *in) {
  uint32_t length;
  lapwing_take(in, &length, sizeof(length));
  if (length > (size_t)(in->end - in->at)) {
    in->is_bad = true;
    return 0;
  }
  return length;
}

LAPWING_UNUSED static char *lapwing_take_text(struct lapwing_in *in) {
  uint32_t length = lapwing_take_length(in);
  char *text = malloc((size_t)length + 1);
  if (!text) {
    in->is_bad = true;
    return 0;
  }
  lapwing_take(in, text, length);
  text[length] = 0;
  return text;
}

LAPWING_UNUSED static void lapwing_give_text(struct lapwing_out *out, const char *text) {
  uint32_t length = text ? (uint32_t)strlen(text) : 0;
  lapwing_give(out, &length, sizeof(length));
  lapwing_give(out, text ? text : "", length);
}

LAPWING_UNUSED static void lapwing_take_string(struct lapwing_in *in, char *to, size_t most) {
  char *text = lapwing_take_text(in);
  memset(to, 0, most + 1);
  if (text) strncpy(to, text, most);
  free(text);
}

LAPWING_UNUSED static void lapwing_give_string(struct lapwing_out *out, const char *text, size_t most) {
  uint32_t length = (uint32_t)strnlen(text, most);
  lapwing_give(out, &length, sizeof(length));
  lapwing_give(out, text, length);
}

#endif
"#;

/// The glue of a component.
pub(super) fn glue(names: &Names<'_>, component: &Component) -> Result<String, NotInC> {
    let mut writer = Glue { names, component, out: String::new() };
    writer.begin()?;
    writer.types()?;
    writer.ports()?;
    for (number, codel) in c_codels(component) {
        writer.codel(number, codel)?;
    }
    writer.end();
    Ok(writer.out)
}

struct Glue<'g, 'm> {
    names: &'g Names<'m>,
    component: &'g Component,
    out: String,
}

/// Whether values are read from bytes, written as such, or given up.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Take,
    Give,
    Drop,
}

impl Way {
    fn word(self) -> &'static str {
        match self {
            Way::Take => "take",
            Way::Give => "give",
            Way::Drop => "drop",
        }
    }
}

impl Glue<'_, '_> {
    fn say(&mut self, text: impl AsRef<str>) {
        self.out.push_str(text.as_ref());
        self.out.push('\n');
    }

    fn begin(&mut self) -> Result<(), NotInC> {
        let name = &self.component.name;
        let print = fingerprint(self.names.model, self.component)?;
        self.say(format!("/* Between Lapwing and the codels of {name}: compile it with them. Made by a program. */"));
        self.say(format!(
            "#define _POSIX_C_SOURCE 200809L\n#include \"{name}_c_types.h\"\n#include \"lapwing_wire.h\"\n"
        ));
        self.say(format!("const char *lapwing_interface_{name}(void) {{ return \"{print}\"; }}"));
        self.say(format!("void lapwing_free_{name}(unsigned char *answer) {{ free(answer); }}\n"));
        Ok(())
    }

    /// How structures and unions are read, written and given up.
    fn types(&mut self) -> Result<(), NotInC> {
        let all: Vec<TypeId> = (0..self.names.model.types.len()).map(TypeId).collect();
        let composite: Vec<TypeId> = all
            .into_iter()
            .filter(|id| {
                matches!(self.names.def(*id).map(|d| &d.kind), Some(TypeDefKind::Struct(_) | TypeDefKind::Union(..)))
            })
            .collect();
        for id in &composite {
            let name = self.names.base(&Type::Named(*id))?;
            for way in [Way::Take, Way::Give, Way::Drop] {
                self.say(format!("LAPWING_UNUSED static void {};", signature(way, &name)));
            }
        }
        for id in composite {
            for way in [Way::Take, Way::Give, Way::Drop] {
                self.composite(id, way)?;
            }
        }
        Ok(())
    }

    fn composite(&mut self, id: TypeId, way: Way) -> Result<(), NotInC> {
        let Some(def) = self.names.def(id).cloned() else { return Ok(()) };
        let name = def.path.join("_");
        self.say(format!("static void {} {{", signature(way, &name)));
        if way != Way::Drop {
            self.say("  (void)bytes;");
        }
        self.say("  (void)v;");
        match &def.kind {
            TypeDefKind::Struct(fields) => {
                for field in fields {
                    self.value(&field.ty, &format!("v->{}", field.name), way, 1)?;
                }
            }
            TypeDefKind::Union(on, cases) => {
                if way != Way::Drop {
                    self.say("  int64_t d = (int64_t)0;");
                    if way == Way::Give {
                        self.say("  d = (int64_t)v->_d;");
                    }
                    self.say(format!("  lapwing_{}(bytes, &d, sizeof(d));", way.word()));
                    if way == Way::Take {
                        self.say(format!("  v->_d = ({})d;", self.names.base(on)?));
                    }
                }
                let prefix = self.names.enumerators(on);
                self.say("  switch ((int64_t)v->_d) {");
                for (tags, field) in cases {
                    let tags = labels(tags, &prefix);
                    for tag in &tags {
                        self.say(format!("  case {tag}:"));
                    }
                    if tags.is_empty() {
                        self.say("  default:");
                    }
                    self.say("  {");
                    self.value(&field.ty, &format!("v->_u.{}", field.name), way, 2)?;
                    self.say("  } break;");
                }
                self.say("  }");
            }
            _ => {}
        }
        self.say("}");
        Ok(())
    }

    /// Reads, writes or gives up a value at a place.
    fn value(&mut self, ty: &Type, at: &str, way: Way, depth: usize) -> Result<(), NotInC> {
        if depth > MOST_DEPTH {
            return Err(NotInC(format!(
                "C codels cannot be given values that nest more than {MOST_DEPTH} levels deep"
            )));
        }
        let margin = "  ".repeat(depth);
        let word = way.word();
        let shape = self.names.shape(ty).clone();
        match &shape {
            Type::Basic(_) | Type::Fixed(_) => {
                if way != Way::Drop {
                    self.say(format!("{margin}lapwing_{word}(bytes, &{at}, sizeof({at}));"));
                }
            }
            Type::Text(None) => match way {
                Way::Take => self.say(format!("{margin}{at} = lapwing_take_text(bytes);")),
                Way::Give => self.say(format!("{margin}lapwing_give_text(bytes, {at});")),
                Way::Drop => self.say(format!("{margin}free({at});")),
            },
            Type::Text(Some(most)) => {
                if way != Way::Drop {
                    self.say(format!("{margin}lapwing_{word}_string(bytes, {at}, {most});"));
                }
            }
            Type::Array(inner, length) => {
                let i = format!("i{depth}");
                self.say(format!("{margin}for (size_t {i} = 0; {i} < {length}; {i}++) {{"));
                self.value(inner, &format!("{at}[{i}]"), way, depth + 1)?;
                self.say(format!("{margin}}}"));
            }
            Type::Sequence(inner, most) => self.sequence(inner, *most, at, way, depth)?,
            Type::Optional(inner) => {
                if way != Way::Drop {
                    self.say(format!("{margin}lapwing_{word}(bytes, &{at}._present, 1);"));
                }
                self.say(format!("{margin}if ({at}._present) {{"));
                self.value(inner, &format!("{at}._value"), way, depth + 1)?;
                self.say(format!("{margin}}}"));
            }
            Type::Named(id) => match self.names.def(*id).map(|d| d.kind.clone()) {
                Some(TypeDefKind::Enum(_)) => match way {
                    Way::Take => self.say(format!(
                        "{margin}{{ uint32_t e; lapwing_take(bytes, &e, 4); {at} = ({})e; }}",
                        self.names.base(&shape)?
                    )),
                    Way::Give => {
                        self.say(format!("{margin}{{ uint32_t e = (uint32_t){at}; lapwing_give(bytes, &e, 4); }}"))
                    }
                    Way::Drop => {}
                },
                Some(TypeDefKind::Native) => match way {
                    Way::Take => self.say(format!(
                        "{margin}{{ uint64_t p; lapwing_take(bytes, &p, 8); {at} = (void *)(uintptr_t)p; }}"
                    )),
                    Way::Give => self.say(format!(
                        "{margin}{{ uint64_t p = (uint64_t)(uintptr_t){at}; lapwing_give(bytes, &p, 8); }}"
                    )),
                    Way::Drop => {}
                },
                Some(TypeDefKind::Struct(_) | TypeDefKind::Union(..)) => {
                    let bytes = if way == Way::Drop { "" } else { "bytes, " };
                    self.say(format!("{margin}{word}_{}({bytes}&{at});", self.names.base(&shape)?));
                }
                _ => {
                    return Err(NotInC(format!(
                        "C codels cannot be given a value of the type `{}`",
                        self.names.base(&shape)?
                    )));
                }
            },
        }
        Ok(())
    }

    fn sequence(&mut self, inner: &Type, most: Option<u64>, at: &str, way: Way, depth: usize) -> Result<(), NotInC> {
        let margin = "  ".repeat(depth);
        let i = format!("i{depth}");
        match way {
            Way::Take => {
                self.say(format!("{margin}{at}._length = lapwing_take_length(bytes);"));
                match most {
                    Some(most) => {
                        self.say(format!("{margin}{at}._maximum = {most};"));
                        self.say(format!(
                            "{margin}if ({at}._length > {most}) {{ bytes->is_bad = true; {at}._length = 0; }}"
                        ));
                    }
                    None => {
                        self.say(format!("{margin}{at}._maximum = 0; {at}._buffer = 0; {at}._release = 0;"));
                        self.say(format!(
                            "{margin}if (genom_sequence_reserve(&{at}, {at}._length) != 0) {{ bytes->is_bad = true; {at}._length = 0; }}"
                        ));
                    }
                }
            }
            Way::Give => {
                if let Some(most) = most {
                    self.say(format!("{margin}if ({at}._length > {most}) {at}._length = {most};"));
                }
                self.say(format!("{margin}lapwing_give(bytes, &{at}._length, sizeof({at}._length));"));
            }
            Way::Drop => {}
        }
        self.say(format!("{margin}for (size_t {i} = 0; {i} < {at}._length; {i}++) {{"));
        self.value(inner, &format!("{at}._buffer[{i}]"), way, depth + 1)?;
        self.say(format!("{margin}}}"));
        if way == Way::Drop && most.is_none() {
            self.say(format!("{margin}if ({at}._release) {at}._release({at}._buffer);"));
        }
        Ok(())
    }

    /// The ports during a call: their contents, what is written, and the functions by which codels come at them.
    fn ports(&mut self) -> Result<(), NotInC> {
        let name = self.component.name.clone();
        let ports = self.component.ports.clone();
        for port in ports.iter().filter(|p| p.multiple) {
            let declared = self.names.declare(&port.ty, "value")?;
            self.say(format!("struct one_{0} {{ struct one_{0} *next; char *id; bool has; {declared}; }};", port.name));
        }
        self.say("struct call {\n  struct genom_context_data base;");
        for port in &ports {
            if port.multiple {
                self.say(format!("  struct one_{} *{};", port.name, port.name));
            } else {
                self.say(format!("  {};\n  bool has_{};", self.names.declare(&port.ty, &port.name)?, port.name));
            }
            self.say(format!("  uint32_t writes_{0};\n  struct lapwing_out written_{0};", port.name));
        }
        self.say("};\n");
        self.say(
            "static genom_event call_raise(genom_event what, const void *detail, size_t size, genom_context self) {",
        );
        self.say("  (void)detail;\n  (void)size;\n  self->raised = what;\n  return what;\n}\n");
        for port in &ports {
            match port.multiple {
                false => self.single(&name, port)?,
                true => self.multiple(&name, port)?,
            }
        }
        Ok(())
    }

    fn single(&mut self, name: &str, port: &Port) -> Result<(), NotInC> {
        let (p, ty) = (&port.name, self.names.pointer(&port.ty, &format!("{name}_{}_element", port.name))?);
        let address = self.names.address(&port.ty);
        // A port out can be prepared before anything has been written; of a port in there is nothing then.
        let there =
            if port.is_out { format!("{address}call->{p}") } else { format!("call->has_{p} ? {address}call->{p} : 0") };
        self.say(format!("static {ty}{p}_data(genom_context self) {{\n  struct call *call = (struct call *)self;\n  return {there};\n}}"));
        self.say(format!("static genom_event {p}_read(genom_context self) {{ (void)self; return genom_ok; }}"));
        let mut table = format!("{p}_data, {p}_read");
        if port.is_out {
            self.say(format!(
                "static genom_event {p}_write(genom_context self) {{\n  struct call *call = (struct call *)self;"
            ));
            self.say(format!(
                "  struct lapwing_out *bytes = &call->written_{p};\n  call->writes_{p}++;\n  call->has_{p} = true;"
            ));
            self.value(&port.ty, &format!("call->{p}"), Way::Give, 1)?;
            self.say("  return genom_ok;\n}");
            table += &format!(", {p}_write");
        }
        self.say(format!("LAPWING_UNUSED static const {name}_{p} port_{p} = {{ {table} }};\n"));
        Ok(())
    }

    fn multiple(&mut self, name: &str, port: &Port) -> Result<(), NotInC> {
        let (p, ty) = (&port.name, self.names.pointer(&port.ty, &format!("{name}_{}_element", port.name))?);
        let address = self.names.address(&port.ty);
        self.say(format!("static struct one_{p} *{p}_find(const char *id, genom_context self, bool makes) {{"));
        self.say(format!("  struct call *call = (struct call *)self;\n  struct one_{p} *one = call->{p};"));
        self.say("  while (one && strcmp(one->id, id) != 0) one = one->next;");
        self.say("  if (!one && makes && (one = calloc(1, sizeof(*one)))) {");
        self.say("    one->id = strdup(id);");
        self.say(format!("    one->next = call->{p};\n    call->{p} = one;\n  }}\n  return one;\n}}"));
        let makes = if port.is_out { "true" } else { "false" };
        let has = if port.is_out { "one" } else { "one && one->has" };
        self.say(format!("static {ty}{p}_data(const char *id, genom_context self) {{\n  struct one_{p} *one = {p}_find(id, self, {makes});\n  return {has} ? {address}one->value : 0;\n}}"));
        for word in ["open", "close", "read"] {
            self.say(format!("static genom_event {p}_{word}(const char *id, genom_context self) {{ (void)id; (void)self; return genom_ok; }}"));
        }
        let mut table = format!("{p}_data, {p}_open, {p}_close, {p}_read");
        if port.is_out {
            self.say(format!("static genom_event {p}_write(const char *id, genom_context self) {{\n  struct call *call = (struct call *)self;"));
            self.say(format!(
                "  struct one_{p} *one = {p}_find(id, self, true);\n  struct lapwing_out *bytes = &call->written_{p};"
            ));
            self.say(format!("  if (!one) return genom_ok;\n  call->writes_{p}++;\n  lapwing_give_text(bytes, id);"));
            self.value(&port.ty, "one->value", Way::Give, 1)?;
            self.say("  return genom_ok;\n}");
            table += &format!(", {p}_write");
        }
        self.say(format!("LAPWING_UNUSED static const {name}_{p} port_{p} = {{ {table} }};\n"));
        Ok(())
    }

    /// How one codel is called.
    fn codel(&mut self, number: u32, codel: &Codel) -> Result<(), NotInC> {
        self.say(format!(
            "static void codel_{number}(struct call *call, struct lapwing_in *in, struct lapwing_out *out) {{"
        ));
        self.say("  struct lapwing_in *bytes = in;\n  genom_event event;\n  unsigned char kind;");
        let mut arguments = Vec::new();
        for parameter in &codel.parameters {
            let v = format!("v_{}", parameter.name);
            match &parameter.object {
                Object::Port(port) => {
                    let Some(port) = self.component.ports.get(port.0).cloned() else { continue };
                    arguments.push(format!("&port_{}", port.name));
                    self.content(&port)?;
                }
                Object::Remote(_) | Object::Unknown => arguments.push("0".to_owned()),
                Object::Ids(_) | Object::Local(..) => {
                    let ty = self.names.of(self.component, codel, parameter)?;
                    self.say(format!("  {};", self.names.declare(&ty, &v)?));
                    self.value(&ty, &v, Way::Take, 1)?;
                    let is_in = parameter.direction == Direction::In;
                    arguments.push(match self.names.passing(&ty) {
                        Passing::Value | Passing::Text | Passing::Native if is_in => v,
                        Passing::Array => v,
                        _ => format!("&{v}"),
                    });
                }
            }
        }
        arguments.push("&call->base".to_owned());
        self.say("  (void)bytes;");
        self.say("  event = genom_ok;");
        self.say(format!("  if (!in->is_bad) event = {}({});", codel.function, arguments.join(", ")));
        self.say("  kind = !event ? 2 : event == call->base.raised ? 1 : 0;");
        self.say("  lapwing_give(out, &kind, 1);\n  lapwing_give_text(out, event ? event : \"\");");
        self.say("  lapwing_give(out, &call->base.elapsed_ns, 8);");
        for parameter in &codel.parameters {
            let v = format!("v_{}", parameter.name);
            let is_out = parameter.direction != Direction::In;
            match &parameter.object {
                Object::Port(port) => {
                    let name = self.component.ports.get(port.0).map_or("", |p| &p.name).to_owned();
                    if is_out {
                        self.say(format!("  lapwing_give(out, &call->writes_{name}, 4);"));
                        self.say(format!("  lapwing_give(out, call->written_{name}.data ? call->written_{name}.data : (unsigned char *)\"\", call->written_{name}.length);"));
                    }
                }
                Object::Ids(_) | Object::Local(..) => {
                    let ty = self.names.of(self.component, codel, parameter)?;
                    if is_out {
                        self.say("  { struct lapwing_out *bytes = out;");
                        self.value(&ty, &v, Way::Give, 2)?;
                        self.say("  }");
                    }
                    self.value(&ty, &v, Way::Drop, 1)?;
                }
                Object::Remote(_) | Object::Unknown => {}
            }
        }
        self.say("}\n");
        Ok(())
    }

    /// What is in a port is read before the call.
    fn content(&mut self, port: &Port) -> Result<(), NotInC> {
        let p = &port.name;
        if port.multiple {
            self.say("  { uint32_t n = 0;\n    lapwing_take(in, &n, 4);\n    while (n-- > 0 && !in->is_bad) {");
            self.say(format!("      char *id = lapwing_take_text(in);\n      struct one_{p} *one = id ? {p}_find(id, &call->base, true) : 0;"));
            self.say("      free(id);\n      if (!one) { in->is_bad = true; break; }\n      one->has = true;");
            self.value(&port.ty, "one->value", Way::Take, 3)?;
            self.say("    }\n  }");
            return Ok(());
        }
        self.say(format!("  {{ unsigned char has = 0;\n    lapwing_take(in, &has, 1);\n    call->has_{p} = has != 0;\n    if (has) {{"));
        self.value(&port.ty, &format!("call->{p}"), Way::Take, 3)?;
        self.say("    }\n  }");
        Ok(())
    }

    /// The function that Lapwing calls.
    fn end(&mut self) {
        let name = self.component.name.clone();
        let mut out = String::new();
        let _ = writeln!(
            out,
            "int lapwing_call_{name}(uint32_t codel, const unsigned char *data, size_t length, unsigned char **answer, size_t *size) {{"
        );
        out += "  struct lapwing_in in = { data, data + length, false };\n  struct lapwing_out result = { 0, 0, 0, false };\n";
        out += "  struct call *call = calloc(1, sizeof(*call));\n  unsigned char logical = 0;\n  int is_known = 1;\n";
        out += "  if (!call) return 3;\n  call->base.raise = call_raise;\n";
        out += "  lapwing_take(&in, &logical, 1);\n  call->base.is_logical = logical != 0;\n  lapwing_take(&in, &call->base.now_ns, 8);\n";
        out += "  switch (codel) {\n";
        for (number, _) in c_codels(self.component) {
            let _ = writeln!(out, "  case {number}: codel_{number}(call, &in, &result); break;");
        }
        out += "  default: is_known = 0;\n  }\n";
        self.out += &out;
        let ports = self.component.ports.clone();
        for port in &ports {
            let p = &port.name;
            self.say(format!("  if (call->written_{p}.is_bad) result.is_bad = true;\n  free(call->written_{p}.data);"));
            if port.multiple {
                self.say(format!("  while (call->{p}) {{ struct one_{p} *one = call->{p}; call->{p} = one->next;"));
                // Types that a port can have were looked at when its declaration was written.
                drop(self.value(&port.ty, "one->value", Way::Drop, 2));
                self.say("    free(one->id); free(one); }");
            } else {
                drop(self.value(&port.ty, &format!("call->{p}"), Way::Drop, 1));
            }
        }
        self.say("  free(call);\n  if (!is_known || in.is_bad || result.is_bad) { free(result.data); return !is_known ? 1 : in.is_bad ? 2 : 3; }");
        self.say("  *answer = result.data;\n  *size = result.length;\n  return 0;\n}");
    }
}

fn signature(way: Way, name: &str) -> String {
    match way {
        Way::Take => format!("take_{name}(struct lapwing_in *bytes, {name} *v)"),
        Way::Give => format!("give_{name}(struct lapwing_out *bytes, {name} *v)"),
        Way::Drop => format!("drop_{name}({name} *v)"),
    }
}
