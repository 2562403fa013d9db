//! Rows of truth values, for a program that is one group which rests: most rows are taken in by comparing them with the row before, as
//! a word.

use lapwing_stream::{Time, Value};

use crate::group::When;
use crate::inputs::Due;
use crate::instances::{Instances, only};
use crate::outcome::{Observer, Output};
use crate::piece::Piece;
use crate::program::{Column, Program, Skim, bits};

/// The latest row, where all of its cells are truth values: a bit for each column, and one above them that tells it from none.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Row(u64);

impl Row {
    /// No row, or one that has to be taken in as any other.
    pub const NONE: Row = Row(0);
    /// The most columns of a row.
    pub const COLUMNS: usize = u64::BITS as usize - 1;

    /// The row of these cells.
    #[inline(always)]
    fn of(columns: &[Column], cells: &[Value]) -> Option<Row> {
        let mut word = 1;
        for column in columns.iter().rev() {
            let Some(Value::Bool(is)) = cells.get(column.cell) else { return None };
            word = (word << 1) | u64::from(*is);
        }
        Some(Row(word))
    }
}

impl Piece {
    /// Takes a row in, at an instant of its own, where that takes no more than a step of a group that rests. Returns whether that was so; else
    /// nothing has happened, and it has to be taken in as any other.
    // PERF: what `take` does, of which nothing is left out but what such a program does not have.
    #[inline(always)]
    pub(crate) fn skim(&mut self, program: &Program, now: i64, cells: &[Value], tell: &mut impl Observer) -> bool {
        let Some(skim) = &program.skim else { return false };
        if now < self.newest {
            return false;
        }
        let Some(row) = Row::of(&program.columns, cells) else { return false };
        let is_other = row != self.inputs.row;
        if (is_other || now >= self.calm_until) && !self.skim_change(program, skim, row, now, tell) {
            return false;
        }
        (self.newest, self.last_instant) = (now, now);
        self.instants += 1;
        tell.output(&self.inputs, Output::Instant(Time(now)));
        true
    }

    /// A row that is another, or at which a bound may run out.
    #[inline(always)]
    fn skim_change(&mut self, program: &Program, skim: &Skim, row: Row, now: i64, tell: &mut impl Observer) -> bool {
        let Piece { inputs, groups, last_instant, calm_until, .. } = self;
        if inputs.row == Row::NONE {
            return false;
        }
        let toggled = row.0 ^ inputs.row.0;
        inputs.row = row;
        for slot in bits(toggled) {
            if let Some(Value::Bool(is)) = inputs.slots.get_mut(slot) {
                *is = !*is;
            }
        }
        let due = skim.due(toggled);
        if now < *calm_until
            && let Some((core, automaton)) = groups.first_mut().and_then(Instances::alone)
            && let Some(glided) = core.walk.glide(automaton, due.letter, now, *last_instant)
        {
            *calm_until = glided.quiet_until;
            if !skim.is_same(glided.from, glided.to) {
                self.turn(program, glided.from, now, tell);
            }
        } else {
            self.step_row(program, due, now, tell);
        }
        true
    }

    /// A row at which a verdict changes; until it the registers' `word` held.
    #[inline(never)]
    fn turn(&mut self, program: &Program, word: u64, now: i64, tell: &mut impl Observer) {
        let when = When { now, number: self.instants, before: self.last_instant };
        if let Some((plan, _, core)) = only(&program.groups, &mut self.groups) {
            core.turn(plan, &self.inputs, when, word, tell);
        }
    }

    /// A row at which more happens than a move of the automaton that is known.
    #[inline(never)]
    fn step_row(&mut self, program: &Program, due: Due, now: i64, tell: &mut impl Observer) {
        let when = When { now, number: self.instants, before: self.last_instant };
        if let Some((plan, automaton, core)) = only(&program.groups, &mut self.groups) {
            self.calm_until = core.step_at_rest((plan, automaton), &self.inputs, due, when, tell);
        }
    }

    /// Remembers a row that is going to be stepped, if the next ones can be compared with it: then and as long as nothing else comes, the group
    /// rests, and the slots hold what the row says.
    pub(crate) fn note_row(&mut self, program: &Program, cells: &[Value]) {
        let core = only(&program.groups, &mut self.groups).filter(|(_, _, core)| core.rests());
        self.inputs.row = core.and_then(|_| Row::of(&program.columns, cells)).unwrap_or(Row::NONE);
    }
}
