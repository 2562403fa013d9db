//! What is said of components outside of their specifications: execution times in a file of their own, and which port reads which.
//!
//! Both files have a line for each statement; what follows `#` or `//` is a comment.
//!
//! ```text
//! ImuDriver.Measure.start = 1.5 ms        # a state of an activity
//! ImuDriver.GetImu        = 2 ms          # a function, wherever it is called
//!
//! POM.Imu  ImuDriver.Imu                  # the port that reads, the port that is read
//! ```

use lapwing_diag::{Code, Diagnostic, FileId, SourceMap, Span};

use crate::model::{Component, Link, Model, PortId, Role};
use lapwing_diag::suggest::{listed, nearest};

/// The words of a line, with their places.
type Words<'t> = Vec<(&'t str, Span)>;

/// The lines of a file that say something.
fn lines(sources: &SourceMap, file: FileId) -> Vec<Words<'_>> {
    let text = sources.text(file);
    let mut all = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let end = ["#", "//"].iter().filter_map(|sign| line.find(sign)).min().unwrap_or(line.len());
        let said = line.get(..end).unwrap_or("");
        let separates = |c: char| c.is_whitespace() || "=\"',;{}".contains(c);
        let mut words = Vec::new();
        for word in said.split(separates).filter(|w| !w.is_empty()) {
            let at = start + (word.as_ptr() as usize - line.as_ptr() as usize);
            words.push((word, Span::new(file, at, at + word.len())));
        }
        if !words.is_empty() {
            all.push(words);
        }
        start += line.len();
    }
    all
}

/// Gives codels the execution times of a file.
pub(crate) fn apply_wcet(model: &mut Model, sources: &SourceMap, file: FileId, diagnostics: &mut Vec<Diagnostic>) {
    for words in lines(sources, file) {
        let Some(((key, place), rest)) = words.split_first() else { continue };
        let text: String = rest.iter().map(|(word, _)| *word).collect();
        let Some(ns) = duration(&text).or_else(|| seconds(&text)) else {
            let span = rest.last().map_or(*place, |(_, last)| place.to(*last));
            let help = "write COMPONENT.ACTIVITY.STATE = 1.5 ms, or COMPONENT.FUNCTION = 1.5 ms; the units are s, ms, us and ns, and s where there is none";
            diagnostics.push(Diagnostic::new(Code::BadSetting, span, "this is no execution time").help(help));
            continue;
        };
        if let Err(diagnostic) = give(model, key, *place, ns) {
            diagnostics.push(*diagnostic);
        }
    }
}

/// Gives one execution time.
fn give(model: &mut Model, key: &str, place: Span, ns: u64) -> Result<(), Box<Diagnostic>> {
    let parts: Vec<&str> = key.split(['.', '/', ':']).filter(|p| !p.is_empty()).collect();
    let (Some((name, rest)), false) = (parts.split_first(), parts.len() < 2) else {
        let message = format!("`{key}` names no codel: write COMPONENT.ACTIVITY.STATE or COMPONENT.FUNCTION");
        return Err(Box::new(Diagnostic::new(Code::BadSetting, place, message)));
    };
    let component = component_of(&mut model.components, name, place)?;
    let names: Vec<String> = component.codels.iter().map(|c| component.codel_name(c)).collect();
    let wanted = rest.join(".");
    let mut found = false;
    for (codel, name) in component.codels.iter_mut().zip(&names) {
        let is_state = rest.split_last().is_some_and(|(state, owner)| {
            !owner.is_empty()
                && name.split('.').next() == Some(&owner.join("."))
                && codel.triggers().iter().any(|t| t == state)
        });
        if *name == wanted || is_state || (rest.len() == 1 && codel.function == wanted && codel.role != Role::Attribute)
        {
            codel.wcet_ns = Some(ns);
            found = true;
        }
    }
    if found {
        return Ok(());
    }
    let functions = component.codels.iter().map(|c| c.function.as_str());
    let help = match nearest(&wanted, names.iter().map(String::as_str).chain(functions)) {
        Some(near) => format!("did you mean `{}.{near}`?", component.name),
        None => format!("its codels are {}", listed(names.iter().map(String::as_str))),
    };
    Err(Box::new(
        Diagnostic::new(Code::UnknownName, place, format!("`{}` has no codel `{wanted}`", component.name)).help(help),
    ))
}

fn component_of<'m>(
    components: &'m mut [Component],
    name: &str,
    place: Span,
) -> Result<&'m mut Component, Box<Diagnostic>> {
    let Some(number) = components.iter().position(|c| c.name == name) else {
        let names = || components.iter().map(|c| c.name.as_str());
        let help = match nearest(name, names()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("the components are {}", listed(names())),
        };
        return Err(Box::new(
            Diagnostic::new(Code::UnknownName, place, format!("no component is called `{name}`")).help(help),
        ));
    };
    Ok(&mut components[number])
}

/// A number and a unit of time, `1.5ms`, in nanoseconds: exactly, so that no more digits are taken than there are nanoseconds.
pub fn duration(text: &str) -> Option<u64> {
    let split = text.find(|c: char| !c.is_ascii_digit() && c != '.')?;
    let (number, unit) = text.split_at_checked(split)?;
    let digits: u32 = match unit {
        "s" => 9,
        "ms" => 6,
        "us" => 3,
        "ns" => 0,
        _ => return None,
    };
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    if number.is_empty() || number == "." || fraction.len() > digits as usize {
        return None;
    }
    let scale = 10_u64.checked_pow(digits)?;
    let rest = if fraction.is_empty() {
        0
    } else {
        fraction.parse::<u64>().ok()?.checked_mul(10_u64.pow(digits - fraction.len() as u32))?
    };
    let whole = if whole.is_empty() { 0 } else { whole.parse::<u64>().ok()? };
    whole.checked_mul(scale)?.checked_add(rest)
}

