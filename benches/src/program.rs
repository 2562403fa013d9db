//! A program of one formula over the columns p, q, r, s, and rows for it.

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Program, State};
use lapwing_stream::{Sample, Time, Value, What};

use crate::timescales::Row;

const COLUMNS: [&str; 4] = ["p", "q", "r", "s"];

/// The program of a formula.
pub fn of(formula: &str) -> Program {
    let mut sources = SourceMap::default();
    let text = format!("holds: {formula}\n");
    let file = sources.add("bench.rv", text.clone());
    let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
    let shape = TraceShape { columns: COLUMNS.map(String::from).to_vec(), schemaless: true, ..TraceShape::default() };
    let checked = check(&sources, &loaded, Some(&shape));
    assert!(!checked.has_errors(), "{formula}: {:?}", checked.diagnostics);
    let mut program = compile(&checked.spec);
    // Cells come as p, q, r, s; the program numbers the columns that it reads in its own order.
    for column in &mut program.columns {
        let name = &checked.spec.columns[column.cell];
        column.cell = COLUMNS.iter().position(|n| n == name).unwrap_or_default();
    }
    program
}

/// Feeds rows, a millisecond apart. Both sides of a comparison read the same rows from memory; this one makes values of them in one
/// buffer, as a connector does.
pub fn feed(state: &mut State, program: &Program, rows: &[Row]) {
    let mut cells = [false; 4].map(Value::Bool);
    for (t, row) in rows.iter().enumerate() {
        cells.iter_mut().zip(row).for_each(|(cell, is)| put(cell, *is));
        let sample = Sample { time: Time(t as i64 * 1_000_000), what: What::Row { cells: &cells } };
        state.feed(program, sample, &mut ());
    }
}

/// Overwrites a truth value in its place.
fn put(cell: &mut Value, is: bool) {
    if let Value::Bool(to) = cell {
        *to = is;
    }
}
