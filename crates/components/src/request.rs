//! Requests as they are written, on a line each: `LaserDriver.SetDelay(delay=0.2)`, and in a file with when they are made: `@1s …`.

use std::fmt;
use std::io::{BufRead, Read as _};

use lapwing_diag::suggest::nearest;
use lapwing_genom::model::{Direction, Model, Service, ServiceId, ServiceKind, Step, Type};
use lapwing_stream::Time;

use crate::datum::Datum;
use crate::types::{MOST_PARTS, Shape, Types};

/// Values inside values no deeper than this.
const MOST_DEPTH: usize = 32;

/// A line of a request that is read as it comes is no longer.
const MOST_LINE: usize = 1 << 20;

/// A request for a service.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The number of the component.
    pub component: usize,
    /// The service.
    pub service: ServiceId,
    /// A value for each of its parameters, in their order; of those that only come out, the first value of their type.
    pub values: Vec<Datum>,
}

/// What is wrong with a request as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequestError {
    /// The line in a file, from 1; 1 where it is a line of its own.
    pub line: usize,
    /// The column, from 1.
    pub column: usize,
    /// In words.
    pub message: String,
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.line, self.column, self.message)
    }
}

impl std::error::Error for RequestError {}

/// Reads a request.
///
/// # Errors
///
/// What is wrong with it, with its place in the text.
pub fn request(model: &Model, types: &Types, text: &str) -> Result<Request, RequestError> {
    let mut reader = Reader { text, at: 0, line: 1 };
    let request = reader.request(model, types)?;
    reader.end()?;
    Ok(request)
}

/// A request and when it is to be made.
pub type Timed = (Time, Request);

/// Reads a line that may begin with when the request is to be made: `@1.5s`, `@20ms`. `None` where there is nothing on it but a comment.
///
/// # Errors
///
/// What is wrong with it, with its place.
pub fn timed(model: &Model, types: &Types, line: &str, number: usize) -> Result<Option<Timed>, RequestError> {
    let mut reader = Reader { text: line, at: 0, line: number };
    reader.blanks();
    if reader.rest().is_empty() || reader.rest().starts_with('#') {
        return Ok(None);
    }
    let time = if reader.take("@") { reader.time()? } else { Time(0) };
    let request = reader.request(model, types)?;
    reader.end()?;
    Ok(Some((time, request)))
}

/// Lines as they come from somebody who is not known: of bytes that need not be text, and that need not end.
pub struct Lines<R> {
    from: R,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// Those of a reader.
    pub fn new(from: R) -> Lines<R> {
        Lines { from, number: 0 }
    }
}

impl<R: BufRead> Iterator for Lines<R> {
    /// The number of a line, and the line, or what is wrong with it.
    type Item = (usize, Result<String, RequestError>);

    fn next(&mut self) -> Option<Self::Item> {
        let mut bytes = Vec::new();
        let most = MOST_LINE as u64 + 1;
        let read = self.from.by_ref().take(most).read_until(b'\n', &mut bytes).ok().filter(|read| *read > 0)?;
        self.number += 1;
        let wrong = |message: String| Err(RequestError { line: self.number, column: 1, message });
        let is_whole = bytes.ends_with(b"\n") || read <= MOST_LINE;
        let line = match (is_whole, String::from_utf8(bytes)) {
            (true, Ok(text)) => Ok(text.trim_end_matches(['\r', '\n']).to_owned()),
            (true, Err(_)) => wrong("the line is no text in UTF-8".to_owned()),
            (false, _) => {
                pass_over(&mut self.from);
                wrong(format!("the line has more than {MOST_LINE} bytes"))
            }
        };
        Some((self.number, line))
    }
}

/// Goes behind the end of a line.
fn pass_over(from: &mut impl BufRead) {
    while let Ok(bytes) = from.fill_buf() {
        let (length, end) = (bytes.len(), bytes.iter().position(|b| *b == b'\n'));
        from.consume(end.map_or(length, |end| end + 1));
        if length == 0 || end.is_some() {
            return;
        }
    }
}

