//! Types as C has them, under GenoM3's names: `nav::scan` is `nav_scan`.

use std::collections::BTreeSet;

use super::NotInC;
use crate::model::{
    Basic, Codel, CodelParameter, Component, Constant, Direction, Field, Label, Model, Object, Step, Type, TypeDef,
    TypeDefKind, TypeId, Value,
};

/// Types inside types no deeper than this.
const MOST_DEPTH: usize = 64;

/// The names of a model's types.
pub(super) struct Names<'m> {
    pub model: &'m Model,
}

/// How C passes something on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Passing {
    /// As it is.
    Value,
    /// By its address.
    Address,
    /// It is an address already: an array, a text of a greatest length.
    Array,
    /// A text without one.
    Text,
    /// Something that only codels know.
    Native,
}

impl Names<'_> {
    /// Declarations of all types, each after those that it contains.
    pub(super) fn all(&self) -> Result<String, NotInC> {
        let mut out = String::new();
        for def in &self.model.types {
            match &def.kind {
                TypeDefKind::Struct(_) | TypeDefKind::Forward => out += &forward("struct", def),
                TypeDefKind::Union(..) => out += &forward("struct", def),
                TypeDefKind::Native => out += &forward("struct", def),
                _ => {}
            }
        }
        let mut writer = Writer { names: self, done: BTreeSet::new(), anonymous: BTreeSet::new(), out };
        for number in 0..self.model.types.len() {
            writer.named(TypeId(number), 0)?;
        }
        for component in &self.model.components {
            writer.nameless(component)?;
        }
        for constant in &self.model.constants {
            let text = self.constant(constant)?;
            writer.out += &text;
        }
        Ok(writer.out)
    }

    /// A constant, where C can tell its type.
    fn constant(&self, constant: &Constant) -> Result<String, NotInC> {
        let Some(value) = self.literal(&constant.ty, &constant.value) else { return Ok(String::new()) };
        let name = constant.path.join("_");
        let declared = match self.passing(&constant.ty) {
            Passing::Text => format!("char *const {name}"),
            _ => self.declare(&constant.ty, &name)?,
        };
        Ok(format!("static const {declared} = {value};\n"))
    }

    fn literal(&self, ty: &Type, value: &Value) -> Option<String> {
        Some(match value {
            Value::Int(value) if *value == i128::from(i64::MIN) => "(-9223372036854775807LL - 1)".to_owned(),
            Value::Int(value) => match i32::try_from(*value) {
                Ok(value) => value.to_string(),
                Err(_) if i64::try_from(*value).is_ok() => format!("{value}LL"),
                Err(_) => format!("{value}ULL"),
            },
            Value::Float(value) => format!("{value:?}"),
            Value::Bool(value) => value.to_string(),
            Value::Text(text) => quoted(text),
            Value::Name(name) => format!("{}{name}", self.enumerators(ty)),
            Value::Parts(_) => return None,
        })
    }

    /// What stands before the values of an enumeration: they are in the scope that it is in.
    pub(super) fn enumerators(&self, ty: &Type) -> String {
        let path = match self.shape(ty) {
            Type::Named(id) => self.def(*id).map_or(&[][..], |d| &d.path),
            _ => &[],
        };
        path.split_last().map_or(&[][..], |(_, scope)| scope).iter().map(|s| format!("{s}_")).collect()
    }

    pub(super) fn def(&self, id: TypeId) -> Option<&TypeDef> {
        self.model.types.get(id.0)
    }

    /// A type with its other names followed.
    pub(super) fn shape<'t>(&'t self, ty: &'t Type) -> &'t Type {
        ty.behind(&self.model.types)
    }

    /// The fields of a structure.
    pub(super) fn fields(&self, ty: &Type) -> Option<&[Field]> {
        match self.shape(ty) {
            Type::Named(id) => match self.def(*id).map(|d| &d.kind) {
                Some(TypeDefKind::Struct(fields)) => Some(fields),
                _ => None,
            },
            _ => None,
        }
    }

    /// The type of what a codel is given.
    pub(super) fn of(&self, component: &Component, codel: &Codel, parameter: &CodelParameter) -> Result<Type, NotInC> {
        let lost = || NotInC(format!("the type of `{}` of `{}` is not known", parameter.name, codel.function));
        let (whole, steps) = match &parameter.object {
            Object::Ids(steps) => (component.ids.map(Type::Named), steps),
            Object::Local(name, steps) => {
                let service = component.service_of(codel.owner);
                let parameter = service.and_then(|s| s.parameters.iter().find(|p| p.name == *name));
                let local = service.and_then(|s| s.locals.iter().find(|l| l.name == *name));
                (parameter.and_then(|p| p.ty.clone()).or(local.map(|l| l.ty.clone())), steps)
            }
            Object::Port(port) => return component.ports.get(port.0).map(|p| p.ty.clone()).ok_or_else(lost),
            Object::Remote(_) | Object::Unknown => return Err(lost()),
        };
        let mut ty = whole.ok_or_else(lost)?;
        for step in steps {
            ty = match (step, self.shape(&ty)) {
                (Step::Member(name), _) => {
                    let fields = self.fields(&ty).ok_or_else(lost)?;
                    fields.iter().find(|f| f.name == *name).map(|f| f.ty.clone()).ok_or_else(lost)?
                }
                (Step::Element(_), Type::Array(inner, _) | Type::Sequence(inner, _)) => (**inner).clone(),
                _ => return Err(lost()),
            };
        }
        Ok(ty)
    }

    pub(super) fn passing(&self, ty: &Type) -> Passing {
        match self.shape(ty) {
            Type::Basic(_) | Type::Fixed(_) => Passing::Value,
            Type::Text(None) => Passing::Text,
            Type::Text(Some(_)) | Type::Array(..) => Passing::Array,
            Type::Sequence(..) | Type::Optional(_) => Passing::Address,
            Type::Named(id) => match self.def(*id).map(|d| &d.kind) {
                Some(TypeDefKind::Enum(_)) => Passing::Value,
                Some(TypeDefKind::Native) => Passing::Native,
                _ => Passing::Address,
            },
        }
    }

    /// A parameter of a function: `in` is a value, or an address of what must not be changed; the others are addresses.
    pub(super) fn parameter(&self, ty: &Type, name: &str, direction: Direction) -> Result<String, NotInC> {
        let is_in = direction == Direction::In;
        // GenoM3's users write `char name[N]`; there is room for one more.
        let text = |name| match ty {
            Type::Text(Some(most)) => Ok(format!("char {name}[{most}]")),
            _ => self.declare(ty, name),
        };
        Ok(match self.passing(ty) {
            Passing::Value if is_in => self.declare(ty, name)?,
            Passing::Array if is_in => format!("const {}", text(name)?),
            Passing::Text if is_in => format!("const char *{name}"),
            Passing::Native if is_in => format!("const {} *{name}", self.base(ty)?),
            Passing::Address if is_in => format!("const {}", self.declare(ty, &format!("*{name}"))?),
            Passing::Array => text(name)?,
            Passing::Text => format!("char **{name}"),
            Passing::Native => format!("{} **{name}", self.base(ty)?),
            Passing::Value | Passing::Address => self.declare(ty, &format!("*{name}"))?,
        })
    }

    /// A declaration of something of a type.
    pub(super) fn declare(&self, ty: &Type, name: &str) -> Result<String, NotInC> {
        Ok(match ty {
            Type::Array(inner, length) => self.declare(inner, &format!("{}[{length}]", bracketed(name)))?,
            // One more for the end of the text.
            Type::Text(Some(most)) => format!("char {}[{}]", bracketed(name), most.saturating_add(1)),
            Type::Text(None) => format!("char *{name}"),
            Type::Named(id) if matches!(self.def(*id).map(|d| &d.kind), Some(TypeDefKind::Native)) => {
                format!("{} *{name}", self.base(ty)?)
            }
            _ => format!("{} {name}", self.base(ty)?),
        })
    }

    /// The type of what a port returns: the address of its content; of an array, as C has it, that of the first element, of which `element` is
    /// the name where it is an array itself.
    pub(super) fn pointer(&self, ty: &Type, element: &str) -> Result<String, NotInC> {
        Ok(match self.shape(ty) {
            Type::Array(inner, _) => match self.shape(inner) {
                Type::Array(..) | Type::Text(Some(_)) => format!("{element} *"),
                _ => format!("{} *", self.base(inner)?),
            },
            Type::Text(Some(_)) => "char *".to_owned(),
            _ => format!("{} *", self.base(ty)?),
        })
    }

    /// The declaration of such a name, where one is needed.
    pub(super) fn element(&self, ty: &Type, element: &str) -> Result<String, NotInC> {
        match self.shape(ty) {
            Type::Array(inner, _) if matches!(self.shape(inner), Type::Array(..) | Type::Text(Some(_))) => {
                Ok(format!("typedef {};\n", self.declare(inner, element)?))
            }
            _ => Ok(String::new()),
        }
    }

    /// What stands before something of a type for the address that [`Names::pointer`] is the type of: an array is its own.
    pub(super) fn address(&self, ty: &Type) -> &'static str {
        if self.passing(ty) == Passing::Array { "" } else { "&" }
    }

    /// The name of a type.
    pub(super) fn base(&self, ty: &Type) -> Result<String, NotInC> {
        Ok(match ty {
            Type::Basic(basic) => match basic {
                Basic::Boolean => "bool",
                Basic::Short => "int16_t",
                Basic::UnsignedShort => "uint16_t",
                Basic::Long => "int32_t",
                Basic::UnsignedLong => "uint32_t",
                Basic::LongLong => "int64_t",
                Basic::UnsignedLongLong => "uint64_t",
                Basic::Float => "float",
                Basic::Double => "double",
                Basic::Char => "int8_t",
                Basic::WideChar => "int32_t",
                Basic::Octet => "uint8_t",
                Basic::Any => return Err(NotInC("a value of the type `any` cannot be given to C codels".to_owned())),
            }
            .to_owned(),
            Type::Fixed(_) => "double".to_owned(),
            Type::Text(None) => "char *".to_owned(),
            Type::Named(id) => self.def(*id).map(|d| d.path.join("_")).unwrap_or_default(),
            Type::Sequence(inner, most) => {
                let most = most.map(|m| m.to_string()).unwrap_or_default();
                format!("sequence{most}_{}", self.key(inner)?)
            }
            Type::Optional(inner) => format!("optional_{}", self.key(inner)?),
            Type::Array(..) | Type::Text(Some(_)) => {
                return Err(NotInC(
                    "an array stands where C needs a name for its type: give it one by `typedef`".to_owned(),
                ));
            }
        })
    }

    /// A type as a part of a name: `sequence8_unsigned_long`, `optional_string128`, as GenoM3 has them.
    fn key(&self, ty: &Type) -> Result<String, NotInC> {
        Ok(match ty {
            Type::Basic(basic) => match basic {
                Basic::Boolean => "boolean",
                Basic::Short => "short",
                Basic::UnsignedShort => "unsigned_short",
                Basic::Long => "long",
                Basic::UnsignedLong => "unsigned_long",
                Basic::LongLong => "long_long",
                Basic::UnsignedLongLong => "unsigned_long_long",
                Basic::Float => "float",
                Basic::Double => "double",
                Basic::Char => "char",
                Basic::WideChar => "wchar",
                Basic::Octet => "octet",
                Basic::Any => return self.base(ty),
            }
            .to_owned(),
            Type::Fixed(_) => "fixed".to_owned(),
            Type::Text(None) => "string".to_owned(),
            Type::Text(Some(most)) => format!("string{most}"),
            Type::Array(inner, length) => format!("array{length}_{}", self.key(inner)?),
            Type::Named(_) | Type::Sequence(..) | Type::Optional(_) => self.base(ty)?,
        })
    }
}

