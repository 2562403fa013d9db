//! What monitoring costs: the thesis's chapter 4. Code size with and without it ([`size`]), and the time that it adds at each place where the thesis
//! measured (figures 4.2 to 4.9), with each of its monitors and with all of them, beside the same program that nobody listens to.
//!
//! Each way runs in a process of its own, since a subscriber is set once; in it matches are played, the first of which is not counted. What is measured
//! is the program's own work: the time that its calls of the brick take, behind which the simulated field stands, is left out ([`probe`]).

mod boxes;
mod page;
mod probe;
pub mod size;
mod ways;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use serde::{Deserialize, Serialize};

pub use boxes::{Box, tables};
pub use page::html;
pub use ways::{Way, play};

/// A place in the robot's program where the thesis measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Place {
    BeforePlay,
    Kick,
    BallClose,
    GameOver,
    BallInFront,
    InfraredModulated,
    InfraredUnmodulated,
    Sonar,
}

impl Place {
    /// All of them, in the order of the thesis's figures.
    pub const ALL: [Place; 8] = [
        Place::BeforePlay,
        Place::Kick,
        Place::BallClose,
        Place::GameOver,
        Place::BallInFront,
        Place::InfraredModulated,
        Place::InfraredUnmodulated,
        Place::Sonar,
    ];

    /// What to call it, and the figure of the thesis.
    pub fn name(self) -> (&'static str, &'static str) {
        match self {
            Place::BeforePlay => ("before Play", "4.2"),
            Place::Kick => ("Kick", "4.3"),
            Place::BallClose => ("BallClose", "4.4"),
            Place::GameOver => ("GameOver", "4.5"),
            Place::BallInFront => ("BallInFront", "4.6"),
            Place::InfraredModulated => ("IR modulated", "4.7"),
            Place::InfraredUnmodulated => ("IR unmodulated", "4.8"),
            Place::Sonar => ("sonar", "4.9"),
        }
    }
}

/// What one way took: nanoseconds of each call, by place, in the order in which they were made.
pub type Times = BTreeMap<Place, Vec<u64>>;

/// Measures all ways, each in a process of `program`, whose `costs --way NAME` prints the [`Times`] of one as JSON.
pub fn measure(program: &Path, matches: u64) -> Result<Vec<(Way, Times)>, String> {
    Way::all()?.into_iter().map(|way| Ok((way.clone(), in_a_process(program, &way, matches)?))).collect()
}

fn in_a_process(program: &Path, way: &Way, matches: u64) -> Result<Times, String> {
    let mut command = Command::new(program);
    command.args(["costs", "--way", way.name(), "--matches", &matches.to_string()]);
    let output = command.output().map_err(|e| format!("{}: {e}", program.display()))?;
    if !output.status.success() {
        return Err(format!("{}: {}", way.name(), String::from_utf8_lossy(&output.stderr)));
    }
    serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())
}
