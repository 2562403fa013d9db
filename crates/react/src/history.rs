//! How signals and verdicts went over time: what a page draws beside a [`Report`](crate::Report). Plain data.
//!
//! All times here are on one axis that never goes back: it is the recording's own time up to the first jump, and goes on counting from there.
//! [`Piece`] says which stamps the recording has.

use lapwing_draw::Graph;
use lapwing_stream::Time;

/// How the signals and properties of one specification went over a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// The stretches between jumps of time; one where time never jumped, none where nothing came.
    pub pieces: Vec<Piece>,
    /// What is drawn, for all properties together.
    pub tracks: Vec<Track>,
    /// For each property of the report, in its order, what happened to it.
    pub courses: Vec<Course>,
}

/// A stretch of a recording in which time never goes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Where it begins on the axis.
    pub from: Time,
    /// Where it ends on the axis.
    pub to: Time,
    /// The stamp with which it begins.
    pub stamp: Time,
}

/// Something that changes over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// What the specification calls it.
    pub name: String,
    /// Its unit, where it is known.
    pub unit: Option<String>,
    /// How it went.
    pub shape: Shape,
    /// Whether there was more than is kept: points between the least and the greatest of a stretch are left out.
    pub is_thinned: bool,
}

/// The ways in which something changes.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A number; it keeps its value from a point to the next.
    Curve(Vec<(Time, f64)>),
    /// One of several states: from when on, and the number of the label; `None` where it changed too often to tell.
    Steps {
        /// The changes.
        changes: Vec<(Time, Option<usize>)>,
        /// What the states are called.
        labels: Vec<String>,
    },
    /// Something that happens now and then.
    Ticks(Vec<Time>),
}

/// How it went with a property.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// What it means, in words.
    pub words: String,
    /// How it stood, from the beginning of the recording to its end.
    pub phases: Vec<Phase>,
    /// When the condition of each of its scopes held, in the order of the report's scopes; `None` where that cannot be told.
    pub scopes: Vec<Option<Vec<(Time, Time)>>>,
    /// The tracks that are drawn as lanes: states, truth values, events.
    pub lanes: Vec<usize>,
    /// The tracks that are drawn as curves.
    pub plots: Vec<Plot>,
    /// By how much the obligations that begin at a time missed changing the verdict.
    pub margin: Option<Track>,
    /// For each violation of the report, its times on the axis.
    pub marks: Vec<Mark>,
    /// Of a state diagram: the diagram, with the moves that were made although it does not have them.
    pub diagram: Option<Graph>,
}

/// A stretch of time in which a property stood in one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Phase {
    /// Since when.
    pub from: Time,
    /// Until when.
    pub to: Time,
    /// How.
    pub stand: Stand,
}

/// How a property can stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stand {
    /// Something that it reads had no value yet.
    NotStarted,
    /// Its outermost scope was not entered: nothing was asked.
    Idle,
    /// Nothing was wrong.
    Holds,
    /// An obligation that began and failed here failed.
    Failed,
    /// Something had to happen and did not before the recording ended.
    Unmet,
    /// Nothing was seen to fail, but it could not be judged.
    Unknown,
}

/// Curves on one pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Which tracks.
    pub tracks: Vec<usize>,
    /// Values that the property compares them with.
    pub limits: Vec<Limit>,
}

/// A value that a curve is compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// The value.
    pub value: f64,
    /// The comparison as it is written, without the curve: `> 2.0`.
    pub text: String,
}

/// The times of a violation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// When the first failed obligation began.
    pub began: Time,
    /// When it failed.
    pub failed: Time,
    /// When the last one failed.
    pub until: Time,
}
