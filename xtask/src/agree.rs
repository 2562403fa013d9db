//! Whether the engine says what the reference says.

use std::fmt;

use lapwing_check::checked::{self, Body, Expr, Kind};
use lapwing_check::compile::compile;
use lapwing_engine::{Ending, Program, State};
use lapwing_reference::{Trace, evaluate};
use lapwing_stream::{Time, Value, Verdict};

/// What both say of a property, as far as it is compared.
#[derive(Clone, PartialEq, Debug)]
pub struct Said {
    /// The property, with its instance.
    pub name: String,
    /// Its verdict.
    pub verdict: Verdict,
    /// Whether a success is vacuous.
    pub vacuous: bool,
    /// Obligations met, failed and open.
    pub counts: (usize, usize, usize),
    /// `(failed, began, until, count)`
    pub episodes: Vec<(Time, Time, Time, usize)>,
    /// Its margin, to the precision to which both compute it.
    pub margin: Option<Margin>,
}

/// A margin; equal to another that differs by no more than rounding does.
#[derive(Clone, Copy, Debug)]
pub struct Margin(pub f64);

impl PartialEq for Margin {
    fn eq(&self, other: &Margin) -> bool {
        let (a, b) = (self.0, other.0);
        a == b || (a.is_finite() && b.is_finite() && (a - b).abs() <= 1e-12 * a.abs().max(b.abs()))
    }
}

/// How the engine is driven.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Drive {
    /// Straight through, with margins, so that nothing rests.
    Measured,
    /// Straight through without margins.
    Plain,
    /// As [`Drive::Measured`], from a state that was saved as bytes before every sample, the original thrown away.
    SavedMeasured,
    /// As [`Drive::Plain`], in the same way.
    Saved,
}

impl Drive {
    /// All ways.
    pub const ALL: [Drive; 4] = [Drive::Measured, Drive::Plain, Drive::SavedMeasured, Drive::Saved];
    /// Those that take no long time.
    pub const QUICK: [Drive; 2] = [Drive::Measured, Drive::Plain];

    fn measures(self) -> bool {
        matches!(self, Drive::Measured | Drive::SavedMeasured)
    }

    fn saves(self) -> bool {
        matches!(self, Drive::SavedMeasured | Drive::Saved)
    }
}

/// A difference.
#[derive(Clone, Debug)]
pub struct Disagreement {
    /// How the engine was driven.
    pub drive: Drive,
    /// What the reference says.
    pub reference: Vec<Said>,
    /// What the engine says.
    pub engine: Vec<Said>,
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (reference, engine) in self.reference.iter().zip(&self.engine).filter(|(r, e)| r != e) {
            writeln!(f, "reference: {reference:?}\nengine:    {engine:?}")?;
        }
        if self.reference.len() != self.engine.len() {
            let names = |said: &[Said]| said.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
            writeln!(f, "reference: {:?}\nengine:    {:?}", names(&self.reference), names(&self.engine))?;
        }
        Ok(())
    }
}

/// Compares them on one specification and trace.
pub fn agree(spec: &checked::Spec, trace: &Trace, drives: &[Drive]) -> Result<(), Disagreement> {
    let said = reference(spec, trace);
    let program = compile(spec);
    let forget_margins = !has_margins(spec);
    for &drive in drives {
        let (mut reference, mut engine) = (said.clone(), engine(&program, trace, drive));
        if forget_margins || !drive.measures() {
            engine.iter_mut().chain(&mut reference).for_each(|s| s.margin = None);
        }
        if engine != reference {
            return Err(Disagreement { drive, reference, engine });
        }
    }
    Ok(())
}

/// Whether the engine computes margins of all formulas. It does not where a scope opens or closes on a formula in which another opens or
/// closes on a future formula.
fn has_margins(spec: &checked::Spec) -> bool {
    fn openings(e: &Expr) -> Vec<&Expr> {
        match &e.kind {
            Kind::Scope(scope, x, _) if *scope != checked::Scope::Whenever => vec![x],
            Kind::AfterUntil(x, y, _) => vec![x, y],
            _ => Vec::new(),
        }
    }
    fn any(e: &Expr, is: fn(&Expr) -> bool) -> bool {
        is(e) || e.children().into_iter().any(|c| any(c, is))
    }
    fn opens_on_future(e: &Expr) -> bool {
        openings(e).into_iter().any(Expr::has_future)
    }
    fn opens_on_that(e: &Expr) -> bool {
        openings(e).into_iter().any(|x| any(x, opens_on_future))
    }
    spec.properties.iter().all(|p| match &p.body {
        Body::Formula(formula) => !any(formula, opens_on_that),
        _ => true,
    })
}

/// What the reference says.
pub fn reference(spec: &checked::Spec, trace: &Trace) -> Vec<Said> {
    evaluate(spec, trace)
        .into_iter()
        .map(|o| Said {
            name: o.name,
            verdict: o.verdict,
            vacuous: o.vacuous,
            counts: (o.met, o.failed, o.open),
            episodes: o.episodes.iter().map(|e| (e.failed, e.began, e.until, e.count)).collect(),
            margin: o.margin.map(Margin),
        })
        .collect()
}

/// What the engine says.
pub fn engine(program: &Program, trace: &Trace, drive: Drive) -> Vec<Said> {
    let mut state = if drive.measures() { State::with_margins(program) } else { State::new(program) };
    for sample in trace.iter() {
        if drive.saves() {
            state = State::resume(program, &state.save(program)).expect("the engine resumes what it saved");
        }
        state.feed(program, sample, &mut ());
    }
    let ending = Ending { broke_off: trace.broke_off.clone(), lost: trace.lost.clone() };
    let outcomes = state.finish(program, &ending, &mut ());
    outcomes
        .into_iter()
        .map(|o| Said {
            name: format!("{}{}", program.properties[o.property].name, instance(&o.instance)),
            verdict: o.verdict,
            vacuous: o.vacuous,
            counts: (o.met as usize, o.failed as usize, o.open as usize),
            episodes: o.episodes.iter().map(|e| (e.failed, e.began, e.until, e.count as usize)).collect(),
            margin: o.margin.map(Margin),
        })
        .collect()
}

/// `[v]` for each value of an instance.
fn instance(values: &[Value]) -> String {
    let one = |value: &Value| match value {
        Value::Num(x) => format!("[{x}]"),
        Value::Str(s) => format!("[{s}]"),
        Value::Bool(b) => format!("[{b}]"),
        other => format!("[{}]", other.kind()),
    };
    values.iter().map(one).collect()
}
