//! Programs of a text over columns.

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::Program;

/// The program of a specification over these columns.
pub fn program(text: &str, columns: &[&str]) -> Program {
    let mut sources = SourceMap::default();
    let file = sources.add("test.rv", text);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, text).file, &|_| None);
    let columns = columns.iter().map(|column| column.to_string()).collect();
    let shape = TraceShape { columns, schemaless: true, ..TraceShape::default() };
    let checked = check(&sources, &loaded, Some(&shape));
    assert!(!checked.has_errors(), "{text}: {:?}", checked.diagnostics);
    compile(&checked.spec)
}
