//! `valgrind --tool=callgrind target/release/examples/count`: the instructions of stepping one property, a hundred thousand times.

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::State;
use lapwing_stream::{Sample, Time, Value, What};

fn main() {
    let formula = std::env::args().nth(1).unwrap_or_else(|| "once within 100 ms p".to_owned());
    let mut sources = SourceMap::default();
    let text = format!("holds: {formula}\n");
    let file = sources.add("count.rv", text.clone());
    let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
    let columns: Vec<String> = ["p", "q", "r", "s"].map(String::from).to_vec();
    let shape = TraceShape { columns, schemaless: true, ..TraceShape::default() };
    let program = compile(&check(&sources, &loaded, Some(&shape)).spec);
    let mut state = State::new(&program);
    let rows = [[true, false, false, false], [false, true, false, true]].map(|row| row.map(Value::Bool));
    for t in 0..100_000i64 {
        let cells = &rows[usize::from(t % 10 != 0)];
        state.feed(&program, Sample { time: Time(t * 1_000_000), what: What::Row { cells } }, &mut ());
    }
    println!("{} instants", state.instants());
}
