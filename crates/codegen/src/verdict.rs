//! What is said of the properties: what failed and when, and the verdicts, across jumps back in time as well.

use lapwing_engine::program::{Clock, Group, Judge, Positions};

use crate::assemble::Writer;
use crate::code::{Block, Expr, Stmt, Ty, elem, field, local, since};
use crate::intake::heard;
use crate::interface::{
    CAPACITY, HOLDS, INCONCLUSIVE, NO_CAUSE, NO_VALUE, SATISFIED, STALE, TIME_JUMPED, UNMET, VIOLATED,
};
use crate::machines;
use crate::obligations::Obligations;
use crate::scene::emitter;

/// What the verdict of a property is worked out from.
pub(crate) struct End {
    property: usize,
    /// Adds up what is open and missed.
    tally: Block,
    never_started: Expr,
    full: Expr,
    can_add: Expr,
}

/// What stands for the verdict before the first jump.
const NOBODY: i64 = 5;

impl Writer<'_> {
    /// What is said of the properties, which survives a jump.
    pub fn kept(&mut self) {
        let n = Some(self.properties());
        let mut add = |name: &str, ty: Ty, initial: Expr, doc: &str| self.unit.add(name, ty, n, initial, true, doc);
        add("verdict", Ty::U8, INCONCLUSIVE.into(), "The verdicts, as of the last call of `end`.");
        add("cause", Ty::U8, NO_VALUE.into(), "Why they are inconclusive.");
        add("met", Ty::U64, 0.into(), "Obligations met.");
        add("failed", Ty::U64, 0.into(), "Obligations failed.");
        add("open", Ty::U64, 0.into(), "Obligations open, as of the last call of `end`.");
        add("first_began", Ty::I64, 0.into(), "When the obligation began that failed first.");
        add("first_failed", Ty::I64, 0.into(), "When it failed.");
        add("sealed", Ty::Bool, false.into(), "Whether that was before a jump back in time.");
        add("open_before", Ty::U64, 0.into(), "What was open at jumps back in time.");
        add("verdict_before", Ty::U8, NOBODY.into(), "The verdict until the latest jump; 5 before the first.");
        add("cause_before", Ty::U8, NO_CAUSE.into(), "Its cause.");
        self.unit.add("newest", Ty::I64, None, 0.into(), true, "The latest stamp of any kind.");
        self.unit.add("has_newest", Ty::Bool, None, false.into(), true, "Whether there was one.");
    }

    /// The function that counts failures.
    pub fn fail(&mut self) {
        let (p, at, began) = (local("property"), local("at"), local("began"));
        let body = Block::of(|b| {
            let (failed, first) = (elem("failed", p.clone()), elem("first_failed", p.clone()));
            let first_began = elem("first_began", p.clone());
            let earlier = at.clone().lt(&first) | (at.clone().eq(&first) & began.clone().lt(&first_began));
            b.when(failed.clone().eq(0) | (!elem("sealed", p.clone()) & earlier), |b| {
                b.set(&first, at.clone());
                b.set(&first_began, began.clone());
            });
            b.add(&failed, local("count"));
        });
        let params = [("property", Ty::U32), ("count", Ty::U64), ("at", Ty::I64), ("began", Ty::I64)];
        self.unit.function(
            "fail",
            "So many obligations of a property failed at a time; the oldest of them began then.",
            &params,
            body,
        );
    }

    /// Notes what the verdict of a property is worked out from, one conjunct after the other.
    pub fn end_of(&mut self, group: &Group, of: &Obligations<'_>, property: usize, prefix: &str, spoilt: Expr) {
        let tally = Block::of(|b| {
            of.tally(b, &local("open"), &local("missed"));
            if of.is_missed_if_empty() {
                b.when(!field(format!("{prefix}_walked")), |b| b.set(&local("missed"), true));
            }
        });
        let full = of.full().unwrap_or(Expr::Bool(false)) | spoilt;
        if let Some(end) = self.ends.iter_mut().find(|e| e.property == property) {
            end.tally.0.extend(tally.0);
            end.full = end.full.clone() | full;
            end.can_add = end.can_add.clone() | of.can_add();
            return;
        }
        let never_started = self.never_started(&group.at, prefix);
        self.ends.push(End { property, tally, never_started, full, can_add: of.can_add() });
    }

    /// The verdicts, as if nothing more came.
    pub fn end(&mut self) {
        let mut b = Block::default();
        if let Clock::Rate(rate) = self.program.clock {
            b.repeat(field("has_t0") & field("next_tick").le(field("last")), |b| self.tick(b, rate));
        }
        for (property, plan) in self.program.properties.iter().enumerate() {
            let p = Expr::Int(property as i64);
            let body = Block::of(|b| self.verdict(b, property, plan.judge));
            let name = format!("end_{property}");
            let doc = format!("The verdict of `{}`.", plan.name);
            if self.unit.function(&name, &doc, &[], body) {
                b.call(name, vec![]);
            }
            let before = elem("verdict_before", p.clone());
            b.when(before.clone().le(elem("verdict", p.clone())), |b| {
                b.set(&elem("verdict", p.clone()), before);
                b.set(&elem("cause", p.clone()), elem("cause_before", p.clone()));
            });
        }
        self.unit.function("end", "Works out the verdicts, as if nothing more came.", &[], b);
    }

    fn verdict(&self, b: &mut Block, property: usize, judge: Judge) {
        let p = Expr::Int(property as i64);
        let open = b.var("open", Ty::U64, 0.into());
        let missed = b.var("missed", Ty::Bool, false.into());
        let (never_started, full, can_add) = match judge {
            Judge::Machine(m) => {
                let plan = &self.program.machines[m];
                machines::tally(plan, m, b, &open, &missed);
                let never = self.never_started(&plan.at, &format!("m{m}"));
                let full = self.spoils.get(&m).into_iter().flatten().map(field).fold(Expr::Bool(false), |a, b| a | b);
                (never, full, Expr::Bool(true))
            }
            _ => match self.ends.iter().find(|e| e.property == property) {
                Some(end) => {
                    b.0.extend(end.tally.0.clone());
                    (end.never_started.clone(), end.full.clone(), end.can_add.clone())
                }
                None => (Expr::Bool(true), false.into(), true.into()),
            },
        };
        let say = |verdict: i64, cause: i64| {
            let p = p.clone();
            move |b: &mut Block| {
                b.set(&elem("verdict", p.clone()), verdict);
                b.set(&elem("cause", p.clone()), cause);
            }
        };
        let stale = self.is_stale(property);
        let done = open.clone().eq(0) & !can_add;
        let cascade = [
            (elem("failed", p.clone()).gt(0), VIOLATED, NO_CAUSE),
            (!field("has_last") | never_started, INCONCLUSIVE, NO_VALUE),
            (stale, INCONCLUSIVE, STALE),
            (full, INCONCLUSIVE, CAPACITY),
            (missed.clone(), UNMET, NO_CAUSE),
            (done, SATISFIED, NO_CAUSE),
        ];
        let mut otherwise = Block::of(say(HOLDS, NO_CAUSE));
        for (condition, verdict, cause) in cascade.into_iter().rev() {
            let other = std::mem::take(&mut otherwise);
            otherwise = Block::of(|b| b.branch(condition, say(verdict, cause), |b| *b = other));
        }
        b.0.extend(otherwise.0);
        b.set(&elem("open", p.clone()), elem("open_before", p) + open);
    }

    /// Whether there was no position 0, or, where only the events of machines make positions, none of one of these.
    fn never_started(&self, at: &Positions, prefix: &str) -> Expr {
        let Some(alphabet) = &at.alphabet else { return !field(format!("{prefix}_started")) };
        let mut machines: Vec<usize> = alphabet.iter().filter_map(|&event| emitter(self.program, event)).collect();
        machines.sort_unstable();
        machines.dedup();
        let never = machines.iter().map(|&m| self.never_started(&self.program.machines[m].at, &format!("m{m}")));
        never.fold(Expr::Bool(false), |a, b| a | b)
    }

    /// Whether a signal has been silent for too long, the silence that lasts included.
    fn is_stale(&self, property: usize) -> Expr {
        let of = self.silences().into_iter().filter(|(p, ..)| *p == property);
        let lasting = of.map(|(_, limit, of)| {
            let (heard, has) = heard(self.scene, of);
            let from = field(has).choose(field(heard), field("t0"));
            field("has_t0") & since(&field("last"), &from).gt(limit)
        });
        let lasting = lasting.fold(Expr::Bool(false), |a, b| a | b);
        if lasting == Expr::Bool(false) { lasting } else { field(format!("stale{property}")) | lasting }
    }

    /// Time went back: what has been is judged, and everything starts anew.
    pub fn restart(&mut self) {
        let body = Block::of(|b| {
            b.call("end", vec![]);
            b.each("p", Expr::Int(self.properties() as i64), |b| {
                let p = || local("p");
                b.when(elem("verdict", p()).eq(UNMET), |b| {
                    b.set(&elem("verdict", p()), INCONCLUSIVE);
                    b.set(&elem("cause", p()), TIME_JUMPED);
                });
                b.set(&elem("verdict_before", p()), elem("verdict", p()));
                b.set(&elem("cause_before", p()), elem("cause", p()));
                b.set(&elem("open_before", p()), elem("open", p()));
                b.set(&elem("sealed", p()), elem("failed", p()).gt(0));
            });
            for f in self.unit.fields.iter().filter(|f| !f.is_kept) {
                match f.len {
                    Some(_) => b.0.push(Stmt::Fill(f.name.clone(), f.initial.clone())),
                    None => b.set(&field(&f.name), f.initial.clone()),
                }
            }
        });
        self.unit.function(
            "restart",
            "Time went back: what has been is judged, and everything starts anew.",
            &[],
            body,
        );
    }
}
