//! Where the robot is, and how it gets to a point: what leJOS has as odometry, pilot and navigator.
//!
//! There it runs in a thread of its own; here it goes on whenever it is asked ([`Navigator::update`]), which the mission does in each of its loops.

use super::hardware::{RegulatedMotor, SampleProvider};
use super::settings::Settings;

/// Where the robot is, in metres, and where it faces, in degrees anticlockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// Ahead of where it started.
    pub x: f64,
    /// To the left of where it started.
    pub y: f64,
    /// Anticlockwise from where it faced at first.
    pub heading: f64,
}

impl Position {
    /// How far it is to a point.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        libm::hypot(x - self.x, y - self.y)
    }

    /// By how much to turn anticlockwise to face a point.
    pub fn bearing(&self, [x, y]: [f64; 2]) -> f64 {
        wrap(libm::atan2(y - self.y, x - self.x).to_degrees() - self.heading)
    }
}

/// Two wheels, a compass, and a point to go to.
pub struct Navigator {
    left: Box<dyn RegulatedMotor>,
    right: Box<dyn RegulatedMotor>,
    compass: Box<dyn SampleProvider>,
    /// What the compass read at the start.
    north: f64,
    wheel: f64,
    track: f64,
    tachos: [f64; 2],
    position: Position,
    linear: f64,
    angular: f64,
    way: Way,
}

/// What the robot is about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// It stands, or does what it was last told.
    Free,
    /// It turns towards a point.
    Turning([f64; 2]),
    /// It drives towards a point.
    Driving([f64; 2]),
}

/// How nearly it faces a point before it drives, in degrees.
const FACING: f64 = 2.0;
/// How far it may face away from a point before it turns again.
const ASTRAY: f64 = 10.0;
/// How near a point is there, in metres.
const THERE: f64 = 0.02;
/// How much a look at the compass counts against the wheels.
const TRUST: f64 = 0.05;

impl Navigator {
    /// At the origin of its map, at rest.
    pub fn new(
        left: Box<dyn RegulatedMotor>,
        right: Box<dyn RegulatedMotor>,
        compass: Box<dyn SampleProvider>,
        settings: &Settings,
    ) -> Navigator {
        let tachos = [left.tacho_count(), right.tacho_count()];
        Navigator {
            north: compass.fetch_sample(),
            left,
            right,
            compass,
            wheel: settings.wheel_diameter,
            track: settings.track_width,
            tachos,
            position: Position::default(),
            linear: settings.dribble_speed,
            angular: settings.turn_speed,
            way: Way::Free,
        }
    }

    /// How fast it drives from now on, in m/s.
    pub fn set_linear_speed(&mut self, speed: f64) {
        self.linear = speed;
    }

    /// How fast it turns from now on, in degrees a second.
    pub fn set_angular_speed(&mut self, speed: f64) {
        self.angular = speed;
    }

    /// Drives straight on.
    pub fn forward(&mut self) {
        self.way = Way::Free;
        self.drive(self.linear, self.linear);
    }

    /// Turns on the spot: anticlockwise, or else clockwise.
    pub fn spin(&mut self, anticlockwise: bool) {
        self.way = Way::Free;
        self.rotate(anticlockwise);
    }

    /// Goes to a point, by turning and then driving. It has not begun when this returns. Who is on the way goes on.
    pub fn go_to(&mut self, point: [f64; 2]) {
        if ![Way::Turning(point), Way::Driving(point)].contains(&self.way) {
            self.turn_to(point);
        }
    }

    fn turn_to(&mut self, point: [f64; 2]) {
        self.way = Way::Turning(point);
        self.rotate(self.position.bearing(point) > 0.0);
    }

    /// Stops, and forgets where it was to go.
    pub fn stop(&mut self) {
        self.way = Way::Free;
        self.drive(0.0, 0.0);
    }

    /// Where it is, as of the last update.
    pub fn position(&self) -> Position {
        self.position
    }

    /// How fast the left and the right wheel turn, in degrees a second.
    pub fn wheel_speeds(&self) -> [f64; 2] {
        [self.left.rotation_speed(), self.right.rotation_speed()]
    }

    /// Reads wheels and compass, and goes on with what it is about.
    pub fn update(&mut self) {
        self.locate();
        match self.way {
            Way::Free => {}
            Way::Turning(point) => {
                let bearing = self.position.bearing(point);
                if bearing.abs() <= FACING {
                    self.way = Way::Driving(point);
                    self.drive(self.linear, self.linear);
                } else {
                    self.rotate(bearing > 0.0);
                }
            }
            Way::Driving(point) if self.position.distance(point) <= THERE => self.stop(),
            Way::Driving(point) if self.position.bearing(point).abs() > ASTRAY => self.turn_to(point),
            Way::Driving(_) => {}
        }
    }

    /// Adds what the wheels have rolled, and corrects the heading a little by the compass.
    fn locate(&mut self) {
        let now = [self.left.tacho_count(), self.right.tacho_count()];
        let rolled = |from: f64, to: f64| (to - from).to_radians() * self.wheel / 2.0;
        let (left, right) = (rolled(self.tachos[0], now[0]), rolled(self.tachos[1], now[1]));
        self.tachos = now;
        let turned = ((right - left) / self.track).to_degrees();
        let (sin, cos) = libm::sincos((self.position.heading + turned / 2.0).to_radians());
        self.position.x += (left + right) / 2.0 * cos;
        self.position.y += (left + right) / 2.0 * sin;
        let heading = wrap(self.position.heading + turned);
        let error = wrap(self.compass.fetch_sample() - self.north - heading);
        self.position.heading = if error.is_nan() { heading } else { wrap(heading + TRUST * error) };
    }

    fn rotate(&mut self, anticlockwise: bool) {
        let speed = self.angular.to_radians() * self.track / 2.0;
        let speed = if anticlockwise { speed } else { -speed };
        self.drive(-speed, speed);
    }

    /// Sets the speeds of the wheels over the floor, in m/s.
    fn drive(&mut self, left: f64, right: f64) {
        for (motor, speed) in [(&self.left, left), (&self.right, right)] {
            motor.set_speed((speed / (self.wheel / 2.0)).to_degrees().abs());
            if speed > 0.0 {
                motor.forward();
            } else if speed < 0.0 {
                motor.backward();
            } else {
                motor.stop();
            }
        }
    }
}

/// An angle within half a turn, in degrees.
fn wrap(angle: f64) -> f64 {
    let turned = (angle + 180.0).rem_euclid(360.0) - 180.0;
    if turned == -180.0 { 180.0 } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_found_where_they_are() {
        let here = Position { x: 1.0, y: 0.0, heading: 90.0 };
        assert!((here.distance([1.0, 2.0]) - 2.0).abs() < 1e-12 && here.bearing([1.0, 2.0]).abs() < 1e-9);
        assert!((here.bearing([2.0, 0.0]) + 90.0).abs() < 1e-9, "to the right is negative");
        for (angle, wrapped) in [(190.0, -170.0), (-190.0, 170.0), (720.0, 0.0), (-180.0, 180.0)] {
            assert_eq!(wrap(angle), wrapped);
        }
    }
}
