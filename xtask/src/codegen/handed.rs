//! Cases at random of what is handed over as a whole: ground truth from each of its sources, texts, arrays of signals and of events, tables.

use std::fmt::Write;
use std::path::Path;

use super::Case;
use crate::suite::{cases, runs};

/// What a case is about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Theme {
    /// Objects in `gazebo_msgs/ModelStates`.
    ModelStates,
    /// An object by its odometry, whose velocities are in its own frame.
    Odometry,
    /// An object by its poses, whose velocities are differences.
    Poses,
    /// An object by a chain of transforms.
    Transforms,
    /// Texts and arrays.
    Wholes,
}

impl Theme {
    /// Those with objects.
    pub const GROUND_TRUTH: [Theme; 4] = [Theme::ModelStates, Theme::Odometry, Theme::Poses, Theme::Transforms];

    /// All of them.
    pub const ALL: [Theme; 5] = [Theme::ModelStates, Theme::Odometry, Theme::Poses, Theme::Transforms, Theme::Wholes];
}

/// The case of a theme and a seed; its trace is written to the folder.
pub fn handed(theme: Theme, seed: u64, folder: &Path) -> Result<Case, String> {
    let mut draw = Draw(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let spec = spec(theme, &mut draw);
    let trace: String = times(&mut draw).into_iter().map(|t| line(theme, t, &mut draw)).collect();
    let page = format!("## {theme:?} {seed}\n\n```rv\n{spec}```\n\n```ndjson\n{trace}```\n\n```verdicts\n```\n");
    let case = cases("handed", &page).pop().ok_or("no case")?;
    let (spec, trace) = runs(&case, folder).pop().ok_or_else(|| format!("no run:\n{page}"))?;
    Ok(Case { label: page, spec, trace })
}

/// Xorshift (Marsaglia, 2003).
struct Draw(u64);

impl Draw {
    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % n
    }

    fn number(&mut self) -> f64 {
        (self.below(1 << 40) as f64 / f64::from(1 << 20) / f64::from(1 << 19) - 1.0) * 2.0
    }

    fn one<'t>(&mut self, of: &[&'t str]) -> &'t str {
        of[self.below(of.len() as u64) as usize]
    }
}

/// Stamps in seconds, of which some are the same.
fn times(draw: &mut Draw) -> Vec<f64> {
    let mut now = 0.0;
    let mut next = || {
        now += [0.0, 0.1, 0.25, 1.0][draw.below(4) as usize];
        now
    };
    (0..24).map(|_| next()).collect()
}

/// How a number compares with one that is near it: what `x` becomes when its last bits are rounded away depends on them.
fn to_the_bit(x: &str) -> String {
    format!("({x} * 1000000000000000 + 6755399441055744) - 6755399441055744 > {x} * 1000000000000000")
}

fn spec(theme: Theme, draw: &mut Draw) -> String {
    let mut text = match theme {
        Theme::ModelStates => "",
        Theme::Odometry => "world robot /gt/robot Odometry\n",
        Theme::Poses => "world * topics /{name}/gt PoseStamped\n",
        Theme::Transforms if draw.below(2) == 0 => "world robot tf arm base\n",
        Theme::Transforms => "world robot tf map base\n",
        Theme::Wholes => return wholes(draw),
    }
    .to_owned();
    let parts = [
        "robot.position.x",
        "robot.position.z",
        "robot.velocity.x",
        "robot.velocity.y",
        "robot.velocity.body.x",
        "robot.velocity.body.y",
        "robot.velocity.body.z",
        "robot.velocity",
        "robot.velocity.angular.z",
        "robot.distance.wall",
        "robot.distanceZ.wall",
        "delta(robot.velocity.x)",
        "max_over(robot.velocity.y, 1 s)",
    ];
    for number in 0..4 {
        let part = loop {
            let part = draw.one(&parts);
            let has_wall = matches!(theme, Theme::ModelStates | Theme::Poses);
            if has_wall || !part.contains("wall") {
                break part;
            }
        };
        let limit = draw.number();
        let (name, exact) = (["a", "b", "c", "d"][number], to_the_bit(part));
        // Turns take an arc tangent, which is not the same to the bit everywhere.
        let is_turned = matches!(theme, Theme::Poses | Theme::Transforms) && part.contains("angular");
        let _ = match draw.below(4) {
            _ if is_turned => writeln!(text, "{name}: never {part} > {limit:.3}"),
            0 => writeln!(text, "{name}: never {part} > {limit:.3}"),
            1 => writeln!(text, "{name}: always {exact}"),
            2 => writeln!(text, "{name}: whenever {exact}, eventually within 1 s {part} < {limit:.3}"),
            _ => writeln!(text, "{name}: always {part} > {limit:.3} implies once within 1 s ({exact})"),
        };
    }
    text
}

