//! Who looks on while a recording is checked.

use lapwing_react::Event;

/// Who looks on while a recording is checked, and may stop it.
pub trait Watch {
    /// Something happened that is worth telling at once.
    fn event(&mut self, _event: Event<'_>) {}

    /// So much was read, of so much: 0 where that is not known.
    fn progress(&mut self, _read: u64, _of: u64) {}

    /// Whether to go on. Asked after every message.
    fn goes_on(&mut self) -> bool {
        true
    }
}

/// Nobody.
impl Watch for () {}
