//! From states in states to machines.
//!
//! A state that holds others is where its children are: arrows to it lead to the child that it begins in, arrows from it leave each of the children,
//! unless the child has an arrow of its own for the same event. That is exact. What a machine cannot be, with a memory of where it was (history) or in two
//! states at once (regions within other states), is refused. Regions that are the whole chart become machines of their own.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::Expr;
use lapwing_syntax::print_expr;

use super::{Annotation, Arrow, Chart, Kind, Trigger};
use crate::names::{Taken, slug};
use crate::sheet::{Edge, Event, Item, Machine, Sheet, State};
use crate::{Report, expr};

/// From choice to choice so far and no farther.
const MOST_CHOICES: usize = 16;
/// A machine with more edges is not written; nor are more steps from choice to choice taken to find them.
const MOST_EDGES: usize = 20_000;
/// So many conditions for one event of a state are kept apart, and no more.
const MOST_CONDITIONS: usize = 50;

/// Writes the machines of a chart.
pub(crate) fn write(chart: &Chart, sheet: &mut Sheet, report: &mut Report) {
    for (root, name) in roots(chart) {
        let refused = refused(chart, root);
        if refused.is_empty() {
            Flat::new(chart, root, report).write(&name, sheet);
        }
        for (place, why) in refused {
            let message = format!("the state diagram `{name}` cannot be a machine");
            let span = report.span(place.start, place.end);
            report.push(Diagnostic::new(Code::ImportRefused, span, message).label(why));
        }
    }
}

/// The parts of a chart that are machines of their own, with their names.
fn roots(chart: &Chart) -> Vec<(usize, String)> {
    let Some(whole) = chart.nodes.first() else { return Vec::new() };
    let at_top = |n: usize| chart.nodes.get(n).is_some_and(|n| n.parent == 0);
    let touches = |n: usize| chart.arrows.iter().any(|a| a.from == n || a.to == n);
    // A sheet of drawings, each in a frame.
    let frames = whole.children.iter().all(|c| chart.nodes.get(*c).is_some_and(|n| !n.children.is_empty()));
    let joined = chart.arrows.iter().any(|a| at_top(a.from) || at_top(a.to));
    if frames && !joined && whole.initial.is_none() && whole.kind == Kind::State && !whole.children.is_empty() {
        let frame = |c: &usize| chart.nodes.get(*c).map(|n| (*c, n.id.clone()));
        return whole.children.iter().filter_map(frame).flat_map(|(c, name)| regions(chart, c, name)).collect();
    }
    // Regions that are all there is, perhaps within states that hold nothing else.
    let mut inner = whole;
    while let [only] = inner.children[..]
        && let Some(node) = chart.nodes.get(only).filter(|_| !touches(only))
    {
        if node.kind == Kind::Parallel {
            return regions(chart, only, chart.name.clone());
        }
        inner = node;
    }
    regions(chart, 0, chart.name.clone())
}

/// The regions of a node, if it has any; else itself.
fn regions(chart: &Chart, node: usize, name: String) -> Vec<(usize, String)> {
    let Some(found) = chart.nodes.get(node).filter(|n| n.kind == Kind::Parallel) else { return vec![(node, name)] };
    let region = |(number, child): (usize, &usize)| {
        let id = chart.nodes.get(*child).map_or("", |n| n.id.as_str());
        let part = if id.is_empty() { format!("{}", number + 1) } else { id.to_owned() };
        (*child, format!("{name}_{part}"))
    };
    found.children.iter().enumerate().map(region).collect()
}

