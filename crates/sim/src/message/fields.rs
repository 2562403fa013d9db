//! Fields of messages as values, for a monitor that looks on while a run goes on: what decoding the encoded message would give it. What is
//! not here is encoded and decoded.

use lapwing_stream::{Name, Value};

use super::{Kind, Message, Model, Placement, Vector};

/// Overwrites a value by a field of a message of its kind.
pub type Field = fn(&Message, &mut Value);

/// A field that is a number.
macro_rules! number {
    ($($message:pat => $number:expr),+) => {
        |message, into| match message {
            $($message => put(into, $number),)+
            _ => *into = Value::Missing,
        }
    };
}

/// Any other field.
macro_rules! field {
    ($message:pat => $fill:expr) => {
        |message, into| match message {
            $message => $fill(into),
            _ => *into = Value::Missing,
        }
    };
}

/// The field of a kind of messages at a path.
pub fn field(kind: Kind, path: &str) -> Option<Field> {
    match kind {
        Kind::Twist | Kind::Rotor => twist(path),
        Kind::Odometry => odometry(path),
        Kind::Scan => scan(path),
        Kind::Battery => battery(path),
        Kind::Models => models(path),
        Kind::Imu | Kind::Joints | Kind::Range | Kind::Bool | Kind::Text => sensors(kind, path),
        Kind::Transforms | Kind::Clock => None,
    }
}

fn twist(path: &str) -> Option<Field> {
    Some(match path {
        "linear.x" => number!(Message::Twist(m) => m.linear[0], Message::Rotor(speed) => *speed),
        "linear.y" => number!(Message::Twist(m) => m.linear[1], Message::Rotor(_) => 0.0),
        "linear.z" => number!(Message::Twist(m) => m.linear[2], Message::Rotor(_) => 0.0),
        "angular.x" => number!(Message::Twist(m) => m.angular[0], Message::Rotor(_) => 0.0),
        "angular.y" => number!(Message::Twist(m) => m.angular[1], Message::Rotor(_) => 0.0),
        "angular.z" => number!(Message::Twist(m) => m.angular[2], Message::Rotor(_) => 0.0),
        _ => return None,
    })
}

fn odometry(path: &str) -> Option<Field> {
    Some(match path {
        "pose.pose.position.x" => number!(Message::Odometry(m) => m.placement.position[0]),
        "pose.pose.position.y" => number!(Message::Odometry(m) => m.placement.position[1]),
        "pose.pose.position.z" => number!(Message::Odometry(m) => m.placement.position[2]),
        "pose.pose.orientation.x" => number!(Message::Odometry(m) => m.placement.rotation.0[0]),
        "pose.pose.orientation.y" => number!(Message::Odometry(m) => m.placement.rotation.0[1]),
        "pose.pose.orientation.z" => number!(Message::Odometry(m) => m.placement.rotation.0[2]),
        "pose.pose.orientation.w" => number!(Message::Odometry(m) => m.placement.rotation.0[3]),
        "twist.twist.linear.x" => number!(Message::Odometry(m) => m.twist.linear[0]),
        "twist.twist.linear.y" => number!(Message::Odometry(m) => m.twist.linear[1]),
        "twist.twist.angular.z" => number!(Message::Odometry(m) => m.twist.angular[2]),
        _ => return None,
    })
}

fn scan(path: &str) -> Option<Field> {
    Some(match path {
        "ranges" => field!(Message::Scan(m) => |into| numbers(into, m.ranges.iter().map(|&range| f64::from(range)))),
        "range_min" => number!(Message::Scan(m) => f64::from(m.limits[0])),
        "range_max" => number!(Message::Scan(m) => f64::from(m.limits[1])),
        _ => return None,
    })
}

fn battery(path: &str) -> Option<Field> {
    Some(match path {
        "voltage" => number!(Message::Battery(m) => f64::from(m.voltage)),
        "current" => number!(Message::Battery(m) => f64::from(m.current)),
        "percentage" => number!(Message::Battery(m) => f64::from(m.charge)),
        "power_supply_status" => number!(Message::Battery(m) => f64::from(m.status as u8)),
        _ => return None,
    })
}