/// Reads a file of requests, one on each line, in the order of their times; comments begin with `#`.
///
/// # Errors
///
/// Everything that is wrong with it.
pub fn file(model: &Model, types: &Types, text: &str) -> Result<Vec<Timed>, Vec<RequestError>> {
    let (mut all, mut errors) = (Vec::new(), Vec::new());
    for (number, line) in text.lines().enumerate() {
        match timed(model, types, line, number + 1) {
            Ok(found) => all.extend(found),
            Err(error) => errors.push(error),
        }
    }
    all.sort_by_key(|(time, _)| *time);
    if errors.is_empty() { Ok(all) } else { Err(errors) }
}

/// The service that `Component.Service` names.
///
/// # Errors
///
/// What is not there, and what was probably meant.
pub fn service_of(model: &Model, name: &str) -> Result<(usize, ServiceId), String> {
    let Some((component, service)) = name.split_once('.') else {
        return Err(format!("`{name}` is no service: write COMPONENT.SERVICE"));
    };
    let Some(number) = model.components.iter().position(|c| c.name == component) else {
        let names: Vec<&str> = model.components.iter().map(|c| c.name.as_str()).collect();
        let near = meant(component, &names);
        return Err(format!("there is no component `{component}`; there are {}{near}", names.join(", ")));
    };
    let declared = &model.components[number];
    match declared.service(service) {
        Some(id) => Ok((number, id)),
        None => {
            let names: Vec<&str> = declared.services.iter().map(|s| s.name.as_str()).collect();
            let there = if names.is_empty() { "no service at all".to_owned() } else { names.join(", ") };
            let near = meant(service, &names);
            Err(format!("`{component}` has no service `{service}`; it has {there}{near}"))
        }
    }
}

/// What a name that nobody has was probably meant to be, in words after those that are there.
fn meant(name: &str, there: &[&str]) -> String {
    nearest(name, there.iter().copied()).map(|near| format!(": did you mean `{near}`?")).unwrap_or_default()
}

/// A request without arguments.
///
/// # Errors
///
/// A parameter has no default.
pub fn plain(model: &Model, types: &Types, component: usize, service: ServiceId) -> Result<Request, String> {
    let missing = || "there is no such service".to_owned();
    let declared = model.components.get(component).and_then(|c| c.services.get(service.0)).ok_or_else(missing)?;
    Ok(Request { component, service, values: values(types, declared, Vec::new())? })
}

/// A value as it is written.
enum Literal {
    Int(i128),
    Float(f64),
    Text(String),
    Word(String),
    List(Vec<Literal>),
    Parts(Vec<(String, Literal)>),
}

/// How many parts the value of a parameter may still have: a short text can ask for long ones, as in `[{}, {}, {}]` of structures of arrays.
struct Room(u64);

impl Room {
    /// Makes a value, if there is room for so many of them.
    fn take(&mut self, one: Datum, times: u64) -> Result<Datum, String> {
        let wanted = one.parts().saturating_mul(times);
        self.0 = self.0.checked_sub(wanted).ok_or("the values have too many parts together")?;
        Ok(one)
    }
}

/// Values for all parameters of a service: those that are given, else the defaults.
fn values(types: &Types, service: &Service, given: Vec<(Option<String>, Literal)>) -> Result<Vec<Datum>, String> {
    let mut all: Vec<Option<Datum>> = Vec::new();
    for parameter in &service.parameters {
        let ty = parameter.ty.as_ref().ok_or_else(|| format!("the type of `{}` is not known", parameter.name))?;
        let default = parameter.default.as_ref().map(|d| types.default(ty, d));
        let is_out = parameter.direction == Direction::Out;
        all.push(default.or_else(|| is_out.then(|| types.initial(ty))));
    }
    for (place, (name, literal)) in given.into_iter().enumerate() {
        let number = match &name {
            None => place,
            Some(name) => service.parameters.iter().position(|p| p.name == *name).unwrap_or(usize::MAX),
        };
        let Some((parameter, slot)) = service.parameters.get(number).zip(all.get_mut(number)) else {
            let names: Vec<&str> = service.parameters.iter().map(|p| p.name.as_str()).collect();
            let has = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            let what = name.map_or_else(|| "so many parameters".to_owned(), |name| format!("parameter `{name}`"));
            return Err(format!("`{}` has no {what}; its parameters are {has}", service.name));
        };
        if parameter.direction == Direction::Out {
            return Err(format!("`{}` only comes out of `{}`", parameter.name, service.name));
        }
        let Some(ty) = &parameter.ty else { continue };
        let base = slot.take().unwrap_or_else(|| types.initial(ty));
        *slot = Some(
            value(types, ty, base, literal, &mut Room(MOST_PARTS))
                .map_err(|why| format!("`{}`: {why}", parameter.name))?,
        );
    }
    let named = all.into_iter().zip(&service.parameters);
    named
        .map(|(value, parameter)| {
            value.ok_or_else(|| format!("`{}` needs a value for `{}`: {0}({1}=…)", service.name, parameter.name))
        })
        .collect()
}