/// What in a part of a chart no machine can be, and why.
fn refused(chart: &Chart, root: usize) -> Vec<(Range<usize>, &'static str)> {
    let inside = chart.nodes.iter().enumerate().filter(|(n, _)| *n != root && chart.is_in(*n, root));
    let mut wrong: Vec<(Range<usize>, &str)> = inside
        .filter_map(|(_, node)| {
            let why = match node.kind {
                Kind::History => "a machine does not remember where it was",
                Kind::Parallel => "a machine is in one state at a time; draw the regions as diagrams of their own",
                Kind::Fork => "a machine is in one state at a time",
                Kind::State | Kind::Final | Kind::Choice | Kind::Region => return None,
            };
            Some((node.place.clone(), why))
        })
        .collect();
    let done: Vec<&Arrow> = chart.arrows.iter().filter(|a| a.trigger == Trigger::Done && a.when.is_none()).collect();
    let holds = |n: usize| chart.nodes.get(n).is_some_and(|n| !n.children.is_empty());
    let again = |(n, a): &(usize, &&Arrow)| holds(a.from) && done[..*n].iter().any(|b| b.from == a.from);
    // Of a drawing both are moves that are allowed.
    let torn = done.iter().enumerate().filter(|_| chart.ordered).filter(again);
    wrong.extend(torn.map(|(_, a)| (a.place.clone(), "another arrow leaves the state when it is done")));
    let crossing = chart.arrows.iter().find(|a| chart.is_in(a.from, root) != chart.is_in(a.to, root));
    wrong.extend(crossing.map(|a| (a.place.clone(), "the arrow leads from one region to another")));
    wrong
}

/// The arrow by which a state is left once it is done; `None` where there is none, or several are drawn.
fn goes_on(chart: &Chart, node: usize) -> Option<&Arrow> {
    let mut done = chart.arrows.iter().filter(|a| a.from == node && a.trigger == Trigger::Done && a.when.is_none());
    done.next().filter(|_| done.next().is_none())
}

/// An edge in the making: the nearer the state that its arrow leaves, the sooner it is tried.
#[derive(Clone, Debug)]
struct Way {
    level: usize,
    /// The arrow that it begins with.
    arrow: usize,
    trigger: Trigger,
    when: Option<Expr>,
    to: usize,
}

struct Flat<'c, 'r> {
    chart: &'c Chart,
    root: usize,
    report: &'r mut Report,
    /// The states of the machine, in the order of the drawing.
    leaves: Vec<usize>,
    ways: BTreeMap<usize, Vec<Way>>,
    /// How many choices have been passed.
    steps: usize,
    failed: bool,
}

impl<'c, 'r> Flat<'c, 'r> {
    fn new(chart: &'c Chart, root: usize, report: &'r mut Report) -> Flat<'c, 'r> {
        let is_done = |n: usize| goes_on(chart, n).is_some();
        let is_leaf = |n: &usize| {
            chart.nodes.get(*n).is_some_and(|node| {
                let passes = node.kind == Kind::Final && node.parent != root && is_done(node.parent);
                node.children.is_empty() && matches!(node.kind, Kind::State | Kind::Final) && *n != root && !passes
            })
        };
        let mut leaves: Vec<usize> = (0..chart.nodes.len()).filter(|n| chart.is_in(*n, root)).filter(is_leaf).collect();
        leaves.sort_by_key(|leaf| chart.nodes[*leaf].rank);
        Flat { chart, root, report, leaves, ways: BTreeMap::new(), steps: 0, failed: false }
    }

    fn refuse(&mut self, node: usize, why: &str) {
        if !std::mem::replace(&mut self.failed, true) {
            let place = self.chart.nodes.get(node).map_or(0..0, |n| n.place.clone());
            let span = self.report.span(place.start, place.end);
            let message = "the state diagram cannot be a machine";
            self.report.push(Diagnostic::new(Code::ImportRefused, span, message).label(why));
        }
    }

    fn kind(&self, node: usize) -> Kind {
        self.chart.nodes.get(node).map_or(Kind::State, |n| n.kind)
    }

    /// Where a chart is once it has entered a node: in a leaf, in a choice, or where a state that is done goes on to.
    fn entered(&mut self, mut node: usize) -> usize {
        for _ in 0..=self.chart.nodes.len() {
            let Some(found) = self.chart.nodes.get(node) else { return node };
            let parent = found.parent;
            if found.kind == Kind::Final && parent != self.root {
                match goes_on(self.chart, parent) {
                    Some(done) => node = done.to,
                    None => return node,
                }
            } else if let Some(first) = found.initial.or(found.children.first().copied()) {
                if found.initial.is_none() {
                    self.guess_initial(node, first);
                }
                node = first;
            } else {
                return node;
            }
        }
        self.refuse(node, "nobody knows where it is entered");
        node
    }

