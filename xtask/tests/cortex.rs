//! Generated C on a Cortex-M3, emulated: it says there what the engine says here, and it is small. `tools/arm.sh` installs what it takes.

use xtask::codegen::cortex::{SOCCER, sizes};
use xtask::codegen::{Case, Target, Theme, agree, handed, of_suite};

/// The version of the compiler.
fn version() -> String {
    let output = std::process::Command::new("arm-none-eabi-gcc").arg("-dumpfullversion").output();
    String::from_utf8(output.expect("tools/arm.sh was run").stdout).expect("a version")
}

/// So many traces of the suite are run, which the compiler and the memory of the board take at once.
const TRACES: usize = 160;

/// So many more of each theme of what is handed over as a whole.
const HANDED: u64 = 5;

#[test]
fn generated_c_agrees_on_a_cortex_m() {
    let folder = tempfile::tempdir().expect("a folder to compile in");
    let all = of_suite(folder.path()).expect("pages that can be read");
    // Some of every page.
    let step = all.len().div_ceil(TRACES);
    let mut some: Vec<Case> = all.into_iter().step_by(step).collect();
    let of = |theme| (1..=HANDED).map(move |seed| (theme, seed));
    let cases = Theme::ALL.into_iter().flat_map(of);
    some.extend(cases.map(|(theme, seed)| handed(theme, seed, folder.path()).expect("a case")));
    let (count, wrong) = agree(&some, &[Target::Cortex], folder.path()).expect("monitors that compile and run");
    assert!(wrong.is_empty(), "{count:?}: {wrong:#?}");
    assert!(count.compared >= 100, "{count:?}");
}

#[test]
fn the_six_properties_of_the_soccer_robot_are_small() {
    let folder = tempfile::tempdir().expect("a folder to compile in");
    let table = sizes(folder.path()).expect("monitors that compile");
    assert_eq!(table.len(), SOCCER.len() + 1);
    for size in &table {
        assert!(size.code > 100 && size.code < 16 << 10, "{size:?}");
        assert!(size.memory > 50 && size.memory < 4 << 10, "{size:?}");
    }
    // Another compiler makes other code of it.
    if version().starts_with("12.") {
        let page = include_str!("../../docs/embedded.md");
        for size in &table {
            let row = format!("| {} | {} | {} |", size.name, size.code, size.memory);
            assert!(page.contains(&row), "docs/embedded.md does not say `{row}`: cargo run -p xtask -- code-size");
        }
    }
}
