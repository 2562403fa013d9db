//! A program without a standard library, linked and run: the engine in it gives the verdicts that it gives here, and asks for no memory
//! once it is warm.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Ending, Program, State};
use lapwing_stream::{Sample, Time, Value, What};

const SPEC: &str = "\
whenever asked, eventually within 2 s done
always once within 3 s (asked or done)
never speed > 2.0 and held for 300 ms moving
moving implies speed > 0.1
after asked, until done, always rate(speed) < 100
machine robot {
    initial still
    state going when moving
    state still when not moving
    still -> going
    going -> still
}
";

const COLUMNS: [&str; 4] = ["moving", "asked", "done", "speed"];
/// Rows before memory is counted, and in all, a tenth of a second apart.
const WARM: u32 = 200;
const ROWS: u32 = 1_000;

fn program() -> Program {
    let mut sources = SourceMap::default();
    let file = sources.add("robot.rv", SPEC);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, SPEC).file, &|_| None);
    let columns = COLUMNS.map(str::to_owned).to_vec();
    let shape = TraceShape { columns, schemaless: true, ..TraceShape::default() };
    let checked = check(&sources, &loaded, Some(&shape));
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    assert_eq!(checked.spec.columns, COLUMNS, "rows are in the order in which the specification reads");
    compile(&checked.spec)
}

/// A row: a request is answered each second. Nothing fails but in the very last row, since a failure is stored, which takes memory.
fn row(k: u32) -> (i64, [Value; 4]) {
    let n = k % 10;
    let (asked, moving) = (n == 0, n > 4);
    let speed = if k == ROWS - 1 {
        0.05
    } else if moving {
        0.5 + f64::from(n) / 10.0
    } else {
        0.0
    };
    let cells = [Value::Bool(moving), Value::Bool(asked), Value::Bool(n == 7), Value::Num(speed)];
    (i64::from(k) * 100_000_000, cells)
}

fn input(program: &Program) -> Vec<u8> {
    let bytes = program.save();
    let mut input = (bytes.len() as u32).to_le_bytes().to_vec();
    input.extend(bytes);
    input.extend((COLUMNS.len() as u32).to_le_bytes());
    input.extend(WARM.to_le_bytes());
    for (time, cells) in (0..ROWS).map(row) {
        input.extend(time.to_le_bytes());
        for cell in cells {
            let (kind, number) = match cell {
                Value::Bool(b) => (1, f64::from(u8::from(b))),
                Value::Num(x) => (2, x),
                _ => (0, 0.0),
            };
            input.push(kind);
            input.extend(number.to_bits().to_le_bytes());
        }
    }
    input
}

/// What the engine says here, in the words of the host.
fn expected(program: &Program) -> String {
    let mut state = State::new(program);
    for (time, cells) in (0..ROWS).map(row) {
        state.feed(program, Sample { time: Time(time), what: What::Row { cells: &cells } }, &mut ());
    }
    let line = |o: lapwing_engine::Outcome| {
        let first = o.episodes.first().map_or((0, 0), |e| (e.began.0, e.failed.0));
        format!("{} {:?} {first:?}\n", o.verdict, (o.met, o.failed, o.open))
    };
    state.finish(program, &Ending::default(), &mut ()).into_iter().map(line).collect()
}

/// Builds the host with the cargo that builds this, into the same folder, so that the engine is there already.
fn build() -> PathBuf {
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).with_file_name("");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut command = Command::new(cargo);
    command.current_dir(env!("CARGO_MANIFEST_DIR")).arg("rustc").arg("--target-dir").arg(&target);
    if !cfg!(debug_assertions) {
        command.arg("--release");
    }
    // Without a standard library nothing could unwind. Only this crate is compiled so; what it stands on is as the tests have it.
    command.args(["--offline", "--features", "host", "--bin", "embedded", "--", "-C", "panic=abort"]);
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    target.join(if cfg!(debug_assertions) { "debug" } else { "release" }).join("embedded")
}

/// Runs the host on that input.
fn run(input: &[u8]) -> Output {
    let mut host = Command::new(build()).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("the host runs");
    host.stdin.take().expect("its input").write_all(input).expect("it reads all of it");
    host.wait_with_output().expect("it ends")
}

#[test]
fn an_engine_without_a_standard_library_says_the_same_and_asks_for_no_memory() {
    let program = program();
    let output = run(&input(&program));
    assert!(output.status.success(), "{:?}", output.status);
    let said = String::from_utf8(output.stdout).expect("text");
    assert_eq!(said, format!("asked 0 in {} rows\n{}", ROWS - WARM - 1, expected(&program)));
    let verdicts: Vec<&str> = said.lines().skip(1).filter_map(|line| line.split(' ').next()).collect();
    assert_eq!(verdicts, ["holds", "holds", "holds", "violated", "satisfied", "holds"], "{said}");
}

#[test]
fn no_rows_to_count_are_an_error_and_no_panic() {
    let mut input = input(&program());
    // A stamp, and of each cell its kind and its bits.
    let row = 8 + COLUMNS.len() * 9;
    input.truncate(input.len() - (ROWS - WARM) as usize * row);
    assert_eq!(run(&input).status.code(), Some(1));
}
