//! What is drawn of each property: the numbers and states that it reads, which of them share axes, and what they are compared with.

use lapwing_check::checked::{self, Body, Compare, Dim, Expr, Kind, Property};
use lapwing_react::history::{Limit, Plot};
use lapwing_stream::Value;

use crate::eval::{self, Moment};
use crate::explain::Printer;
use crate::shown;
use crate::spec::Spec;

/// What is drawn of all properties of a specification.
#[derive(Debug, Default)]
pub(super) struct Plan {
    /// What is drawn, each once.
    pub wanted: Vec<Wanted>,
    /// For each property, which of it.
    pub views: Vec<View>,
}

/// Something that is drawn.
#[derive(Debug)]
pub(super) struct Wanted {
    pub name: String,
    pub unit: Option<String>,
    pub source: Source,
}

/// Where it comes from.
#[derive(Debug)]
pub(super) enum Source {
    /// An expression over signals.
    Expr(Expr),
    /// The state of a machine, with what its states are called.
    Machine(usize, Vec<String>),
    /// The occurrences of an event.
    Event(usize),
}

/// What is drawn of one property: groups of tracks that are compared with each other, and so share axes.
#[derive(Debug, Default)]
pub(super) struct View {
    pub groups: Vec<Group>,
}

/// Tracks on the same axes.
#[derive(Debug, Default)]
pub(super) struct Group {
    pub tracks: Vec<usize>,
    pub limits: Vec<Limit>,
}

impl Plan {
    pub fn new(spec: &Spec, meaning: &checked::Spec) -> Plan {
        let mut planner = Planner { spec, meaning, printer: Printer { spec, meaning }, wanted: Vec::new() };
        let views = meaning.properties.iter().map(|p| planner.view(p)).collect();
        Plan { wanted: planner.wanted, views }
    }
}

impl Plan {
    /// The tracks of a property: those that come as numbers as curves, the rest as lanes.
    pub fn drawn(&self, property: usize, is_curve: impl Fn(usize) -> bool) -> (Vec<usize>, Vec<Plot>) {
        let (mut all_lanes, mut plots) = (Vec::new(), Vec::new());
        for group in self.views.get(property).into_iter().flat_map(|view| &view.groups) {
            let (curves, lanes): (Vec<usize>, Vec<usize>) = group.tracks.iter().partition(|t| is_curve(**t));
            all_lanes.extend(lanes);
            if !curves.is_empty() {
                plots.push(Plot { tracks: curves, limits: group.limits.clone() });
            }
        }
        (all_lanes, plots)
    }
}

struct Planner<'p> {
    spec: &'p Spec,
    meaning: &'p checked::Spec,
    printer: Printer<'p>,
    wanted: Vec<Wanted>,
}

/// A number of a property: its track, and its canonical text, by which comparisons find it.
struct Number {
    track: usize,
    text: String,
}

