//! Shapes of traces.

use std::sync::Arc;

use lapwing_check::{MessageTypes, TraceShape, TraceTopic};
use lapwing_stream::{Constant, Field, Schema, Type, Value};

/// A message type.
pub fn message(name: &str, fields: &[(&str, Type)]) -> Arc<Schema> {
    let fields = fields.iter().map(|(name, ty)| Field { name: (*name).into(), ty: ty.clone() }).collect();
    Arc::new(Schema { name: name.to_owned(), fields, constants: Vec::new() })
}

pub const FLOAT: Type = Type::Num { float: true };
pub const INT: Type = Type::Num { float: false };

pub fn array(of: Type) -> Type {
    Type::Array(Box::new(of))
}

fn of(schema: Arc<Schema>) -> Type {
    Type::Message(schema)
}

fn header() -> Type {
    let time = of(message("builtin_interfaces/Time", &[("sec", INT), ("nanosec", INT)]));
    of(message("std_msgs/Header", &[("stamp", time), ("frame_id", Type::Str)]))
}

fn vector() -> Type {
    of(message("geometry_msgs/Vector3", &[("x", FLOAT), ("y", FLOAT), ("z", FLOAT)]))
}

fn twist() -> Arc<Schema> {
    message("geometry_msgs/Twist", &[("linear", vector()), ("angular", vector())])
}

fn pose() -> Arc<Schema> {
    let point = of(message("geometry_msgs/Point", &[("x", FLOAT), ("y", FLOAT), ("z", FLOAT)]));
    let turn = of(message("geometry_msgs/Quaternion", &[("x", FLOAT), ("y", FLOAT), ("z", FLOAT), ("w", FLOAT)]));
    message("geometry_msgs/Pose", &[("position", point), ("orientation", turn)])
}

fn odometry() -> Arc<Schema> {
    let pose = of(message("geometry_msgs/PoseWithCovariance", &[("pose", of(pose())), ("covariance", array(FLOAT))]));
    let twist =
        of(message("geometry_msgs/TwistWithCovariance", &[("twist", of(twist())), ("covariance", array(FLOAT))]));
    message(
        "nav_msgs/Odometry",
        &[("header", header()), ("child_frame_id", Type::Str), ("pose", pose), ("twist", twist)],
    )
}

fn battery() -> Arc<Schema> {
    let constants = [("UNKNOWN", 0.0), ("CHARGING", 1.0), ("DISCHARGING", 2.0), ("NOT_CHARGING", 3.0), ("FULL", 4.0)];
    let constant = |(name, value): (&str, f64)| Constant {
        name: format!("POWER_SUPPLY_STATUS_{name}").as_str().into(),
        value: Value::Num(value),
    };
    Arc::new(Schema {
        name: "sensor_msgs/BatteryState".to_owned(),
        fields: message("", &[("voltage", FLOAT), ("power_supply_status", INT), ("present", Type::Bool)])
            .fields
            .clone(),
        constants: constants.into_iter().map(constant).collect(),
    })
}

/// The message types that are known without a trace.
pub struct Common;

impl MessageTypes for Common {
    fn names(&self) -> Vec<String> {
        let names = ["geometry_msgs/Twist", "std_msgs/Bool", "std_srvs/SetBool_Request", "std_srvs/Trigger_Request"];
        [
            "geometry_msgs/Vector3",
            "std_msgs/Empty",
            "std_srvs/Empty_Request",
            "other_msgs/Bool",
            "sensor_msgs/BatteryState",
        ]
        .iter()
        .chain(&names)
        .map(|n| (*n).to_owned())
        .collect()
    }

    fn schema(&self, name: &str) -> Option<Arc<Schema>> {
        Some(match name {
            "geometry_msgs/Twist" => twist(),
            "sensor_msgs/BatteryState" => battery(),
            "std_msgs/Bool" | "std_srvs/SetBool_Request" | "other_msgs/Bool" => message(name, &[("data", Type::Bool)]),
            "std_srvs/Trigger_Request" => message(name, &[]),
            _ => return None,
        })
    }
}

/// A mobile robot as ROS shows it.
pub fn robot() -> TraceShape {
    let scan =
        message("sensor_msgs/LaserScan", &[("header", header()), ("angle_min", FLOAT), ("ranges", array(FLOAT))]);
    let joints = message(
        "sensor_msgs/JointState",
        &[("header", header()), ("name", array(Type::Str)), ("position", array(FLOAT)), ("velocity", array(FLOAT))],
    );
    let models = message(
        "gazebo_msgs/ModelStates",
        &[("name", array(Type::Str)), ("pose", array(of(pose()))), ("twist", array(of(twist())))],
    );
    let flag = message("std_msgs/Bool", &[("data", Type::Bool)]);
    let text = message("std_msgs/String", &[("data", Type::Str)]);
    let only_vector = message("geometry_msgs/Vector3", &[("x", FLOAT), ("y", FLOAT), ("z", FLOAT)]);
    shape(&[
        ("/odom", odometry()),
        ("/robot1/odom", odometry()),
        ("/robot2/odom", odometry()),
        ("/scan", scan),
        ("/cmd_vel", twist()),
        ("/cmd_vel_original", twist()),
        ("/joint_states", joints),
        ("/gazebo/model_states", models),
        ("/estop", flag.clone()),
        ("/kick", flag),
        ("/mode", text),
        ("/battery", battery()),
        ("/drone_mov/rotor1", only_vector.clone()),
        ("/drone_mov/rotor2", only_vector),
        ("/LaserDriver/Laser", message("laser/Scan", &[("count", INT)])),
    ])
}

/// A trace of these topics.
pub fn shape(topics: &[(&str, Arc<Schema>)]) -> TraceShape {
    let topic = |(name, schema): &(&str, Arc<Schema>)| TraceTopic {
        name: (*name).to_owned(),
        type_name: schema.name.clone(),
        schema: Some(schema.clone()),
    };
    TraceShape { topics: topics.iter().map(topic).collect(), ..TraceShape::default() }
}

/// A CSV file with these columns.
pub fn csv(columns: &[&str]) -> TraceShape {
    let columns = columns.iter().map(|c| (*c).to_owned()).collect();
    TraceShape { columns, schemaless: true, ..TraceShape::default() }
}

/// NDJSON with these columns and topics.
pub fn ndjson(columns: &[&str], topics: &[(&str, &str)], open: bool) -> TraceShape {
    let topic =
        |(name, ty): &(&str, &str)| TraceTopic { name: (*name).to_owned(), type_name: (*ty).to_owned(), schema: None };
    TraceShape { topics: topics.iter().map(topic).collect(), columns_open: open, ..csv(columns) }
}
