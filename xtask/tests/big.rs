//! Memory does not grow with the length of a recording. `cargo run --release -p xtask -- big` does the same with gigabytes.

use std::env;
use std::process::Command;

use lapwing::{Options, Session, Spec, Standing};
use xtask::big::{Comparison, Kind, SPEC};

/// How long the longer recordings are, in bytes.
const LENGTH: u64 = 100_000_000;
/// Names the recording for the test that is run as a process of its own.
const RECORDING: &str = "LAPWING_BIG_RECORDING";

#[test]
fn a_recording_that_is_named_is_checked() {
    let Some(path) = env::var_os(RECORDING) else { return };
    let specs = [Spec::parse("big.rv", SPEC, &|_| None).unwrap()];
    let report = Session::open(&specs, path.as_ref(), &Options::default()).unwrap().run(&mut ());
    assert_eq!(report.standing(), Standing::Good, "{report:?}");
    assert!(report.instants > 1000, "{} instants", report.instants);
}

#[test]
fn memory_does_not_grow_with_the_length() {
    let folder = tempfile::tempdir().unwrap();
    for kind in [Kind::Mcap, Kind::Db3, Kind::Bag, Kind::Csv] {
        // Each is checked by the test above, in a process of its own: only there its memory can be told.
        let comparison = Comparison::new(kind, folder.path(), LENGTH, &|path| {
            let mut command = Command::new(env::current_exe().unwrap());
            command.args(["--exact", "a_recording_that_is_named_is_checked"]).env(RECORDING, path);
            command
        });
        let comparison = comparison.unwrap();
        assert!(comparison.is_fine(), "{comparison}");
        println!("{comparison}");
    }
}
