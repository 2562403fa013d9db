//! Lapwing as a library: a specification, a monitor, a session over a recording.
