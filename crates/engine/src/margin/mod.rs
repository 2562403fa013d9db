//! Margins: by how much a property missed changing its verdict.
//!
//! A comparison counts with its signed distance to changing, everything else that is true or false with ±∞; `and` and `always` take
//! the least, `or` and `eventually` the greatest, `not` the negative. What met NaN is skipped: NaN stands for it throughout, and
//! `f64::min` and `f64::max` skip it of themselves.
//!
//! Formulas without future operators are computed as positions come ([`memory`]). What must hold at every position needs no more than
//! the least so far; the rest is stored, column by column, and evaluated at the end ([`duties`], [`terms`], [`scopes`]): the trace is
//! taken as it is, as if it were all.

mod curve;
mod duties;
mod memory;
mod peak;
pub mod plan;
mod scopes;
mod terms;

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::node::{Notes, View};
use memory::Memory;
use plan::{Column, Plan};
use terms::{Span, Stored};

/// What is true by itself has nothing to lose.
const CERTAIN: f64 = f64::INFINITY;
const IMPOSSIBLE: f64 = f64::NEG_INFINITY;

fn certain(holds: bool) -> f64 {
    if holds { CERTAIN } else { IMPOSSIBLE }
}

fn opposite(margin: f64) -> f64 {
    // Zero stays what it is, without a sign.
    0.0 - margin
}

/// The margins of one instance of a group.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Margins {
    meters: Vec<Meter>,
    /// The stamps of all positions, where something is stored.
    stamps: Vec<i64>,
    stores: bool,
    /// How many values may be stored of a property.
    limit: usize,
}

/// The margin of one property so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Meter {
    registers: Vec<f64>,
    memories: Vec<Memory>,
    least: f64,
    columns: Vec<Vec<f64>>,
    /// More would have been stored than is allowed.
    gave_up: bool,
}

/// What became of a margin.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct Measured {
    pub margin: Option<f64>,
    /// It would have taken more memory than is allowed.
    pub gave_up: bool,
}

impl Margins {
    /// Nothing has come yet; `view` is on the world before anything has.
    pub fn new(plans: &[Plan], limit: usize, view: View<'_>) -> Margins {
        let quiet = Notes::default();
        let view = View { notes: &quiet, ..view };
        let meters = plans.iter().map(|plan| Meter::new(plan, &view)).collect();
        Margins { meters, stamps: Vec::new(), stores: plans.iter().any(|plan| !plan.duties.is_empty()), limit }
    }

    /// One of so many instances: the memory is shared.
    pub fn share(&mut self, instances: usize) {
        self.limit /= instances.max(1);
    }

    /// An instant has been computed: a position, or one before the first.
    pub fn step(&mut self, plans: &[Plan], view: View<'_>, is_position: bool) {
        // What the comparisons remark was remarked when their truth was computed.
        let quiet = Notes::default();
        let view = View { notes: &quiet, ..view };
        if is_position && self.stores {
            self.stamps.push(view.now);
        }
        for (meter, plan) in self.meters.iter_mut().zip(plans) {
            meter.step(plan, &view, is_position);
            if self.stamps.len().saturating_mul(plan.columns.len()) > self.limit {
                meter.give_up();
            }
        }
    }

    /// The margin of a property, taking the trace, whose last stamp is `last`, as it is.
    pub fn of(&self, plans: &[Plan], property: usize, last: i64) -> Measured {
        let of_property = plans.iter().zip(&self.meters).find(|(plan, _)| plan.property == property);
        of_property.map_or_else(Measured::default, |(plan, meter)| meter.measured(plan, &self.stamps, last))
    }
}

impl Meter {
    fn new(plan: &Plan, view: &View<'_>) -> Meter {
        let mut memories: Vec<_> = plan.ops.iter().map(Memory::new).collect();
        let mut registers = alloc::vec![f64::NAN; plan.ops.len()];
        memory::prime(&plan.ops, &mut memories, &mut registers, view);
        let columns = alloc::vec![Vec::new(); plan.columns.len()];
        Meter { registers, memories, least: f64::NAN, columns, gave_up: false }
    }

    fn step(&mut self, plan: &Plan, view: &View<'_>, is_position: bool) {
        let Meter { registers, memories, least, columns, .. } = self;
        if self.gave_up {
            return;
        }
        memory::run(&plan.ops, memories, registers, view, is_position);
        if is_position {
            *least = plan.least.iter().fold(*least, |least, reg| least.min(registers[*reg as usize]));
            for (column, values) in plan.columns.iter().zip(columns) {
                values.push(match column {
                    Column::Margin(reg) => registers[*reg as usize],
                    Column::Truth(bit) => certain(view.bool(*bit)),
                });
            }
        }
    }

    fn give_up(&mut self) {
        self.gave_up = true;
        self.columns = Vec::new();
    }

    fn measured(&self, plan: &Plan, stamps: &[i64], last: i64) -> Measured {
        if self.gave_up {
            return Measured { margin: None, gave_up: true };
        }
        let stored = Stored { stamps, columns: &self.columns, last, is_truth: false };
        let whole = Span { from: 0, to: stamps.len(), is_cut: true };
        let others = if stamps.is_empty() { f64::NAN } else { stored.least(&plan.duties, whole, true) };
        let least = self.least.min(others);
        Measured { margin: (!least.is_nan()).then_some(least), gave_up: false }
    }
}