/// A value as one of a type. What a structure is not given is as in `base`.
fn value(types: &Types, ty: &Type, base: Datum, literal: Literal, room: &mut Room) -> Result<Datum, String> {
    match literal {
        Literal::Int(i) => types.fit(ty, Datum::Int(i)),
        Literal::Float(x) => types.fit(ty, Datum::Float(x)),
        Literal::Text(text) => types.fit(ty, Datum::Text(text)),
        Literal::Word(word) if word == "true" || word == "false" => types.fit(ty, Datum::Bool(word == "true")),
        Literal::Word(word) if word == "nan" => types.fit(ty, Datum::Float(f64::NAN)),
        Literal::Word(word) if word == "inf" => types.fit(ty, Datum::Float(f64::INFINITY)),
        Literal::Word(word) => types.fit(ty, Datum::Text(word)),
        Literal::List(items) => list(types, ty, items, room),
        Literal::Parts(mut parts) if matches!(types.shape(ty), Shape::Union(..)) => {
            let (Some((name, part)), true) = (parts.pop(), parts.is_empty()) else {
                return Err("a union has one member at a time".to_owned());
            };
            let (tag, number, inner) = types.case(ty, &name)?;
            let first = room.take(types.initial(&inner), 1)?;
            let part = value(types, &inner, first, part, room)?;
            Ok(Datum::Union(tag, Some((number, Box::new(part)))))
        }
        Literal::Parts(parts) => {
            let mut whole = base;
            for (name, part) in parts {
                let (way, inner) = types.way(ty, &[Step::Member(name)])?;
                let Some(place) = whole.part_mut(&way) else { continue };
                let before = std::mem::replace(place, Datum::Native(0));
                *place = value(types, inner, before, part, room)?;
            }
            Ok(whole)
        }
    }
}

