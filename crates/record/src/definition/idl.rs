//! Reads `.idl` texts: the part of OMG IDL that ROS 2's own tools write.
//!
//! Modules, structs, typedefs (which stand for arrays), sequences, bounded texts and constants are understood;
//! annotations and preprocessor lines are passed over. Unions, enums and interfaces are refused by name.

use std::collections::BTreeMap;

use lapwing_stream::{Constant, Value};

use super::{Base, Definition, DefinitionError, FieldDef, FieldType, MAX_FIELDS, Prim, msg, normal_name};

/// Modules and sequences may not be nested deeper than this.
const MAX_DEPTH: usize = 32;

pub(super) fn parse(root: &str, text: &str) -> Result<Vec<Definition>, DefinitionError> {
    let mut parser = Parser {
        tokens: tokens(text),
        at: 0,
        typedefs: BTreeMap::new(),
        found: Vec::new(),
        constants: BTreeMap::new(),
    };
    while parser.peek().is_some() {
        parser
            .declaration("", 0)
            .map_err(|what| DefinitionError::new(format!("the IDL definition of {root}: {what}")))?;
    }
    let Parser { mut found, mut constants, .. } = parser;
    for definition in &mut found {
        definition.constants = constants.remove(&definition.name).unwrap_or_default();
    }
    let at = found.iter().position(|d| d.name == root);
    let at = at.ok_or_else(|| DefinitionError::new(format!("its IDL text does not define {root}")))?;
    found.swap(0, at);
    Ok(found)
}

struct Parser<'a> {
    tokens: Vec<&'a str>,
    at: usize,
    /// By their full name with `::`.
    typedefs: BTreeMap<String, FieldType>,
    found: Vec<Definition>,
    /// By the normal name of the message that they belong to.
    constants: BTreeMap<String, Vec<Constant>>,
}

