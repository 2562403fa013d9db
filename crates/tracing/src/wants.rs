//! What a specification wants of a program, and which of its call sites give it.
//!
//! `A::f` is a span named `A::f`, or one named `f` whose target ends in the module `a` or `A`; `A.x` is a field named `A.x`, or one named
//! `x` of a call site whose target ends so. A name that is not qualified is taken from any target. Modules are compared without regard to
//! case and underscores, so that `SensorController` is the module `sensor_controller`.

use std::collections::BTreeSet;

use lapwing_check::checked::{self, EventSource, PointKind, Step, part};

use crate::site::{Origin, Raise, Returned, Site, SpanPlan, When};

/// At most so many different functions may follow `below` in one specification, and at most so many different fields may be read of
/// its events: each is a bit.
pub(crate) const MOST: usize = 64;

/// What a specification wants of a program.
#[derive(Debug, Default)]
pub(crate) struct Wants {
    /// The signals, by the segments of their names.
    columns: Vec<Vec<String>>,
    events: Vec<Wanted>,
    /// The functions that events are to be below; each is a bit.
    belows: Vec<Vec<String>>,
    /// The fields that events read: they get them from the spans around them as well.
    carried: Vec<String>,
}

/// An event that comes from call sites.
#[derive(Debug)]
struct Wanted {
    /// Its number in the specification.
    number: usize,
    what: What,
    /// The number of the function that it is to be below.
    below: Option<usize>,
    /// The fields that are read of it.
    fields: Vec<String>,
}

#[derive(Debug)]
enum What {
    /// An event of that name.
    Named(String),
    Call(Vec<String>),
    Return(Vec<String>),
    Set(Vec<String>),
}

/// A call site, of `tracing` or of `log`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<'p> {
    pub kind: PlaceKind,
    pub name: &'p str,
    pub target: &'p str,
    pub fields: &'p [&'p str],
    pub file: Option<&'p str>,
    pub line: Option<u32>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PlaceKind {
    Span,
    Event,
}

/// Something that a call site gives. What two give that are not the same is nobody's.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Need {
    /// An event of the specification.
    Event(usize),
    /// A function that events are below.
    Below(usize),
    /// A signal.
    Column(usize),
}

/// How many call sites may give the same.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Oneness {
    /// One span: two would be two functions.
    Function,
    /// Those of one target: two targets would be two variables.
    Module,
    /// As many as there are.
    Any,
}

impl Wants {
    /// What a specification wants; `None` where it is more than can be kept account of.
    pub fn of(meaning: &checked::Spec) -> Option<Wants> {
        let columns = meaning.columns.iter().map(|c| c.split('.').map(str::to_owned).collect()).collect();
        let mut wants = Wants { columns, ..Wants::default() };
        for (number, event) in meaning.events.iter().enumerate() {
            let (what, below) = match &event.source {
                EventSource::Named => (What::Named(event.name.clone()), None),
                EventSource::Point(point) => {
                    let what = match point.kind {
                        PointKind::Call => What::Call(point.path.clone()),
                        PointKind::Return => What::Return(point.path.clone()),
                        PointKind::Set => What::Set(point.path.clone()),
                    };
                    (what, point.below.as_ref().map(|path| wants.below(path)))
                }
                _ => continue,
            };
            let fields: Vec<String> = event.fields.iter().map(|f| field_name(&f.path)).collect();
            fields.iter().for_each(|field| wants.carry(field));
            wants.events.push(Wanted { number, what, below, fields });
        }
        (wants.belows.len() <= MOST && wants.carried.len() <= MOST).then_some(wants)
    }

    fn below(&mut self, path: &[String]) -> usize {
        let known = self.belows.iter().position(|p| p == path);
        known.unwrap_or_else(|| {
            self.belows.push(path.to_vec());
            self.belows.len() - 1
        })
    }

    fn carry(&mut self, field: &str) {
        if !self.carried.iter().any(|f| f == field) && !matches!(field, "result" | "error") {
            self.carried.push(field.to_owned());
        }
    }