fn sensors(kind: Kind, path: &str) -> Option<Field> {
    Some(match (kind, path) {
        (Kind::Imu, "angular_velocity.z") => number!(Message::Imu(m) => m.turn),
        (Kind::Imu, "linear_acceleration.x") => number!(Message::Imu(m) => m.acceleration[0]),
        (Kind::Imu, "linear_acceleration.y") => number!(Message::Imu(m) => m.acceleration[1]),
        (Kind::Imu, "linear_acceleration.z") => number!(Message::Imu(m) => m.acceleration[2]),
        (Kind::Joints, "position") => field!(Message::Joints(m) => |into| numbers(into, m.positions.into_iter())),
        (Kind::Joints, "velocity") => field!(Message::Joints(m) => |into| numbers(into, m.velocities.into_iter())),
        (Kind::Range, "range") => number!(Message::Range(m) => f64::from(m.range)),
        (Kind::Bool, "data") => field!(Message::Bool(is) => |into: &mut Value| *into = Value::Bool(*is)),
        (Kind::Text, "data") => field!(Message::Text(m) => |into| text(into, m)),
        _ => return None,
    })
}

fn models(path: &str) -> Option<Field> {
    Some(match path {
        "name" => field!(Message::Models(all) => |into| list(into, all, |into, model| text(into, &model.name))),
        "pose" => field!(Message::Models(all) => |into| list(into, all, |into, model| pose(into, &model.placement))),
        "twist" => field!(Message::Models(all) => |into| list(into, all, |into, model| {
            let [linear, angular] = record(into, ["linear", "angular"]) else { return };
            vector(&mut linear.1, &model.twist.linear);
            vector(&mut angular.1, &model.twist.angular);
        })),
        _ => return None,
    })
}

fn pose(into: &mut Value, placement: &Placement) {
    let [position, orientation] = record(into, ["position", "orientation"]) else { return };
    vector(&mut position.1, &placement.position);
    let parts = record(&mut orientation.1, ["x", "y", "z", "w"]);
    parts.iter_mut().zip(placement.rotation.0).for_each(|((_, part), x)| put(part, x));
}

fn vector(into: &mut Value, vector: &Vector) {
    let parts = record(into, ["x", "y", "z"]);
    parts.iter_mut().zip(vector).for_each(|((_, part), x)| put(part, *x));
}

/// A number, most likely in the place of one.
#[inline]
fn put(into: &mut Value, number: f64) {
    match into {
        Value::Num(there) => *there = number,
        _ => *into = Value::Num(number),
    }
}

fn text(into: &mut Value, text: &str) {
    match into {
        Value::Str(there) if there == text => {}
        Value::Str(there) => {
            there.clear();
            there.push_str(text);
        }
        _ => *into = Value::Str(text.to_owned()),
    }
}

fn numbers(into: &mut Value, numbers: impl Iterator<Item = f64>) {
    match into {
        Value::Nums(there) => {
            there.clear();
            there.extend(numbers);
        }
        _ => *into = Value::Nums(numbers.collect()),
    }
}

fn list(into: &mut Value, all: &[Model], fill: impl Fn(&mut Value, &Model)) {
    if !matches!(into, Value::List(_)) {
        *into = Value::List(Vec::new());
    }
    if let Value::List(there) = into {
        if there.len() != all.len() {
            there.resize_with(all.len(), Value::default);
        }
        there.iter_mut().zip(all).for_each(|(into, model)| fill(into, model));
    }
}

/// The fields of a record, in the buffers of the one before it.
fn record<'v, const N: usize>(into: &'v mut Value, names: [&str; N]) -> &'v mut [(Name, Value)] {
    if !matches!(into, Value::Record(there) if there.len() == N) {
        *into = Value::Record(names.map(|name| (Name::from(name), Value::Missing)).into());
    }
    match into {
        Value::Record(fields) => fields,
        _ => &mut [],
    }
}

#[cfg(test)]
mod tests {
    use lapwing_record::{Decoder, MessageType};

    use super::*;
    use crate::message::{Battery, Model};
    use crate::message::{BatteryStatus, Cdr, Header, Imu, Joints, Odometry, Quaternion, Range, Scan, Twist};

    fn placement(x: f64) -> Placement {
        Placement { position: [x, -1.5, 0.25], rotation: Quaternion([0.1, x, 0.3, 0.4]) }
    }

    fn moves(x: f64) -> Twist {
        Twist { linear: [x, 2.0, 3.5], angular: [4.0, 5.5, -x] }
    }

