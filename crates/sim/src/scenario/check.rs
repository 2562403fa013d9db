//! What the types of a scenario file cannot say: names that must be there, names that must differ, limits of numbers.

use std::collections::BTreeSet;
use std::ops::Range;

use toml::Spanned;

use super::error::{ScenarioError, similar};
use super::file::{Drive, File};
use crate::fault::Order;

/// A run takes no longer, in seconds: a day.
const LONGEST: f64 = 86_400.0;
/// No scenario has more robots and objects, nor more scattered posts.
const MOST: usize = 1000;

pub(super) fn check(name: &str, text: &str, file: &File) -> Result<(), ScenarioError> {
    let cx = Context { name, text };
    cx.limits(file)?;
    let objects: Vec<&Spanned<String>> = file
        .robot
        .iter()
        .map(|r| &r.name)
        .chain(file.drone.iter().map(|d| &d.name))
        .chain(file.world.sign.iter().map(|s| &s.name))
        .chain(file.world.boxes.iter().map(|b| &b.name))
        .collect();
    cx.names(&objects)?;
    let robots: Vec<&str> =
        objects[..file.robot.len() + file.drone.len()].iter().map(|n| n.get_ref().as_str()).collect();
    for (number, robot) in file.robot.iter().enumerate() {
        if let Drive::Follow(follow) = &robot.drive {
            let (whom, others) = (follow.whom.get_ref(), &robots[..file.robot.len()]);
            cx.known(whom, Some(follow.whom.span()), others)?;
            if robots[number] == whom {
                return Err(cx.error(follow.whom.span(), "a robot cannot follow itself"));
            }
        }
    }
    for fault in &file.faults {
        if let Some(robot) = fault.get_ref().robot() {
            cx.known(robot, Some(fault.span()), &robots)?;
        }
    }
    Ok(())
}

/// Whether a fault that is ordered besides those of the file is meant for something that is there.
pub(super) fn order(name: &str, file: &File, order: &Order) -> Result<(), ScenarioError> {
    let robots = file.robot.iter().map(|r| r.name.get_ref()).chain(file.drone.iter().map(|d| d.name.get_ref()));
    let robots: Vec<&str> = robots.map(String::as_str).collect();
    match order.robot() {
        Some(robot) => Context { name, text: "" }.known(robot, None, &robots),
        None => Ok(()),
    }
}

struct Context<'c> {
    name: &'c str,
    text: &'c str,
}

impl Context<'_> {
    fn error(&self, span: Range<usize>, what: impl Into<String>) -> ScenarioError {
        ScenarioError::new(self.name, self.text, Some(span), what)
    }

    fn whole(&self, what: impl Into<String>) -> ScenarioError {
        ScenarioError::new(self.name, self.text, None, what)
    }

    fn limits(&self, file: &File) -> Result<(), ScenarioError> {
        if file.robot.is_empty() && file.drone.is_empty() {
            return Err(self.whole("there is no robot: a scenario needs at least one `[[robot]]` or `[[drone]]`"));
        }
        if !(file.duration.least() > 0.0 && file.duration.greatest() <= LONGEST) {
            return Err(self.whole(format!("`duration` must be greater than 0 and at most {LONGEST} s")));
        }
        let things = file.robot.len() + file.drone.len() + file.world.boxes.len() + file.world.sign.len();
        let more = file.world.post.len() + file.world.wall.len();
        let scattered = file.world.scatter.as_ref().map_or(0.0, |s| s.count.greatest());
        if things + more > MOST || scattered > MOST as f64 {
            return Err(
                self.whole(format!("there can be at most {MOST} robots and objects, and as many scattered posts"))
            );
        }
        Ok(())
    }

    /// Names that can be told apart, and that a specification can write.
    fn names(&self, names: &[&Spanned<String>]) -> Result<(), ScenarioError> {
        let mut seen = BTreeSet::new();
        for name in names {
            let word = name.get_ref();
            let starts = word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
            if !starts || !word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                return Err(self.error(name.span(), "a name has letters, digits and `_`, and begins with no digit"));
            }
            if !seen.insert(word) {
                return Err(self.error(name.span(), format!("there are two things called `{word}`")));
            }
        }
        Ok(())
    }

    fn known(&self, name: &str, span: Option<Range<usize>>, names: &[&str]) -> Result<(), ScenarioError> {
        if names.contains(&name) {
            return Ok(());
        }
        let help = match similar(name, names.iter().copied()) {
            Some(other) => format!("did you mean `{other}`?"),
            None => format!("there are: {}", names.join(", ")),
        };
        let what = format!("there is no robot called `{name}`");
        Err(ScenarioError::new(self.name, self.text, span, what).with_help(Some(help)))
    }
}
