//! What the field does when somebody plays on it by hand.

use std::time::Duration;

use super::*;
use crate::robot::{Brick, InfraredMode, MotorPort};

fn field(ball: (f64, f64), hands: Vec<Hand>) -> Field {
    Field::new(&Kickoff { seed: 1, ball, hands, unplugged: Vec::new(), goal: [1.0, -1.0] })
}

fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

#[test]
fn the_seeker_shows_the_direction_in_steps_and_has_a_dead_zone() {
    for (left, shown) in [(0.0, 0.0), (58.0, -60.0), (-58.0, 60.0), (118.0, -120.0)] {
        let field = field((0.5, left), Vec::new());
        for mode in [InfraredMode::Modulated, InfraredMode::Unmodulated] {
            let seeker = field.infrared_seeker(SensorPort::S3, mode).unwrap();
            assert_eq!(seeker.fetch_sample(), shown, "{left} {mode:?}");
        }
    }
    let behind = field((0.5, 180.0), Vec::new());
    let seeker = behind.infrared_seeker(SensorPort::S3, InfraredMode::Unmodulated).unwrap();
    assert!(seeker.fetch_sample().is_nan());
}

#[test]
fn a_ball_that_is_off_gives_no_signal() {
    let hands = vec![
        Hand { moment: Moment::After(seconds(0.1)), deed: Deed::SwitchOff },
        Hand { moment: Moment::After(seconds(0.1)), deed: Deed::SwitchOn },
    ];
    let field = field((0.5, 0.0), hands);
    let seeker = field.infrared_seeker(SensorPort::S3, InfraredMode::Modulated).unwrap();
    let mut seen = Vec::new();
    for _ in 0..3 {
        seen.push(seeker.fetch_sample().is_nan());
        field.delay(seconds(0.1));
    }
    assert_eq!(seen, [false, true, false]);
}

#[test]
fn the_sonar_hears_the_ball_and_errs_when_it_is_hurried() {
    let field = field((0.5, 0.0), Vec::new());
    let sonar = field.ultrasonic_sensor(SensorPort::S2).unwrap();
    for _ in 0..20 {
        let heard = sonar.fetch_sample();
        assert!((heard - (0.5 - BALL - 0.05)).abs() < 0.01, "{heard}");
        field.delay(seconds(0.02));
    }
    let hurried = (0..60).filter(|_| sonar.fetch_sample() == 0.0).count();
    assert!((8..40).contains(&hurried), "{hurried} errors of 60");
}

/// Pushes the ball along for two seconds, and stops; the arm strikes then, or not. Where the ball comes to rest.
fn pushed(strikes: bool) -> f64 {
    let field = field((0.13, 0.0), Vec::new());
    let wheels = [MotorPort::A, MotorPort::D].map(|port| field.regulated_motor(port).unwrap());
    for wheel in &wheels {
        wheel.set_speed(240.0);
        wheel.forward();
    }
    field.delay(seconds(2.0));
    let rolled = wheels[0].tacho_count().to_radians() * WHEEL;
    let robot = field.sketches().last().unwrap().robot;
    assert!((robot[0] - rolled).abs() < 0.01 && robot[0] > 0.15, "{robot:?} {rolled}");
    assert!((field.ball()[0] - robot[0] - 0.12).abs() < 0.03, "the ball is pushed along: {:?}", field.ball());
    let arm = field.unregulated_motor(MotorPort::C).unwrap();
    arm.set_power(if strikes { 100.0 } else { 0.0 });
    arm.forward();
    assert_eq!(arm.is_moving(), strikes);
    wheels.iter().for_each(|wheel| wheel.stop());
    field.delay(seconds(2.0));
    assert!(field.ball()[1].abs() < 0.01, "straight on: {:?}", field.ball());
    field.ball()[0]
}

#[test]
fn wheels_roll_and_a_kick_sends_the_ball_off() {
    let (struck, rolled) = (pushed(true), pushed(false));
    assert!(struck > rolled + 0.03, "{struck} {rolled}");
}

#[test]
fn what_is_not_plugged_in_does_not_answer() {
    let kickoff =
        Kickoff { seed: 1, ball: (0.5, 0.0), hands: Vec::new(), unplugged: vec![SensorPort::S2], goal: [1.0, -1.0] };
    let field = Field::new(&kickoff);
    let missing = field.ultrasonic_sensor(SensorPort::S2).err().unwrap();
    assert_eq!(missing.to_string(), "no sonar answers at port S2");
    assert!(field.compass(SensorPort::S4).is_err() && field.regulated_motor(MotorPort::B).is_err());
    field.wait_for_any_press();
    assert!(field.ultrasonic_sensor(SensorPort::S2).is_ok());
}

#[test]
fn the_arms_open_where_they_end() {
    let field = field((1.5, 0.0), Vec::new());
    let inner = field.lock();
    let left = std::f64::consts::FRAC_PI_2;
    let gap = |ahead: f64| inner.world.look([ahead, 0.0], left, 1.0, inner.ball).unwrap_or(f64::INFINITY);
    let around_the_ball = BODY[0] / 2.0 + BALL;
    assert!((BALL..BALL + 0.025).contains(&gap(around_the_ball)), "{}", gap(around_the_ball));
    assert!(gap(ARM[2][0]) > 2.0 * BALL && gap(0.25) > 0.5, "{}", gap(ARM[2][0]));
}
