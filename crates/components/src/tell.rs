//! What happens in a run, a line for each.

use lapwing_diag::SourceMap;
use lapwing_genom::Model;
use lapwing_genom::model::{Direction, Parameter};
use lapwing_stream::{Duration, Time};

use crate::datum::Datum;
use crate::happening::{Happening, What, Whose, line, place};
use crate::types::Types;

/// What is written to a port is shown up to so many bytes.
const MOST_SHOWN: usize = 160;

/// How a run is told.
#[derive(Clone, Copy, Debug)]
pub struct Teller<'t> {
    /// The components.
    pub model: &'t Model,
    /// The types of their values.
    pub types: &'t Types,
    /// Where they are written.
    pub sources: &'t SourceMap,
    /// Whether every call and every writing is told; else only requests, activities, and what goes wrong.
    pub is_verbose: bool,
}

impl Teller<'_> {
    /// What is said of something that happens, without the end of the line; `None` where nothing is.
    pub fn line(&self, happening: &Happening) -> Option<String> {
        let text = match &happening.what {
            What::Requested { id, whose, values, by } => {
                let by = by.as_ref().map(|by| format!(", by {by}")).unwrap_or_default();
                format!("request #{id} {}{}{by}", self.service(*whose), self.values(*whose, values, false))
            }
            What::Replied { id, whose, refused: Some(why), .. } => {
                format!("reply #{id} {} refused: {why}", self.service(*whose))
            }
            What::Replied { id, whose, refused: None, .. } => format!("reply #{id} {} accepted", self.service(*whose)),
            What::Reported { id, whose, outcome, values } => {
                format!("report #{id} {} {outcome} {}", self.service(*whose), self.values(*whose, values, true))
            }
            What::Started { whose, instance, .. } => format!("start {} ({instance})", self.service(*whose)),
            What::Interrupted { whose, instance } => format!("interrupt {} ({instance})", self.service(*whose)),
            What::Ended { whose, instance, outcome } => format!("end {} ({instance}) {outcome}", self.service(*whose)),
            What::Called { component, codel } if self.is_verbose => {
                let codel = place(self.model, self.sources, *component, *codel);
                format!("call {} {}", codel.name, codel.function)
            }
            What::Returned { component, codel, answer, took } if self.is_verbose => {
                let codel = place(self.model, self.sources, *component, *codel);
                format!("return {} {} {answer} after {}", codel.name, codel.function, shown(*took))
            }
            What::Written { component, port, name, value } if self.is_verbose => {
                let component = self.model.components.get(*component)?;
                let port = component.ports.get(port.0)?;
                let name = name.as_ref().map(|n| format!("[{n}]")).unwrap_or_default();
                let value = self.value(&port.ty, value);
                format!("write {}.{}{name} {value}", component.name, port.name)
            }
            What::Overrun { component, codel, took, wcet } => {
                let codel = place(self.model, self.sources, *component, *codel);
                let (took, wcet) = (shown(*took), shown(*wcet));
                format!(
                    "overrun {} {} took {took}, and {wcet} is its wcet ({})",
                    codel.name, codel.function, codel.place
                )
            }
            What::Missed { component, task } => {
                let (name, at) = self.task(*component, task.0)?;
                format!("missed {name}: a period began before the turn of the last one ({at})")
            }
            What::Late { component, task, by } => {
                let (name, at) = self.task(*component, task.0)?;
                format!("late {name}: its turn began {} after its period ({at})", shown(*by))
            }
            What::Failed(failure) => {
                let codel = place(self.model, self.sources, failure.component, failure.codel);
                format!("failure {} {} ({}): {}", codel.name, codel.function, codel.place, failure.trouble)
            }
            _ => return None,
        };
        Some(format!("{} {text}", stamp(happening.time)))
    }

    fn service(&self, whose: Whose) -> String {
        let component = self.model.components.get(whose.component);
        let service = component.and_then(|c| c.services.get(whose.service.0));
        match (component, service) {
            (Some(component), Some(service)) => format!("{}.{}", component.name, service.name),
            _ => "?".to_owned(),
        }
    }

    fn task(&self, component: usize, task: usize) -> Option<(String, String)> {
        let component = self.model.components.get(component)?;
        let task = component.tasks.get(task)?;
        Some((format!("{}.{}", component.name, task.name), line(self.sources, task.span)))
    }

    /// The values of a service's parameters; those that only come out are there only once it has ended.
    fn values(&self, whose: Whose, values: &[Datum], has_ended: bool) -> String {
        let component = self.model.components.get(whose.component);
        let parameters = component.and_then(|c| c.services.get(whose.service.0)).map_or(&[][..], |s| &s.parameters);
        let is_there = |p: &&Parameter| has_ended || p.direction != Direction::Out;
        let named = parameters.iter().zip(values).filter(|(p, _)| is_there(p)).filter_map(|(parameter, value)| {
            Some(format!("{}={}", parameter.name, self.value(parameter.ty.as_ref()?, value)))
        });
        format!("({})", named.collect::<Vec<_>>().join(", "))
    }

    fn value(&self, ty: &lapwing_genom::model::Type, value: &Datum) -> String {
        let mut text = String::new();
        self.types.write(&mut text, ty, value);
        if text.len() > MOST_SHOWN {
            let end = (0..=MOST_SHOWN).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
            text.truncate(end);
            text.push('…');
        }
        text
    }
}

/// A time as lines begin with it: seconds, to the nanosecond.
pub fn stamp(time: Time) -> String {
    format!("{:6}.{:09}", time.0.div_euclid(1_000_000_000), time.0.rem_euclid(1_000_000_000))
}

/// A duration in the unit that fits.
fn shown(duration: Duration) -> String {
    lapwing_genom::shown(u64::try_from(duration.nanos()).unwrap_or(0))
}
