//! What is said of a property at the end.

use core::fmt;

use serde::{Deserialize, Serialize};

/// The verdict of a property on a trace, from the worst to the best: merging the pieces of a trace takes the least.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
pub enum Verdict {
    /// At least one obligation failed.
    Violated,
    /// It could not be judged; a cause comes with it.
    Inconclusive,
    /// Nothing failed, but something that had to happen had not happened when the trace ended.
    Unmet,
    /// Nothing failed; the trace merely ended.
    Holds,
    /// All obligations are met and none can be added.
    Satisfied,
}

impl Verdict {
    /// The word used in every report.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Violated => "violated",
            Verdict::Inconclusive => "inconclusive",
            Verdict::Unmet => "unmet",
            Verdict::Holds => "holds",
            Verdict::Satisfied => "satisfied",
        }
    }

    /// Whether the property came out well.
    pub fn is_success(self) -> bool {
        self >= Verdict::Holds
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
