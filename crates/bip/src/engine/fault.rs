//! What ends a run.

use crate::time::Time;
use lapwing_diag::Span;
use std::fmt;

/// Why a run cannot go on. What an engine shows after a fault is the state in which the fault was found, and perhaps only half of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// Two transitions of a port, or two internal ones, can be taken at once.
    NonDeterministic {
        /// The atom.
        atom: String,
        /// The port; none of internal transitions.
        port: Option<String>,
    },
    /// A transition marks a place that is marked.
    NotSafe {
        /// The atom.
        atom: String,
        /// The place.
        place: String,
    },
    /// Interactions that are possible go before one another in a circle.
    PriorityCycle(Vec<String>),
    /// Ports of an atom that are possible go before one another in a circle.
    AtomPriorityCycle {
        /// The atom.
        atom: String,
        /// The ports, in the order of the circle.
        ports: Vec<String>,
    },
    /// An invariant is false, and time does not change that.
    Invariant {
        /// The atom.
        atom: String,
        /// The invariant.
        name: String,
    },
    /// An event came to a port that takes none unless the atom waits for it.
    UnexpectedEvent {
        /// The port.
        port: String,
        /// When it came.
        at: Time,
    },
    /// Time went on further than the model allows.
    TimeSafety {
        /// How far.
        at: Time,
        /// What it does not allow, each a line.
        violated: Vec<String>,
    },
    /// An expression came to nothing: a division by zero, a function that failed.
    Computation {
        /// The atom or connector.
        whose: String,
        /// What happened.
        what: String,
        /// Where in the text.
        at: Span,
    },
    /// Internal transitions that never come to an end.
    Endless {
        /// The atom.
        atom: String,
    },
    /// More events wait than can be kept.
    TooManyEvents {
        /// The port.
        port: String,
    },
    /// A move was asked for that is not possible then.
    NotOffered,
}

impl Fault {
    /// The exit code of a run that ends so. The first seven are those of the original engine.
    pub fn code(&self) -> u8 {
        match self {
            Fault::NonDeterministic { .. } => 1,
            Fault::NotSafe { .. } => 2,
            Fault::PriorityCycle(_) => 3,
            Fault::AtomPriorityCycle { .. } => 4,
            Fault::Invariant { .. } => 5,
            Fault::UnexpectedEvent { .. } | Fault::TooManyEvents { .. } => 6,
            Fault::TimeSafety { .. } => 7,
            Fault::Computation { .. } | Fault::Endless { .. } | Fault::NotOffered => 8,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::NonDeterministic { atom, port: Some(port) } => {
                write!(f, "{atom} can take two transitions of the port {port} at once: it is non-deterministic")
            }
            Fault::NonDeterministic { atom, port: None } => {
                write!(f, "{atom} can take two internal transitions at once: it is non-deterministic")
            }
            Fault::NotSafe { atom, place } => {
                write!(f, "{atom} marks the place {place}, which is marked already: its net is not 1-safe")
            }
            Fault::PriorityCycle(all) => write!(f, "cycle in priorities! ({})", all.join(" < ")),
            Fault::AtomPriorityCycle { atom, ports } => {
                write!(f, "cycle in priorities of {atom}! ({})", ports.join(" < "))
            }
            Fault::Invariant { atom, name } => write!(f, "the invariant {name} of {atom} is violated"),
            Fault::UnexpectedEvent { port, at } => write!(f, "{port} did not wait for the event that came at {at}"),
            Fault::TimeSafety { .. } => f.write_str("violation of timing constraints"),
            Fault::Computation { whose, what, .. } => write!(f, "{whose}: {what}"),
            Fault::Endless { atom } => write!(f, "{atom} takes internal transitions without end"),
            Fault::TooManyEvents { port } => write!(f, "more events wait at {port} than can be kept"),
            Fault::NotOffered => f.write_str("a move was asked for that is not possible"),
        }
    }
}

impl std::error::Error for Fault {}
