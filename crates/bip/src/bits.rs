//! Sets of small numbers, sixty-four to a word.

/// A set of numbers below a size.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Bits {
    words: Box<[u64]>,
}

impl Bits {
    /// The empty set of numbers below `size`.
    pub fn new(size: usize) -> Bits {
        Bits { words: vec![0; size.div_ceil(64)].into() }
    }

    #[inline]
    pub fn has(&self, at: u32) -> bool {
        self.words.get(at as usize / 64).is_some_and(|word| word >> (at % 64) & 1 == 1)
    }

    /// Adds a number; numbers that are too large are not in the set afterwards.
    #[inline]
    pub fn add(&mut self, at: u32) {
        if let Some(word) = self.words.get_mut(at as usize / 64) {
            *word |= 1 << (at % 64);
        }
    }

    #[inline]
    pub fn remove(&mut self, at: u32) {
        if let Some(word) = self.words.get_mut(at as usize / 64) {
            *word &= !(1 << (at % 64));
        }
    }

    /// The numbers in it, in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        self.words.iter().enumerate().flat_map(|(place, word)| ones(*word, place))
    }

    /// The word that holds the numbers from `64 * place` on.
    #[inline]
    pub fn word(&self, place: usize) -> u64 {
        self.words.get(place).copied().unwrap_or(0)
    }

    pub fn words(&self) -> usize {
        self.words.len()
    }
}

/// The numbers that the bits of a word stand for.
pub(crate) fn ones(word: u64, place: usize) -> impl Iterator<Item = u32> {
    let mut rest = word;
    std::iter::from_fn(move || {
        if rest == 0 {
            return None;
        }
        let bit = rest.trailing_zeros();
        rest &= rest - 1;
        Some(place as u32 * 64 + bit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_over_several_words() {
        let mut bits = Bits::new(130);
        for at in [0, 63, 64, 129] {
            bits.add(at);
        }
        bits.add(4000);
        bits.remove(63);
        assert_eq!(bits.iter().collect::<Vec<_>>(), [0, 64, 129]);
        assert!(bits.has(129) && !bits.has(63) && !bits.has(4000));
        assert_eq!(bits.words(), 3);
    }
}