    /// A message of each kind that has fields here, with no two values the same, and longer and shorter than the one before.
    fn messages(n: usize) -> Vec<(Kind, Message)> {
        let x = 0.1 * n as f64;
        let header = || Header { stamp: lapwing_stream::Time(7), frame: "base".repeat(n) };
        let odometry = Odometry { header: header(), child: "b".repeat(n), placement: placement(x), twist: moves(x) };
        let model = |i: usize| {
            let x = x + i as f64;
            Model { name: "m".repeat(i + n), placement: placement(x), twist: moves(x) }
        };
        let ranges = (0..n).map(|i| 0.1 * i as f32).chain([f32::INFINITY]).collect();
        let acceleration = [x, 9.8, -0.5];
        let battery = Battery {
            header: header(),
            voltage: 11.1,
            current: -0.3,
            charge: 0.7 + x as f32,
            status: BatteryStatus::Discharging,
        };
        let joints = Joints { header: header(), names: ["l", "r"], positions: [x, 2.0], velocities: [3.0, -x] };
        vec![
            (Kind::Twist, Message::Twist(moves(x))),
            (Kind::Rotor, Message::Rotor(x)),
            (Kind::Odometry, Message::Odometry(Box::new(odometry))),
            (Kind::Scan, Message::Scan(Scan { header: header(), duration: 0.2, limits: [0.12, 3.5], ranges })),
            (Kind::Battery, Message::Battery(battery)),
            (Kind::Imu, Message::Imu(Box::new(Imu { header: header(), yaw: 0.3, turn: x, acceleration }))),
            (Kind::Joints, Message::Joints(Box::new(joints))),
            (Kind::Range, Message::Range(Range { header: header(), limit: 0.15, range: 0.1 * n as f32 })),
            (Kind::Bool, Message::Bool(n % 2 == 0)),
            (Kind::Text, Message::Text("word".repeat(n))),
            (Kind::Models, Message::Models((0..n + 1).map(model).collect())),
        ]
    }

    /// All paths that some kind has a field for.
    const PATHS: [&str; 37] = [
        "linear.x",
        "linear.y",
        "linear.z",
        "angular.x",
        "angular.y",
        "angular.z",
        "pose.pose.position.x",
        "pose.pose.position.y",
        "pose.pose.position.z",
        "pose.pose.orientation.x",
        "pose.pose.orientation.y",
        "pose.pose.orientation.z",
        "pose.pose.orientation.w",
        "twist.twist.linear.x",
        "twist.twist.linear.y",
        "twist.twist.angular.z",
        "ranges",
        "range_min",
        "range_max",
        "voltage",
        "current",
        "percentage",
        "power_supply_status",
        "angular_velocity.z",
        "linear_acceleration.x",
        "linear_acceleration.y",
        "linear_acceleration.z",
        "position",
        "velocity",
        "range",
        "data",
        "name",
        "pose",
        "twist",
        "header",
        "effort",
        "child_frame_id",
    ];

    #[test]
    fn a_field_is_what_decoding_gives() {
        let mut cdr = Cdr::default();
        let mut fields: Vec<(Kind, Vec<(Field, Decoder, [Value; 2])>)> = Vec::new();
        for n in [2, 5, 1, 3] {
            for (kind, message) in messages(n) {
                let known = fields.iter().position(|(of, _)| *of == kind).unwrap_or_else(|| {
                    let layout = kind.definition().expect("it has one").layout.clone();
                    let decoder = |path: &str| {
                        Decoder::new(&MessageType::Cdr(layout.clone()), &[path.parse().expect("a path")], 1000)
                            .expect(path)
                    };
                    let found =
                        PATHS.iter().filter_map(|path| Some((field(kind, path)?, decoder(path), Default::default())));
                    fields.push((kind, found.collect()));
                    fields.len() - 1
                });
                message.encode(&mut cdr);
                assert!(!fields[known].1.is_empty(), "{kind:?}");
                for (field, decoder, [told, decoded]) in &mut fields[known].1 {
                    field(&message, told);
                    decoder.decode(cdr.bytes(), std::slice::from_mut(decoded)).expect("it is right");
                    assert_eq!(told, decoded, "{kind:?}");
                }
            }
        }
        let count: usize = fields.iter().map(|(_, fields)| fields.len()).sum();
        // The last three are nobody's; a rotor has the six parts of a twist, and two kinds have `data`.
        assert_eq!(count, PATHS.len() - 3 + 6 + 1);
    }
}
