//! Margins over time, for who wants to draw them: by how much the obligations that begin at a position miss changing the verdict.

use lapwing_stream::Time;

use super::terms::{Span, Stored};
use super::{Margins, Meter};
use crate::group::Core;
use crate::outcome::Observer;
use crate::program::Group;

impl Core {
    /// Tells the margins that are known at the present position.
    #[cold]
    pub(crate) fn tell_margins(&self, plan: &Group, now: i64, tell: &mut impl Observer) {
        let Some(margins) = self.margins.as_ref().filter(|_| self.is_instance) else { return };
        for (plan, meter) in plan.margins.iter().zip(&margins.meters).filter(|(plan, _)| !plan.least.is_empty()) {
            let least = plan.least.iter().fold(f64::NAN, |least, reg| least.min(meter.registers[*reg as usize]));
            tell.margin(plan.property, &self.key, Time(now), least);
        }
    }

    /// The trace is over: tells the margins that depended on what came later, position by position.
    pub(crate) fn tell_late_margins(&self, plan: &Group, last: i64, tell: &mut impl Observer) {
        let Some(margins) = self.margins.as_ref().filter(|_| self.is_instance) else { return };
        for (plan, meter) in plan.margins.iter().zip(&margins.meters) {
            for (stamp, margin) in margins.stamps.iter().zip(meter.late(plan, margins, last)) {
                tell.margin(plan.property, &self.key, Time(*stamp), margin);
            }
        }
    }
}

impl Meter {
    /// For each position the least margin of the obligations that begin there, NaN where none does; nothing where none is stored.
    fn late(&self, plan: &super::plan::Plan, margins: &Margins, last: i64) -> alloc::vec::Vec<f64> {
        if plan.duties.is_empty() || self.gave_up || margins.stamps.is_empty() {
            return alloc::vec::Vec::new();
        }
        let mut curve = alloc::vec![f64::NAN; margins.stamps.len()];
        let stored = Stored { stamps: &margins.stamps, columns: &self.columns, last, is_truth: false };
        let whole = Span { from: 0, to: margins.stamps.len(), is_cut: true };
        stored.obligations(&plan.duties, whole, true, &mut |position, margin| {
            curve[position] = curve[position].min(margin);
        });
        curve
    }
}
