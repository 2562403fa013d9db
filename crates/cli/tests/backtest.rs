//! `lapwing backtest`: how often properties fire, and which values fit.

mod common;

use common::Folder;
use serde_json::Value;

/// A laser that is written every 20 ms, but for one gap of so many milliseconds.
fn laser(gap: u32) -> String {
    let stamp = |k: u32| if k < 50 { k * 20 } else { k * 20 + gap - 20 };
    let lines = (0..100).map(|k| format!("{{\"t_ns\": {}, \"event\": \"laser\"}}\n", u64::from(stamp(k)) * 1_000_000));
    lines.collect()
}

/// Healthy gaps of up to 60 ms, faulty ones from 105 ms on; nobody goes faster than 1.
fn fleet() -> Folder {
    let spec = "\
event laser
gap = 40 ms
fresh: whenever laser, eventually within (0 s, gap] laser
never speed > 1
";
    let folder = Folder::new(&[("robot.rv", spec)]);
    for gap in [30, 45, 60] {
        folder.write(&format!("runs/good/{gap}.ndjson"), laser(gap).as_bytes());
    }
    for gap in [105, 250] {
        folder.write(&format!("runs/bad/{gap}.ndjson"), laser(gap).as_bytes());
    }
    folder
}

fn json(folder: &Folder, arguments: &str) -> (i32, Value) {
    let run = folder.lapwing(&format!("backtest {arguments} --format json"));
    (run.code, serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}\n{}{}", run.stdout, run.stderr)))
}

#[test]
fn each_property_is_counted_over_all_recordings() {
    let folder = fleet();
    let (code, found) = json(&folder, "robot.rv runs");
    assert_eq!(code, 0);
    assert_eq!(found["recordings"].as_array().unwrap().len(), 5);
    let fresh = &found["properties"][0];
    assert_eq!((fresh["name"].as_str(), fresh["alarms"].as_u64()), (Some("fresh"), Some(4)), "{fresh:#}");
    assert_eq!(fresh["exercised_in"].as_array().unwrap().len(), 5);
    let fired: Vec<&str> = fresh["fired_in"].as_array().unwrap().iter().map(|t| t.as_str().unwrap()).collect();
    assert_eq!(fired, ["runs/bad/105.ndjson", "runs/bad/250.ndjson", "runs/good/45.ndjson", "runs/good/60.ndjson"]);
    let speed = &found["properties"][1];
    assert_eq!(speed["inconclusive_in"].as_array().unwrap().len(), 5, "{speed:#}");
    let text = folder.lapwing("backtest robot.rv runs");
    for said in ["fired in 4 of 5, 4 alarms", "3 marked good, 2 bad", "Never exercised: line 4"] {
        assert!(text.stdout.contains(said), "{said}\n{}", text.stdout);
    }
    let one = folder.lapwing("backtest robot.rv runs --jobs 1").stdout;
    assert_eq!(text.stdout, one);
}

#[test]
fn margins_make_a_histogram() {
    let folder = Folder::new(&[("a.rv", "never x > 5\n")]);
    for n in 0..10 {
        folder.write(&format!("runs/{n}.csv"), format!("time,x\n0,0\n1,{n}\n").as_bytes());
    }
    let (_, found) = json(&folder, "a.rv runs");
    let bars = found["properties"][0]["histogram"].as_array().unwrap();
    assert_eq!((bars[0]["from"].as_f64(), bars[7]["to"].as_f64()), (Some(-4.0), Some(5.0)));
    assert_eq!(bars.iter().map(|b| b["count"].as_u64().unwrap()).sum::<u64>(), 10);
    let text = folder.lapwing("backtest a.rv runs").stdout;
    assert!(text.contains("margins (below 0 it failed):") && text.contains("-4 to -2.875  ##"), "{text}");
}

#[test]
fn the_smallest_value_without_a_false_alarm_is_found() {
    let folder = fleet();
    let (code, found) = json(&folder, "robot.rv runs --tune gap");
    let tune = &found["tune"];
    assert_eq!(code, 0, "{tune:#}");
    assert_eq!((tune["current"]["false_alarms"].as_u64(), tune["current"]["missed"].as_u64()), (Some(2), Some(0)));
    let (smallest, largest) = (tune["smallest"].as_f64().unwrap(), tune["largest"].as_f64().unwrap());
    assert!((60.0..60.2).contains(&smallest) && (104.0..105.0).contains(&largest), "{tune:#}");
    assert_eq!((tune["unit"].as_str(), tune["properties"][0].as_str()), (Some("ms"), Some("fresh")));
    // It is what the specification would say with that value.
    let spec = folder.read("robot.rv").replace("gap = 40 ms", &format!("gap = {smallest} ms"));
    folder.write("tuned.rv", spec.as_bytes());
    let (_, checked) = json(&folder, "tuned.rv runs");
    let fired = checked["properties"][0]["fired_in"].as_array().unwrap();
    assert!(fired.len() == 2 && fired.iter().all(|t| t.as_str().unwrap().contains("bad")), "{fired:?}");
    let text = folder.lapwing("backtest robot.rv --good runs/good/*.ndjson --bad runs/bad --tune gap").stdout;
    assert!(text.contains("an alarm in 2 of 3 good recordings, 2 of 2 bad ones caught"), "{text}");
    assert!(text.contains(&format!("is caught: {smallest} ms")), "{text}");
}

#[test]
fn that_no_value_fits_is_said() {
    let folder = fleet();
    folder.write("runs/good/120.ndjson", laser(120).as_bytes());
    let run = folder.lapwing("backtest robot.rv runs --tune gap");
    assert!(run.code == 1 && run.stdout.contains("fits. What each of them does:"), "{}{}", run.stdout, run.stderr);
    let (_, found) = json(&folder, "robot.rv runs --tune gap");
    assert!(found["tune"]["smallest"].is_null() && found["tune"]["tried"].as_array().unwrap().len() == 21);
}

#[test]
fn what_cannot_be_tuned_is_said() {
    let folder = fleet();
    let complaint = |arguments: &str| {
        let run = folder.lapwing(&format!("backtest {arguments}"));
        assert_eq!(run.code, 2, "{}", run.stdout);
        run.stderr
    };
    assert!(complaint("robot.rv runs --tune gaps").contains("there are gap"));
    assert!(
        complaint("robot.rv runs/good/30.ndjson --bad runs/good/30.ndjson --good runs/good --tune gap")
            .contains("marked good and bad")
    );
    folder.write("plain/1.ndjson", laser(20).as_bytes());
    assert!(complaint("robot.rv plain --tune gap").contains("which recordings are good"));
    folder.write("two.rv", b"gap = 1\nnever x > 5\n");
    assert!(complaint("robot.rv two.rv runs --tune gap").contains("takes one specification"));
    assert!(complaint("two.rv runs --tune gap").contains("no property depends on `gap`"));
}