    fn guess_initial(&mut self, node: usize, first: usize) {
        let id = |n: usize| self.chart.nodes.get(n).map_or("", |n| n.id.as_str()).to_owned();
        let place = self.chart.nodes.get(first).map_or(0..0, |n| n.place.clone());
        let what = if node == self.root { "the state diagram".to_owned() } else { format!("`{}`", id(node)) };
        let message = format!("{what} does not say where it begins: `{}`, its first state, is taken", id(first));
        let span = self.report.span(place.start, place.end);
        let diagnostic = Diagnostic::new(Code::ImportDiffers, span, message);
        if !self.report.diagnostics.contains(&diagnostic) {
            self.report.push(diagnostic);
        }
    }

    /// The ways out of every leaf, in the order in which they are tried.
    fn find_ways(&mut self) {
        let mut total = 0;
        for leaf in self.leaves.clone() {
            let mut ways = Vec::new();
            let (chart, root) = (self.chart, self.root);
            // The root too: a region may be left for itself, and begins anew then.
            let inside = chart.around(leaf).take_while(|n| chart.is_in(*n, root));
            for (level, node) in inside.take(super::MOST_DEPTH + 2).enumerate() {
                for (number, arrow) in chart.arrows.iter().enumerate().filter(|(_, a)| a.from == node) {
                    let mut way = Way {
                        level,
                        arrow: number,
                        trigger: arrow.trigger.clone(),
                        when: arrow.when.clone(),
                        to: arrow.to,
                    };
                    if arrow.trigger == Trigger::Done {
                        // A state that is done goes on from its final state.
                        let is_end = chart.nodes.get(leaf).is_some_and(|n| n.kind == Kind::Final && n.parent == node);
                        if !is_end {
                            continue;
                        }
                        let is_certain = chart.ordered || arrow.when.is_some() || goes_on(chart, node).is_some();
                        way.trigger = if is_certain { Trigger::Eventless } else { Trigger::Unsaid };
                    }
                    if arrow.stays {
                        ways.push(Way { to: leaf, ..way });
                        continue;
                    }
                    self.follow(way, 0, &mut ways);
                }
            }
            total += ways.len();
            if total > MOST_EDGES {
                return self.refuse(leaf, "it has too many arrows");
            }
            let ways = self.apart(leaf, ways);
            self.ways.insert(leaf, ways);
        }
    }

    /// Follows an arrow to where it ends, through choices.
    fn follow(&mut self, way: Way, choices: usize, ways: &mut Vec<Way>) {
        let to = self.entered(way.to);
        if self.kind(to) != Kind::Choice {
            ways.push(Way { to, ..way });
            return;
        }
        self.steps += 1;
        if choices == MOST_CHOICES || self.steps > MOST_EDGES {
            self.refuse(to, "choices lead in a circle, or to too many others");
        }
        if self.failed {
            return;
        }
        let chart = self.chart;
        let branches: Vec<_> = chart.arrows.iter().filter(|a| a.from == to).collect();
        let guards = || branches.iter().filter(|b| !b.otherwise).filter_map(|b| b.when.clone());
        for branch in &branches {
            let own = match branch.otherwise {
                true => expr::all(guards().map(expr::not)),
                false => branch.when.clone(),
            };
            let when = expr::all(way.when.clone().into_iter().chain(own));
            let trigger = match (&way.trigger, &when) {
                (Trigger::Unsaid, Some(_)) => Trigger::Eventless,
                (trigger, _) => trigger.clone(),
            };
            self.follow(Way { trigger, when, to: branch.to, ..way }, choices + 1, ways);
        }
    }

