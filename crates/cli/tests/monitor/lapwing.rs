//! `lapwing monitor`, run on a graph.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::graph::{Graph, LIMIT, Process};

/// A run of `lapwing monitor` in a folder of its own.
pub struct Lapwing {
    process: Process,
    pub folder: tempfile::TempDir,
}

/// What a run came to.
pub struct Ended {
    pub code: i32,
    pub stdout: String,
    pub folder: tempfile::TempDir,
}

impl Lapwing {
    /// Watches a graph with a specification, once it says what it watches. The words stand between the graph's and the end.
    pub fn watches(graph: &Graph, spec: &str, words: &str) -> Lapwing {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("robot.rv"), spec).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lapwing"));
        let arguments = format!("monitor robot.rv {words} {}", graph.words());
        command.args(arguments.split_whitespace()).current_dir(folder.path());
        Lapwing { process: Process::start(graph.around(command), "cargo build"), folder }
    }

    /// The first line on standard output with that text in it.
    pub fn says(&self, text: &str) -> String {
        self.process.line_with(text)
    }

    /// The same, if it comes in that time.
    pub fn says_within(&self, text: &str, patience: Duration) -> Option<String> {
        self.process.line_within(text, patience)
    }

    /// The same, while something is done over and over: publishers and subscribers take their time to find each other, and what was said before is
    /// lost.
    pub fn says_while(&self, text: &str, pause: Duration, mut act: impl FnMut()) -> String {
        let begin = Instant::now();
        loop {
            act();
            if let Some(line) = self.says_within(text, pause) {
                return line;
            }
            assert!(begin.elapsed() < LIMIT, "never `{text}`");
        }
    }

    pub fn signal(&self, name: &str) {
        self.process.signal(name);
    }

    /// Ends it by a signal, and gives its report.
    pub fn ends_by(mut self, name: &str) -> Ended {
        self.process.signal(name);
        self.ends_in_place()
    }

    fn ends_in_place(&mut self) -> Ended {
        let stdout = self.process.rest().join("\n");
        let code = self.process.child.wait().unwrap().code().unwrap_or(-1);
        let folder = std::mem::replace(&mut self.folder, tempfile::tempdir().unwrap());
        Ended { code, stdout, folder }
    }
}

impl Ended {
    /// The report on the recording.
    pub fn checked(&self) -> serde_json::Value {
        checked(self.folder.path())
    }
}

/// The report on the recording of a run in that folder.
pub fn checked(folder: &Path) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lapwing"));
    command.args(["check", "robot.rv", "run.mcap", "--format", "json"]).current_dir(folder);
    let output = command.output().unwrap();
    serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()[0].take()
}
