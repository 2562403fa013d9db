//! The monitors: an immutable program, a state owned by the caller, and the step between two instants.
