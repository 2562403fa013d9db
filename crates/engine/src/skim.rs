//! Rows of truth values, for a program that is one automaton over them: most rows are taken in by comparing them with the row before, as
//! a word.

use lapwing_stream::{Time, Value};

use crate::outcome::{Observer, Output};
use crate::piece::Piece;
use crate::program::{Column, Program, bits};

/// The latest row, a bit for each column and [`Row::MARK`], where all of its cells are truth values; else zero.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Row(u64);

impl Row {
    /// What tells a row from none.
    const MARK: u64 = 1 << Self::COLUMNS;
    /// The most columns of a row.
    pub const COLUMNS: u32 = u64::BITS - 1;

    /// A row whose cells are truth values, at most so many.
    #[inline(always)]
    fn of(columns: &[Column], cells: &[Value]) -> Option<Row> {
        let mut word = Self::MARK;
        for (i, column) in columns.iter().enumerate() {
            let Some(Value::Bool(is)) = cells.get(column.cell) else { return None };
            word |= u64::from(*is) << i;
        }
        Some(Row(word))
    }
}

impl Piece {
    /// Takes a row in, at an instant of its own, if all that it takes is a move of the automaton that is known. Returns whether that was so;
    /// else it has to be taken in as any other.
    // PERF: what `take` does, of which nothing is left out but what such a program does not have.
    #[inline(always)]
    pub(crate) fn skim(&mut self, program: &Program, now: i64, cells: &[Value], tell: &mut impl Observer) -> bool {
        if program.letters.is_empty() {
            return false;
        }
        let Some(row) = Row::of(&program.columns, cells) else {
            self.inputs.row = Row::default();
            return false;
        };
        let before = core::mem::replace(&mut self.inputs.row, row);
        if (row != before || now >= self.calm_until)
            && (before == Row::default() || !self.skim_change(program, now, row.0 ^ before.0, tell))
        {
            return false;
        }
        (self.newest, self.last, self.last_instant) = (now, Some(now), now);
        self.instants += 1;
        tell.output(&self.inputs, Output::Instant(Time(now)));
        true
    }

    /// A row in which these columns toggle, or at which a bound may run out.
    #[inline(always)]
    fn skim_change(&mut self, program: &Program, now: i64, changed: u64, tell: &mut impl Observer) -> bool {
        if self.inputs.woken {
            return false;
        }
        let letter = toggle(program, changed, &mut self.inputs.slots);
        let is_known = self.glide(program, now, letter, tell);
        if !is_known {
            // As it was: what takes the row in as any other finds out what changed.
            toggle(program, changed, &mut self.inputs.slots);
        }
        is_known
    }
}

/// Toggles the signals of some columns, and gives the letter that they make.
#[inline(always)]
fn toggle(program: &Program, changed: u64, slots: &mut [Value]) -> u32 {
    let mut letter = 0;
    for i in bits(changed) {
        letter ^= program.letters[i];
        if let Some(Value::Bool(is)) = slots.get_mut(program.columns[i].slot) {
            *is = !*is;
        }
    }
    letter
}
