//! `reset`: the monitor of one property starts afresh, as JavaMOP's `__RESET` has it. Its past is forgotten and what it was waiting for is
//! given up, neither met nor failed; what it has counted, and the violations that it has told, stand.
//!
//! Properties with the same positions share one walk through them, so only one that has it to itself can start afresh on its own. The
//! compiler sees to that where a reaction says `reset`.

use lapwing_stream::Value;

use crate::feed::State;
use crate::program::Program;

impl State {
    /// The monitor of a property starts afresh, in all its instances. Returns `false`, and does nothing, where other properties share its
    /// positions, or nothing judges it.
    pub fn reset(&mut self, program: &Program, property: usize) -> bool {
        self.piece.reset(program, property, None)
    }

    /// The same for one instance under `for each k of EVENT.field`, by its values from the outermost on; without any, for the property.
    pub fn reset_instance(&mut self, program: &Program, property: usize, instance: &[Value]) -> bool {
        self.piece.reset(program, property, Some(instance))
    }
}
