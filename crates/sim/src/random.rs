//! Chance, from a seed: everything that draws has a stream of its own, so that one that draws more does not change the others.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random {
    generator: Pcg64,
}

impl Random {
    /// The stream of that name and number under a seed.
    pub fn new(seed: u64, name: &str, number: u64) -> Random {
        let stream = (u128::from(hash(name)) << 64) | u128::from(number);
        Random { generator: Pcg64::new(u128::from(seed), stream) }
    }

    /// Evenly from 0 to 1, 1 excluded.
    pub fn unit(&mut self) -> f64 {
        // The 53 high bits, as many as a double has.
        (self.generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `count`; 0 where `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// Normally distributed around 0, by the method of Box and Muller.
    pub fn normal(&mut self, deviation: f64) -> f64 {
        let (radius, angle) = (1.0 - self.unit(), self.unit());
        deviation * (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
    }
}

/// FNV-1a: the standard library's hashes may change between its versions.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_is_the_same_for_the_same_seed_and_another_for_another() {
        let draw = |seed, name, number| {
            let mut random = Random::new(seed, name, number);
            [random.unit(), random.unit(), random.normal(1.0)]
        };
        assert_eq!(draw(7, "scan", 3), draw(7, "scan", 3));
        for other in [draw(8, "scan", 3), draw(7, "odom", 3), draw(7, "scan", 4)] {
            assert_ne!(draw(7, "scan", 3), other);
        }
    }

    #[test]
    fn numbers_are_spread_as_they_should_be() {
        let mut random = Random::new(1, "test", 0);
        let normal: Vec<f64> = (0..20_000).map(|_| random.normal(2.0)).collect();
        let mean = normal.iter().sum::<f64>() / normal.len() as f64;
        let spread = (normal.iter().map(|x| x * x).sum::<f64>() / normal.len() as f64).sqrt();
        assert!(mean.abs() < 0.05 && (spread - 2.0).abs() < 0.05, "{mean} {spread}");
        let below: Vec<usize> = (0..1000).map(|_| random.below(3)).collect();
        assert!((0..3).all(|k| below.iter().filter(|b| **b == k).count() > 250) && below.iter().all(|b| *b < 3));
        assert_eq!(random.below(0), 0);
    }
}
