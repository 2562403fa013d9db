//! What a scenario file may say. Lengths are in metres, times in seconds, angles in degrees, masses in kilograms.

use serde::Deserialize;
use toml::Spanned;

use super::number::{Amount, Number, Size};
use crate::fault::Order;

/// A whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct File {
    /// What it shows, in one sentence.
    pub about: String,
    /// How long a run takes.
    #[serde(default = "half_a_minute")]
    pub duration: Number,
    /// The faults that are there from the start.
    #[serde(default)]
    pub faults: Vec<Spanned<Order>>,
    /// What stands around.
    #[serde(default)]
    pub world: World,
    /// The robots on wheels.
    #[serde(default)]
    pub robot: Vec<Robot>,
    /// The drones.
    #[serde(default)]
    pub drone: Vec<Drone>,
}

/// What stands around.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct World {
    /// A room around the origin: its length to the east and its width to the north.
    pub room: Option<[Size; 2]>,
    /// Walls.
    #[serde(default)]
    pub wall: Vec<Wall>,
    /// Round posts.
    #[serde(default)]
    pub post: Vec<Post>,
    /// Boxes.
    #[serde(default, rename = "box")]
    pub boxes: Vec<Crate>,
    /// Signs beside the road.
    #[serde(default)]
    pub sign: Vec<Sign>,
    /// Posts that stand anywhere.
    pub scatter: Option<Scatter>,
    /// A charging station.
    pub dock: Option<Dock>,
}

/// A wall from one point to another.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Wall {
    /// Where it begins.
    pub from: [Number; 2],
    /// Where it ends.
    pub to: [Number; 2],
}

/// A round post.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Post {
    /// Where.
    pub at: [Number; 2],
    /// Its radius.
    pub radius: Size,
}

/// A box, which stays where it is, or can be pushed where it has a mass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Crate {
    /// What it is called in the ground truth.
    pub name: Spanned<String>,
    /// Where.
    pub at: [Number; 2],
    /// Length and width.
    pub size: [Size; 2],
    /// Which way its length points.
    #[serde(default = "zero")]
    pub heading: Number,
    /// What it weighs.
    pub mass: Option<Size>,
}

/// A sign beside the road.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Sign {
    /// What it is called in the ground truth.
    pub name: Spanned<String>,
    /// Where.
    pub at: [Number; 2],
}

/// Posts that stand anywhere in a field around the origin, but for where the robots start.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Scatter {
    /// How many.
    pub count: Amount,
    /// The length and the width of the field.
    pub within: [Size; 2],
    /// Their radius.
    pub radius: Size,
    /// How far they keep from where a robot starts.
    pub clear: Amount,
}

/// A charging station.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Dock {
    /// Where.
    pub at: [Number; 2],
    /// How near the middle of a robot has to come.
    #[serde(default = "dock_reach")]
    pub reach: Amount,
    /// By how much of its capacity a battery is charged in a second.
    #[serde(default = "dock_rate")]
    pub rate: Amount,
}

/// A robot on wheels.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Robot {
    /// What it is called in the ground truth.
    pub name: Spanned<String>,
    /// What it is.
    #[serde(default)]
    pub kind: Kind,
    /// Where it starts.
    pub at: [Number; 2],
    /// Which way it looks there, anticlockwise from the east.
    #[serde(default = "zero")]
    pub heading: Number,
    /// What its topics begin with: nothing where it is the only robot, else its name.
    pub topics: Option<String>,
    /// What it weighs, where that is not usual for its kind.
    pub mass: Option<Size>,
    /// How full its battery is, from 0 to 1.
    #[serde(default = "charged")]
    pub charge: Amount,
    /// How good its odometry is.
    #[serde(default)]
    pub odometry: Odometry,
    /// What its program does.
    pub drive: Drive,
    /// Whose commands its base obeys.
    #[serde(default)]
    pub commands: Commands,
    /// What people do to it.
    #[serde(default)]
    pub event: Vec<Event>,
}

/// What a robot on wheels is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// As small and as fast as a TurtleBot3 Burger.
    #[default]
    Turtlebot3,
    /// A small car.
    Car,
}

/// Whose commands the base of a robot obeys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Commands {
    /// Those of its program, as the faults between the two alter them.
    #[default]
    Own,
    /// Those that other nodes of a live graph publish on `cmd_vel`. Its program speaks all the same, on `cmd_vel_original`.
    Outside,
}

