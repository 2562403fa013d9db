//! Rows of truth values, for a program that is one automaton over them: most rows are taken in by comparing them with the row before, as
//! a word.

use lapwing_stream::{Time, Value};

use crate::inputs::Inputs;
use crate::outcome::{Observer, Output};
use crate::piece::Piece;
use crate::program::{Column, Program, bits};

/// The latest row, a bit for each column, where all of its cells are truth values.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row(Option<u64>);

impl Piece {
    /// Takes a row in, at an instant of its own, if all that it takes is a move of the automaton that is known. Returns whether that was so;
    /// else it has to be taken in as any other.
    // PERF: what `take` does, of which nothing is left out but what such a program does not have.
    #[inline]
    pub(crate) fn skim(&mut self, program: &Program, now: i64, cells: &[Value], tell: &mut impl Observer) -> bool {
        if program.letters.is_empty() {
            return false;
        }
        let (Row(before), row) = (self.inputs.row, word(&program.columns, cells));
        if row.is_none() || row != before || now >= self.calm_until {
            self.inputs.row = Row(row);
            let changed = row.zip(before).map(|(row, before)| row ^ before);
            if !changed.is_some_and(|changed| self.skim_change(program, now, changed, tell)) {
                return false;
            }
        }
        (self.newest, self.last, self.last_instant) = (now, Some(now), now);
        self.instants += 1;
        tell.output(&self.inputs, Output::Instant(Time(now)));
        true
    }

    /// A row in which these columns toggle, or at which a bound may run out.
    #[inline(always)]
    fn skim_change(&mut self, program: &Program, now: i64, changed: u64, tell: &mut impl Observer) -> bool {
        let letter = bits(changed).fold(0, |letter, column| letter ^ program.letters[column]);
        let toggle_all = |inputs: &mut Inputs| {
            for column in bits(changed) {
                toggle(&mut inputs.slots, &program.columns[column]);
            }
        };
        !self.inputs.woken && self.glide(program, now, letter, toggle_all, tell)
    }
}

/// A row as a word, where its cells are truth values.
#[inline]
fn word(columns: &[Column], cells: &[Value]) -> Option<u64> {
    let mut word = 0;
    for (i, column) in columns.iter().enumerate() {
        let Some(Value::Bool(is)) = cells.get(column.cell) else { return None };
        word |= u64::from(*is) << i;
    }
    Some(word)
}

#[inline(always)]
fn toggle(slots: &mut [Value], column: &Column) {
    if let Some(Value::Bool(is)) = slots.get_mut(column.slot) {
        *is = !*is;
    }
}
