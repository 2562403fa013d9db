//! Reads `.msg` texts: one definition, or many with `MSG: pkg/Type` lines between rulers of equals signs.

use lapwing_stream::{Constant, Value};

use super::{Base, Definition, DefinitionError, Dialect, FieldDef, FieldType, MAX_FIELDS, Prim, normal_name};

pub(super) fn parse(dialect: Dialect, root: &str, text: &str) -> Result<Vec<Definition>, DefinitionError> {
    let mut all = vec![Definition { name: root.to_owned(), ..Definition::default() }];
    for line in text.lines().map(str::trim) {
        if let Some(name) = line.strip_prefix("MSG:") {
            begin(&mut all, normal_name(name.trim()));
        } else if !is_ruler(line) && !line.is_empty() && !line.starts_with('#') {
            let Some(current) = all.last_mut() else { continue };
            member(dialect, current, line).map_err(|what| {
                DefinitionError::new(format!("the definition of {}: {what}: `{}`", current.name, short(line)))
            })?;
        }
    }
    Ok(all)
}

/// A `MSG:` line before any member of the root names the root itself.
fn begin(all: &mut Vec<Definition>, name: String) {
    match all.as_mut_slice() {
        [only] if only.name == name && only.fields.is_empty() && only.constants.is_empty() => {}
        _ => all.push(Definition { name, ..Definition::default() }),
    }
}

fn is_ruler(line: &str) -> bool {
    line.len() >= 3 && line.bytes().all(|b| b == b'=')
}

/// The beginning of a line, for a message.
fn short(line: &str) -> &str {
    line.char_indices().nth(60).map_or(line, |(end, _)| &line[..end])
}

fn member(dialect: Dialect, into: &mut Definition, line: &str) -> Result<(), &'static str> {
    let (ty, rest) = line.split_once(char::is_whitespace).ok_or("a type without a name")?;
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    let (name, rest) = rest.split_at(end);
    if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
        return Err("no name after the type");
    }
    let package = into.name.split_once('/').map_or("", |(package, _)| package);
    let ty = field_type(dialect, package, ty)?;
    if into.fields.len() + into.constants.len() >= MAX_FIELDS {
        return Err("too many fields");
    }
    match rest.trim_start().strip_prefix('=') {
        Some(value) => into.constants.push(Constant { name: name.into(), value: constant(&ty, value.trim())? }),
        // What else follows is a default, which is not sent, or a comment.
        None => {
            let default = if dialect == Dialect::Ros1 { None } else { default(&ty, rest.trim()) };
            into.fields.push(FieldDef { name: name.into(), ty, default });
        }
    }
    Ok(())
}

fn field_type(dialect: Dialect, package: &str, text: &str) -> Result<FieldType, &'static str> {
    let (base, array) = match text.split_once('[') {
        Some((base, rest)) => (base, Some(rest.strip_suffix(']').ok_or("an array bracket is not closed")?)),
        None => (text, None),
    };
    let arrays = match array {
        None => Vec::new(),
        Some(bound) if bound.is_empty() || bound.starts_with("<=") => vec![None],
        Some(length) => vec![Some(length.parse().map_err(|_| "the length of an array is no number")?)],
    };
    Ok(FieldType { base: base_type(dialect, package, base)?, arrays })
}

fn base_type(dialect: Dialect, package: &str, text: &str) -> Result<Base, &'static str> {
    let name = text.split_once("<=").map_or(text, |(name, _bound)| name);
    Ok(match name {
        "string" => Base::Text,
        "wstring" => Base::WideText,
        "bool" => Base::Prim(Prim::Bool),
        "int8" => Base::Prim(Prim::I8),
        "byte" if dialect == Dialect::Ros1 => Base::Prim(Prim::I8),
        "uint8" | "byte" | "char" => Base::Prim(Prim::U8),
        "int16" => Base::Prim(Prim::I16),
        "uint16" => Base::Prim(Prim::U16),
        "int32" => Base::Prim(Prim::I32),
        "uint32" => Base::Prim(Prim::U32),
        "int64" => Base::Prim(Prim::I64),
        "uint64" => Base::Prim(Prim::U64),
        "float32" => Base::Prim(Prim::F32),
        "float64" => Base::Prim(Prim::F64),
        "time" | "duration" if dialect == Dialect::Ros1 => Base::Message(name.to_owned()),
        "time" => Base::Message("builtin_interfaces/Time".to_owned()),
        "duration" => Base::Message("builtin_interfaces/Duration".to_owned()),
        "Header" if dialect == Dialect::Ros1 => Base::Message("std_msgs/Header".to_owned()),
        "" => return Err("a type is empty"),
        name if !name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'/') => return Err("not a type"),
        name if name.contains('/') => Base::Message(normal_name(name)),
        name => Base::Message(format!("{package}/{name}")),
    })
}

/// The value of a constant. A text reaches to the end of the line, unless it is quoted; a number ends at a comment.
fn constant(ty: &FieldType, text: &str) -> Result<Value, &'static str> {
    if !ty.arrays.is_empty() {
        return Err("a constant cannot be an array");
    }
    match ty.base {
        Base::Text | Base::WideText => Ok(Value::Str(unquoted(text).to_owned())),
        Base::Prim(prim) => {
            let text = text.split_once('#').map_or(text, |(value, _)| value).trim();
            number(prim, text).ok_or("the value of the constant is no number")
        }
        Base::Message(_) => Err("a constant cannot be a message"),
    }
}

