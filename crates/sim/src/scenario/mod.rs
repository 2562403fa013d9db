//! A scenario: a world, robots with what they do, and what goes wrong, read from a file.

mod check;
mod error;
mod file;
mod number;

use std::path::Path;

use crate::fault::Order;

pub use error::{ScenarioError, similar};
pub use file::{
    Action, Climb, Commands, Crate, Dock, DockDrive, Drive, Drone, Event, File, Follow, Kind, Line, Odometry, Post,
    Road, Robot, Scatter, Sign, Wall, Wander, Waypoints, World,
};
pub use number::{Amount, Number, Size, draw_point};

/// A scenario without errors.
#[derive(Clone, Debug)]
pub struct Scenario {
    name: String,
    text: String,
    file: File,
}

/// The scenarios that come with the simulator: names and texts.
pub const BUNDLED: &[(&str, &str)] = &[
    ("patrol", include_str!("../../scenarios/patrol.toml")),
    ("wander", include_str!("../../scenarios/wander.toml")),
    ("stop-sign", include_str!("../../scenarios/stop-sign.toml")),
    ("follow-the-leader", include_str!("../../scenarios/follow-the-leader.toml")),
    ("localization", include_str!("../../scenarios/localization.toml")),
    ("rotors", include_str!("../../scenarios/rotors.toml")),
    ("turning", include_str!("../../scenarios/turning.toml")),
    ("docking", include_str!("../../scenarios/docking.toml")),
    ("errand", include_str!("../../scenarios/errand.toml")),
    ("emergency", include_str!("../../scenarios/emergency.toml")),
    ("modes", include_str!("../../scenarios/modes.toml")),
    ("silence", include_str!("../../scenarios/silence.toml")),
    ("bump", include_str!("../../scenarios/bump.toml")),
    ("fleet", include_str!("../../scenarios/fleet.toml")),
    ("traffic", include_str!("../../scenarios/traffic.toml")),
];

impl Scenario {
    /// Reads and checks a text; `name` is what it is called.
    pub fn parse(name: &str, text: &str) -> Result<Scenario, ScenarioError> {
        let file: File = toml::from_str(text).map_err(|e| ScenarioError::of_toml(name, text, &e))?;
        check::check(name, text, &file)?;
        Ok(Scenario { name: name.to_owned(), text: text.to_owned(), file })
    }

    /// Reads and checks a file.
    pub fn load(path: &Path) -> Result<Scenario, ScenarioError> {
        let name = path.to_string_lossy();
        let text = std::fs::read_to_string(path).map_err(|e| ScenarioError::new(&name, "", None, e.to_string()))?;
        Scenario::parse(&name, &text)
    }

    /// One that comes with the simulator, by its name.
    pub fn bundled(name: &str) -> Option<Result<Scenario, ScenarioError>> {
        BUNDLED.iter().find(|(n, _)| *n == name).map(|(name, text)| Scenario::parse(name, text))
    }

    /// Whether a fault can be ordered: the robot that it is meant for, where one is named, must be there.
    pub fn accepts(&self, order: &Order) -> Result<(), ScenarioError> {
        check::order(&self.name, &self.file, order)
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What it says.
    pub fn file(&self) -> &File {
        &self.file
    }
}