impl Planner<'_> {
    fn view(&mut self, property: &Property) -> View {
        let mut view = View::default();
        for track in self.states(property) {
            view.groups.push(Group { tracks: vec![track], limits: Vec::new() });
        }
        let numbers: Vec<Number> = shown::of(self.spec, self.meaning, property)
            .into_iter()
            .map(|s| {
                let text = self.printer.print(&s.expr);
                Number { track: self.want(s.name, unit(s.expr.dim), &text, s.expr), text }
            })
            .collect();
        let own = numbers.iter().map(|n| Group { tracks: vec![n.track], limits: Vec::new() });
        view.groups.extend(own);
        for e in exprs(self.meaning, property) {
            self.compare(e, &numbers, &mut view);
        }
        view
    }

    /// The number of the track of an expression, which is wanted from now on.
    fn want(&mut self, name: String, unit: Option<String>, text: &str, expr: Expr) -> usize {
        let is_same = |w: &Wanted| match &w.source {
            Source::Expr(e) => w.name == name && self.printer.print(e) == text,
            _ => false,
        };
        match self.wanted.iter().position(is_same) {
            Some(known) => known,
            None => self.push(Wanted { name, unit, source: Source::Expr(expr) }),
        }
    }

    fn push(&mut self, wanted: Wanted) -> usize {
        self.wanted.push(wanted);
        self.wanted.len() - 1
    }

    /// The tracks of the machines and events of a property.
    fn states(&mut self, property: &Property) -> Vec<usize> {
        let mut machines = property.machines.clone();
        let mut events = Vec::new();
        if let Body::Machine(machine) = property.body {
            machines.push(machine);
        }
        for e in exprs(self.meaning, property) {
            below(e, &mut |e| match e.kind {
                Kind::Event(event) => events.push(event),
                Kind::InState { machine, .. } => machines.push(machine),
                _ => {}
            });
        }
        events.extend(property.alphabet.iter().flatten().copied());
        for list in [&mut machines, &mut events] {
            list.sort_unstable();
            list.dedup();
        }
        let machines = machines.into_iter().filter_map(|m| self.machine(m)).collect::<Vec<_>>();
        machines.into_iter().chain(events.into_iter().filter_map(|e| self.event(e)).collect::<Vec<_>>()).collect()
    }

    fn machine(&mut self, number: usize) -> Option<usize> {
        let machine = self.meaning.machines.get(number)?;
        let is_known = |w: &Wanted| matches!(w.source, Source::Machine(m, _) if m == number);
        let labels = machine.states.iter().map(|s| s.name.clone()).collect();
        let known = self.wanted.iter().position(is_known);
        Some(known.unwrap_or_else(|| {
            self.push(Wanted { name: machine.name.clone(), unit: None, source: Source::Machine(number, labels) })
        }))
    }

    fn event(&mut self, number: usize) -> Option<usize> {
        let event = self.meaning.events.get(number)?;
        let is_known = |w: &Wanted| matches!(w.source, Source::Event(e) if e == number);
        let known = self.wanted.iter().position(is_known);
        Some(known.unwrap_or_else(|| {
            self.push(Wanted { name: event.name.clone(), unit: None, source: Source::Event(number) })
        }))
    }

    /// Notes what the numbers below an expression are compared with.
    fn compare(&self, e: &Expr, numbers: &[Number], view: &mut View) {
        if let Kind::Compare { op, margin, left, right } = &e.kind {
            let margin = margin.as_ref().map_or(Some(0.0), |m| constant(m)).unwrap_or(0.0);
            let find = |side: &Expr| {
                let text = self.printer.print(side);
                numbers.iter().find(|n| n.text == text).map(|n| n.track)
            };
            match (find(left), find(right)) {
                (Some(a), Some(b)) => view.join(a, b),
                (Some(track), None) => view.limit(track, *op, margin, right, &self.printer),
                (None, Some(track)) => view.limit(track, op.mirrored(), margin, left, &self.printer),
                (None, None) => {}
            }
        }
        e.children().into_iter().for_each(|c| self.compare(c, numbers, view));
    }
}

impl View {
    fn group(&self, track: usize) -> Option<usize> {
        self.groups.iter().position(|g| g.tracks.contains(&track))
    }

    /// Puts two tracks on the same axes.
    fn join(&mut self, a: usize, b: usize) {
        if let (Some(a), Some(b)) = (self.group(a), self.group(b))
            && a != b
        {
            let gone = self.groups.remove(a.max(b));
            let kept = &mut self.groups[a.min(b)];
            kept.tracks.extend(gone.tracks);
            kept.limits.extend(gone.limits);
        }
    }

    /// A track is compared with something that does not change.
    fn limit(&mut self, track: usize, op: Compare, margin: f64, with: &Expr, printer: &Printer<'_>) {
        let (Some(group), Some(value)) = (self.group(track), constant(with)) else { return };
        let within = if margin == 0.0 { String::new() } else { format!("{{{margin}}}") };
        let text = format!("{}{within} {}", crate::explain::compare(op), printer.print(with));
        let values = match op {
            Compare::Lt | Compare::Le => vec![value + margin],
            Compare::Gt | Compare::Ge => vec![value - margin],
            Compare::Eq | Compare::Ne if margin == 0.0 => vec![value],
            Compare::Eq | Compare::Ne => vec![value - margin, value + margin],
        };
        let limits = &mut self.groups[group].limits;
        for value in values.into_iter().filter(|v| v.is_finite()) {
            if limits.iter().all(|l| l.value != value) {
                limits.push(Limit { value, text: text.clone() });
            }
        }
    }
}

