//! What the robot is told about itself and the field.

use std::time::Duration;

/// Lengths are in metres, angles in degrees. The origin is where the robot starts, and `x` is the way that it faces there.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The middle of the goal.
    pub goal: [f64; 2],
    /// From how near it shoots.
    pub goal_range: f64,
    /// What the sonar reads at most when the ball is close.
    pub sonar_close: f64,
    /// What the sonar reads at most when the ball is between the arms.
    pub sonar_in_arms: f64,
    /// What the sonar reads after an error.
    pub sonar_error: f64,
    /// How long the sonar rests between two pings.
    pub sonar_rest: Duration,
    /// The greatest speed, in m/s.
    pub full_speed: f64,
    /// The speed towards the ball, in m/s.
    pub approach_speed: f64,
    /// The speed with the ball, in m/s.
    pub dribble_speed: f64,
    /// The turn towards the ball, in degrees a second.
    pub turn_speed: f64,
    /// The turn with the ball, in degrees a second.
    pub dribble_turn: f64,
    /// By how much it turns where the seeker sees nothing.
    pub search_turn: f64,
    /// How often it turns before it gives up.
    pub turns: u32,
    /// How often it turns and goes before it gives up.
    pub tries: u32,
    /// How long it goes on when the ball is between the arms, to have it well.
    pub grab: Duration,
    /// How long it runs before it shoots.
    pub run_up: Duration,
    /// How long a match lasts.
    pub match_length: Duration,
    /// The diameter of a wheel.
    pub wheel_diameter: f64,
    /// The distance between the wheels.
    pub track_width: f64,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            goal: [1.0, -1.0],
            goal_range: 0.7,
            sonar_close: 0.19,
            sonar_in_arms: 0.07,
            sonar_error: 0.0,
            sonar_rest: Duration::from_millis(12),
            full_speed: 0.30,
            approach_speed: 0.07,
            dribble_speed: 0.10,
            turn_speed: 25.0,
            dribble_turn: 10.0,
            search_turn: 90.0,
            turns: 15,
            tries: 20,
            grab: Duration::from_millis(1500),
            run_up: Duration::from_millis(1500),
            match_length: Duration::from_secs(180),
            wheel_diameter: 0.04746,
            track_width: 0.132,
        }
    }
}
