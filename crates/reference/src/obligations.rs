//! The obligations of a property, when each is decided, and the episodes of those that fail (language reference, *Verdicts*).

use crate::course::{Course, Fault};
use crate::future::{End, View};
use crate::truth::Truth;
use lapwing_check::checked::{Bound, Connective, Expr, Kind, Scope};
use lapwing_stream::{Duration, Time};

/// Failed obligations of one segment and one conjunct at consecutive positions.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Episode {
    /// When the obligation began that failed first.
    pub began: Time,
    /// When it failed.
    pub failed: Time,
    /// When the last one failed.
    pub until: Time,
    /// How many failed.
    pub count: usize,
}

/// What became of the obligations of a property in a piece.
#[derive(Clone, Default, PartialEq, Debug)]
pub(crate) struct Tally {
    pub(crate) met: usize,
    pub(crate) failed: usize,
    pub(crate) open: usize,
    pub(crate) episodes: Vec<Episode>,
}

impl Tally {
    /// One obligation of its own that fails when it begins.
    pub(crate) fn fail(&mut self, at: Time) {
        self.fail_since(at, at);
    }

    /// One obligation of its own that began earlier.
    pub(crate) fn fail_since(&mut self, began: Time, at: Time) {
        self.failed += 1;
        self.episodes.push(Episode { began, failed: at, until: at, count: 1 });
    }
}

/// What has to be true for an obligation to be met.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Duty<'e> {
    /// A formula.
    Formula(&'e Expr),
    /// The first implies the second: a position of `whenever`.
    Implies(&'e Expr, &'e Expr),
    /// It holds somewhere in the segment: the X of `until X, φ`.
    Exists(&'e Expr),
}

/// One obligation.
#[derive(Clone, Debug)]
pub(crate) struct Obligation<'e> {
    pub(crate) duty: Duty<'e>,
    /// The position at which it begins.
    pub(crate) at: usize,
    /// The position that closes its segment, where one does.
    pub(crate) end: Option<usize>,
    /// The scopes `before X` around it: it can fail only once all their X have come.
    before: Vec<Awaited>,
    /// Which segment and conjunct it belongs to.
    family: usize,
}

impl Obligation<'_> {
    /// Whether, on the trace as it is, it could fail: every `before X` around it has its X.
    pub(crate) fn can_fail(&self) -> bool {
        self.before.iter().all(|x| x.at.is_some())
    }
}

/// The X of a `before X, φ`.
#[derive(Clone, Copy, Debug)]
struct Awaited {
    /// Where it comes, if it does.
    at: Option<usize>,
    /// The position that closes the segment in which it may come.
    end: Option<usize>,
}

/// A segment of positions, the last of which is that before `end`.
#[derive(Clone, Copy, Debug)]
struct Segment {
    first: usize,
    end: Option<usize>,
}

/// All obligations that a property's formula puts on a course.
pub(crate) fn of<'e>(course: &Course<'_>, formula: &'e Expr) -> Vec<Obligation<'e>> {
    let mut split = Split { course, before: Vec::new(), families: 0, found: Vec::new() };
    if course.len() > 0 {
        split.formula(formula, Segment { first: 0, end: None });
    }
    split.found
}

/// Splits a formula into its obligations.
struct Split<'c, 'e> {
    course: &'c Course<'c>,
    /// The scopes `before X` around what is being split.
    before: Vec<Awaited>,
    families: usize,
    found: Vec<Obligation<'e>>,
}

