//! How much the ROS 2 connector takes: small messages as fast as asked for, or point clouds of ten megabytes of which the header alone is decoded,
//! both from rclpy. `tools/ros2.sh` installs that.
//!
//! ```text
//! cargo run --release -p lapwing-ros --features ros2 --example ros2_load -- small 20000 10
//! cargo run --release -p lapwing-ros --features ros2 --example ros2_load -- cloud 10 10
//! ```
//!
//! Says what was published, what came, what was said to be lost, and what it cost this process.

use std::error::Error;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use lapwing_record::Decoder;
use lapwing_ros::connector::Happening;

const DOMAIN: u16 = 199;
const TOPIC: &str = "/load";

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [what, rate, seconds] = words.as_slice() else {
        return Err("usage: ros2_load small|cloud RATE SECONDS".into());
    };
    let count = (rate.parse::<f64>()? * seconds.parse::<f64>()?).round();
    let (ty, fields, more) = match what.as_str() {
        "small" => ("geometry_msgs/Twist", vec!["linear.x".parse()?], "--depth 1000"),
        "cloud" => (
            "sensor_msgs/PointCloud2",
            vec!["header.stamp.sec".parse()?, "header.frame_id".parse()?],
            "--bytes 10000000 --depth 5",
        ),
        other => return Err(format!("`{other}` is neither small nor cloud").into()),
    };
    let mut connector = lapwing_ros::ros2::connect(Some(DOMAIN), "/lapwing_load")?;
    connector.subscribe(&[TOPIC.to_owned()]);
    let (mut peer, lines) = start(&format!("publish {TOPIC} {ty} --rate {rate} --count {count} --wait-for 1 {more}"))?;

    let (mut decoder, mut values) = (None, Vec::new());
    let (mut came, mut bytes, mut lost, mut wrong) = (0u64, 0usize, 0u64, 0u64);
    let (mut first, mut last) = (None, Instant::now());
    let mut published = None;
    while published.is_none() || last.elapsed() < Duration::from_secs(2) {
        published = published.or_else(|| lines.try_iter().find(|l| l.starts_with("published")));
        let Some(arrival) = connector.next(Duration::from_millis(100)) else { continue };
        match arrival.what {
            Happening::Stream(offer) if offer.channel.topic == TOPIC => {
                if let Ok(ty) = &offer.channel.ty {
                    let new = Decoder::new(ty, &fields, 1 << 24)?;
                    values = new.slots();
                    decoder = Some(new);
                }
            }
            Happening::Message { payload, .. } => {
                first.get_or_insert_with(|| (Instant::now(), usage()));
                came += 1;
                bytes += payload.len();
                last = Instant::now();
                let is_read = decoder.as_mut().is_some_and(|d| d.decode(&payload, &mut values).is_ok());
                wrong += u64::from(!is_read);
            }
            Happening::Lost { count, .. } => lost += count,
            Happening::Blind { topic, cause } if topic == TOPIC => println!("blind: {cause}"),
            _ => {}
        }
    }
    let (start, before) = first.ok_or("nothing came")?;
    let after = usage();
    let took = last.duration_since(start).as_secs_f64();
    println!("{}", published.unwrap_or_default());
    println!("came {came} in {took:.2} s: {:.0} messages/s, {:.1} MB/s", came as f64 / took, bytes as f64 / took / 1e6);
    println!("said to be lost {lost}, not decoded {wrong}");
    println!("processor {:.1} % of one core, resident {:.0} MB", (after.0 - before.0) / took * 100.0, after.1);
    peer.kill()?;
    peer.wait()?;
    Ok(())
}

fn start(words: &str) -> Result<(Child, Receiver<String>), Box<dyn Error>> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut peer = Command::new(here.join("../../.venv-jazzy/bin/python"))
        .arg(here.join("tests/ros2/peer.py"))
        .args(words.split_whitespace())
        .env("ROS_DOMAIN_ID", DOMAIN.to_string())
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let stdout = BufReader::new(peer.stdout.take().ok_or("the peer has no output")?);
    let (sender, lines) = channel();
    std::thread::spawn(move || stdout.lines().map_while(Result::ok).all(|line| sender.send(line).is_ok()));
    Ok((peer, lines))
}

/// Seconds of processor time, and megabytes of memory, of this process (Linux: hundredths of seconds, pages of 4 kB).
fn usage() -> (f64, f64) {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<f64> =
        stat.rsplit(')').next().unwrap_or_default().split_whitespace().map(|f| f.parse().unwrap_or(0.0)).collect();
    let field = |k: usize| fields.get(k).copied().unwrap_or(0.0);
    ((field(11) + field(12)) / 100.0, field(21) * 4096.0 / 1e6)
}