type Parsed<T> = Result<T, String>;

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<&'a str> {
        self.tokens.get(self.at).copied()
    }

    fn next(&mut self) -> Parsed<&'a str> {
        let token = self.peek().ok_or("it ends too early")?;
        self.at += 1;
        Ok(token)
    }

    fn take(&mut self, token: &str) -> bool {
        let found = self.peek() == Some(token);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, token: &str) -> Parsed<()> {
        match self.next()? {
            found if found == token => Ok(()),
            found => Err(format!("`{found}` where `{token}` was expected")),
        }
    }

    fn declaration(&mut self, scope: &str, depth: usize) -> Parsed<()> {
        if depth > MAX_DEPTH {
            return Err("modules are nested too deeply".into());
        }
        self.annotations()?;
        match self.next()? {
            "module" => self.module(scope, depth),
            "struct" => self.structure(scope),
            "typedef" => self.typedef(scope),
            "const" => self.constant(scope),
            ";" => Ok(()),
            other => Err(format!("`{other}` is not supported: only modules, structs, typedefs and constants are")),
        }
    }

    fn module(&mut self, scope: &str, depth: usize) -> Parsed<()> {
        let scope = join(scope, self.next()?);
        self.expect("{")?;
        while !self.take("}") {
            self.declaration(&scope, depth + 1)?;
        }
        self.take(";");
        Ok(())
    }

    fn structure(&mut self, scope: &str) -> Parsed<()> {
        let name = join(scope, self.next()?);
        self.expect("{")?;
        let mut fields = Vec::new();
        loop {
            self.annotations()?;
            if self.take("}") {
                break;
            }
            let ty = self.field_type(scope, 0)?;
            loop {
                let name = self.next()?;
                fields.push(FieldDef { name: name.into(), ty: self.with_arrays(ty.clone())?, default: None });
                if fields.len() > MAX_FIELDS {
                    return Err("too many fields".into());
                }
                if !self.take(",") {
                    break;
                }
            }
            self.expect(";")?;
        }
        // What the tools put into an empty message, so that it takes a byte; the layout puts it back.
        if matches!(fields.as_slice(), [only] if &*only.name == "structure_needs_at_least_one_member") {
            fields.clear();
        }
        self.take(";");
        self.found.push(Definition { name: normal_name(&name), fields, constants: Vec::new() });
        Ok(())
    }

    fn typedef(&mut self, scope: &str) -> Parsed<()> {
        let ty = self.field_type(scope, 0)?;
        let name = join(scope, self.next()?);
        let ty = self.with_arrays(ty)?;
        self.typedefs.insert(name, ty);
        self.expect(";")
    }

    /// `const TYPE NAME = VALUE;` in a module `<Message>_Constants`.
    fn constant(&mut self, scope: &str) -> Parsed<()> {
        let ty = self.field_type(scope, 0)?;
        let name = self.next()?;
        self.expect("=")?;
        let mut text = String::new();
        while !self.take(";") {
            text.push_str(self.next()?);
        }
        let value = match ty.base {
            Base::Prim(prim) => msg::number(prim, &text).ok_or_else(|| format!("the constant {name} is no number"))?,
            _ => Value::Str(text.trim_start_matches('L').trim_matches('"').to_owned()),
        };
        if let Some(message) = scope.strip_suffix("_Constants") {
            let list = self.constants.entry(normal_name(message)).or_default();
            list.push(Constant { name: name.into(), value });
        }
        Ok(())
    }

    /// The brackets after a declared name.
    fn with_arrays(&mut self, mut ty: FieldType) -> Parsed<FieldType> {
        let mut arrays = Vec::new();
        while self.take("[") {
            let length = self.next()?;
            arrays.push(Some(length.parse().map_err(|_| format!("`{length}` is no array length"))?));
            self.expect("]")?;
        }
        arrays.append(&mut ty.arrays);
        if arrays.len() > MAX_DEPTH {
            return Err("arrays are nested too deeply".into());
        }
        Ok(FieldType { arrays, ..ty })
    }

    fn field_type(&mut self, scope: &str, depth: usize) -> Parsed<FieldType> {
        if depth > MAX_DEPTH {
            return Err("sequences are nested too deeply".into());
        }
        let word = self.next()?;
        let base = match word {
            "sequence" => return self.sequence(scope, depth),
            "string" | "wstring" => {
                self.bound()?;
                if word == "string" { Base::Text } else { Base::WideText }
            }
            "unsigned" => Base::Prim(self.integer(true)?),
            "short" | "long" => {
                self.at -= 1;
                Base::Prim(self.integer(false)?)
            }
            word => match primitive(word) {
                Some(prim) => Base::Prim(prim),
                None => return Ok(self.named(scope, word)),
            },
        };
        Ok(FieldType { base, arrays: Vec::new() })
    }

    fn sequence(&mut self, scope: &str, depth: usize) -> Parsed<FieldType> {
        self.expect("<")?;
        let mut ty = self.field_type(scope, depth + 1)?;
        if self.take(",") {
            self.next()?;
        }
        self.expect(">")?;
        ty.arrays.insert(0, None);
        Ok(ty)
    }

    fn bound(&mut self) -> Parsed<()> {
        if self.take("<") {
            self.next()?;
            self.expect(">")?;
        }
        Ok(())
    }

    fn integer(&mut self, unsigned: bool) -> Parsed<Prim> {
        Ok(match (self.next()?, unsigned) {
            ("short", true) => Prim::U16,
            ("short", false) => Prim::I16,
            ("long", unsigned) => match (self.peek(), unsigned) {
                (Some("double"), _) => return Err("`long double` is not supported".into()),
                (Some("long"), true) => self.skip(Prim::U64),
                (Some("long"), false) => self.skip(Prim::I64),
                (_, true) => Prim::U32,
                (_, false) => Prim::I32,
            },
            (other, _) => return Err(format!("`{other}` is no integer type")),
        })
    }

    fn skip(&mut self, prim: Prim) -> Prim {
        self.at += 1;
        prim
    }

    /// A typedef, looked for from the innermost scope outwards, or else a message.
    fn named(&self, scope: &str, word: &str) -> FieldType {
        let word = word.trim_start_matches("::");
        let mut within = scope;
        loop {
            if let Some(ty) = self.typedefs.get(&join(within, word)) {
                return ty.clone();
            }
            if within.is_empty() {
                break;
            }
            within = within.rsplit_once("::").map_or("", |(outer, _)| outer);
        }
        let full = if word.contains("::") { word.to_owned() } else { join(scope, word) };
        FieldType { base: Base::Message(normal_name(&full)), arrays: Vec::new() }
    }

    /// `@name` and `@name(…)`, any number of them.
    fn annotations(&mut self) -> Parsed<()> {
        while self.take("@") {
            self.next()?;
            if self.take("(") {
                let mut open = 1;
                while open > 0 {
                    match self.next()? {
                        "(" => open += 1,
                        ")" => open -= 1,
                        _ => {}
                    }
                }
            }
        }
        Ok(())
    }
}

