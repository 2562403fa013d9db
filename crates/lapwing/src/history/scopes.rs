//! When the scopes of a property were open.
//!
//! The engine says how often a scope was entered, not when. So the conditions of all scopes are judged as properties of their own, each at the
//! positions of the property that it belongs to: `not X` fails exactly where X holds, and its episodes are the stretches that are looked for.

use lapwing_check::checked::{self, Body, Expr, Kind, Property, Scope};
use lapwing_check::compile;
use lapwing_engine::{Ending, Outcome, Output, Program, State, inputs::Inputs};
use lapwing_react::history::Piece;
use lapwing_stream::{Sample, Type};

use super::alarms::Alarms;
use super::axis::Axis;
use super::stretches::{Stretch, thin};

/// The conditions of all scopes, judged beside the properties.
#[derive(Debug)]
pub(super) struct Probes {
    program: Program,
    state: State,
    alarms: Alarms,
    axis: Axis,
    outcomes: Vec<Outcome>,
    /// For each property its scopes, in the order of the text.
    scopes: Vec<Vec<Probe>>,
}

/// A scope, with the numbers of the properties that judge its conditions; `None` where a condition cannot be judged alone.
#[derive(Debug)]
struct Probe {
    kind: Opening,
    x: Option<usize>,
    y: Option<usize>,
    /// Whether it is the whole formula of its property.
    is_outermost: bool,
}

/// The ways in which scopes open and close.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Opening {
    /// `while`, `whenever`: it is open where X holds.
    During,
    /// `after`: from the first X on.
    From,
    /// `until`, `before`: up to the first X.
    UpTo,
    /// `after_until`
    Between,
}

impl Probes {
    /// Of all properties of a specification; `None` where there is nothing to judge.
    pub fn new(meaning: &checked::Spec) -> Option<Probes> {
        let is_machine = |p: &&Property| matches!(p.body, Body::Machine(_));
        let mut properties: Vec<Property> = meaning.properties.iter().filter(is_machine).cloned().collect();
        let machines = properties.len();
        let mut gather = Gather { properties: &mut properties, scopes: Vec::new() };
        let scopes = meaning.properties.iter().map(|p| gather.of(p)).collect();
        if properties.len() == machines {
            return None;
        }
        let spec = checked::Spec { properties, reactions: Vec::new(), ..meaning.clone() };
        let program = compile::compile(&spec);
        let state = State::new(&program);
        let (alarms, axis) = (Alarms::default(), Axis::default());
        Some(Probes { program, state, alarms, axis, outcomes: Vec::new(), scopes })
    }

