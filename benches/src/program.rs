//! Programs of formulas over columns, and rows for them.

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Program, State};
use lapwing_stream::{Sample, Time, Value, What};

/// The program of some formulas over these columns.
pub fn of<const N: usize>(columns: [&str; N], formulas: &[String]) -> Program {
    let mut sources = SourceMap::default();
    let text: String = formulas.iter().enumerate().map(|(i, formula)| format!("p{i}: {formula}\n")).collect();
    let file = sources.add("bench.rv", text.clone());
    let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
    let shape = TraceShape { columns: columns.map(String::from).to_vec(), schemaless: true, ..TraceShape::default() };
    let checked = check(&sources, &loaded, Some(&shape));
    assert!(!checked.has_errors(), "{text}: {:?}", checked.diagnostics);
    let mut program = compile(&checked.spec);
    // Cells come in the order of the columns; the program numbers those that it reads in its own.
    for column in &mut program.columns {
        let name = &checked.spec.columns[column.cell];
        column.cell = columns.iter().position(|n| n == name).unwrap_or_default();
    }
    program
}

/// A cell of a row.
pub trait Cell: Copy {
    /// As a value.
    fn value(self) -> Value;
    /// Overwrites a value in its place.
    fn put(self, into: &mut Value);
}

impl Cell for bool {
    fn value(self) -> Value {
        Value::Bool(self)
    }

    #[inline]
    fn put(self, into: &mut Value) {
        if let Value::Bool(to) = into {
            *to = self;
        }
    }
}

impl Cell for f64 {
    fn value(self) -> Value {
        Value::Num(self)
    }

    #[inline]
    fn put(self, into: &mut Value) {
        if let Value::Num(to) = into {
            *to = self;
        }
    }
}

/// Feeds rows, a millisecond apart. Both sides of a comparison read the same rows from memory; this one makes values of them in one
/// buffer, as a connector does.
pub fn feed<C: Cell + Default, const N: usize>(state: &mut State, program: &Program, rows: &[[C; N]]) {
    let mut cells = [C::default(); N].map(C::value);
    for (t, row) in rows.iter().enumerate() {
        cells.iter_mut().zip(row).for_each(|(cell, is)| is.put(cell));
        let sample = Sample { time: Time(t as i64 * 1_000_000), what: What::Row { cells: &cells } };
        state.feed(program, sample, &mut ());
    }
}