/// A number without a unit: seconds, as in a specification.
fn seconds(text: &str) -> Option<u64> {
    let is_number = text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    if is_number { duration(&format!("{text}s")) } else { None }
}

/// Links ports as a file says; those that it does not name are linked by their names.
pub(crate) fn apply_ports(model: &mut Model, sources: &SourceMap, file: FileId, diagnostics: &mut Vec<Diagnostic>) {
    for words in lines(sources, file) {
        let [(reader, reader_span), (writer, writer_span)] = words.as_slice() else {
            let span = words.iter().map(|(_, s)| *s).reduce(Span::to).unwrap_or_default();
            let help = "write READER.port WRITER.port on a line, as in POM.Imu ImuDriver.Imu";
            diagnostics.push(Diagnostic::new(Code::BadSetting, span, "this links no two ports").help(help));
            continue;
        };
        let ends =
            port(model, reader, *reader_span, false).and_then(|r| Ok((r, port(model, writer, *writer_span, true)?)));
        match ends {
            Ok((reader, writer)) => {
                model.links.retain(|link| link.reader != reader);
                model.links.push(Link { reader, writer });
            }
            Err(diagnostic) => diagnostics.push(*diagnostic),
        }
    }
    model.links.sort();
}

/// The port that `component.port` or `component_port` names.
fn port(model: &Model, text: &str, place: Span, is_out: bool) -> Result<(usize, PortId), Box<Diagnostic>> {
    let named = |component: &Component| {
        let rest = text.strip_prefix(&component.name)?;
        let name =
            rest.strip_prefix('.').or(rest.strip_prefix("::")).or(rest.strip_prefix('/')).or(rest.strip_prefix('_'))?;
        component.ports.iter().position(|p| p.name == name && p.is_out == is_out).map(PortId)
    };
    if let Some(found) = model.components.iter().enumerate().find_map(|(number, c)| Some((number, named(c)?))) {
        return Ok(found);
    }
    let side = if is_out { "out" } else { "in" };
    let all: Vec<String> = model
        .components
        .iter()
        .flat_map(|c| c.ports.iter().filter(|p| p.is_out == is_out).map(move |p| format!("{}.{}", c.name, p.name)))
        .collect();
    let help = match nearest(text, all.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("the ports {side} are {}", listed(all.iter().map(String::as_str))),
    };
    Err(Box::new(
        Diagnostic::new(Code::UnknownPort, place, format!("`{text}` is no port {side} of a component")).help(help),
    ))
}

/// Links each in-port that no file has linked to the out-port of the same name and type of another component.
pub(crate) fn link_by_name(model: &mut Model, diagnostics: &mut Vec<Diagnostic>) {
    let mut links = Vec::new();
    for (number, component) in model.components.iter().enumerate() {
        for (id, port) in component.ports.iter().enumerate().filter(|(_, p)| !p.is_out) {
            let reader = (number, PortId(id));
            if model.links.iter().any(|link| link.reader == reader) {
                continue;
            }
            let writers: Vec<(usize, PortId)> = writers(model, number, port).collect();
            match writers.as_slice() {
                [] => {}
                [writer] => links.push(Link { reader, writer: *writer }),
                several => {
                    let names: Vec<String> = several
                        .iter()
                        .filter_map(|(c, _)| model.components.get(*c))
                        .map(|c| format!("{}.{}", c.name, port.name))
                        .collect();
                    let message = format!("`{}.{}` may read any of {}", component.name, port.name, names.join(", "));
                    let help = format!(
                        "say which in a file for --ports: `{}.{} {}`",
                        component.name,
                        port.name,
                        names.first().map_or("", String::as_str)
                    );
                    diagnostics.push(Diagnostic::new(Code::AmbiguousPort, port.span, message).help(help));
                }
            }
        }
    }
    model.links.extend(links);
    model.links.sort();
}

fn writers<'m>(
    model: &'m Model,
    reader: usize,
    port: &'m crate::model::Port,
) -> impl Iterator<Item = (usize, PortId)> + 'm {
    let of = move |(number, component): (usize, &'m Component)| {
        let same = move |p: &crate::model::Port| p.is_out && p.name == port.name && p.ty == port.ty;
        component.ports.iter().position(same).map(|id| (number, PortId(id)))
    };
    model.components.iter().enumerate().filter(move |(number, _)| *number != reader).filter_map(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact() {
        let times = [
            "1.5ms",
            "10ms",
            "0.000001s",
            "3ns",
            "18446744073s",
            "99999999999s",
            "1.5ns",
            "1",
            "ms",
            "1.5.2ms",
            "1min",
            ".5us",
            ".ms",
        ];
        assert_eq!(
            times.map(duration),
            [
                Some(1_500_000),
                Some(10_000_000),
                Some(1_000),
                Some(3),
                Some(18_446_744_073_000_000_000),
                None,
                None,
                None,
                None,
                None,
                None,
                Some(500),
                None,
            ]
        );
    }
}