impl<'e> Split<'_, 'e> {
    /// `φ̂` at the first position of a segment that has one.
    fn formula(&mut self, f: &'e Expr, segment: Segment) {
        match &f.kind {
            _ if !f.has_future() => self.at_each(&[Duty::Formula(f)], &Bound::ALL, segment),
            Kind::Connective(Connective::And, ..) => {
                for part in conjuncts(f) {
                    if part.has_future() {
                        self.formula(part, segment);
                    } else {
                        self.once(Duty::Formula(part), segment);
                    }
                }
            }
            Kind::Always(bound, body) => {
                let duties: Vec<Duty<'e>> = conjuncts(body).into_iter().map(Duty::Formula).collect();
                self.at_each(&duties, bound, segment);
            }
            Kind::Scope(Scope::Whenever, x, body) => self.at_each(&[Duty::Implies(x, body)], &Bound::ALL, segment),
            Kind::Scope(scope, x, body) if !x.has_future() => self.scope(*scope, x, body, segment),
            Kind::AfterUntil(x, y, body) if !x.has_future() && !y.has_future() => {
                self.after_until(x, y, body, segment);
            }
            _ => self.once(Duty::Formula(f), segment),
        }
    }

    /// One obligation per conjunct at each position of the segment that the bound looks at.
    fn at_each(&mut self, duties: &[Duty<'e>], bound: &Bound, segment: Segment) {
        let start = self.course.time(segment.first);
        for duty in duties {
            self.families += 1;
            for at in segment.first..self.upto(segment) {
                if bound.contains(self.course.time(at).since(start)) {
                    self.put(*duty, at, segment);
                }
            }
        }
    }

    /// One obligation at the segment's first position.
    fn once(&mut self, duty: Duty<'e>, segment: Segment) {
        self.families += 1;
        self.put(duty, segment.first, segment);
    }

    fn put(&mut self, duty: Duty<'e>, at: usize, segment: Segment) {
        let before = self.before.clone();
        self.found.push(Obligation { duty, at, end: segment.end, before, family: self.families });
    }

    fn scope(&mut self, scope: Scope, x: &'e Expr, body: &'e Expr, segment: Segment) {
        let first = self.first(x, segment.first, segment);
        match scope {
            Scope::After => {
                if let Some(first) = first {
                    self.formula(body, Segment { first, ..segment });
                }
            }
            Scope::Until => {
                self.once(Duty::Exists(x), segment);
                self.up_to(first, body, segment);
            }
            Scope::Before => {
                self.before.push(Awaited { at: first, end: segment.end });
                self.up_to(first, body, segment);
                self.before.pop();
            }
            Scope::While => self.while_(x, body, segment),
            Scope::Whenever => {}
        }
    }

    /// The body from the segment's beginning to the first X, or to its end.
    fn up_to(&mut self, x: Option<usize>, body: &'e Expr, segment: Segment) {
        let end = x.or(segment.end);
        if end != Some(segment.first) {
            self.formula(body, Segment { end, ..segment });
        }
    }

    fn while_(&mut self, x: &'e Expr, body: &'e Expr, segment: Segment) {
        let mut from = segment.first;
        while let Some(first) = self.first(x, from, segment) {
            let stop = (first..self.upto(segment)).find(|&j| !self.course.holds(x, j as i64));
            self.formula(body, Segment { first, end: stop.or(segment.end) });
            match stop {
                Some(stop) => from = stop,
                None => return,
            }
        }
    }

    fn after_until(&mut self, x: &'e Expr, y: &'e Expr, body: &'e Expr, segment: Segment) {
        let mut from = segment.first;
        while let Some(first) = self.first(x, from, segment) {
            let stop = self.first(y, first, segment);
            if stop != Some(first) {
                self.formula(body, Segment { first, end: stop.or(segment.end) });
            }
            match stop {
                Some(stop) => from = stop + 1,
                None => return,
            }
        }
    }

    fn upto(&self, segment: Segment) -> usize {
        segment.end.unwrap_or(self.course.len())
    }

    fn first(&self, x: &Expr, from: usize, segment: Segment) -> Option<usize> {
        (from..self.upto(segment)).find(|&j| self.course.holds(x, j as i64))
    }

    /// Whether a trace that goes on may put further obligations.
    fn may_grow(&self, f: &Expr, segment: Segment) -> bool {
        if segment.end.is_some() {
            return false;
        }
        match &f.kind {
            _ if !f.has_future() => true,
            Kind::Connective(Connective::And, ..) => {
                conjuncts(f).into_iter().any(|part| part.has_future() && self.may_grow(part, segment))
            }
            Kind::Always(bound, _) => self.course.may_still_reach(bound, segment.first),
            Kind::Scope(Scope::Whenever, ..) => true,
            Kind::Scope(scope, x, body) if !x.has_future() => {
                let first = self.first(x, segment.first, segment);
                match (scope, first) {
                    (Scope::After, Some(first)) => self.may_grow(body, Segment { first, ..segment }),
                    (Scope::After | Scope::While | Scope::Whenever, _) => true,
                    (Scope::Until | Scope::Before, Some(_)) => false,
                    (Scope::Until | Scope::Before, None) => self.may_grow(body, segment),
                }
            }
            Kind::AfterUntil(x, y, _) => !x.has_future() && !y.has_future(),
            _ => false,
        }
    }
}

