//! The estimate of the pose: an extended Kalman filter over position, heading, speed and rate of turn.

use lapwing_components::{Answer, Call, Codels, Trouble};

/// How many numbers the state has.
const N: usize = 5;

type Vector = [f64; N];
type Matrix = [[f64; N]; N];

/// How much the speed and the rate of turn may change in a second, as standard deviations.
const CHANGES: (f64, f64) = (1.5, 3.0);

/// How many seconds lie between two fixes.
const FIXES: f64 = 0.1;

/// A filter: what is believed, and how firmly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// x, y, heading, speed, rate of turn.
    pub state: Vector,
    /// How they vary together.
    pub covariance: Matrix,
}

impl Filter {
    /// At the origin, at rest, and fairly sure of it.
    pub fn new() -> Filter {
        let mut covariance = [[0.0; N]; N];
        for (place, sigma) in [0.1, 0.1, 0.05, 0.05, 0.05].into_iter().enumerate() {
            covariance[place][place] = sigma * sigma;
        }
        Filter { state: [0.0; N], covariance }
    }

    /// Time passes: the robot goes on as it did.
    pub fn predict(&mut self, dt: f64) {
        let [x, y, yaw, speed, rate] = self.state;
        let (sin, cos) = libm::sincos(yaw);
        self.state = [x + speed * cos * dt, y + speed * sin * dt, lapwing_sim::wrap(yaw + rate * dt), speed, rate];
        let mut f = identity();
        (f[0][2], f[0][3]) = (-speed * sin * dt, cos * dt);
        (f[1][2], f[1][3]) = (speed * cos * dt, sin * dt);
        f[2][4] = dt;
        self.covariance = product(&product(&f, &self.covariance), &transposed(&f));
        self.covariance[3][3] += CHANGES.0 * CHANGES.0 * dt;
        self.covariance[4][4] += CHANGES.1 * CHANGES.1 * dt;
    }

    /// One of its numbers was measured, with that standard deviation.
    pub fn correct(&mut self, number: usize, measured: f64, sigma: f64) {
        let (Some(believed), Some(row)) = (self.state.get(number).copied(), self.covariance.get(number).copied())
        else {
            return;
        };
        let spread = row[number] + sigma * sigma;
        if spread <= 0.0 {
            return;
        }
        let gain: Vector = std::array::from_fn(|i| self.covariance[i][number] / spread);
        for (i, gain) in gain.into_iter().enumerate() {
            self.state[i] += gain * (measured - believed);
            for (j, value) in row.into_iter().enumerate() {
                self.covariance[i][j] -= gain * value;
            }
        }
    }

    fn of(call: &Call) -> Result<Filter, Trouble> {
        let (state, flat) = (call.numbers("filter.state")?, call.numbers("filter.covariance")?);
        let at = |list: &[f64], n: usize| list.get(n).copied().unwrap_or(0.0);
        Ok(Filter {
            state: std::array::from_fn(|i| at(&state, i)),
            covariance: std::array::from_fn(|i| std::array::from_fn(|j| at(&flat, i * N + j))),
        })
    }

    fn keep(&self, call: &mut Call) -> Result<(), Trouble> {
        call.set("filter.state", self.state.to_vec())?;
        call.set("filter.covariance", self.covariance.concat())
    }
}

impl Default for Filter {
    fn default() -> Filter {
        Filter::new()
    }
}

fn identity() -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The codels of POM.
pub fn codels() -> Codels {
    Codels::new()
        .on("POM", "CheckNoise", |call: &mut Call| {
            let all = ["noise.odometry", "noise.imu", "noise.gps"].map(|name| call.number(name));
            let is_good = all.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().all(|x| x > 0.0);
            Ok(if is_good { Answer::Ok } else { Answer::exception("BAD_NOISE") })
        })
        .on("POM", "GatherStart", |_: &mut Call| Ok(Answer::event("odometry")))
        .on("POM", "ReadOdometry", |call: &mut Call| read(call, "Odometry", "odometry", "imu"))
        .on("POM", "ReadImu", |call: &mut Call| read(call, "IMU", "imu", "gps"))
        .on("POM", "ReadGps", |call: &mut Call| read(call, "GPS", "gps", "pause::odometry"))
        .on("POM", "GatherStop", |_: &mut Call| Ok(Answer::event("ether")))
        .on("POM", "FilterStart", |call: &mut Call| {
            Filter::new().keep(call)?;
            call.set("filter.last", call.seconds())?;
            Ok(Answer::event("predict"))
        })
        .on("POM", "Predict", predict)
        .on("POM", "Correct", |call: &mut Call| {
            let mut filter = Filter::of(call)?;
            let sigma = call.number("gps.sigma")?.max(call.number("noise.gps")?);
            filter.correct(0, call.number("gps.x")?, sigma);
            filter.correct(1, call.number("gps.y")?, sigma);
            filter.keep(call)?;
            Ok(Answer::event("write_p"))
        })
        .on("POM", "WritePose", |call: &mut Call| {
            let filter = Filter::of(call)?;
            let [x, y, yaw, ..] = filter.state;
            let sigma = libm::sqrt((filter.covariance[0][0] + filter.covariance[1][1]).max(0.0) / 2.0);
            for to in ["pose", "Pose"] {
                for (name, value) in [("taken", call.seconds()), ("x", x), ("y", y), ("yaw", yaw), ("sigma", sigma)] {
                    call.set(&format!("{to}.{name}"), value)?;
                }
            }
            call.write("Pose")?;
            Ok(Answer::event("pause::predict"))
        })
        .on("POM", "FilterStop", |_: &mut Call| Ok(Answer::event("ether")))
        .on("POM", "ResetFilter", |call: &mut Call| {
            let mut filter = Filter::new();
            filter.state = [call.number("x")?, call.number("y")?, call.number("yaw")?, 0.0, 0.0];
            filter.keep(call)?;
            Ok(Answer::Ok)
        })
}

fn read(call: &mut Call, port: &str, to: &str, next: &str) -> Result<Answer, Trouble> {
    if call.has(port) {
        call.copy(port, to)?;
    }
    Ok(Answer::event(next))
}

fn predict(call: &mut Call) -> Result<Answer, Trouble> {
    let mut filter = Filter::of(call)?;
    let now = call.seconds();
    let last = call.number("filter.last")?;
    filter.predict((now - last).clamp(0.0, 0.1));
    filter.correct(3, call.number("odometry.speed.linear")?, call.number("noise.odometry")?.max(1e-3));
    filter.correct(4, call.number("imu.yaw_rate")?, call.number("noise.imu")?.max(1e-3));
    filter.keep(call)?;
    call.set("filter.last", now)?;
    // Fixes come every 100 ms, and predictions every 10 ms: each fix is taken in once.
    let is_due = (now / FIXES).floor() > (last / FIXES).floor();
    Ok(Answer::event(if is_due { "correct" } else { "write_p" }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_finds_where_a_robot_is_that_was_put_down_elsewhere() {
        let mut filter = Filter::new();
        let before = filter.covariance[0][0];
        for _ in 0..200 {
            filter.predict(0.1);
            filter.correct(3, 0.5, 0.02);
            filter.correct(4, 0.0, 0.01);
            let along = filter.state[0];
            filter.correct(1, 0.4, 0.3);
            assert!(filter.state[0] >= along - 0.5);
        }
        assert!((filter.state[1] - 0.4).abs() < 0.1, "{:?}", filter.state);
        assert!((filter.state[3] - 0.5).abs() < 0.05 && filter.covariance[1][1] < before, "{filter:?}");
    }
}