/// What texts are made of.
const TEXTS: [&str; 8] = ["", "run", "running", "auto run", "\\\"run\\\"", "größe", "unrun", "ab??/run"];

fn wholes(draw: &mut Draw) -> String {
    let mut text =
        "decl mode /mode String.data\ndecl place /place String.data default \"run\"\ndecl ranges /scan LaserScan.ranges\ndecl joints /joints JointState\nevent kick\n"
            .to_owned();
    for name in ["a", "b", "c", "d", "e"] {
        let (word, limit) = (draw.one(&TEXTS), draw.number());
        let asked = match draw.below(24) {
            0 => format!("starts_with(mode, \"{word}\")"),
            1 => format!("ends_with(mode, \"{word}\")"),
            2 => format!("contains(mode, \"{word}\")"),
            3 => format!("mode == \"{word}\""),
            4 => format!("(starts_with(@{{mode, -1}}, \"{word}\") and mode != \"{word}\")"),
            5 => format!("lookup(joints.name, joints.position, \"{word}\") > {limit:.3}"),
            6 => format!("delta(lookup(joints.name, joints.effort, \"hip\")) > {limit:.3}"),
            7 => format!("any(kick.ranges, v => v > {limit:.3})"),
            8 => format!("all(kick.ranges, v => v > {limit:.3})"),
            9 => format!("min(kick.ranges) != {limit:.3}"),
            10 => format!("contains(kick.by, \"{word}\")"),
            11 => format!("kick.by == \"{word}\""),
            12 => format!("all(ranges, v => v > {limit:.3} or v < -1.5)"),
            16 => format!("any(ranges, v => v {} joints.position[0])", draw.one(&["<", "<=", ">", ">="])),
            17 => format!("all(kick.ranges, v => joints.position[0] {} v)", draw.one(&["<", "<=", ">", ">="])),
            18 => format!("any(seen.list, o => o.far < {limit:.3} and o.class == \"{word}\")"),
            19 => format!("all(seen.list, o => o.is_there or o.at.x > {limit:.3})"),
            20 => format!("seen.list[1].far > {limit:.3}"),
            21 => format!("any(joints.name, n => n == \"{word}\")"),
            13 => "mode == place".to_owned(),
            14 => "mode != @{mode, -1}".to_owned(),
            15 => format!("(kick.by == mode or place == \"{word}\")"),
            _ => format!("len(kick.ranges) + len(ranges) > 2"),
        };
        let _ = match draw.below(4) {
            0 => writeln!(text, "{name}: never {asked}"),
            1 => writeln!(text, "{name}: whenever {asked}, eventually within 1 s not {asked}"),
            2 => writeln!(text, "{name}: always kick implies {asked}"),
            _ => writeln!(text, "{name}: always {asked} implies once within 1 s not {asked}"),
        };
    }
    text
}

fn line(theme: Theme, time: f64, draw: &mut Draw) -> String {
    let (topic, ty, message) = match theme {
        Theme::ModelStates => ("/gazebo/model_states", "gazebo_msgs/ModelStates", model_states(draw)),
        Theme::Odometry => {
            let (pose, twist) = (pose(draw), twist(draw));
            let message = format!("{{\"pose\": {{\"pose\": {pose}}}, \"twist\": {{\"twist\": {twist}}}}}");
            ("/gt/robot", "nav_msgs/Odometry", message)
        }
        Theme::Poses => {
            let topic = draw.one(&["/robot/gt", "/wall/gt"]);
            (topic, "geometry_msgs/PoseStamped", format!("{{\"pose\": {}}}", pose(draw)))
        }
        Theme::Transforms => {
            let (parent, child) =
                [("earth", "map"), ("map", "odom"), ("odom", "base"), ("odom", "arm")][draw.below(4) as usize];
            let ([x, y, z], [i, j, k, w]) = ([0; 3].map(|_| draw.number()), turn(draw));
            let message = format!(
                "{{\"transforms\": [{{\"header\": {{\"frame_id\": \"{parent}\"}}, \"child_frame_id\": \"{child}\", \"transform\": \
                 {{\"translation\": {{\"x\": {x:?}, \"y\": {y:?}, \"z\": {z:?}}}, \"rotation\": {{\"x\": {i:?}, \"y\": {j:?}, \"z\": {k:?}, \"w\": {w:?}}}}}}}]}}"
            );
            ("/tf", "tf2_msgs/TFMessage", message)
        }
        Theme::Wholes => return whole_line(time, draw),
    };
    format!("{{\"t\": {time:?}, \"topic\": \"{topic}\", \"type\": \"{ty}\", \"msg\": {message}}}\n")
}

