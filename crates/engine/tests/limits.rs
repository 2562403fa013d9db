//! What happens when more obligations are open than a program allows.

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Ending, Outcome, Program, State};
use lapwing_stream::{Sample, Time, Value, Verdict, What};

fn program(text: &str, open_limit: usize) -> Program {
    let mut sources = SourceMap::default();
    let file = sources.add("limits.rv", text);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, text).file, &|_| None);
    let columns = vec!["p".to_owned(), "q".to_owned()];
    let shape = TraceShape { columns, schemaless: true, ..TraceShape::default() };
    Program { open_limit, ..compile(&check(&sources, &loaded, Some(&shape)).spec) }
}

/// p every other second, q never but where `q` says; so every promise of a q is a run of its own.
fn outcome(program: &Program, q: impl Fn(i64) -> bool) -> Outcome {
    let mut state = State::new(program);
    for t in 0..100 {
        let cells = [Value::Bool(t % 2 == 0), Value::Bool(q(t))];
        state.feed(program, Sample { time: Time(t * 1_000_000_000), what: What::Row { cells: &cells } }, &mut ());
    }
    state.finish(program, &Ending::default(), &mut ()).remove(0)
}

#[test]
fn too_many_open_runs_make_a_property_inconclusive() {
    let text = "whenever p, eventually q\n";
    assert_eq!(outcome(&program(text, 1000), |_| false).verdict, Verdict::Unmet);
    let few = outcome(&program(text, 10), |_| false);
    assert_eq!(few.verdict, Verdict::Inconclusive);
    assert_eq!(few.cause.as_deref(), Some("more than 10 runs of obligations were open at once"));
}
