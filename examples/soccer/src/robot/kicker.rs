//! The mission of a kicker: find the ball, turn to it, go to it, grab it, turn to the goal, dribble, kick, and again until the ball is in.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

use tracing::{info, instrument, warn};

use super::hardware::{Brick, InfraredMode, MotorPort, NotConnected, SensorPort};
use super::motor_controller::{MotorController, Ports};
use super::sensor_controller::SensorController;
use super::settings::Settings;

/// A robot that shoots at the goal. It can be shared: a second hand may help it up while it plays.
pub struct Kicker {
    brick: Arc<dyn Brick>,
    settings: Settings,
    controllers: RwLock<Option<Controllers>>,
    ball_kicked: AtomicBool,
}

/// What a kicker has when its cables are where they should be.
#[derive(Clone)]
struct Controllers {
    motors: Arc<MotorController>,
    sensors: Arc<SensorController>,
}

const PORTS: Ports = Ports { left: MotorPort::A, right: MotorPort::D, arm: MotorPort::C, compass: SensorPort::S1 };
const SONAR: SensorPort = SensorPort::S2;
const SEEKER: SensorPort = SensorPort::S3;

impl Kicker {
    /// A kicker that is not connected to anything yet.
    pub fn new(brick: Arc<dyn Brick>, settings: Settings) -> Kicker {
        Kicker { brick, settings, controllers: RwLock::default(), ball_kicked: AtomicBool::new(false) }
    }

    /// Connects to motors and sensors, and reads each once. Whether that went well says [`Kicker::ready`].
    #[instrument(skip_all)]
    pub fn init(&self) {
        match self.connect() {
            Ok(controllers) => {
                controllers.sensors.flush_sensors();
                controllers.motors.update();
                *self.controllers.write().unwrap_or_else(PoisonError::into_inner) = Some(controllers);
                info!(playing = false);
            }
            Err(missing) => warn!("{missing}"),
        }
    }

    fn connect(&self) -> Result<Controllers, NotConnected> {
        let motors = Arc::new(MotorController::new(self.brick.clone(), PORTS, &self.settings)?);
        let sensors = Arc::new(SensorController::new(self.brick.clone(), SEEKER, SONAR, &self.settings)?);
        Ok(Controllers { motors, sensors })
    }

    /// Whether all motors and sensors are there.
    #[instrument(skip_all, ret)]
    pub fn ready(&self) -> bool {
        self.controllers().is_some()
    }

    /// The wheels and the arm; `None` before the robot is ready.
    pub fn motors(&self) -> Option<Arc<MotorController>> {
        self.controllers().map(|c| c.motors)
    }

    /// The sensors; `None` before the robot is ready.
    pub fn sensors(&self) -> Option<Arc<SensorController>> {
        self.controllers().map(|c| c.sensors)
    }

    /// What it was told.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The brick that it runs on.
    pub fn brick(&self) -> &dyn Brick {
        &*self.brick
    }

    /// Notes whether the ball is in the goal, as far as the robot can tell.
    pub fn set_ball_kicked_at_goal(&self, kicked: bool) {
        self.ball_kicked.store(kicked, Ordering::Relaxed);
    }

    /// Whether it is.
    pub fn is_ball_kicked_at_goal(&self) -> bool {
        self.ball_kicked.load(Ordering::Relaxed)
    }

    /// Whether the match has lasted as long as it may.
    pub fn is_time_up(&self) -> bool {
        self.brick.elapsed() >= self.settings.match_length
    }

