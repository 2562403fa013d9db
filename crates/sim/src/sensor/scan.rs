//! A laser scanner like the LDS-01 of a TurtleBot3: 360 rays, five times a second, up to 3.5 m.

use crate::random::Random;
use crate::world::{Body, World};

/// How many rays a scan has.
const RAYS: usize = 360;
/// The least and the greatest distance that it can tell, in metres.
pub const LIMIT: [f64; 2] = [0.12, 3.5];
/// The standard deviation of a distance, in metres.
const NOISE: f64 = 0.01;

/// The scan of that number as it is seen from a body: the noise of a scan depends on nothing but the seed, the name and the number.
pub fn scan(world: &World, body: Body, seed: u64, robot: &str, number: u64) -> Vec<f32> {
    let mut random = Random::new(seed, &format!("{robot}/scan"), number);
    let far = world.look_around(body, RAYS, LIMIT[1]);
    let range = |far: Option<f64>| {
        let noise = random.normal(NOISE);
        far.map_or(f32::INFINITY, |far| (far + noise).clamp(LIMIT[0], LIMIT[1]) as f32)
    };
    far.map(range).collect()
}