/// Whether a trace that goes on may put further obligations of a formula.
pub(crate) fn may_grow(course: &Course<'_>, formula: &Expr) -> bool {
    let split = Split { course, before: Vec::new(), families: 0, found: Vec::new() };
    course.len() == 0 || split.may_grow(formula, Segment { first: 0, end: None })
}

/// A conjunction with a future operator splits, grouped to the left as it is; anything else is one part.
fn conjuncts(f: &Expr) -> Vec<&Expr> {
    match &f.kind {
        Kind::Connective(Connective::And, left, right) if f.has_future() => {
            let mut parts = conjuncts(left);
            parts.extend(conjuncts(right));
            parts
        }
        _ => vec![f],
    }
}

/// A moment at which something may be decided: what is seen by then, and the time that is reported.
#[derive(Clone, Copy, Debug)]
struct Moment {
    at: Time,
    seen: usize,
    rest: (Time, bool),
}

/// What became of an obligation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Fate {
    Met,
    Failed(Time),
    /// Still open; what it would be if the trace, as it is, were all.
    Open(Truth),
}

/// All moments of a course at which an obligation of the formula may be decided, in order.
///
/// At each stamp first time reaches it, then its positions are looked at one by one, then time goes beyond it.
fn moments(course: &Course<'_>, formula: &Expr) -> Vec<Moment> {
    let mut bounds = Vec::new();
    deadlines(formula, &mut bounds);
    let mut stamps: Vec<Time> = (0..course.len()).map(|k| course.time(k)).collect();
    let ends: Vec<Time> = stamps.iter().flat_map(|&t| bounds.iter().map(move |&d| t + d)).collect();
    stamps.extend(ends);
    stamps.sort();
    stamps.dedup();

    let last = course.piece.last;
    let mut moments = Vec::new();
    for at in stamps.into_iter().filter(|&t| t <= last) {
        let earlier = (0..course.len()).filter(|&k| course.time(k) < at).count();
        let now = (0..course.len()).filter(|&k| course.time(k) == at).count();
        moments.extend((0..=now).map(|n| Moment { at, seen: earlier + n, rest: (at, false) }));
        if at < last {
            moments.push(Moment { at, seen: earlier + now, rest: (at, true) });
        }
    }
    moments
}

/// The upper ends of all bounds of future operators.
fn deadlines(f: &Expr, found: &mut Vec<Duration>) {
    if let Kind::Always(bound, _) | Kind::Eventually(bound, _) | Kind::Until(bound, ..) = &f.kind {
        found.extend(bound.hi);
    }
    for child in f.children() {
        deadlines(child, found);
    }
}