/// A pointer to an array, not an array of pointers.
fn bracketed(name: &str) -> String {
    if name.starts_with('*') { format!("({name})") } else { name.to_owned() }
}

/// A text as C writes it.
fn quoted(text: &str) -> String {
    let inside: String = text
        .bytes()
        .map(|byte| match byte {
            b'"' | b'\\' => format!("\\{}", char::from(byte)),
            b' '..=b'~' => char::from(byte).to_string(),
            _ => format!("\\{byte:03o}"),
        })
        .collect();
    format!("\"{inside}\"")
}

fn forward(what: &str, def: &TypeDef) -> String {
    let name = def.path.join("_");
    format!("typedef {what} {name} {name};\n")
}

struct Writer<'w, 'm> {
    names: &'w Names<'m>,
    done: BTreeSet<TypeId>,
    anonymous: BTreeSet<String>,
    out: String,
}

impl Writer<'_, '_> {
    /// Declares a type, after what it contains.
    fn named(&mut self, id: TypeId, depth: usize) -> Result<(), NotInC> {
        if depth > MOST_DEPTH || !self.done.insert(id) {
            return Ok(());
        }
        let Some(def) = self.names.def(id).cloned() else { return Ok(()) };
        let name = def.path.join("_");
        match &def.kind {
            TypeDefKind::Struct(fields) => {
                let body = self.members(fields, depth, "  ")?;
                self.out += &format!("struct {name} {{\n{body}}};\n");
            }
            TypeDefKind::Exception(fields) if !fields.is_empty() => {
                let body = self.members(fields, depth, "  ")?;
                self.out += &format!("typedef struct {name}_detail {{\n{body}}} {name}_detail;\n");
            }
            TypeDefKind::Union(on, cases) => {
                self.need(on, depth)?;
                let on = self.names.declare(on, "_d")?;
                let fields: Vec<Field> = cases.iter().map(|(_, field)| field.clone()).collect();
                let body = self.members(&fields, depth, "    ")?;
                self.out += &format!("struct {name} {{\n  {on};\n  union {{\n{body}  }} _u;\n}};\n");
            }
            TypeDefKind::Enum(values) => {
                let prefix = self.names.enumerators(&Type::Named(id));
                let values: Vec<String> = values.iter().map(|v| format!("{prefix}{v}")).collect();
                self.out += &format!("typedef uint32_t {name};\nenum {{ {} }};\n", values.join(", "));
            }
            TypeDefKind::Alias(inner) => {
                self.need(inner, depth)?;
                let declared = self.names.declare(inner, &name)?;
                self.out += &format!("typedef {declared};\n");
            }
            TypeDefKind::Exception(_) | TypeDefKind::Native | TypeDefKind::Forward => {}
        }
        Ok(())
    }