    /// Ways that exclude each other: what is tried first is left out of the conditions of what is tried later.
    fn apart(&mut self, leaf: usize, ways: Vec<Way>) -> Vec<Way> {
        let mut kept: Vec<Way> = Vec::new();
        // What each was drawn with, and what it comes to, as text.
        let mut drawn: Vec<(Option<Expr>, String)> = Vec::new();
        for mut way in ways {
            let sooner = |k: &Way| self.chart.ordered || k.level < way.level;
            let rivals =
                |k: &Way| sooner(k) && k.trigger == way.trigger && k.to != way.to && way.trigger != Trigger::Unsaid;
            let earlier: Vec<&Option<Expr>> =
                kept.iter().zip(&drawn).filter(|(k, _)| rivals(k)).map(|(_, (guard, _))| guard).collect();
            if earlier.iter().any(|guard| guard.is_none()) {
                continue;
            }
            if earlier.len() > MOST_CONDITIONS {
                self.refuse(leaf, "one event leads to too many states, each on a condition of its own");
                return Vec::new();
            }
            let guard = way.when.take();
            let not = earlier.into_iter().flatten().map(|other| expr::not(other.clone()));
            way.when = expr::all(guard.clone().into_iter().chain(not));
            let text = way.when.as_ref().map(print_expr).unwrap_or_default();
            let alike = |(k, (_, known)): (&Way, &(Option<Expr>, String))| {
                k.trigger == way.trigger && k.to == way.to && *known == text
            };
            if !kept.iter().zip(&drawn).any(alike) {
                kept.push(way);
                drawn.push((guard, text));
            }
        }
        kept
    }

    /// Leaves that are left as soon as they are entered, with where to.
    fn transient(&mut self) -> BTreeMap<usize, usize> {
        let at_once = |ways: &Vec<Way>| {
            let first = ways.iter().find(|w| w.trigger == Trigger::Eventless);
            first.filter(|w| w.when.is_none()).map(|w| w.to)
        };
        let mut goes: BTreeMap<usize, usize> =
            self.ways.iter().filter_map(|(l, ways)| Some((*l, at_once(ways)?))).collect();
        for leaf in goes.clone().into_keys() {
            let (mut to, mut steps) = (leaf, 0);
            while let Some(next) = goes.get(&to) {
                (to, steps) = (*next, steps + 1);
                if steps > self.leaves.len() {
                    self.refuse(leaf, "it is left at once, and so on in a circle");
                    return BTreeMap::new();
                }
            }
            goes.insert(leaf, to);
        }
        goes
    }

    fn write(mut self, name: &str, sheet: &mut Sheet) {
        let initial = self.entered(self.root);
        if self.leaves.is_empty() || self.kind(initial) == Kind::Choice {
            return self.refuse(self.root, "it has no state to begin in");
        }
        self.find_ways();
        let goes = self.transient();
        if self.failed {
            return;
        }
        let end = |leaf: usize| goes.get(&leaf).copied().unwrap_or(leaf);
        let mut taken = Taken::default();
        let kept: Vec<usize> = self.leaves.iter().copied().filter(|l| !goes.contains_key(l)).collect();
        let names: BTreeMap<usize, String> =
            kept.iter().map(|l| (*l, taken.take(&slug(&self.chart.nodes[*l].id)))).collect();
        let name_of = |leaf: usize| names.get(&end(leaf)).cloned().unwrap_or_default();
        // The arrows of a flat chart keep their order; otherwise those that leave a state stand together.
        let is_flat = kept.iter().all(|l| self.chart.nodes[*l].parent == self.root);
        let mut edges = Vec::new();
        let mut unsaid = BTreeSet::new();
        let mut delayed = None;
        for leaf in &kept {
            for way in self.ways.get(leaf).into_iter().flatten() {
                let to = end(way.to);
                let own = self.chart.nodes.get(to).map(|n| n.own.clone()).unwrap_or_default();
                let on = match &way.trigger {
                    Trigger::Event(event) => Some(event.clone()),
                    _ => None,
                };
                let is_unsaid = matches!(way.trigger, Trigger::Unsaid | Trigger::Done) && way.when.is_none();
                if is_unsaid && own.on.is_none() && own.when.is_none() {
                    unsaid.insert(to);
                }
                if way.trigger == Trigger::Eventless && self.chart.ordered {
                    delayed = delayed.or(Some(*leaf));
                }
                // What the state says itself need not be said at its arrows.
                let same = |a: &Expr, b: &Option<Expr>| b.as_ref().is_some_and(|b| print_expr(a) == print_expr(b));
                let edge = Edge {
                    from: name_of(*leaf),
                    to: name_of(to),
                    when: way.when.clone().filter(|w| !same(w, &own.when)),
                    on: on.filter(|on| own.on.as_ref() != Some(on)),
                };
                edges.push((if is_flat { way.arrow } else { 0 }, edge));
            }
        }
        edges.sort_by_key(|(arrow, _)| *arrow);
        let mut edges: Vec<Edge> = edges.into_iter().map(|(_, edge)| edge).collect();
        edges.dedup();
        self.mention_delay(delayed);
        let annotation = self.chart.nodes.get(self.root).and_then(|n| n.annotation.as_ref());
        if annotation.is_some() {
            unsaid.clear();
        }
        let heard: BTreeSet<String> = edges.iter().filter_map(|e| e.on.clone()).collect();
        let mut states: Vec<State> = kept
            .iter()
            .map(|l| {
                let own = self.chart.nodes[*l].own.clone();
                State { name: name_of(*l), on: own.on, when: own.when, bounds: own.bounds }
            })
            .collect();
        let mut told = Vec::new();
        for state in &mut states {
            if unsaid.iter().any(|l| name_of(*l) == state.name) {
                let event =
                    if heard.contains(&state.name) { format!("{}_state", state.name) } else { state.name.clone() };
                told.push(state.name.clone());
                state.on = Some(event);
            }
        }
        self.mention_unsaid(&unsaid, &told);
        let events =
            states.iter_mut().filter_map(|s| s.on.as_mut()).chain(edges.iter_mut().filter_map(|e| e.on.as_mut()));
        events.for_each(|event| declare(sheet, event));
        let name = sheet.taken.take(&slug(name));
        let (sample, else_stay) = annotation.map_or((None, false), |a: &Annotation| (a.sample.clone(), a.else_stay));
        let remarks = self.remarks(&name, &name_of);
        let machine = Machine { name, remarks, sample, initial: name_of(initial), states, else_stay, edges };
        sheet.items.push(Item::Machine(machine));
    }

