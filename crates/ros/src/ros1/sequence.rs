//! Messages that a publisher dropped before it sent them: its client library numbers those with a header, and a number that is left out was one.
//!
//! Both rospy and roscpp number what they publish by themselves, each publisher from one on. Others leave the number alone, or fill in what they like:
//! it counts only where it has gone up by one several times in a row.

/// So often in a row it has to go up by one.
const STEADY: u8 = 3;
/// More are not missed at once: it is another count that begins.
const MOST: u32 = 1_000_000;

/// The numbers of one publisher's messages.
#[derive(Debug, Default)]
pub(crate) struct Sequence {
    last: Option<u32>,
    steps: u8,
}

impl Sequence {
    /// How many messages were left out before this one, which begins with its number.
    pub fn missed(&mut self, message: &[u8]) -> u64 {
        let Some(number) = message.first_chunk().map(|bytes| u32::from_le_bytes(*bytes)) else { return 0 };
        let Some(last) = self.last.replace(number) else { return 0 };
        match number.wrapping_sub(last) {
            1 => self.steps = self.steps.saturating_add(1),
            step if (2..MOST).contains(&step) && self.steps >= STEADY => return u64::from(step - 1),
            _ => self.steps = 0,
        }
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn missed(numbers: &[u32]) -> Vec<u64> {
        let mut sequence = Sequence::default();
        numbers.iter().map(|number| sequence.missed(&number.to_le_bytes())).collect()
    }

    #[test]
    fn only_a_steady_count_can_miss_something() {
        assert_eq!(missed(&[5, 6, 7, 8, 12, 13, 15]), [0, 0, 0, 0, 3, 0, 1]);
        assert_eq!(missed(&[0, 0, 0, 0, 9]), [0; 5], "nobody counts");
        assert_eq!(missed(&[1, 2, 9, 11, 20]), [0; 5], "somebody counts otherwise");
        assert_eq!(missed(&[7, 8, 9, 10, 1, 2, 3, 5]), [0; 8], "a count that begins anew");
        assert_eq!(missed(&[u32::MAX - 2, u32::MAX - 1, u32::MAX, 0, 2]), [0, 0, 0, 0, 1], "it wraps");
        assert_eq!(Sequence::default().missed(&[1, 2]), 0);
    }
}