impl Course<'_> {
    /// Whether positions still to come may lie within the bound of an `always` at position `k`.
    fn may_still_reach(&self, bound: &Bound, k: usize) -> bool {
        let deadline = bound.hi.map(|hi| self.time(k) + hi);
        deadline.is_none_or(|d| if bound.hi_closed { self.piece.last <= d } else { self.piece.last < d })
    }

    /// The value of an obligation in a view whose end is that of the trace so far.
    fn value_of(&self, o: &Obligation<'_>, trace: View) -> Truth {
        let end = match o.end {
            Some(end) if end < trace.seen => End::At(end),
            _ => trace.end,
        };
        let view = View { end, ..trace };
        let value = match o.duty {
            Duty::Formula(f) => self.truth(f, o.at, view),
            Duty::Implies(x, f) => self.truth(x, o.at, view).implies(self.truth(f, o.at, view)),
            Duty::Exists(x) => self.exists(x, o.at, view),
        };
        o.before.iter().fold(value, |value, x| (!x.came(trace)).or(value))
    }

    /// Finds the first moment at which an obligation is decided.
    fn fate(&self, o: &Obligation<'_>, moments: &[Moment]) -> Fate {
        for moment in moments.iter().filter(|m| m.seen > o.at) {
            match self.value_of(o, View { seen: moment.seen, sure: usize::MAX, rest: moment.rest, end: End::Open }) {
                Truth::True => return Fate::Met,
                Truth::False => return Fate::Failed(moment.at),
                Truth::Unknown => {}
            }
        }
        Fate::Open(self.value_of(o, self.whole()))
    }

    /// The whole trace, taken as all there is.
    pub(crate) fn whole(&self) -> View {
        View { seen: self.len(), sure: usize::MAX, rest: (self.piece.last, false), end: End::Cut }
    }
}

impl Awaited {
    /// Whether the X has come.
    fn came(&self, trace: View) -> Truth {
        match (self.at, self.end, trace.end) {
            (Some(at), _, _) if at < trace.seen => Truth::True,
            (_, Some(end), _) if end < trace.seen => Truth::False,
            (_, _, End::Open) => Truth::Unknown,
            (_, _, End::At(_) | End::Cut) => Truth::False,
        }
    }
}

/// What became of the obligations of a property.
pub(crate) struct Judged {
    pub(crate) tally: Tally,
    /// Whether one that is open would be false if the trace were all.
    pub(crate) unmet: bool,
    /// Whether a trace that goes on may put more.
    pub(crate) may_grow: bool,
}

/// Judges a formula on a course.
pub(crate) fn judge(course: &Course<'_>, formula: &Expr) -> Judged {
    course.compute_everything(formula);
    let mut moments = moments(course, formula);
    let spoilt = course.spoilt();
    // From a value of a wrong kind on nothing is judged.
    let sound = |m: &Moment, fault: &Fault| m.seen <= fault.position && fault.before.is_none_or(|time| m.at < time);
    moments.retain(|m| spoilt.as_ref().is_none_or(|fault| sound(m, fault)));
    let obligations = of(course, formula);
    let fates: Vec<Fate> = obligations.iter().map(|o| course.fate(o, &moments)).collect();
    let count = |wanted: fn(&Fate) -> bool| fates.iter().filter(|f| wanted(f)).count();
    let open_and_false = fates.contains(&Fate::Open(Truth::False));
    // Events alone, and none occurred: there is no obligation yet, but the formula still has a value.
    let nothing_came = course.len() == 0 && course.without_position(formula) == Truth::False;
    Judged {
        tally: Tally {
            met: count(|f| *f == Fate::Met),
            failed: count(|f| matches!(f, Fate::Failed(_))),
            open: if spoilt.is_some() { 0 } else { count(|f| matches!(f, Fate::Open(_))) },
            episodes: episodes(course, &obligations, &fates),
        },
        unmet: open_and_false || nothing_came,
        may_grow: may_grow(course, formula),
    }
}

/// Gathers the failed obligations of one family at consecutive positions.
fn episodes(course: &Course<'_>, obligations: &[Obligation<'_>], fates: &[Fate]) -> Vec<Episode> {
    let mut episodes: Vec<Episode> = Vec::new();
    let mut before: Option<(usize, usize)> = None;
    // The obligations of a family stand side by side, in the order of their positions.
    for (o, fate) in obligations.iter().zip(fates) {
        let Fate::Failed(failed) = *fate else { continue };
        let began = course.time(o.at);
        match episodes.last_mut() {
            Some(episode) if before.is_some_and(|(family, at)| family == o.family && at + 1 == o.at) => {
                if failed < episode.failed {
                    (episode.began, episode.failed) = (began, failed);
                }
                episode.until = episode.until.max(failed);
                episode.count += 1;
            }
            _ => episodes.push(Episode { began, failed, until: failed, count: 1 }),
        }
        before = Some((o.family, o.at));
    }
    episodes.sort_by_key(|e| (e.failed, e.began));
    episodes
}
