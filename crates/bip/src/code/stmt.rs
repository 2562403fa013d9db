//! What statements do.

use super::{Address, Bool, Bound, Call, Context, Eval, Float, Int, Object, Slot};

/// A statement.
#[derive(Clone, Debug)]
pub(crate) enum Stmt {
    Bool(Slot, Bool),
    Int(Slot, Int),
    Float(Slot, Float),
    Object(Slot, Object),
    /// A clock is set.
    Clock(Slot, Bound),
    /// A clock goes at another rate, in 10⁻⁹.
    Rate(Slot, i64),
    Call(Call),
    If(Bool, Box<[Stmt]>, Box<[Stmt]>),
}

impl Stmt {
    /// Carries out one after the other.
    pub fn run<A: Address>(body: &[Stmt], at: A, cx: &mut Context<'_>) -> Eval<()> {
        for stmt in body {
            stmt.exec(at, cx)?;
        }
        Ok(())
    }

    fn exec<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<()> {
        match self {
            Stmt::Bool(slot, value) => {
                let value = value.eval(at, cx)?;
                set(at, cx, *slot, u64::from(value));
            }
            Stmt::Int(slot, value) => {
                let value = value.eval(at, cx)?;
                set(at, cx, *slot, value as u64);
            }
            Stmt::Float(slot, value) => {
                let value = value.eval(at, cx)?;
                set(at, cx, *slot, value.to_bits());
            }
            Stmt::Object(slot, value) => {
                let value = value.eval(at, cx)?;
                if let Some(place) = cx.memory.objects.get_mut(at.object(*slot)) {
                    *place = value;
                }
            }
            Stmt::Clock(slot, value) => {
                let (value, now) = (value.eval(at, cx)?, cx.now);
                if let Some(clock) = cx.memory.clocks.get_mut(at.clock(*slot)) {
                    clock.set(now, value);
                }
            }
            Stmt::Rate(slot, rate) => {
                let now = cx.now;
                if let Some(clock) = cx.memory.clocks.get_mut(at.clock(*slot)) {
                    clock.set_rate(now, *rate);
                }
            }
            Stmt::Call(call) => drop(call.eval(at, cx)?),
            Stmt::If(condition, then, otherwise) => {
                let body = if condition.eval(at, cx)? { then } else { otherwise };
                Stmt::run(body, at, cx)?;
            }
        }
        Ok(())
    }
}

#[inline]
fn set<A: Address>(at: A, cx: &mut Context<'_>, slot: Slot, value: u64) {
    if let Some(cell) = cx.memory.cells.get_mut(at.cell(slot)) {
        *cell = value;
    }
}
