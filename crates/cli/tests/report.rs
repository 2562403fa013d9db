//! `lapwing check --report`: where the page goes, and what it says of real recordings. How it looks is tested in crates/page.

mod common;

use common::{Folder, stop_sign};
use serde_json::Value;

const SPEC: &str = "limit = 2\nslow: never speed > limit\nquick: never speed < 0\n";
const TRACE: &str = "time,speed\n0,1\n1,3\n2,1\n";

/// What the charts of a recording draw.
fn data(page: &str, number: usize) -> Value {
    let begins = format!("<script type=\"application/json\" id=\"data-{number}\">");
    let (_, rest) = page.split_once(&begins).unwrap();
    serde_json::from_str(rest.split("</script>").next().unwrap()).unwrap()
}

#[test]
fn a_page_says_what_the_report_says() {
    let folder = Folder::new(&[("a.rv", SPEC), ("run.csv", TRACE)]);
    let run = folder.lapwing("check a.rv run.csv --format json --report page.html");
    assert_eq!((run.code, run.stderr.as_str()), (1, "the report is in page.html\n"));
    // It implies margins.
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(json[0]["properties"][0]["margin"], -1.0);
    let page = folder.read("page.html");
    assert!(page.contains("<h1>1 of 2 properties failed</h1>"));
    let data = data(&page, 0);
    assert_eq!(data["range"], serde_json::json!([0.0, 2.0]));
    let slow = &data["properties"][0];
    assert_eq!(slow["name"], "slow");
    assert_eq!(slow["marks"], serde_json::json!([[1.0, 1.0, 1.0]]));
    assert_eq!(slow["plots"][0]["limits"], serde_json::json!([[2.0, "> limit"]]));
    assert_eq!(slow["margin"]["y"], serde_json::json!([1.0, -1.0, 1.0]));
    assert_eq!(data["tracks"][0]["y"], serde_json::json!([1.0, 3.0, 1.0]));
}

#[test]
fn several_recordings_share_a_page_in_their_order() {
    let good = "time,speed\n0,1\n";
    let folder = Folder::new(&[("a.rv", SPEC), ("1.csv", TRACE), ("2.csv", good), ("3.csv", "")]);
    let run = folder.lapwing("check a.rv 1.csv 2.csv 3.csv --report page.html -q");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    let page = folder.read("page.html");
    assert!(page.contains("<h1>1 of 3 recordings failed, 1 could not be judged</h1>"));
    let at = |name: &str| page.find(&format!("<bdi>{name}</bdi></button>")).unwrap();
    assert!(at("1.csv") < at("2.csv") && at("2.csv") < at("3.csv"));
    assert_eq!(data(&page, 1)["tracks"][0]["y"], serde_json::json!([1.0]));
}

#[test]
fn the_page_of_the_demo_shows_when_scopes_were_open() {
    let folder = Folder::new(&[]);
    folder.write("run.mcap", &stop_sign());
    folder.write(
        "stop.rv",
        &std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/stop-sign/stop_sign.rv")).unwrap(),
    );
    let run = folder.lapwing("check stop.rv run.mcap --report page.html");
    assert_eq!(run.code, 1);
    let data = data(&folder.read("page.html"), 0);
    let second = &data["properties"][1];
    let open = &second["scopes"][0]["open"];
    assert_eq!((open.as_array().unwrap().len(), &open[0][0], &open[0][1]), (1, &13.575.into(), &19.475.into()));
    let names: Vec<&str> = data["tracks"].as_array().unwrap().iter().map(|t| t["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"car.velocity") && names.contains(&"car.distance.second_sign"), "{names:?}");
    let velocity = names.iter().position(|n| *n == "car.velocity").unwrap();
    assert_eq!(data["tracks"][velocity]["unit"], "m/s");
}

#[test]
fn hostile_names_stay_text() {
    let evil = "</script><script>alert(1)";
    let line = |t: u32, v: u32| format!("{{\"t\": {t}, \"values\": {{\"x\": {v}}}}}\n");
    let folder = Folder::new(&[
        ("a.rv", &format!("property `{evil}`: never x > 2\n")),
        ("run.ndjson", &(line(0, 1) + &line(1, 3))),
    ]);
    let run = folder.lapwing("check a.rv run.ndjson --report page.html");
    assert_eq!(run.code, 1, "{}", run.stderr);
    let page = folder.read("page.html");
    assert!(!page.contains("<script>alert") && page.contains("&lt;script&gt;alert(1)"));
    assert_eq!(data(&page, 0)["properties"][0]["name"], evil);
}

#[test]
fn a_page_that_cannot_be_written_is_known_before_anything_is_checked() {
    let folder = Folder::new(&[("a.rv", SPEC), ("run.csv", TRACE)]);
    let run = folder.lapwing("check a.rv run.csv --report not/there/page.html");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("not/there/page.html: the report cannot be written"), "{}", run.stderr);
    assert!(run.stderr.contains("the folder is not there"), "{}", run.stderr);
}

#[test]
fn a_page_draws_the_diagram_with_the_moves_that_it_does_not_have() {
    let spec = "machine gear {\n    initial low\n    state low when speed < 1\n    state high when speed >= 1\n    low -> high\n}\n";
    let folder = Folder::new(&[
        ("a.rv", spec),
        ("bad.csv", "time,speed\n0,0\n1,2\n2,0\n"),
        ("good.csv", "time,speed\n0,0\n1,2\n"),
    ]);
    let run = folder.lapwing("check a.rv bad.csv --report bad.html -q");
    assert_eq!(run.code, 1);
    let page = folder.read("bad.html");
    assert!(
        page.contains("aria-label=\"State diagram of gear: low to high (speed &gt;= 1); high to low (illegal, once)\"")
    );
    assert!(page.contains("<li><bdi>high</bdi> → <bdi>low</bdi>: illegal, once</li>"));
    let run = folder.lapwing("check a.rv good.csv --report good.html -q");
    assert_eq!(run.code, 0);
    let page = folder.read("good.html");
    assert!(page.contains("No move was seen that it does not have.") && !page.contains("<g class=\"wrong\">"));
}
