//! The codels that speak with the hardware, which here is simulated: laser, receiver, inertial unit and base.

use lapwing_components::{Answer, Call, Codels, Trouble};
use lapwing_stream::Duration;

use crate::field::Field;

/// How many directions the laser looks into.
const BEAMS: usize = 180;

/// How far off fixes are, in metres.
const SIGMA: f64 = 0.15;

fn to(event: &'static str) -> impl Fn(&mut Call) -> Result<Answer, Trouble> {
    move |_| Ok(Answer::event(event))
}

/// The codels of the four drivers.
pub fn codels(field: &Field) -> Codels {
    let mut all = laser(field);
    all.join(receiver(field));
    all.join(inertial(field));
    all.join(base(field));
    all
}

fn laser(field: &Field) -> Codels {
    let field = field.clone();
    Codels::new()
        .on("LaserDriver", "Open", to("ether"))
        .on("LaserDriver", "Prepare", to("read"))
        .on("LaserDriver", "ReadScan", move |call: &mut Call| {
            call.set("scan.taken", call.seconds())?;
            call.set("scan.ranges", field.scan(call.seconds(), BEAMS))?;
            // The fault that can be injected: the scan is there, and the driver holds it back.
            let delay = call.number("delay")?;
            if delay > 0.0 {
                call.take(Duration::from_nanos((delay * 1e9) as i64));
            }
            Ok(Answer::event("write"))
        })
        .on("LaserDriver", "WriteLaser", |call: &mut Call| {
            call.copy("scan", "Laser")?;
            call.write("Laser")?;
            Ok(Answer::event("pause::read"))
        })
        .on("LaserDriver", "Release", to("ether"))
        .on("LaserDriver", "CheckDelay", |call: &mut Call| {
            Ok(if (0.0..=10.0).contains(&call.number("delay")?) { Answer::Ok } else { Answer::exception("BAD_DELAY") })
        })
        .on("LaserDriver", "StoreDelay", |call: &mut Call| {
            call.copy("delay", "stored")?;
            Ok(Answer::Ok)
        })
}

fn receiver(field: &Field) -> Codels {
    let field = field.clone();
    Codels::new()
        .on("GPSDriver", "GpsOpen", to("ether"))
        .on("GPSDriver", "GpsStart", to("get"))
        .on("GPSDriver", "GpsGet", move |call: &mut Call| {
            let [x, y] = field.fix(call.seconds(), SIGMA);
            for (name, value) in [("taken", call.seconds()), ("x", x), ("y", y), ("sigma", SIGMA)] {
                call.set(&format!("fix.{name}"), value)?;
            }
            Ok(Answer::event("write_p"))
        })
        .on("GPSDriver", "GpsWrite", |call: &mut Call| {
            call.copy("fix", "GPS")?;
            call.write("GPS")?;
            Ok(Answer::event("pause::get"))
        })
        .on("GPSDriver", "GpsStop", to("ether"))
}

fn inertial(field: &Field) -> Codels {
    let field = field.clone();
    Codels::new()
        .on("IMUDriver", "ImuOpen", to("ether"))
        .on("IMUDriver", "ImuClose", to("ether"))
        .on("IMUDriver", "MsStart", to("get"))
        .on("IMUDriver", "GetImu", move |call: &mut Call| {
            call.set("imu.taken", call.seconds())?;
            call.set("imu.yaw_rate", field.yaw_rate(call.seconds()))?;
            call.set("timestamp", call.seconds())?;
            Ok(Answer::event("write_p"))
        })
        .on("IMUDriver", "WritePort", |call: &mut Call| {
            call.copy("imu", "IMU")?;
            call.write("IMU")?;
            Ok(Answer::event("pause::get"))
        })
        .on("IMUDriver", "MeasureStop", to("ether"))
}

fn base(field: &Field) -> Codels {
    let (hears, obeys, halts) = (field.clone(), field.clone(), field.clone());
    Codels::new()
        .on("RobotDriver", "CheckLimits", |call: &mut Call| {
            let is_good = call.number("limits.linear")? >= 0.0 && call.number("limits.angular")? >= 0.0;
            Ok(if is_good { Answer::Ok } else { Answer::exception("BAD_LIMITS") })
        })
        .on("RobotDriver", "BaseOpen", to("ether"))
        .on("RobotDriver", "DriveStart", to("receive"))
        .on("RobotDriver", "ReceiveOdometry", move |call: &mut Call| {
            let said = hears.motions(call.seconds());
            let pose = said.counted;
            let all = [("taken", call.seconds()), ("x", pose.x), ("y", pose.y), ("yaw", pose.yaw)];
            for (name, value) in all.into_iter().chain([("speed.linear", said.linear), ("speed.angular", said.angular)])
            {
                call.set(&format!("motion.{name}"), value)?;
            }
            Ok(Answer::event("write_p"))
        })
        .on("RobotDriver", "WriteOdometry", |call: &mut Call| {
            call.copy("motion", "Odometry")?;
            call.write("Odometry")?;
            Ok(Answer::event("read_p"))
        })
        .on("RobotDriver", "ReadCmd", |call: &mut Call| {
            if !call.has("Cmd") {
                return Ok(Answer::event("pause::receive"));
            }
            call.copy("Cmd", "command")?;
            Ok(Answer::event("send"))
        })
        .on("RobotDriver", "SendSpeed", move |call: &mut Call| {
            let (linear, angular) = (call.number("limits.linear")?, call.number("limits.angular")?);
            let ahead = call.number("command.speed.linear")?.clamp(-linear, linear);
            let turn = call.number("command.speed.angular")?.clamp(-angular, angular);
            obeys.command(call.seconds(), ahead, turn);
            Ok(Answer::event("pause::receive"))
        })
        .on("RobotDriver", "DriveStop", move |call: &mut Call| {
            halts.command(call.seconds(), 0.0, 0.0);
            Ok(Answer::event("ether"))
        })
}