fn primitive(word: &str) -> Option<Prim> {
    Some(match word {
        "boolean" => Prim::Bool,
        "octet" | "uint8" | "char" => Prim::U8,
        "int8" => Prim::I8,
        "int16" => Prim::I16,
        "uint16" | "wchar" => Prim::U16,
        "int32" => Prim::I32,
        "uint32" => Prim::U32,
        "int64" => Prim::I64,
        "uint64" => Prim::U64,
        "float" => Prim::F32,
        "double" => Prim::F64,
        _ => return None,
    })
}

fn join(scope: &str, name: &str) -> String {
    if scope.is_empty() { name.to_owned() } else { format!("{scope}::{name}") }
}

/// Words, numbers, quoted texts and single signs. Comments, preprocessor lines, rulers and `IDL:` lines are left out.
fn tokens(text: &str) -> Vec<&str> {
    let mut out = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        let Some(first) = rest.chars().next() else { return out };
        let end = match first {
            '#' => line(rest),
            '=' if rest.starts_with("===") => line(rest),
            'I' if rest.starts_with("IDL:") => line(rest),
            '/' if rest.starts_with("//") => line(rest),
            '/' if rest.starts_with("/*") => comment(rest),
            '"' => quoted(rest),
            c if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            c => c.len_utf8(),
        };
        let (token, after) = rest.split_at(end);
        let dropped = matches!(first, '#')
            || token.starts_with("===")
            || token.starts_with("IDL:")
            || token.starts_with("//")
            || token.starts_with("/*");
        if !dropped {
            out.push(token);
        }
        rest = after;
    }
}

fn line(text: &str) -> usize {
    text.find('\n').unwrap_or(text.len())
}

/// The length of the comment that a text begins with. The star of `/*` is not the one of `*/`: `/*/` only begins a comment.
fn comment(text: &str) -> usize {
    let end = text.get(2..).and_then(|inside| inside.find("*/"));
    end.map_or(text.len(), |end| end + 4)
}

/// The end of a quoted text, escapes heeded.
fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// A name with its scopes, or a number: `a::b`, `-1.5e+3`.
fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | ':' | '.' | '-' | '+')
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
================================================================================
IDL: pkg/msg/Root
/*/ generated; { */
#include "pkg/msg/Point.idl"
module pkg { module msg {
  typedef double double__36[36];
  module Root_Constants {
    @verbatim (language="comment", text="a ( \" b")
    const uint8 FULL = 2;
    const string NAME = "x y";
  };
  @verbatim (language="comment", text="Doc; {")
  struct Root {
    pkg::msg::Point p; @default (value=0.5) double d;
    sequence<pkg::msg::Point, 4> some; string<20> name;
    double__36 cov; unsigned long long n; long a, b;
  };
}; };
===
IDL: pkg/msg/Point
module pkg { module msg { struct Point { float x; }; struct Empty { uint8 structure_needs_at_least_one_member; }; }; };
"#;

    #[test]
    fn what_the_tools_write_is_read() {
        let all = parse("pkg/Root", TEXT).unwrap();
        assert_eq!(all[0].name, "pkg/Root");
        let shown: Vec<_> = all[0].fields.iter().map(|f| (&*f.name, f.ty.arrays.clone())).collect();
        assert_eq!(
            shown,
            [
                ("p", vec![]),
                ("d", vec![]),
                ("some", vec![None]),
                ("name", vec![]),
                ("cov", vec![Some(36)]),
                ("n", vec![]),
                ("a", vec![]),
                ("b", vec![])
            ]
        );
        assert_eq!(all[0].fields[5].ty.base, Base::Prim(Prim::U64));
        assert_eq!(all[0].constants[0].value, Value::Num(2.0));
        assert_eq!(all[0].constants[1].value, "x y".into());
        assert!(all[2].fields.is_empty());
    }

    #[test]
    fn other_idl_is_refused_by_name() {
        assert!(parse("a/B", "module a { union U {}; };").unwrap_err().to_string().contains("`union`"));
        assert!(parse("a/B", "module a { struct C { long x; }; };").unwrap_err().to_string().contains("a/B"));
        assert!(parse("a/B", "module a { struct B { long").is_err());
        assert!(parse("a/B", &"module a {".repeat(100)).is_err());
        assert!(parse("a/B", &format!("struct B {{ {} ", "sequence<".repeat(100))).is_err());
    }
}
