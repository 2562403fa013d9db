//! Values as lines show them: JSON, in which a whole number is a whole number, however large.

use std::fmt::Write as _;

use lapwing_genom::model::Type;
use lapwing_stream::json;

use super::{Shape, Types};
use crate::datum::Datum;

impl Types {
    /// Writes a value of a type at the end of a line.
    pub(crate) fn write(&self, line: &mut String, ty: &Type, datum: &Datum) {
        match (self.shape(ty), datum) {
            // Writing to a text cannot fail.
            (Shape::Int(..), Datum::Int(i)) => _ = write!(line, "{i}"),
            (Shape::Array(inner, _) | Shape::Sequence(inner, _), Datum::List(items)) => {
                line.push('[');
                for (place, item) in items.iter().enumerate() {
                    separate(line, place);
                    self.write(line, inner, item);
                }
                line.push(']');
            }
            (Shape::Struct(fields), Datum::Struct(parts)) => {
                let members = fields.iter().zip(parts);
                self.write_members(line, members.map(|(field, part)| (field.name.as_str(), &field.ty, part)));
            }
            (Shape::Union(_, cases), Datum::Union(_, Some((number, value)))) => {
                let member = cases.get(*number).map(|(_, field)| (field.name.as_str(), &field.ty, value.as_ref()));
                self.write_members(line, member.into_iter());
            }
            (Shape::Optional(inner), Datum::Optional(Some(value))) => self.write(line, inner, value),
            _ => json::value(line, &self.to_value(ty, datum)),
        }
    }

    fn write_members<'d>(&self, line: &mut String, members: impl Iterator<Item = (&'d str, &'d Type, &'d Datum)>) {
        line.push('{');
        for (place, (name, ty, value)) in members.enumerate() {
            separate(line, place);
            json::text(line, name);
            line.push(':');
            self.write(line, ty, value);
        }
        line.push('}');
    }
}

fn separate(line: &mut String, place: usize) {
    if place > 0 {
        line.push(',');
    }
}
