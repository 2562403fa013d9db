//! What happens while a recording is checked.

use crate::report::{Property, Report, Violation, Warning};

/// Something worth telling at once.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// The recording is open: specifications, recording and topics are known, and the properties without their verdicts.
    Start(&'a Report),
    /// An episode of failures began; how long it lasts is not known yet.
    Violation {
        /// Whose.
        property: &'a Property,
        /// What is known of it.
        violation: &'a Violation,
    },
    /// Something that its reader should know.
    Warning(&'a Warning),
    /// What is said of a property at the end.
    Verdict(&'a Property),
    /// The recording is over.
    End(&'a Report),
}