    fn controllers(&self) -> Option<Controllers> {
        self.controllers.read().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// The steps of the mission. Each takes the next through `self`, so that another player may do one of them in its own way.
///
/// A robot that is not ready does nothing, and finds nothing.
pub trait Mission {
    /// The robot that plays.
    fn kicker(&self) -> &Kicker;

    /// Plays until the ball is in the goal, or the time is up.
    #[instrument(skip_all)]
    fn play(&self) {
        let kicker = self.kicker();
        let Some(sensors) = kicker.sensors() else {
            warn!("not ready");
            return;
        };
        sensors.flush_sensors();
        info!(playing = true);
        while !kicker.is_ball_kicked_at_goal() && !kicker.is_time_up() {
            if !self.find_ball() {
                continue;
            }
            if !self.goto_goal() {
                info!("lost the ball");
                continue;
            }
            // One more look: what is kicked should be there.
            self.ball_in_front();
            self.kick_ball();
            kicker.set_ball_kicked_at_goal(self.ball_in_front());
        }
        self.game_over();
    }

    /// Turns and goes until the ball is between the arms. Gives up after some tries.
    #[instrument(skip_all, ret)]
    fn find_ball(&self) -> bool {
        (0..self.kicker().settings().tries).any(|_| {
            self.turn_to_ball();
            self.goto_ball()
        })
    }

    /// Turns until the ball is in front. Gives up after some turns.
    #[instrument(skip_all, ret)]
    fn turn_to_ball(&self) -> bool {
        let Some(motors) = self.kicker().motors() else { return false };
        let settings = self.kicker().settings();
        (0..settings.turns).any(|_| {
            if self.ball_in_front() {
                return true;
            }
            // The seeker counts clockwise, the wheels anticlockwise.
            let angle = self.ball_angle().map_or(settings.search_turn, |angle| -angle);
            motors.turn(settings.turn_speed, angle);
            false
        })
    }

    /// Goes ahead until the ball is between the arms, and a little farther to grab it. Gives up when it is no longer in front.
    #[instrument(skip_all, ret)]
    fn goto_ball(&self) -> bool {
        let kicker = self.kicker();
        let (Some(motors), Some(sensors)) = (kicker.motors(), kicker.sensors()) else { return false };
        let settings = kicker.settings();
        loop {
            motors.update();
            let is_close = sensors.get_sonar() <= settings.sonar_close;
            motors.go_forward(if is_close { settings.approach_speed / 2.0 } else { settings.approach_speed });
            let has_ball = self.has_ball();
            if has_ball {
                kicker.brick().delay(settings.grab);
            }
            if !self.ball_in_front() || has_ball || kicker.is_time_up() {
                return self.has_ball();
            }
        }
    }

    /// Takes the ball near the goal. Gives up when it is lost.
    #[instrument(skip_all, ret)]
    fn goto_goal(&self) -> bool {
        let kicker = self.kicker();
        let Some(motors) = kicker.motors() else { return false };
        while !motors.in_goal_range() {
            motors.set_out_for_goal(kicker.settings().dribble_speed, kicker.settings().dribble_turn);
            self.ball_close();
            if !self.ball_in_front() || kicker.is_time_up() {
                motors.stop();
                return false;
            }
        }
        true
    }

    /// Runs, and strikes with the arm.
    #[instrument(skip_all)]
    fn kick_ball(&self) {
        let kicker = self.kicker();
        let Some(motors) = kicker.motors() else { return };
        motors.go_forward(kicker.settings().full_speed);
        kicker.brick().delay(kicker.settings().run_up);
        motors.move_arm(&[(true, Duration::from_millis(300)), (false, Duration::from_millis(300))]);
        motors.stop();
        motors.update();
    }

    /// The match is over.
    #[instrument(skip_all)]
    fn game_over(&self) {
        if let Some(motors) = self.kicker().motors() {
            motors.stop();
        }
        info!(playing = false);
        info!("game over");
    }

    /// Whether the ball is straight ahead, or close.
    #[instrument(skip_all, ret)]
    fn ball_in_front(&self) -> bool {
        let Some(sensors) = self.kicker().sensors() else { return false };
        sensors.get_ir(InfraredMode::Unmodulated);
        sensors.get_ir(InfraredMode::Modulated);
        let ahead = |mode| sensors.last_ir(mode) == Some(0.0);
        let is_close = self.ball_close();
        ahead(InfraredMode::Unmodulated) || ahead(InfraredMode::Modulated) || is_close
    }

    /// Whether the ball is close.
    #[instrument(skip_all, ret)]
    fn ball_close(&self) -> bool {
        let kicker = self.kicker();
        let Some(distance) = kicker.sensors().map(|sensors| sensors.get_sonar()) else { return false };
        distance <= kicker.settings().sonar_close && distance != kicker.settings().sonar_error
    }

    /// Whether the ball is between the arms.
    #[instrument(skip_all, ret)]
    fn has_ball(&self) -> bool {
        let kicker = self.kicker();
        let Some(distance) = kicker.sensors().map(|sensors| sensors.get_sonar()) else { return false };
        distance <= kicker.settings().sonar_in_arms && distance != kicker.settings().sonar_error
    }

    /// Where the ball is, in degrees clockwise: the mean of what the seeker sees in its two ways; `None` without a signal.
    fn ball_angle(&self) -> Option<f64> {
        let sensors = self.kicker().sensors()?;
        let seen = [InfraredMode::Unmodulated, InfraredMode::Modulated].map(|mode| {
            sensors.get_ir(mode);
            sensors.last_ir(mode)
        });
        let seen: Vec<f64> = seen.into_iter().flatten().collect();
        (!seen.is_empty()).then(|| seen.iter().sum::<f64>() / seen.len() as f64)
    }
}

impl Mission for Kicker {
    fn kicker(&self) -> &Kicker {
        self
    }
}
