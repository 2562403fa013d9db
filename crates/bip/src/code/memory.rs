//! Where variables and clocks live.

use super::Slot;
use crate::value::{Type, Value};

/// All variables and clocks of a model.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    /// Truth values, whole numbers and the bits of doubles.
    pub cells: Vec<u64>,
    /// Texts and what belongs to the host.
    pub objects: Vec<Value>,
    pub clocks: Vec<Clock>,
}

impl Memory {
    /// A place for a variable, with a value in it.
    pub fn allocate(&mut self, ty: Type, value: &Value) -> u32 {
        if ty.is_plain() {
            self.cells.push(bits(value));
            self.cells.len() as u32 - 1
        } else {
            self.objects.push(value.clone());
            self.objects.len() as u32 - 1
        }
    }

    /// The value of a variable.
    pub fn get(&self, ty: Type, at: u32) -> Value {
        let cell = self.cells.get(at as usize).copied().unwrap_or(0);
        match ty {
            Type::Bool => Value::Bool(cell != 0),
            Type::Int => Value::Int(cell as i64),
            Type::Float => Value::Float(f64::from_bits(cell)),
            _ => self.objects.get(at as usize).cloned().unwrap_or_default(),
        }
    }

    /// Sets a variable.
    pub fn set(&mut self, ty: Type, at: u32, value: &Value) {
        if ty.is_plain() {
            let cell = if ty == Type::Float { value.as_float().unwrap_or(0.0).to_bits() } else { bits(value) };
            if let Some(place) = self.cells.get_mut(at as usize) {
                *place = cell;
            }
        } else if let Some(place) = self.objects.get_mut(at as usize) {
            place.clone_from(value);
        }
    }
}

fn bits(value: &Value) -> u64 {
    match value {
        Value::Bool(value) => u64::from(*value),
        Value::Int(value) => *value as u64,
        Value::Float(value) => value.to_bits(),
        _ => 0,
    }
}

/// Where the variables of a piece of code lie in memory.
pub(crate) trait Address: Copy {
    fn cell(self, slot: Slot) -> usize;
    fn object(self, slot: Slot) -> usize;
    fn clock(self, slot: Slot) -> usize;
}

/// The variables of an atom: one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Base {
    pub cells: u32,
    pub objects: u32,
    pub clocks: u32,
}

impl Address for Base {
    #[inline]
    fn cell(self, slot: Slot) -> usize {
        (self.cells + slot) as usize
    }

    #[inline]
    fn object(self, slot: Slot) -> usize {
        (self.objects + slot) as usize
    }

    #[inline]
    fn clock(self, slot: Slot) -> usize {
        (self.clocks + slot) as usize
    }
}

/// The variables of a connector: its own, and those of the ports that take part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Table<'a> {
    pub cells: &'a [u32],
    pub objects: &'a [u32],
}

impl Address for Table<'_> {
    #[inline]
    fn cell(self, slot: Slot) -> usize {
        self.cells.get(slot as usize).map_or(usize::MAX, |c| *c as usize)
    }

    #[inline]
    fn object(self, slot: Slot) -> usize {
        self.objects.get(slot as usize).map_or(usize::MAX, |o| *o as usize)
    }

    /// Connectors have no clocks.
    fn clock(self, _: Slot) -> usize {
        usize::MAX
    }
}

/// What the value of a clock is counted in: 10⁻⁹ ns, so that decimal rates of up to nine digits are exact.
pub(crate) const FINE: i128 = 1_000_000_000;

/// A clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// When it was last set, or its rate changed.
    pub since: i64,
    /// What it showed then, in 10⁻⁹ ns.
    pub shown: i128,
    /// How fast it goes, in 10⁻⁹: never negative.
    pub rate: i64,
}

impl Default for Clock {
    fn default() -> Clock {
        Clock { since: 0, shown: 0, rate: FINE as i64 }
    }
}

impl Clock {
    /// What it shows at a moment, in 10⁻⁹ ns.
    pub fn at(&self, now: i64) -> i128 {
        self.shown.saturating_add(i128::from(now.saturating_sub(self.since)) * i128::from(self.rate))
    }

    /// Sets it, in 10⁻⁹ ns.
    pub fn set(&mut self, now: i64, shown: i128) {
        self.since = now;
        self.shown = shown;
    }

    pub fn set_rate(&mut self, now: i64, rate: i64) {
        self.shown = self.at(now);
        self.since = now;
        self.rate = rate;
    }
}