    /// Takes in what the properties take in.
    pub fn feed(&mut self, sample: Sample<'_>) {
        let Probes { program, state, alarms, axis, .. } = self;
        state.feed(program, sample, &mut |_: &Inputs, output: Output<'_>| note(alarms, axis, &output));
        axis.see(sample.time);
    }

    /// The recording is over.
    pub fn finish(&mut self) {
        let Probes { program, state, alarms, axis, outcomes, .. } = self;
        let mut observer = |_: &Inputs, output: Output<'_>| note(alarms, axis, &output);
        *outcomes = state.finish(program, &Ending::default(), &mut observer);
    }

    /// When the scopes of a property were open, in the order of the text; of a scope inside of something, when its condition held.
    pub fn open(&self, property: usize, most: usize) -> Vec<Option<Vec<Stretch>>> {
        let probes = self.scopes.get(property).map_or(&[][..], Vec::as_slice);
        probes.iter().map(|probe| self.stretches(probe).map(|s| thin(s, most))).collect()
    }

    /// When the scope that is the whole formula of a property was open.
    pub fn outermost(&self, property: usize) -> Option<Vec<Stretch>> {
        self.stretches(self.scopes.get(property)?.first().filter(|probe| probe.is_outermost)?)
    }

    fn stretches(&self, probe: &Probe) -> Option<Vec<Stretch>> {
        let x = self.held(probe.x?);
        if !probe.is_outermost || probe.kind == Opening::During {
            return Some(x);
        }
        let y = if probe.kind == Opening::Between { self.held(probe.y?) } else { Vec::new() };
        Some(self.axis.pieces().iter().flat_map(|piece| opened(probe.kind, piece, &x, &y)).collect())
    }

    /// When a condition held.
    fn held(&self, probe: usize) -> Vec<Stretch> {
        let of_probe = self.outcomes.iter().find(|o| o.property == probe);
        let episodes = of_probe.map_or(&[][..], |o| &o.episodes);
        let marks = self.alarms.marks(probe, &[], episodes, &self.axis);
        thin(marks.iter().map(|m| (m.failed, m.until)).collect(), usize::MAX)
    }
}

fn note(alarms: &mut Alarms, axis: &mut Axis, output: &Output<'_>) {
    match output {
        Output::Alarm(alarm) | Output::Further(alarm) => {
            alarms.note(alarm.property, alarm.instance, axis.piece());
        }
        Output::Jump { to, .. } => axis.jump(*to),
        _ => {}
    }
}

/// When a scope was open within a piece, from when its conditions held.
fn opened(kind: Opening, piece: &Piece, x: &[Stretch], y: &[Stretch]) -> Vec<Stretch> {
    let inside = |s: &&Stretch| s.0 >= piece.from && s.0 <= piece.to;
    let first = x.iter().find(inside).map(|s| s.0);
    match kind {
        Opening::During => x.iter().filter(inside).copied().collect(),
        Opening::From => first.map(|from| (from, piece.to)).into_iter().collect(),
        Opening::UpTo => vec![(piece.from, first.unwrap_or(piece.to))],
        Opening::Between => {
            let (x, y): (Vec<_>, Vec<_>) = (x.iter().filter(inside).collect(), y.iter().filter(inside).collect());
            between(piece, &x, &y)
        }
    }
}

/// From an X to the next Y, again and again. Where both hold, what opens closes at once.
fn between(piece: &Piece, x: &[&Stretch], y: &[&Stretch]) -> Vec<Stretch> {
    let mut found = Vec::new();
    let (mut y, mut over) = (y.iter().peekable(), None);
    for &&(begins, ends) in x {
        let is_over = |over: Option<_>| over.is_some_and(|over| ends <= over);
        while !is_over(over) {
            let opens = over.map_or(begins, |over| begins.max(over));
            while y.next_if(|y| y.1 < opens).is_some() {}
            let Some(closing) = y.peek() else {
                found.push((opens, piece.to));
                return found;
            };
            if closing.0 > opens {
                found.push((opens, closing.0));
            }
            over = Some(closing.1);
            y.next();
        }
    }
    found
}

/// Makes the properties that judge conditions.
struct Gather<'p> {
    properties: &'p mut Vec<Property>,
    scopes: Vec<Probe>,
}

impl Gather<'_> {
    fn of(&mut self, property: &Property) -> Vec<Probe> {
        if let Body::Formula(formula) = &property.body {
            self.walk(property, formula, true);
        }
        std::mem::take(&mut self.scopes)
    }

    fn walk(&mut self, property: &Property, e: &Expr, is_outermost: bool) {
        let probe = match &e.kind {
            Kind::Scope(scope, x, _) => Some((opening(*scope), x, None)),
            Kind::AfterUntil(x, y, _) => Some((Opening::Between, x, Some(y))),
            _ => None,
        };
        if let Some((kind, x, y)) = probe {
            let (x, y) = (self.judge(property, x), y.and_then(|y| self.judge(property, y)));
            self.scopes.push(Probe { kind, x, y, is_outermost });
        }
        e.children().into_iter().for_each(|c| self.walk(property, c, false));
    }

    /// A property that fails where X holds.
    fn judge(&mut self, property: &Property, x: &Expr) -> Option<usize> {
        let is_alone = property.slices.is_empty() && property.problem.is_none() && !x.has_future();
        is_alone.then(|| {
            let not = Expr { kind: Kind::Not(Box::new(x.clone())), ty: Type::Bool, dim: x.dim, span: x.span };
            self.properties.push(Property { body: Body::Formula(not), ..property.clone() });
            self.properties.len() - 1
        })
    }
}

fn opening(scope: Scope) -> Opening {
    match scope {
        Scope::While | Scope::Whenever => Opening::During,
        Scope::After => Opening::From,
        Scope::Until | Scope::Before => Opening::UpTo,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lapwing_stream::Time;

    fn stretch(from: i64, to: i64) -> Stretch {
        (Time(from), Time(to))
    }

    #[test]
    fn what_opens_and_closes() {
        let piece = Piece { from: Time(0), to: Time(100), stamp: Time(0) };
        let x = [stretch(10, 30), stretch(50, 55), stretch(90, 90)];
        let y = [stretch(20, 25), stretch(54, 80)];
        let of = |kind| opened(kind, &piece, &x, &y);
        assert_eq!(of(Opening::Between), [stretch(10, 20), stretch(25, 54), stretch(90, 100)]);
        assert_eq!(of(Opening::From), [stretch(10, 100)]);
        assert_eq!(of(Opening::UpTo), [stretch(0, 10)]);
        assert_eq!(of(Opening::During), x);
    }
}