/// The default of a field. One that cannot be read is none: nothing but the values of messages that others leave out depends on it.
fn default(ty: &FieldType, text: &str) -> Option<Value> {
    if text.is_empty() || text.starts_with('#') {
        return None;
    }
    if ty.arrays.is_empty() {
        return constant(ty, text).ok();
    }
    let element = FieldType { base: ty.base.clone(), arrays: Vec::new() };
    let inner = text.strip_prefix('[')?.split_once(']')?.0;
    let items = inner.split(',').map(str::trim).filter(|item| !item.is_empty());
    items.map(|item| constant(&element, item).ok()).collect::<Option<Vec<_>>>().map(Value::List)
}

fn unquoted(text: &str) -> &str {
    let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''));
    quote.and_then(|q| text[1..].find(q).map(|end| &text[1..=end])).unwrap_or(text)
}

pub(super) fn number(prim: Prim, text: &str) -> Option<Value> {
    if prim == Prim::Bool {
        return match text.to_ascii_lowercase().as_str() {
            "true" | "1" => Some(Value::Bool(true)),
            "false" | "0" => Some(Value::Bool(false)),
            _ => None,
        };
    }
    let (sign, digits) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    if let Some(hex) = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        return u64::from_str_radix(hex, 16).ok().map(|n| Value::Num(sign * n as f64));
    }
    digits.parse::<f64>().ok().map(|n| Value::Num(sign * n))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(dialect: Dialect, text: &str) -> Definition {
        parse(dialect, "pkg/Root", text).unwrap().remove(0)
    }

    #[test]
    fn fields_defaults_bounds_and_comments() {
        let d = one(
            Dialect::Ros2,
            "# head\nint32 x 5 # why\nstring<=10 name \"a # b\"\nfloat64[36] cov\nuint8[<=4] small\nPoint[] points\nother/msg/T t",
        );
        let names: Vec<_> = d.fields.iter().map(|f| &*f.name).collect();
        assert_eq!(names, ["x", "name", "cov", "small", "points", "t"]);
        assert_eq!(d.fields[1].ty, FieldType { base: Base::Text, arrays: vec![] });
        assert_eq!(d.fields[2].ty.arrays, [Some(36)]);
        assert_eq!(d.fields[3].ty.arrays, [None]);
        assert_eq!(d.fields[4].ty.base, Base::Message("pkg/Point".into()));
        assert_eq!(d.fields[5].ty.base, Base::Message("other/T".into()));
        assert_eq!((&d.fields[0].default, &d.fields[1].default), (&Some(5.0.into()), &Some("a # b".into())));
        assert!(d.fields[2..].iter().all(|f| f.default.is_none()));
        let arrays = one(Dialect::Ros2, "int8[3] a [1, -2, 3] # why\nstring[] b [\"x\", 'y']\nbool[] c []");
        let list = |values: &[Value]| Some(Value::List(values.to_vec()));
        assert_eq!(arrays.fields[0].default, list(&[1.0.into(), (-2.0).into(), 3.0.into()]));
        assert_eq!(
            (&arrays.fields[1].default, &arrays.fields[2].default),
            (&list(&["x".into(), "y".into()]), &list(&[]))
        );
    }

    #[test]
    fn constants_of_every_kind() {
        let d = one(Dialect::Ros1, "uint8 A=1\nint32 B = -0x10 # hex\nstring S= a # b \nbool T=True\nfloat32 F=1.5e3");
        let values: Vec<_> = d.constants.iter().map(|c| c.value.clone()).collect();
        assert_eq!(values, [Value::Num(1.0), Value::Num(-16.0), "a # b".into(), true.into(), Value::Num(1500.0)]);
        assert_eq!(one(Dialect::Ros2, "string S=\"a b\" # c").constants[0].value, "a b".into());
    }

    #[test]
    fn concatenated_definitions_are_taken_apart() {
        let text = "Header header\ntime t\n====\nMSG: std_msgs/Header\nuint32 seq\n====\nMSG: pkg/B\nchar c";
        let all = parse(Dialect::Ros1, "pkg/Root", text).unwrap();
        assert_eq!(all.iter().map(|d| d.name.as_str()).collect::<Vec<_>>(), ["pkg/Root", "std_msgs/Header", "pkg/B"]);
        assert_eq!(all[0].fields[0].ty.base, Base::Message("std_msgs/Header".into()));
        assert_eq!(all[0].fields[1].ty.base, Base::Message("time".into()));
    }

    #[test]
    fn wrong_texts_are_refused_with_the_line() {
        for text in ["int32", "int32 5x", "int32[ x", "int32[-1] x", "int32 A=b", "a<b x", "Point P=1"] {
            let error = parse(Dialect::Ros2, "pkg/Root", text).unwrap_err();
            assert!(error.to_string().contains(text), "{error}");
        }
    }
}