/// The value of an expression that reads nothing.
fn constant(e: &Expr) -> Option<f64> {
    struct Nothing;
    impl Moment for Nothing {
        fn value(&self, _: usize) -> &Value {
            &Value::Missing
        }
    }
    match eval::eval(e, &Nothing) {
        Some(Value::Num(x)) => Some(x),
        _ => None,
    }
}

/// The formula of a property, or the conditions of the machine that it is.
fn exprs<'m>(meaning: &'m checked::Spec, property: &'m Property) -> Vec<&'m Expr> {
    match &property.body {
        Body::Formula(formula) => vec![formula],
        Body::Machine(machine) => {
            let machine = meaning.machines.get(*machine);
            let states = machine.into_iter().flat_map(|m| m.states.iter().filter_map(|s| s.when.as_ref()));
            let edges = machine.into_iter().flat_map(|m| m.edges.iter().filter_map(|e| e.when.as_ref()));
            states.chain(edges).collect()
        }
        Body::None => Vec::new(),
    }
}

fn below(e: &Expr, visit: &mut impl FnMut(&Expr)) {
    visit(e);
    e.children().into_iter().for_each(|c| below(c, visit));
}

/// The unit of a number in SI units, where its dimension is known.
fn unit(dim: Dim) -> Option<String> {
    let [length, time, angle] = dim.0?;
    let power = |unit: &str, n: i8| match n.unsigned_abs() {
        0 => None,
        1 => Some(unit.to_owned()),
        2 => Some(format!("{unit}²")),
        3 => Some(format!("{unit}³")),
        n => Some(format!("{unit}^{n}")),
    };
    let units = [("m", length), ("rad", angle), ("s", time)];
    let side = |positive: bool| {
        let some = units.iter().filter(|(_, n)| (*n > 0) == positive);
        some.filter_map(|(unit, n)| power(unit, *n)).collect::<Vec<_>>().join("·")
    };
    match (side(true), side(false)) {
        (above, below) if above.is_empty() && below.is_empty() => None,
        (above, below) if below.is_empty() => Some(above),
        (above, below) if above.is_empty() => Some(format!("1/{below}")),
        (above, below) => Some(format!("{above}/{below}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(text: &str) -> (Vec<Vec<String>>, Vec<(f64, String)>) {
        let spec = Spec::parse("t.rv", text, &|_| None).unwrap();
        let columns = ["a", "b", "c"].map(str::to_owned).to_vec();
        let shape = lapwing_check::TraceShape { columns, schemaless: true, ..Default::default() };
        let plan = Plan::new(&spec, &spec.against(&shape).spec);
        let names = |g: &Group| g.tracks.iter().map(|t| plan.wanted[*t].name.clone()).collect();
        let groups = plan.views[0].groups.iter();
        let limits = groups.clone().flat_map(|g| &g.limits).map(|l| (l.value, l.text.clone())).collect();
        (groups.map(names).collect(), limits)
    }

    #[test]
    fn what_is_compared_shares_axes_and_constants_are_limits() {
        let (groups, limits) = view("limit = 0.5 * 4\nnever a > limit or c < b\n");
        assert_eq!(groups, [vec!["a"], vec!["c", "b"]]);
        assert_eq!(limits, [(2.0, "> limit".to_owned())]);
    }

    #[test]
    fn margins_move_limits() {
        let (groups, limits) = view("whenever 3 <{0.5} a, eventually within 2 s b =={0.25} 1\n");
        assert_eq!(groups, [["a"], ["b"]]);
        assert_eq!(limits.iter().map(|l| l.0).collect::<Vec<_>>(), [2.5, 0.75, 1.25]);
    }

    #[test]
    fn units_of_dimensions() {
        let of = |dim| unit(Dim(Some(dim))).unwrap_or_default();
        assert_eq!([of([1, -1, 0]), of([0, -2, 1]), of([0, 0, 0]), of([0, -1, 0])], ["m/s", "rad/s²", "", "1/s"]);
        assert_eq!(unit(Dim(None)), None);
    }
}
