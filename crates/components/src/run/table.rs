//! What belongs to a number, where only some numbers have something.

/// By a number of one kind, that of another.
pub(super) struct Table(Vec<Option<usize>>);

impl Table {
    /// Of so many numbers, of which those in `pairs` have something. Of several pairs with one number the last counts.
    pub fn new(length: usize, pairs: impl Iterator<Item = (usize, usize)>) -> Table {
        let mut all = vec![None; length];
        for (key, value) in pairs {
            if let Some(place) = all.get_mut(key) {
                *place = Some(value);
            }
        }
        Table(all)
    }

    /// What belongs to a number.
    pub fn get(&self, key: usize) -> Option<usize> {
        self.0.get(key).copied().flatten()
    }
}
