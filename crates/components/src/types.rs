//! The types of a specification at work: first values, ways into values, whether a value fits, and how monitors and recordings see it.

mod outline;
mod size;
mod text;

use std::collections::BTreeSet;
use std::sync::Arc;

use lapwing_genom::model::{
    Basic, Component, Field, Label, Model, Step, Type, TypeDef, TypeDefKind, TypeId, Value as Default,
};
use lapwing_stream as stream;
use lapwing_stream::Name;

use crate::datum::Datum;

use outline::Outline;
use size::Sizes;

/// Types inside types beyond this depth are not looked into.
const MOST_DEPTH: usize = 64;

/// A value has no more parts than this at first.
pub(crate) const MOST_PARTS: u64 = 1 << 20;

/// The types that have names.
#[derive(Clone, Debug, Default)]
pub struct Types {
    defs: Arc<[TypeDef]>,
}

/// What a type comes to once its names are followed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape<'t> {
    Bool,
    /// Between these, ends included.
    Int(i128, i128),
    Float,
    Text(Option<u64>),
    Sequence(&'t Type, Option<u64>),
    Array(&'t Type, u64),
    Optional(&'t Type),
    Struct(&'t [Field]),
    /// By the values of a type; a member for each of some of them.
    Union(&'t Type, &'t [(Vec<Label>, Field)]),
    Enum(&'t [String]),
    Native,
    /// What cannot be a value here, in words.
    Other(&'static str),
}

/// What a type comes to, for who carries values elsewhere.
#[derive(Clone, Debug)]
pub enum Layout<'t> {
    /// A number, a truth value or a character.
    Basic(Basic),
    /// A text, of a greatest length.
    Text(Option<u64>),
    /// One of so many names.
    Enum(usize),
    /// So many elements.
    Array(&'t Type, u64),
    /// Any number of elements, up to a greatest one.
    Sequence(&'t Type, Option<u64>),
    /// Members.
    Struct(&'t [Field]),
    /// A value that may be missing.
    Optional(&'t Type),
    /// For each member, the values that tell that it is there, none for all others, and its type.
    Union(Vec<(Vec<i128>, &'t Type)>),
    /// What only codels know.
    Native,
    /// What has no values, in words.
    Other(&'static str),
}

impl Types {
    /// What a type comes to.
    pub fn layout<'t>(&'t self, ty: &'t Type) -> Layout<'t> {
        let ty = ty.behind(&self.defs);
        if let Type::Basic(basic) = ty {
            return Layout::Basic(*basic);
        }
        match self.shape(ty) {
            Shape::Text(most) => Layout::Text(most),
            Shape::Enum(names) => Layout::Enum(names.len()),
            Shape::Array(inner, length) => Layout::Array(inner, length),
            Shape::Sequence(inner, most) => Layout::Sequence(inner, most),
            Shape::Struct(fields) => Layout::Struct(fields),
            Shape::Optional(inner) => Layout::Optional(inner),
            Shape::Native => Layout::Native,
            // Of numbers only those with a fixed point are left, which are kept as doubles.
            Shape::Bool | Shape::Int(..) | Shape::Float => Layout::Basic(Basic::Double),
            Shape::Other(what) => Layout::Other(what),
            Shape::Union(on, cases) => {
                Layout::Union(cases.iter().map(|(labels, field)| (self.tags(on, labels), &field.ty)).collect())
            }
        }
    }

    /// The values that tell that a member of a union is there; none for all that no other member has.
    fn tags(&self, on: &Type, labels: &[Label]) -> Vec<i128> {
        if labels.contains(&Label::Default) {
            return Vec::new();
        }
        let number = |label: &Label| match (label, self.shape(on)) {
            (Label::Int(value), _) => Some(*value),
            (Label::Name(name), Shape::Enum(names)) => names.iter().position(|n| n == name).map(|n| n as i128),
            _ => None,
        };
        labels.iter().filter_map(number).collect()
    }

    /// A value that tells that a member of a union is there: its first, or the least that no other member has.
    fn tag(&self, on: &Type, cases: &[(Vec<Label>, Field)], number: usize) -> i128 {
        let own = cases.get(number).and_then(|(labels, _)| self.tags(on, labels).first().copied());
        own.unwrap_or_else(|| {
            let taken: BTreeSet<i128> = cases.iter().flat_map(|(labels, _)| self.tags(on, labels)).collect();
            (0..).find(|tag| !taken.contains(tag)).unwrap_or(0)
        })
    }

    /// The member of a union by its name: a value that tells that it is there, its number, and its type.
    pub(crate) fn case(&self, ty: &Type, name: &str) -> Result<(i128, usize, Type), String> {
        let Shape::Union(on, cases) = self.shape(ty) else { return Err("it is no union".to_owned()) };
        let found = cases.iter().enumerate().find(|(_, (_, field))| field.name == name);
        let (number, (_, field)) = found.ok_or_else(|| {
            let names: Vec<&str> = cases.iter().map(|(_, field)| field.name.as_str()).collect();
            format!("there is no `{name}` in it; there are {}", names.join(", "))
        })?;
        Ok((self.tag(on, cases, number), number, field.ty.clone()))
    }

    /// Those of a model.
    ///
    /// # Errors
    ///
    /// A first value of a type that a component needs would be too large to be kept, or would contain itself: which, in words.
    pub fn new(model: &Model) -> Result<Types, String> {
        let types = Types { defs: model.types.clone().into() };
        let all: Vec<(&Component, Type)> =
            model.components.iter().flat_map(|c| needed(c).into_iter().map(move |ty| (c, ty))).collect();
        let mut sizes = Sizes::new(&types);
        if let Some((component, ty)) = all.iter().find(|(_, ty)| !sizes.are_fair(ty)) {
            return Err(format!(
                "a value of `{}` of `{}` has more than {MOST_PARTS} parts, or contains itself, and cannot be kept",
                types.type_name(ty),
                component.name
            ));
        }
        drop(sizes);
        Ok(types)
    }

    pub(crate) fn shape<'t>(&'t self, ty: &'t Type) -> Shape<'t> {
        match ty.behind(&self.defs) {
            Type::Basic(basic) => of_basic(*basic),
            Type::Text(most) => Shape::Text(*most),
            Type::Sequence(inner, most) => Shape::Sequence(inner, *most),
            Type::Array(inner, length) => Shape::Array(inner, *length),
            Type::Optional(inner) => Shape::Optional(inner),
            Type::Fixed(_) => Shape::Float,
            Type::Named(id) => match self.def(*id).map(|d| &d.kind) {
                Some(TypeDefKind::Struct(fields) | TypeDefKind::Exception(fields)) => Shape::Struct(fields),
                Some(TypeDefKind::Union(on, cases)) => Shape::Union(on, cases),
                Some(TypeDefKind::Enum(names)) => Shape::Enum(names),
                Some(TypeDefKind::Native) => Shape::Native,
                Some(TypeDefKind::Alias(_)) => Shape::Other("a type that is defined by itself"),
                Some(TypeDefKind::Forward) | None => Shape::Other("a type that is nowhere defined"),
            },
        }
    }

    /// The type by that number, where there is one.
    pub fn def(&self, id: TypeId) -> Option<&TypeDef> {
        self.defs.get(id.0)
    }

    /// The first value of a type that a component of the model needs: zeros, empty texts and sequences, nothing.
    pub fn initial(&self, ty: &Type) -> Datum {
        match self.shape(ty) {
            Shape::Bool => Datum::Bool(false),
            Shape::Int(..) | Shape::Enum(_) => Datum::Int(0),
            Shape::Float => Datum::Float(0.0),
            Shape::Text(_) => Datum::Text(String::new()),
            Shape::Sequence(..) => Datum::List(Vec::new()),
            Shape::Array(inner, length) => {
                let one = self.initial(inner);
                Datum::List(vec![one; usize::try_from(length.min(MOST_PARTS)).unwrap_or(0)])
            }
            Shape::Optional(_) => Datum::Optional(None),
            Shape::Struct(fields) => Datum::Struct(fields.iter().map(|field| self.initial(&field.ty)).collect()),
            Shape::Union(on, cases) => {
                let first = cases.first().map(|(_, field)| (0, Box::new(self.initial(&field.ty))));
                Datum::Union(self.tag(on, cases, 0), first)
            }
            Shape::Native | Shape::Other(_) => Datum::Native(0),
        }
    }

    /// Where steps lead in a value of a type: the numbers of members and elements, and the type there.
    ///
    /// # Errors
    ///
    /// What is not there, in words.
    pub(crate) fn way<'t>(&'t self, ty: &'t Type, steps: &[Step]) -> Result<(Vec<usize>, &'t Type), String> {
        let (mut ty, mut way) = (ty, Vec::with_capacity(steps.len()));
        for step in steps {
            let (number, next) = match (step, self.shape(ty)) {
                (Step::Member(name), Shape::Struct(fields)) => {
                    let found = fields.iter().enumerate().find(|(_, field)| field.name == *name);
                    let (number, field) = found.ok_or_else(|| {
                        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
                        format!("there is no `{name}` in it; there are {}", names.join(", "))
                    })?;
                    (number, &field.ty)
                }
                (Step::Element(number), Shape::Array(inner, _) | Shape::Sequence(inner, _)) => {
                    (usize::try_from(*number).unwrap_or(usize::MAX), inner)
                }
                (Step::Member(name), _) => return Err(format!("what is there has no members, and so no `{name}`")),
                (Step::Element(_), _) => return Err("what is there has no elements".to_owned()),
            };
            way.push(number);
            ty = next;
        }
        Ok((way, ty))
    }

    /// A value as one of a type, where it fits: a whole number is a number, too, and a text may name an enumerator.
    ///
    /// # Errors
    ///
    /// Why it does not fit, in words.
    pub fn fit(&self, ty: &Type, datum: Datum) -> Result<Datum, String> {
        match (self.shape(ty), datum) {
            (Shape::Bool, Datum::Bool(b)) => Ok(Datum::Bool(b)),
            (Shape::Int(low, high), Datum::Int(i)) if (low..=high).contains(&i) => Ok(Datum::Int(i)),
            (Shape::Int(low, high), Datum::Int(i)) => Err(format!("{i} is not between {low} and {high}")),
            (Shape::Int(low, high), Datum::Float(x)) if x.fract() == 0.0 && x.abs() < 2_f64.powi(53) => {
                self.fit_int(x as i128, low, high)
            }
            (Shape::Float, Datum::Int(i)) => Ok(Datum::Float(i as f64)),
            (Shape::Float, Datum::Float(x)) => Ok(Datum::Float(x)),
            (Shape::Text(most), Datum::Text(text)) => match most {
                Some(most) if text.len() as u64 > most => Err(format!("the text is longer than {most} bytes")),
                _ => Ok(Datum::Text(text)),
            },
            (Shape::Enum(names), Datum::Text(name)) => {
                let number = names.iter().position(|n| *n == name);
                number.map(|n| Datum::Int(n as i128)).ok_or_else(|| format!("`{name}` is none of {}", names.join(", ")))
            }
            (Shape::Enum(names), Datum::Int(i)) => match usize::try_from(i).ok().filter(|i| *i < names.len()) {
                Some(_) => Ok(Datum::Int(i)),
                None => Err(format!("there are {} values, and none with the number {i}", names.len())),
            },
            (Shape::Sequence(inner, most), Datum::List(items)) => {
                if most.is_some_and(|most| items.len() as u64 > most) {
                    return Err(format!("{} elements are more than the sequence may have", items.len()));
                }
                Ok(Datum::List(items.into_iter().map(|item| self.fit(inner, item)).collect::<Result<_, _>>()?))
            }
            (Shape::Array(inner, length), Datum::List(items)) => {
                if items.len() as u64 != length {
                    return Err(format!("there are {} elements where the array has {length}", items.len()));
                }
                Ok(Datum::List(items.into_iter().map(|item| self.fit(inner, item)).collect::<Result<_, _>>()?))
            }
            (Shape::Struct(fields), Datum::Struct(parts)) if parts.len() == fields.len() => {
                let fitted = fields.iter().zip(parts).map(|(field, part)| self.fit(&field.ty, part));
                Ok(Datum::Struct(fitted.collect::<Result<_, _>>()?))
            }
            (Shape::Optional(_), Datum::Optional(None)) => Ok(Datum::Optional(None)),
            (Shape::Optional(inner), Datum::Optional(Some(value))) => {
                Ok(Datum::Optional(Some(Box::new(self.fit(inner, *value)?))))
            }
            (Shape::Optional(inner), value) => Ok(Datum::Optional(Some(Box::new(self.fit(inner, value)?)))),
            (Shape::Union(..), value @ Datum::Union(..)) | (Shape::Native, value @ Datum::Native(_)) => Ok(value),
            (shape, _) => Err(format!("{} is wanted", words(shape))),
        }
    }

    fn fit_int(&self, value: i128, low: i128, high: i128) -> Result<Datum, String> {
        match (low..=high).contains(&value) {
            true => Ok(Datum::Int(value)),
            false => Err(format!("{value} is not between {low} and {high}")),
        }
    }

    /// A default of a specification as a value of a type; what it leaves out is as at first.
    pub(crate) fn default(&self, ty: &Type, default: &Default) -> Datum {
        let plain = |datum: Datum| self.fit(ty, datum).unwrap_or_else(|_| self.initial(ty));
        match default {
            Default::Int(i) if matches!(self.shape(ty), Shape::Bool) => Datum::Bool(*i != 0),
            Default::Int(i) => plain(Datum::Int(*i)),
            Default::Float(x) => plain(Datum::Float(*x)),
            Default::Bool(b) => plain(Datum::Bool(*b)),
            Default::Text(text) | Default::Name(text) => plain(Datum::Text(text.clone())),
            Default::Parts(parts) => {
                let mut whole = self.initial(ty);
                for (step, value) in parts {
                    if let (Step::Element(n), Shape::Sequence(inner, _), Datum::List(items)) =
                        (step, self.shape(ty), &mut whole)
                    {
                        let wanted = usize::try_from(*n).unwrap_or(usize::MAX).saturating_add(1);
                        let one = self.initial(inner);
                        if items.len() < wanted && (wanted as u64).saturating_mul(one.parts()) <= MOST_PARTS {
                            items.resize(wanted, one);
                        }
                    }
                    let Ok((way, inner)) = self.way(ty, std::slice::from_ref(step)) else { continue };
                    if let Some(place) = whole.part_mut(&way) {
                        *place = self.default(inner, value);
                    }
                }
                whole
            }
        }
    }

    /// The type of messages as monitors know types.
    pub(crate) fn stream_type(&self, ty: &Type) -> stream::Type {
        Outline::new(self).ty(ty, 0)
    }

    /// What messages of a type are called: `nav/scan`.
    pub(crate) fn type_name(&self, ty: &Type) -> String {
        match ty {
            Type::Named(id) => self.def(*id).map_or_else(String::new, |def| def.path.join("/")),
            _ => "value".to_owned(),
        }
    }

    /// A value as monitors and recordings have it: enumerators by their names, a union as the member that is there.
    pub fn to_value(&self, ty: &Type, datum: &Datum) -> stream::Value {
        use stream::Value;
        match (self.shape(ty), datum) {
            (Shape::Enum(names), Datum::Int(i)) => {
                let name = usize::try_from(*i).ok().and_then(|i| names.get(i));
                name.map_or(Value::Num(*i as f64), |name| Value::Str(name.clone()))
            }
            (_, Datum::Bool(b)) => Value::Bool(*b),
            (_, Datum::Int(i)) => Value::Num(*i as f64),
            (_, Datum::Float(x)) => Value::Num(*x),
            (_, Datum::Text(text)) => Value::Str(text.clone()),
            (Shape::Array(inner, _) | Shape::Sequence(inner, _), Datum::List(items)) => self.to_list(inner, items),
            (Shape::Struct(fields), Datum::Struct(parts)) => {
                let named = fields.iter().zip(parts);
                Value::Record(
                    named.map(|(f, part)| (Name::from(f.name.as_str()), self.to_value(&f.ty, part))).collect(),
                )
            }
            (Shape::Union(_, cases), Datum::Union(_, Some((number, value)))) => match cases.get(*number) {
                Some((_, field)) => Value::Record(vec![(field.name.as_str().into(), self.to_value(&field.ty, value))]),
                None => Value::Missing,
            },
            (Shape::Optional(inner), Datum::Optional(Some(value))) => self.to_value(inner, value),
            _ => Value::Missing,
        }
    }

    fn to_list(&self, inner: &Type, items: &[Datum]) -> stream::Value {
        let numbers: Option<Vec<f64>> = match self.shape(inner) {
            Shape::Int(..) | Shape::Float => items.iter().map(Datum::number).collect(),
            _ => None,
        };
        match numbers {
            Some(numbers) => stream::Value::Nums(numbers),
            None => stream::Value::List(items.iter().map(|item| self.to_value(inner, item)).collect()),
        }
    }
}

/// The types of which a component keeps values.
fn needed(component: &Component) -> Vec<Type> {
    let parameters = component.services.iter().flat_map(|s| s.parameters.iter().filter_map(|p| p.ty.clone()));
    let locals = component.services.iter().flat_map(|s| s.locals.iter().map(|l| l.ty.clone()));
    let ports = component.ports.iter().map(|p| p.ty.clone());
    ports.chain(parameters).chain(locals).chain(component.ids.map(Type::Named)).collect()
}

fn of_basic(basic: Basic) -> Shape<'static> {
    let signed = |bits: u32| Shape::Int(-(1_i128 << (bits - 1)), (1_i128 << (bits - 1)) - 1);
    let unsigned = |bits: u32| Shape::Int(0, (1_i128 << bits) - 1);
    match basic {
        Basic::Boolean => Shape::Bool,
        Basic::Short => signed(16),
        Basic::UnsignedShort => unsigned(16),
        Basic::Long | Basic::WideChar => signed(32),
        Basic::UnsignedLong => unsigned(32),
        Basic::LongLong => signed(64),
        Basic::UnsignedLongLong => unsigned(64),
        Basic::Float | Basic::Double => Shape::Float,
        Basic::Char => Shape::Int(-128, 255),
        Basic::Octet => unsigned(8),
        Basic::Any => Shape::Other("a value of any type"),
    }
}

fn words(shape: Shape<'_>) -> String {
    match shape {
        Shape::Bool => "true or false".to_owned(),
        Shape::Int(..) => "a whole number".to_owned(),
        Shape::Float => "a number".to_owned(),
        Shape::Text(_) => "a text".to_owned(),
        Shape::Sequence(..) | Shape::Array(..) => "a list `[…]`".to_owned(),
        Shape::Optional(_) => "a value".to_owned(),
        Shape::Struct(_) => "a structure `{member=…}`".to_owned(),
        Shape::Union(..) => "a member of a union `{member=…}`".to_owned(),
        Shape::Enum(names) => format!("one of {}", names.join(", ")),
        Shape::Native => "what only codels know, and cannot be written here,".to_owned(),
        Shape::Other(what) => what.to_owned(),
    }
}