    /// A line for each state that holds others: which states of the machine it is.
    fn remarks(&self, name: &str, name_of: &dyn Fn(usize) -> String) -> Vec<String> {
        let holds = |n: &usize| {
            *n != self.root
                && self.chart.is_in(*n, self.root)
                && self.chart.nodes.get(*n).is_some_and(|n| !n.children.is_empty())
        };
        let line = |n: usize| {
            let mut inside: Vec<String> = self
                .leaves
                .iter()
                .filter(|l| self.chart.is_in(**l, n))
                .map(|l| format!("{name} == {}", name_of(*l)))
                .collect();
            inside.dedup();
            format!("{} is: {}", self.chart.nodes[n].id, inside.join(" or "))
        };
        (0..self.chart.nodes.len()).filter(holds).map(line).collect()
    }

    fn mention_unsaid(&mut self, unsaid: &BTreeSet<usize>, names: &[String]) {
        let Some(first) = unsaid.first().and_then(|n| self.chart.nodes.get(*n)) else { return };
        let span = self.report.span(first.place.start, first.place.end);
        let list = names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
        let message = format!("nothing says when the robot is in {list}");
        self.report.push(
            Diagnostic::new(Code::ImportTrigger, span, message)
                .label("entered on an event of its name")
                .help("write a condition in its place, `state NAME when …`, or let the robot tell the event"),
        );
    }

    fn mention_delay(&mut self, leaf: Option<usize>) {
        let Some(node) = leaf.and_then(|l| self.chart.nodes.get(l)) else { return };
        let span = self.report.span(node.place.start, node.place.end);
        let message = format!("`{}` is left when a condition holds, without an event", node.id);
        self.report.push(
            Diagnostic::new(Code::ImportDiffers, span, message)
                .label("SCXML looks at it as soon as the state is entered, a machine at the next instant"),
        );
    }
}

/// Declares an event that is told by its name; one whose name something else has gets another.
fn declare(sheet: &mut Sheet, name: &mut String) {
    let mut event = Event { name: name.clone(), source: None, when: None, below: None };
    if !sheet.events.contains(&event) {
        event.name = sheet.taken.take(name);
        *name = sheet.event(event);
    }
}