    /// Types without a name that stand nowhere but in ports, parameters and local data.
    fn nameless(&mut self, component: &Component) -> Result<(), NotInC> {
        for port in &component.ports {
            self.need(&port.ty, 0)?;
        }
        for service in &component.services {
            for ty in service.parameters.iter().filter_map(|p| p.ty.as_ref()) {
                self.need(ty, 0)?;
            }
            for local in &service.locals {
                self.need(&local.ty, 0)?;
            }
        }
        Ok(())
    }

    fn members(&mut self, fields: &[Field], depth: usize, margin: &str) -> Result<String, NotInC> {
        let mut body = String::new();
        for field in fields {
            self.need(&field.ty, depth)?;
            body += &format!("{margin}{};\n", self.names.declare(&field.ty, &field.name)?);
        }
        if fields.is_empty() {
            body = format!("{margin}char _empty;\n");
        }
        Ok(body)
    }

    /// What stands inside another type must be declared before it.
    fn need(&mut self, ty: &Type, depth: usize) -> Result<(), NotInC> {
        match ty {
            Type::Named(id) => self.named(*id, depth + 1),
            Type::Array(inner, _) => self.need(inner, depth + 1),
            Type::Sequence(inner, most) => {
                let is_struct = self.names.fields(inner).is_some();
                // Where only an address is kept, that the structure exists is enough, and it may be the one that is being declared.
                if !(is_struct && most.is_none() && matches!(inner.as_ref(), Type::Named(_))) {
                    self.need(inner, depth + 1)?;
                }
                let name = self.names.base(ty)?;
                if self.anonymous.insert(name.clone()) {
                    let buffer = match most {
                        Some(most) => self.names.declare(inner, &format!("_buffer[{most}]"))?,
                        None => self.names.declare(inner, "*_buffer")? + "; void (*_release)(void *_buffer)",
                    };
                    self.out += &format!("typedef struct {name} {{ uint32_t _maximum, _length; {buffer}; }} {name};\n");
                }
                Ok(())
            }
            Type::Optional(inner) => {
                self.need(inner, depth + 1)?;
                let name = self.names.base(ty)?;
                if self.anonymous.insert(name.clone()) {
                    let value = self.names.declare(inner, "_value")?;
                    self.out += &format!("typedef struct {name} {{ bool _present; {value}; }} {name};\n");
                }
                Ok(())
            }
            Type::Basic(_) | Type::Text(_) | Type::Fixed(_) => Ok(()),
        }
    }
}

/// The labels of a case, as C writes them; none for all others, whatever stands beside `default`.
pub(super) fn labels(labels: &[Label], enumerators: &str) -> Vec<String> {
    if labels.contains(&Label::Default) {
        return Vec::new();
    }
    let text = |label: &Label| match label {
        Label::Int(value) => Some(value.to_string()),
        Label::Name(name) => Some(format!("{enumerators}{name}")),
        Label::Default => None,
    };
    labels.iter().filter_map(text).collect()
}