/// How good an odometry is.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct Odometry {
    /// By how much it takes a wheel to be larger or smaller than it is, as a share: the standard deviation between robots.
    pub drift: Amount,
    /// The noise of the speed that it gives, as a share of the speed.
    pub noise: Amount,
}

/// What a robot's program does.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    /// It gives no commands.
    Rest {},
    /// Commands at given times, each repeated until the next.
    Script(Vec<Line>),
    /// From point to point.
    Waypoints(Waypoints),
    /// Anywhere, but not into what its scanner sees.
    Wander(Wander),
    /// To a point at one speed, and from there to another one slowly.
    Dock(DockDrive),
    /// Behind another robot.
    Follow(Follow),
    /// Straight on, with a stop at each sign.
    Road(Road),
}

/// A command of a script.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Line {
    /// From when on.
    pub at: Amount,
    /// Forwards, in m/s.
    #[serde(default = "zero")]
    pub ahead: Number,
    /// Anticlockwise, in degrees a second.
    #[serde(default = "zero")]
    pub turn: Number,
    /// Whether the program says nothing at all from then on.
    #[serde(default)]
    pub silent: bool,
}

/// From point to point.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Waypoints {
    /// The points.
    pub points: Vec<[Number; 2]>,
    /// The speed between them.
    pub speed: Amount,
    /// How fast it turns, in degrees a second.
    #[serde(default = "quick_turn")]
    pub turn: Amount,
    /// Whether the first point comes after the last.
    #[serde(default)]
    pub again: bool,
}

/// Anywhere.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Wander {
    /// The speeds that it chooses from.
    pub speed: Amount,
    /// The turns that it chooses from, in degrees a second; it turns to either side.
    pub turn: Amount,
    /// How long it keeps to a choice.
    pub keep: Amount,
    /// How near the scanner may see something ahead before it turns away.
    #[serde(default = "wander_clear")]
    pub clear: Amount,
}

/// To a point at one speed, and from there to another one slowly.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct DockDrive {
    /// The first point.
    pub before: [Number; 2],
    /// The second one.
    pub at: [Number; 2],
    /// The speed to the first.
    pub speed: Amount,
    /// The speed from there on.
    pub creep: Amount,
}

/// Behind another robot.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Follow {
    /// The name of the other one.
    pub whom: Spanned<String>,
    /// How far behind.
    pub gap: Amount,
    /// The greatest speed.
    pub speed: Amount,
}

/// Straight on, with a stop at each sign.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Road {
    /// The speed between signs.
    pub speed: Amount,
    /// How near a sign it stops.
    #[serde(default = "stop_near")]
    pub stop: Amount,
    /// For how long.
    #[serde(default = "stop_time")]
    pub wait: Amount,
}

/// Something that people do to a robot.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Event {
    /// When.
    pub at: Amount,
    /// What.
    #[serde(rename = "do")]
    pub action: Action,
}

/// What people do to a robot.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Action {
    /// The emergency stop is pressed.
    PressStop,
    /// The emergency stop is released.
    ReleaseStop,
    /// The base is enabled after an emergency stop.
    Enable,
    /// The odometry is set to zero.
    ResetOdometry,
    /// Another mode is asked for.
    SetMode(String),
}

/// A drone.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Drone {
    /// What it is called in the ground truth.
    pub name: Spanned<String>,
    /// Above which point.
    pub at: [Number; 2],
    /// What its topics begin with.
    #[serde(default = "drone_topics")]
    pub topics: String,
    /// The altitudes that it is told to go to, and when.
    pub climb: Vec<Climb>,
}

/// An altitude to go to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Climb {
    /// From when on.
    pub at: Amount,
    /// The altitude.
    pub to: Amount,
}

impl Default for Odometry {
    fn default() -> Odometry {
        Odometry { drift: Amount::given(0.004), noise: Amount::given(0.01) }
    }
}

fn half_a_minute() -> Number {
    Number::Given(30.0)
}

fn zero() -> Number {
    Number::Given(0.0)
}

fn charged() -> Amount {
    Amount::given(0.9)
}

fn dock_reach() -> Amount {
    Amount::given(0.1)
}

fn dock_rate() -> Amount {
    Amount::given(0.05)
}

fn quick_turn() -> Amount {
    Amount::given(60.0)
}

fn wander_clear() -> Amount {
    Amount::given(0.45)
}

fn stop_near() -> Amount {
    Amount::given(0.8)
}

fn stop_time() -> Amount {
    Amount::given(1.5)
}

fn drone_topics() -> String {
    "/drone_mov".to_owned()
}
