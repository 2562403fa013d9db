//! How many bytes a run of fixed-size fields takes, from every alignment at which it may begin.
//!
//! CDR puts each number at a multiple of its size, so a run's length depends on where it begins, modulo eight, and on
//! nothing else. Eight lengths, worked out once, let a decoder skip any run in one jump.

/// The bytes that a run of fixed-size fields takes, by the position, modulo eight, at which it begins.
///
/// Lengths saturate: what would not fit into 64 bits does not fit into any message either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span([u64; 8]);

impl Span {
    /// Nothing.
    pub const NONE: Span = Span([0; 8]);

    /// One number of that size; without alignment no gap comes before it.
    pub fn of(size: usize, aligned: bool) -> Span {
        let size = size as u64;
        Span(std::array::from_fn(|phase| {
            if aligned { (phase as u64).next_multiple_of(size) - phase as u64 + size } else { size }
        }))
    }

    /// This run and then another.
    pub fn then(self, next: Span) -> Span {
        Span(std::array::from_fn(|phase| {
            let first = self.0[phase];
            first.saturating_add(next.from(phase as u64 + (first & 7)))
        }))
    }

    /// This run so many times, by squaring.
    pub fn times(self, mut n: u64) -> Span {
        let (mut result, mut power) = (Span::NONE, self);
        while n > 0 {
            if n & 1 == 1 {
                result = result.then(power);
            }
            power = power.then(power);
            n >>= 1;
        }
        result
    }

    /// The bytes it takes from that position on.
    pub fn from(&self, position: u64) -> u64 {
        self.0[(position & 7) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The length of a run of numbers, one by one.
    fn walked(sizes: &[u64], start: u64) -> u64 {
        sizes.iter().fold(start, |at, size| at.next_multiple_of(*size) + size) - start
    }

    #[test]
    fn spans_agree_with_walking() {
        let run = [1, 8, 2, 4, 1];
        let one = run.iter().fold(Span::NONE, |span, size| span.then(Span::of(*size as usize, true)));
        for start in 0..8 {
            assert_eq!(one.from(start), walked(&run, start));
            for times in 0..20 {
                assert_eq!(one.times(times).from(start), walked(&run.repeat(times as usize), start));
            }
        }
        assert_eq!(Span::of(8, false).times(3).from(5), 24);
        assert_eq!(Span::of(8, true).times(u64::MAX).from(0), u64::MAX);
    }
}
