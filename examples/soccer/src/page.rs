//! A page that shows a match: the field from above, the state of the robot in its colour, and a bar of time on which violations are marked. One file,
//! with everything in it.

use serde::Serialize;

use crate::field::{ARM, ARM_THICK, BALL, BODY, CORNERS, GOAL, facing};
use crate::game::Account;
use crate::robot::Settings;

const FRAME: &str = include_str!("../assets/match.html");
const STYLE: &str = include_str!("../assets/match.css");
const SCRIPT: &str = include_str!("../assets/match.js");

/// What the script draws.
#[derive(Serialize)]
struct Data<'a> {
    account: &'a Account,
    /// The middle of the goal, and the way into it in radians.
    goal: [f64; 3],
    /// How wide and how deep it is.
    goal_size: [f64; 2],
    /// From how near the robot shoots.
    goal_range: f64,
    corners: [[f64; 2]; 2],
    ball: f64,
    body: [f64; 2],
    arm: [[f64; 2]; 3],
    arm_thick: f64,
}

/// The page.
pub fn html(account: &Account) -> serde_json::Result<String> {
    let settings = Settings::default();
    let goal = facing(settings.goal);
    let data = Data {
        account,
        goal: [goal.x, goal.y, goal.yaw],
        goal_size: GOAL,
        goal_range: settings.goal_range,
        corners: CORNERS,
        ball: BALL,
        body: BODY,
        arm: ARM,
        arm_thick: ARM_THICK,
    };
    // `<` might end the script that the data stand in.
    let data = serde_json::to_string(&data)?.replace('<', "\\u003c");
    Ok(FRAME.replace("/*STYLE*/", STYLE).replace("/*SCRIPT*/", SCRIPT).replace("\"DATA\"", &data))
}
