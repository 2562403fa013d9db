//! A trace in the words that the driver of generated monitors reads, and what it answers.
//!
//! A line `m N` begins monitor N, `s TIME MEMBER=VALUE… aARRAY=VALUE;VALUE… tTEXT=BYTES lTABLE=BYTES;BYTES;|VALUE;VALUE
//! rARRAY=COUNT|VALUE;VALUE;|BYTES;BYTES;
//! oOBJECT=VALUE;VALUE…` is a step, `a TIME` says that time went on, `e` ends. The answer to `e` is a line
//! for each property, `VERDICT MET FAILED OPEN BEGAN AT`, and an empty line.

use lapwing_check::checked::{EventSource, InputSource, Spec};
use lapwing_codegen::{From, Interface, Kind, Member};
use lapwing_reference::{Arrival, Trace};
use lapwing_stream::{Time, Type, Value, Verdict};

use super::Said;
use super::objects::Objects;
use super::wholes::{Latest, handed, letter, numbers};

/// The lines of a trace; `None` where a value is of another kind than its member.
pub fn of(spec: &Spec, interface: &Interface, trace: &Trace) -> Option<Vec<String>> {
    let (mut objects, mut latest) = (Objects::default(), Latest::default());
    let lines = trace.samples.iter().map(|(time, arrival)| {
        objects.take(spec, &interface.objects, *time, arrival);
        line(spec, interface, &objects, &mut latest, *time, arrival)
    });
    lines.collect()
}

/// The lines of one monitor's run.
pub fn script(number: usize, lines: &[String]) -> String {
    format!("m {number}\n{}e\n", lines.iter().map(|l| format!("{l}\n")).collect::<String>())
}

fn line(
    spec: &Spec,
    interface: &Interface,
    objects: &Objects,
    latest: &mut Latest,
    time: Time,
    arrival: &Arrival,
) -> Option<String> {
    if !arrival.is_read() {
        return Some(format!("a {}", time.0));
    }
    let mut line = format!("s {}", time.0);
    // Texts are handed to functions.
    for (number, member) in super::members(interface).filter(|(_, member)| member.kind != Kind::Text) {
        match found(spec, arrival, member.from) {
            None | Some(Value::Missing) => {}
            Some(value) => line.push_str(&format!(" {number}={}", number_of(spec, member, &value)?)),
        }
    }
    for (number, whole) in interface.wholes.iter().enumerate() {
        if let Some(of) = handed(whole, latest, |from| found(spec, arrival, from)).ok()? {
            line.push_str(&format!(" {}{number}={of}", letter(whole.shape)));
        }
    }
    for (number, (object, setter)) in super::setters(interface).enumerate() {
        if let Some(of) = objects.handed(object, setter) {
            line.push_str(&format!(" o{number}={}", numbers(&of)));
        }
    }
    Some(line)
}

/// What an arrival brings for a member.
fn found(spec: &Spec, arrival: &Arrival, from: From) -> Option<Value> {
    let message = |of: usize| match arrival {
        Arrival::Message { topic, values } if *topic == of => Some(values),
        _ => None,
    };
    let is_event = |e: usize| match (&spec.events[e].source, arrival) {
        (EventSource::Message { topic }, _) => message(*topic).is_some(),
        (_, Arrival::Event { event, .. }) => *event == e,
        _ => false,
    };
    match from {
        // What is asked of an array is an input, or a field, that the specification does not have: it comes with the array.
        From::Input(i) => match (&spec.inputs.get(i)?.source, arrival) {
            (InputSource::Field { topic, field }, _) => message(*topic)?.get(*field).cloned(),
            (InputSource::Column(column), Arrival::Row { cells }) => cells.get(*column).cloned(),
            _ => None,
        },
        From::Topic(topic) => message(topic).map(|_| Value::Bool(true)),
        From::Event(e) => is_event(e).then_some(Value::Bool(true)),
        From::EventField(e, f) if is_event(e) => match (&spec.events[e].source, arrival) {
            (EventSource::Message { topic }, _) => message(*topic)?.get(spec.events[e].fields.get(f)?.wanted?).cloned(),
            (_, Arrival::Event { values, .. }) => values.get(f).cloned(),
            _ => None,
        },
        From::EventField(..) | From::Pose(_) | From::Twist(_) | From::Part(..) => None,
    }
}

/// A value as a number.
fn number_of(spec: &Spec, member: &Member, value: &Value) -> Option<String> {
    let is_any = match member.from {
        From::Input(i) => spec.inputs[i].ty == Type::Any,
        From::EventField(e, f) => spec.events[e].fields[f].ty == Type::Any,
        _ => false,
    };
    match (member.kind, value) {
        (Kind::Truth, Value::Bool(b)) => Some(u8::from(*b).to_string()),
        (Kind::Truth, Value::Num(x)) if is_any => Some(u8::from(*x != 0.0 && !x.is_nan()).to_string()),
        (Kind::Number, Value::Num(x)) => Some(format!("{x:?}")),
        _ => None,
    }
}

/// What monitors said, one after the other.
pub fn outcomes(text: &str) -> Result<Vec<Vec<Said>>, String> {
    let mut all = Vec::new();
    let mut of = Vec::new();
    for line in text.lines() {
        if line.is_empty() {
            all.push(std::mem::take(&mut of));
        } else {
            of.push(outcome(line).ok_or_else(|| format!("`{line}` is no outcome"))?);
        }
    }
    Ok(all)
}

fn outcome(line: &str) -> Option<Said> {
    let numbers: Vec<i64> = line.split(' ').map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let &[verdict, met, failed, open, began, at] = numbers.as_slice() else { return None };
    let verdicts = [Verdict::Violated, Verdict::Inconclusive, Verdict::Unmet, Verdict::Holds, Verdict::Satisfied];
    Some(Said {
        verdict: *verdicts.get(usize::try_from(verdict).ok()?)?,
        counts: (met as u64, failed as u64, open as u64),
        first: (failed > 0).then_some((Time(began), Time(at))),
    })
}
