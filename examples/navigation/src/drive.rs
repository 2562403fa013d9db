//! The codels that decide where to go and how: Navigation and PotentialField.

use lapwing_components::{Answer, Call, Codels, Datum, Trouble};

/// Codels of both components.
pub fn codels() -> Codels {
    let mut all = navigation();
    all.join(potential_field());
    all
}

fn navigation() -> Codels {
    Codels::new()
        .on("Navigation", "CheckPosition", |call: &mut Call| {
            let is_there = call.number("x")?.is_finite() && call.number("y")?.is_finite();
            Ok(if is_there { Answer::Ok } else { Answer::exception("UNREACHABLE") })
        })
        .on("Navigation", "PlanStart", |call: &mut Call| {
            for (name, value) in [("taken", call.seconds()), ("x", call.number("x")?), ("y", call.number("y")?)] {
                call.set(&format!("goal.{name}"), value)?;
            }
            call.set("goal.is_set", true)?;
            Ok(Answer::event("read_p"))
        })
        .on("Navigation", "ReadPose", |call: &mut Call| {
            if !call.has("Pose") {
                return Ok(Answer::exception("NO_POSE"));
            }
            call.copy("Pose", "pose")?;
            Ok(Answer::event("search"))
        })
        .on("Navigation", "Search", |call: &mut Call| {
            // Straight on: what stands in the way is the potential field's business.
            let goal = call.get("goal")?.clone();
            call.set("path.points", Datum::List(vec![goal]))?;
            call.set("path.next", 0_i64)?;
            Ok(Answer::event("follow"))
        })
        .on("Navigation", "Follow", follow)
        .on("Navigation", "WriteTarget", |call: &mut Call| {
            let next = call.number("path.next")? as usize;
            call.copy(&format!("path.points[{next}]"), "Target")?;
            call.set("Target.taken", call.seconds())?;
            call.write("Target")?;
            Ok(Answer::event("pause::follow"))
        })
        .on("Navigation", "ClearTarget", |call: &mut Call| {
            call.set("Target.is_set", false)?;
            call.write("Target")?;
            Ok(Answer::event("ether"))
        })
}

/// Goes on to the next point when one is reached; at the last one it is done.
fn follow(call: &mut Call) -> Result<Answer, Trouble> {
    call.copy("Pose", "pose")?;
    let next = call.number("path.next")? as usize;
    let Datum::List(points) = call.get("path.points")? else { return Ok(Answer::exception("UNREACHABLE")) };
    let count = points.len();
    let at = |name: &str| call.number(&format!("path.points[{next}].{name}"));
    let left = libm::hypot(at("x")? - call.number("pose.x")?, at("y")? - call.number("pose.y")?);
    if left > call.number("tolerance")? {
        return Ok(Answer::event("write_p"));
    }
    if next + 1 >= count {
        return Ok(Answer::event("ether"));
    }
    call.set("path.next", next as i64 + 1)?;
    Ok(Answer::event("write_p"))
}

fn potential_field() -> Codels {
    Codels::new()
        .on("PotentialField", "FieldStart", |call: &mut Call| {
            call.write("PFCmd")?;
            Ok(Answer::event("inputs"))
        })
        .on("PotentialField", "ReadInputs", |call: &mut Call| {
            if !(call.has("Target") && call.has("Pose")) {
                return Ok(Answer::event("pause::inputs"));
            }
            call.copy("Target", "target")?;
            call.copy("Pose", "pose")?;
            Ok(Answer::event("scan"))
        })
        .on("PotentialField", "ReadScanPort", |call: &mut Call| {
            if !call.has("Laser") {
                return Ok(Answer::exception("NO_SCAN"));
            }
            call.copy("Laser", "scan")?;
            Ok(Answer::event("compute"))
        })
        .on("PotentialField", "ComputeField", |call: &mut Call| {
            let (linear, angular) = match call.flag("target.is_set")? {
                true => speeds(call)?,
                false => (0.0, 0.0),
            };
            call.set("command.taken", call.seconds())?;
            call.set("command.speed.linear", linear)?;
            call.set("command.speed.angular", angular)?;
            Ok(Answer::event("write_p"))
        })
        .on("PotentialField", "WritePFCmd", |call: &mut Call| {
            call.copy("command", "PFCmd")?;
            call.write("PFCmd")?;
            Ok(Answer::event("pause::inputs"))
        })
        .on("PotentialField", "FieldStop", |call: &mut Call| {
            call.set("PFCmd.speed.linear", 0.0)?;
            call.set("PFCmd.speed.angular", 0.0)?;
            call.write("PFCmd")?;
            Ok(Answer::event("ether"))
        })
}

/// How near an obstacle counts as touching: the field has no end there.
const NEAREST: f64 = 0.15;

/// How much an obstacle leads around it, as a share of how much it pushes away.
const AROUND: f64 = 0.8;

/// The speed that the field asks for: the target pulls, and what the laser sees pushes, the more the nearer it is.
fn speeds(call: &Call) -> Result<(f64, f64), Trouble> {
    let (x, y, yaw) = (call.number("pose.x")?, call.number("pose.y")?, call.number("pose.yaw")?);
    let (dx, dy) = (call.number("target.x")? - x, call.number("target.y")? - y);
    let (far, angle) = (libm::hypot(dx, dy), lapwing_sim::wrap(libm::atan2(dy, dx) - yaw));
    let (attraction, repulsion) = (call.number("gains.attraction")?, call.number("gains.repulsion")?);
    let reach = call.number("gains.reach")?;
    let pull = attraction * far.min(1.0);
    let (mut ahead, mut left) = (pull * libm::cos(angle), pull * libm::sin(angle));
    let ranges = call.numbers("scan.ranges")?;
    let width = std::f64::consts::PI / ranges.len().max(1) as f64;
    for (beam, range) in ranges.iter().enumerate().filter(|(_, range)| **range < reach) {
        let near = (range - crate::field::RADIUS).max(NEAREST);
        let push = repulsion * (1.0 / near - 1.0 / reach).max(0.0) / near * width;
        let direction = (beam as f64 + 0.5) * width - std::f64::consts::FRAC_PI_2;
        let (sin, cos) = libm::sincos(direction);
        // Around it as well as away from it, on the side of the target: else the robot would stand where the forces cancel.
        let around = if angle >= direction { AROUND * push } else { -AROUND * push };
        (ahead, left) = (ahead - push * cos - around * sin, left - push * sin + around * cos);
    }
    let turn = libm::atan2(left, ahead.max(0.05));
    Ok((ahead.clamp(0.0, 0.8) * libm::cos(turn).max(0.0), (1.5 * turn).clamp(-1.5, 1.5)))
}
