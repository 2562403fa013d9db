//! Instrumented programs with a monitor in them: what it says is what `lapwing check` says of the same events.

mod robot;
mod support;

mod beside;
mod calls;
mod deadlines;
mod fields;
mod filters;
mod handlers;
#[cfg(feature = "log")]
mod logs;
mod machines;
mod memory;
mod plain;
mod recordings;
mod spans;