/// The elements of an array or a sequence.
fn list(types: &Types, ty: &Type, items: Vec<Literal>, room: &mut Room) -> Result<Datum, String> {
    let (Shape::Sequence(inner, _) | Shape::Array(inner, _)) = types.shape(ty) else {
        return Err("a list does not go there".to_owned());
    };
    let one = room.take(types.initial(inner), items.len() as u64)?;
    let items = items.into_iter().map(|item| value(types, inner, one.clone(), item, room));
    let items = items.collect::<Result<_, _>>()?;
    types.fit(ty, Datum::List(items))
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    line: usize,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn wrong<T>(&self, message: impl Into<String>) -> Result<T, RequestError> {
        let column = self.text.get(..self.at).unwrap_or("").chars().count() + 1;
        Err(RequestError { line: self.line, column, message: message.into() })
    }

    fn blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn take(&mut self, sign: &str) -> bool {
        self.blanks();
        let is_there = self.rest().starts_with(sign);
        self.at += if is_there { sign.len() } else { 0 };
        is_there
    }

    fn end(&mut self) -> Result<(), RequestError> {
        self.blanks();
        if self.rest().is_empty() || self.rest().starts_with('#') {
            return Ok(());
        }
        self.wrong(format!("the request has ended, and `{}` follows", self.rest().trim_end()))
    }

    /// A name; with `dots`, of parts.
    fn word(&mut self, dots: bool) -> String {
        self.blanks();
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || (dots && c == '.');
        let rest = self.rest();
        let word = rest.get(..rest.find(|c| !is_part(c)).unwrap_or(rest.len())).unwrap_or("").to_owned();
        self.at += word.len();
        word
    }

    fn time(&mut self) -> Result<Time, RequestError> {
        let rest = self.rest();
        let text = rest.get(..rest.find(char::is_whitespace).unwrap_or(rest.len())).unwrap_or("").to_owned();
        match lapwing_genom::duration(&text).and_then(|ns| i64::try_from(ns).ok()) {
            Some(ns) => {
                self.at += text.len();
                Ok(Time(ns))
            }
            None => self.wrong(format!("`{text}` is no time: write @1.5s, @20ms or @300us")),
        }
    }

    fn request(&mut self, model: &Model, types: &Types) -> Result<Request, RequestError> {
        self.blanks();
        let start = self.at;
        let name = self.word(true);
        let (component, service) = match service_of(model, &name) {
            Ok(found) => found,
            Err(why) => {
                self.at = start;
                return self.wrong(why);
            }
        };
        let declared = &model.components[component].services[service.0];
        if declared.kind == ServiceKind::Activity && declared.codels.is_empty() {
            self.at = start;
            return self.wrong(format!("`{name}` has no codels: there is nothing to run"));
        }
        let mut given = Vec::new();
        if self.take("(") {
            while !self.take(")") {
                if !given.is_empty() && !self.take(",") {
                    return self.wrong("`,` or `)` is wanted here");
                }
                let before = self.at;
                let name = self.word(false);
                let name = if !name.is_empty() && self.take("=") {
                    Some(name)
                } else {
                    self.at = before;
                    None
                };
                given.push((name, self.literal(0)?));
            }
        }
        match values(types, declared, given) {
            Ok(values) => Ok(Request { component, service, values }),
            Err(why) => {
                self.at = start;
                self.wrong(why)
            }
        }
    }

    fn literal(&mut self, depth: usize) -> Result<Literal, RequestError> {
        if depth > MOST_DEPTH {
            return self.wrong("values stand too deep inside values");
        }
        if self.take("[") {
            let mut items = Vec::new();
            while !self.take("]") {
                if !items.is_empty() && !self.take(",") {
                    return self.wrong("`,` or `]` is wanted here");
                }
                items.push(self.literal(depth + 1)?);
            }
            return Ok(Literal::List(items));
        }
        if self.take("{") {
            let mut parts = Vec::new();
            while !self.take("}") {
                if !parts.is_empty() && !self.take(",") {
                    return self.wrong("`,` or `}` is wanted here");
                }
                let name = self.word(false);
                if name.is_empty() || !self.take("=") {
                    return self.wrong("a member is wanted here: `{x=1}`");
                }
                parts.push((name, self.literal(depth + 1)?));
            }
            return Ok(Literal::Parts(parts));
        }
        if self.take("\"") {
            return self.quoted();
        }
        self.plain()
    }

    fn quoted(&mut self) -> Result<Literal, RequestError> {
        let (mut text, mut escaped, mut length) = (String::new(), false, None);
        for (at, c) in self.rest().char_indices() {
            match (escaped, c) {
                (false, '"') => {
                    length = Some(at + 1);
                    break;
                }
                (false, '\\') => escaped = true,
                (true, 'n') => (escaped, _) = (false, text.push('\n')),
                (_, c) => (escaped, _) = (false, text.push(c)),
            }
        }
        match length {
            Some(length) => {
                self.at += length;
                Ok(Literal::Text(text))
            }
            None => self.wrong("the text has no end: `\"` is missing"),
        }
    }

    /// A number or a word.
    fn plain(&mut self) -> Result<Literal, RequestError> {
        self.blanks();
        let rest = self.rest();
        let is_part = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
        let text = rest.get(..rest.find(|c| !is_part(c)).unwrap_or(rest.len())).unwrap_or("").to_owned();
        let is_number = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let literal = match (text.parse::<i128>(), text.parse::<f64>()) {
            (Ok(i), _) => Literal::Int(i),
            (_, Ok(x)) if is_number => Literal::Float(x),
            _ if text.is_empty() || is_number => return self.wrong("a value is wanted here"),
            _ => Literal::Word(text.clone()),
        };
        self.at += text.len();
        Ok(literal)
    }
}