    /// Whether a text is the name of an event that is raised by its name.
    #[cfg(feature = "log")]
    pub fn names(&self, text: &str) -> bool {
        self.events.iter().any(|w| matches!(&w.what, What::Named(name) if name == text))
    }

    /// How many fields spans hand on to what happens inside them.
    pub fn carries(&self) -> usize {
        self.carried.len()
    }

    /// How many signals there are: the cells of a row.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// Whether anything asks for the spans around it.
    pub fn looks_around(&self) -> bool {
        !self.belows.is_empty() || !self.carried.is_empty()
    }

    /// How an event that comes from call sites is written, and the functions and fields that it stands on.
    pub fn needs_of(&self, event: usize) -> Vec<Need> {
        let Some(wanted) = self.events.iter().find(|w| w.number == event) else { return Vec::new() };
        match &wanted.what {
            What::Named(_) => Vec::new(),
            What::Call(path) | What::Return(path) if path.is_empty() => Vec::new(),
            _ => std::iter::once(Need::Event(event)).chain(wanted.below.map(Need::Below)).collect(),
        }
    }

    /// What a need is called.
    pub fn name(&self, need: Need) -> String {
        match need {
            Need::Column(column) => self.columns.get(column).map_or_else(String::new, |c| c.join(".")),
            Need::Below(below) => self.belows.get(below).map_or_else(String::new, |path| path.join("::")),
            Need::Event(event) => match self.events.iter().find(|w| w.number == event).map(|w| &w.what) {
                Some(What::Named(name)) => name.clone(),
                Some(What::Call(path) | What::Return(path)) => path.join("::"),
                Some(What::Set(path)) => path.join("."),
                None => String::new(),
            },
        }
    }

    /// Whether it takes one function, one module or any number of call sites to give it.
    pub fn oneness(&self, need: Need) -> Oneness {
        let of_event = |event| self.events.iter().find(|w| w.number == event).map(|w| &w.what);
        match need {
            Need::Below(_) => Oneness::Function,
            Need::Column(_) => Oneness::Module,
            Need::Event(event) => match of_event(event) {
                Some(What::Call(_) | What::Return(_)) => Oneness::Function,
                Some(What::Set(_)) => Oneness::Module,
                _ => Oneness::Any,
            },
        }
    }

    /// Whether an event wants to know what a function returned.
    pub fn wants_result(&self, event: usize) -> bool {
        self.events.iter().any(|w| w.number == event && w.fields.iter().any(|f| f == "result"))
    }

    /// Everything that a call site gives.
    pub fn given_by(&self, place: &Place<'_>) -> Vec<Need> {
        let is_span = place.kind == PlaceKind::Span;
        let has = |path: &[String]| place.fields.iter().any(|field| is_field(path, field, place.target));
        let gives = |wanted: &&Wanted| match &wanted.what {
            What::Named(name) => !is_span && place.name == name,
            What::Call(path) | What::Return(path) => {
                is_span && !path.is_empty() && is_function(path, place.name, place.target)
            }
            What::Set(path) => has(path),
        };
        let events = self.events.iter().filter(gives).map(|w| Need::Event(w.number));
        let belows = self.belows.iter().enumerate();
        let belows = belows.filter(|(_, path)| is_span && is_function(path, place.name, place.target));
        let columns = self.columns.iter().enumerate().filter(|(_, path)| has(path));
        events.chain(belows.map(|(i, _)| Need::Below(i))).chain(columns.map(|(i, _)| Need::Column(i))).collect()
    }

    /// What is to be done at a call site, leaving out what is `barred` because nobody knows which call site is meant. `None` where
    /// nothing is.
    pub fn plan(&self, place: &Place<'_>, barred: &BTreeSet<Need>) -> Option<Site> {
        let mut plan = Draft { routes: vec![Vec::new(); place.fields.len()], width: 0 };
        let row = self.row(place, barred, &mut plan);
        let raises = self.raises(place, barred, &mut plan);
        let span = self.span(place, barred, &mut plan);
        if row.is_none() && raises.is_empty() && span.is_none() {
            return None;
        }
        let asks = raises.iter().any(|r| r.below.is_some() || !r.inherited.is_empty());
        Some(Site {
            width: plan.width,
            routes: plan.routes.into_iter().map(Vec::into_boxed_slice).collect(),
            row,
            raises: raises.into_boxed_slice(),
            asks_around: asks || (span.is_some() && self.looks_around()),
            span,
            origin: Origin::of(place),
        })
    }