fn whole_line(time: f64, draw: &mut Draw) -> String {
    let word = draw.one(&TEXTS);
    let (topic, ty, message) = match draw.below(5) {
        4 => {
            let one = |draw: &mut Draw| {
                let (class, far, x, is_there) = (draw.one(&TEXTS), draw.number(), draw.number(), draw.below(2) == 0);
                format!(
                    "{{\"class\": \"{class}\", \"far\": {far:?}, \"at\": {{\"x\": {x:?}}}, \"is_there\": {is_there}}}"
                )
            };
            let list: Vec<String> = (0..draw.below(4)).map(|_| one(draw)).collect();
            return format!("{{\"t\": {time:?}, \"event\": \"seen\", \"list\": [{}]}}\n", list.join(", "));
        }
        0 => {
            let topic = draw.one(&["/mode", "/mode", "/place"]);
            (topic, "std_msgs/String", format!("{{\"data\": \"{word}\"}}"))
        }
        1 => ("/scan", "sensor_msgs/LaserScan", format!("{{\"ranges\": [{}]}}", list(draw))),
        2 => {
            let names: Vec<String> = (0..draw.below(4)).map(|_| format!("\"{}\"", draw.one(&["hip", word]))).collect();
            let message = format!(
                "{{\"name\": [{}], \"position\": [{}], \"effort\": [{}]}}",
                names.join(", "),
                list(draw),
                list(draw)
            );
            ("/joints", "sensor_msgs/JointState", message)
        }
        _ => {
            let ranges = list(draw);
            return format!("{{\"t\": {time:?}, \"event\": \"kick\", \"by\": \"{word}\", \"ranges\": [{ranges}]}}\n");
        }
    };
    format!("{{\"t\": {time:?}, \"topic\": \"{topic}\", \"type\": \"{ty}\", \"msg\": {message}}}\n")
}

/// A few numbers.
fn list(draw: &mut Draw) -> String {
    (0..draw.below(4)).map(|_| format!("{:?}", draw.number())).collect::<Vec<_>>().join(", ")
}

/// A message of model states, in which an object may be missing.
fn model_states(draw: &mut Draw) -> String {
    let names: &[&str] = [&["robot", "wall"][..], &["wall", "robot"], &["wall"], &["robot"]][draw.below(4) as usize];
    let names_text: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    let poses: Vec<String> = names.iter().map(|_| pose(draw)).collect();
    // Velocities may be missing as well.
    let twists: Vec<String> = names.iter().take(names.len() - draw.below(2) as usize).map(|_| twist(draw)).collect();
    format!(
        "{{\"name\": [{}], \"pose\": [{}], \"twist\": [{}]}}",
        names_text.join(", "),
        poses.join(", "),
        twists.join(", ")
    )
}

/// A unit quaternion, as nearly as numbers are.
fn turn(draw: &mut Draw) -> [f64; 4] {
    let of = [0; 4].map(|_| draw.number());
    let norm = of.iter().map(|x| x * x).sum::<f64>().sqrt();
    of.map(|x| x / norm)
}

fn vector(draw: &mut Draw) -> String {
    let [x, y, z] = [0; 3].map(|_| draw.number());
    format!("{{\"x\": {x:?}, \"y\": {y:?}, \"z\": {z:?}}}")
}

fn pose(draw: &mut Draw) -> String {
    let (position, [x, y, z, w]) = (vector(draw), turn(draw));
    format!("{{\"position\": {position}, \"orientation\": {{\"x\": {x:?}, \"y\": {y:?}, \"z\": {z:?}, \"w\": {w:?}}}}}")
}

fn twist(draw: &mut Draw) -> String {
    format!("{{\"linear\": {}, \"angular\": {}}}", vector(draw), vector(draw))
}