    fn row(&self, place: &Place<'_>, barred: &BTreeSet<Need>, plan: &mut Draft) -> Option<std::ops::Range<usize>> {
        let mut found = Vec::new();
        for (number, path) in self.columns.iter().enumerate().filter(|(n, _)| !barred.contains(&Need::Column(*n))) {
            let fields = place.fields.iter().enumerate().filter(|(_, field)| is_field(path, field, place.target));
            found.extend(fields.map(|(field, _)| (field, number)));
        }
        let start = plan.width;
        (!found.is_empty()).then(|| {
            plan.width += self.columns.len();
            found.into_iter().for_each(|(field, number)| plan.routes[field].push(start + number));
            start..plan.width
        })
    }

    fn raises(&self, place: &Place<'_>, barred: &BTreeSet<Need>, plan: &mut Draft) -> Vec<Raise> {
        let mut raises = Vec::new();
        for wanted in self.events.iter().filter(|w| !self.is_barred(w, barred)) {
            let is_span = place.kind == PlaceKind::Span;
            let when = match &wanted.what {
                What::Named(name) if !is_span && place.name == name => When::Always,
                What::Call(path) if is_span && is_function(path, place.name, place.target) => {
                    // Any call, where only those with its fields are meant.
                    let fields = &wanted.fields;
                    if path.is_empty() && !place.fields.iter().any(|f| fields.iter().any(|w| w == f)) {
                        continue;
                    }
                    When::Begins
                }
                What::Set(path) => {
                    let field = place.fields.iter().position(|field| is_field(path, field, place.target));
                    let Some(field) = field else { continue };
                    When::Gets(plan.slot_for(Some(field)))
                }
                _ => continue,
            };
            raises.push(self.raise(wanted, when, place, plan));
        }
        raises
    }

    fn raise(&self, wanted: &Wanted, when: When, place: &Place<'_>, plan: &mut Draft) -> Raise {
        let start = plan.width;
        let mut inherited = Vec::new();
        for name in &wanted.fields {
            let own = place.fields.iter().position(|f| f == name);
            let slot = plan.slot_for(own);
            inherited.extend(self.carried.iter().position(|c| c == name).map(|carried| (slot, carried)));
        }
        Raise {
            event: wanted.number,
            when,
            values: start..plan.width,
            below: wanted.below,
            inherited: inherited.into_boxed_slice(),
        }
    }

    fn span(&self, place: &Place<'_>, barred: &BTreeSet<Need>, plan: &mut Draft) -> Option<SpanPlan> {
        if place.kind != PlaceKind::Span {
            return None;
        }
        let is_it = |path: &[String]| is_function(path, place.name, place.target);
        let below = self.belows.iter().enumerate();
        let bits = below
            .filter(|(i, path)| is_it(path) && !barred.contains(&Need::Below(*i)))
            .fold(0_u64, |bits, (i, _)| bits | 1 << i);
        let returns: Vec<Returned> = self
            .events
            .iter()
            .filter(|w| !self.is_barred(w, barred) && matches!(&w.what, What::Return(path) if is_it(path)))
            .filter(|w| matches!(&w.what, What::Return(path) if !path.is_empty()) || self.has_own(w, place))
            .map(|w| Returned {
                event: w.number,
                below: w.below,
                fields: w.fields.iter().map(|f| self.source(f)).collect(),
            })
            .collect();
        let carries = place.fields.iter().any(|f| self.carried.iter().any(|c| c == f));
        if bits == 0 && returns.is_empty() && !carries {
            return None;
        }
        let start = plan.width;
        for name in &self.carried {
            plan.slot_for(place.fields.iter().position(|f| f == name));
        }
        Some(SpanPlan { bits, returns: returns.into_boxed_slice(), carried: start..plan.width })
    }

    fn has_own(&self, wanted: &Wanted, place: &Place<'_>) -> bool {
        wanted.fields.iter().any(|w| place.fields.iter().any(|f| f == w))
    }

    /// Where a return gets a field from.
    fn source(&self, field: &str) -> crate::site::Source {
        use crate::site::Source;
        match field {
            "result" => Source::Result,
            "error" => Source::Error,
            _ => self.carried.iter().position(|c| c == field).map_or(Source::Nowhere, Source::Carried),
        }
    }

    fn is_barred(&self, wanted: &Wanted, barred: &BTreeSet<Need>) -> bool {
        barred.contains(&Need::Event(wanted.number)) || wanted.below.is_some_and(|b| barred.contains(&Need::Below(b)))
    }
}

/// A plan in the making: for each field of the call site, where its value goes.
struct Draft {
    routes: Vec<Vec<usize>>,
    width: usize,
}

impl Draft {
    /// One more place for a value, and the field that fills it.
    fn slot_for(&mut self, field: Option<usize>) -> usize {
        let slot = self.width;
        self.width += 1;
        if let Some(routes) = field.and_then(|f| self.routes.get_mut(f)) {
            routes.push(slot);
        }
        slot
    }
}

/// What a field of an event is called by call sites, by those who tell it and in recordings: fields of fields have dots.
pub(crate) fn field_name(path: &[Step]) -> String {
    part("", path)
}

/// Whether a span is the function. The empty path is any.
fn is_function(path: &[String], name: &str, target: &str) -> bool {
    let own = name.split("::").count();
    let Some(outer) = path.len().checked_sub(own) else { return path.is_empty() };
    path[outer..].iter().map(String::as_str).eq(name.split("::")) && ends_in(target, &path[..outer])
}

/// Whether a field of a call site with that target is the one of this name.
fn is_field(path: &[String], field: &str, target: &str) -> bool {
    if path.iter().map(String::as_str).eq(field.split('.')) {
        return true;
    }
    path.split_last().is_some_and(|(last, outer)| last == field && !outer.is_empty() && ends_in(target, outer))
}

/// Whether a target ends in those modules.
fn ends_in(target: &str, modules: &[String]) -> bool {
    let mut parts = target.rsplit("::");
    modules.iter().rev().all(|module| parts.next().is_some_and(|part| is_module(module, part)))
}

fn is_module(written: &str, module: &str) -> bool {
    fn plain(name: &str) -> impl Iterator<Item = char> {
        name.chars().filter(|c| *c != '_').map(|c| c.to_ascii_lowercase())
    }
    written == module || plain(written).eq(plain(module))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> Vec<String> {
        text.split(['.', ':']).filter(|s| !s.is_empty()).map(str::to_owned).collect()
    }

    #[test]
    fn functions_are_spans_by_name_and_module() {
        let is = |written: &str, name, target| is_function(&path(written), name, target);
        assert!(is("Kicker::play", "Kicker::play", "anywhere"));
        assert!(is("Kicker::play", "play", "robot::kicker"));
        assert!(is("SensorController::get_ir", "get_ir", "robot::sensor_controller"));
        assert!(is("robot::kicker::play", "play", "soccer::robot::kicker"));
        assert!(is("play", "play", "robot::kicker"));
        assert!(!is("Kicker::play", "play", "robot"));
        assert!(!is("Kicker::play", "play", "robot::kicker::tests"));
        assert!(!is("Kicker::play", "Play", "robot::kicker"));
        assert!(!is("play", "Kicker::play", "robot::kicker"));
    }

    #[test]
    fn fields_are_taken_from_their_module_or_by_their_whole_name() {
        let is = |written: &str, field, target| is_field(&path(written), field, target);
        assert!(is("SensorController.sonar", "sonar", "robot::sensor_controller"));
        assert!(is("SensorController.sonar", "SensorController.sonar", "robot"));
        assert!(is("sonar", "sonar", "anywhere"));
        assert!(!is("SensorController.sonar", "sonar", "robot::motor"));
        assert!(!is("sonar", "a.sonar", "robot"));
    }
}
