//! The commands beside `check`.

mod common;
#[path = "../examples/make_stop_sign.rs"]
#[allow(dead_code, reason = "its main is not called")]
mod make_stop_sign;

use common::{Folder, stop_sign, table};

#[test]
fn fmt_formats_in_place_and_then_changes_nothing() {
    let folder = Folder::new(&[("a.rv", "limit=0.5*2 #half\nnever  x>limit\n"), ("wrong.rv", "never x >\n")]);
    let check = folder.lapwing("fmt a.rv --check");
    assert_eq!((check.code, check.stderr.as_str()), (1, "a.rv: not formatted\n"));
    assert_eq!(folder.lapwing("fmt a.rv").code, 0);
    assert_eq!(folder.read("a.rv"), "limit = 0.5 * 2  # half\nnever x > limit\n");
    assert_eq!(folder.lapwing("fmt a.rv --check").code, 0);
    let wrong = folder.lapwing("fmt wrong.rv a.rv");
    assert!(wrong.code == 2 && wrong.stderr.contains("wrong.rv:1"), "{}", wrong.stderr);
    assert_eq!(folder.read("wrong.rv"), "never x >\n");
    let standard = folder.lapwing_with("fmt -", "never  x>1");
    assert_eq!((standard.code, standard.stdout.as_str()), (0, "never x > 1\n"));
}

#[test]
fn explain_prints_the_page_of_a_code() {
    let folder = Folder::new(&[]);
    let page = folder.lapwing("explain latched-after");
    assert!(page.code == 0 && page.stdout.starts_with("# latched-after\n"), "{}", page.stdout);
    assert_eq!(folder.lapwing("explain warning[latched-after]").stdout, page.stdout);
    let wrong = folder.lapwing("explain latched-aftr");
    assert!(wrong.code == 2 && wrong.stderr.contains("did you mean `latched-after`?"), "{}", wrong.stderr);
}

#[test]
fn explain_says_what_a_property_means_and_costs() {
    let folder = Folder::new(&[(
        "a.rv",
        "decl v /odom Odometry.twist.twist.linear.x\nwhenever v > 1, eventually within 2 s v < 0.1\n",
    )]);
    folder.write("run.mcap", &stop_sign());
    let run = folder.lapwing("explain a.rv run.mcap");
    for said in [
        "/odom nav_msgs/Odometry: twist.twist.linear.x",
        "at every instant with v > 1, seen from there: at some instant within 2 s v < 0.1",
        "whenever v > 1, eventually within 2 s v < 0.1",
        "v from /odom (twist.twist.linear.x): a number",
        "at the latest 2 s after what fails began",
    ] {
        assert!(run.stdout.contains(said), "{said}\n{}", run.stdout);
    }
}

#[test]
fn explain_draws_state_diagrams() {
    let spec = "machine gate {\n    initial shut\n    state shut when x < 1\n    state open when x >= 1\n    shut -> open\n    open -> shut\n}\n";
    let folder = Folder::new(&[("a.rv", spec), ("plain.rv", "never x > 1\n")]);
    let mermaid = folder.lapwing("explain a.rv --format mermaid").stdout;
    assert!(
        mermaid.starts_with("stateDiagram-v2\n") && mermaid.contains("gate_shut --> gate_open : x >= 1"),
        "{mermaid}"
    );
    let dot = folder.lapwing("explain a.rv --format dot").stdout;
    assert!(dot.starts_with("digraph {") && dot.contains("\"0.0\" -> \"0.1\" [label=\"x >= 1\"];"), "{dot}");
    assert_eq!(folder.lapwing("explain plain.rv --format dot").code, 2);
    assert!(folder.lapwing("explain a.rv --format svg").stderr.contains("dot -Tsvg"));
}

#[test]
fn new_declares_what_a_recording_has() {
    let folder = Folder::new(&[("run.csv", &table("speed", &[(0.0, 1.0)]))]);
    folder.write("run.mcap", &stop_sign());
    assert_eq!(folder.lapwing("new run.mcap -o robot.rv").code, 0);
    let text = folder.read("robot.rv");
    assert!(text.contains("decl odom /odom nav_msgs/Odometry.twist.twist.linear.x\n"), "{text}");
    assert!(text.contains("decl cmd_vel /cmd_vel geometry_msgs/Twist.linear.x\n"), "{text}");
    assert_eq!(folder.lapwing("fmt --check robot.rv").code, 0, "{text}");
    assert_eq!(folder.lapwing("new run.mcap -o robot.rv").code, 2);
    // With its properties uncommented it can be checked.
    let active: String = text
        .lines()
        .map(|l| l.strip_prefix("# never").map_or(l.to_owned(), |rest| format!("never{rest}")) + "\n")
        .collect();
    folder.write("active.rv", active.as_bytes());
    let run = folder.lapwing("check active.rv run.mcap");
    assert!(run.code == 1 && run.stdout.contains("never odom > 1.5 m/s"), "{}{}", run.stdout, run.stderr);
    assert!(folder.lapwing("new run.csv").stdout.contains("# never speed > 1.5\n"));
    assert!(folder.lapwing("new").stdout.contains("# decl speed"));
}

#[test]
fn demo_shows_a_violation_and_succeeds() {
    let folder = Folder::new(&[]);
    let run = folder.lapwing("demo playground");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert!(run.stdout.contains("Error at line 16:\n  second_stop: after_until"), "{}", run.stdout);
    assert!(run.stdout.contains("1 violated, 5 holds, 1 vacuous"), "{}", run.stdout);
    assert_eq!(folder.lapwing("check playground/stop_sign.rv playground/run.mcap").code, 1);
    assert_eq!(folder.lapwing("fmt --check playground/stop_sign.rv").code, 0);
}

#[test]
fn the_recording_of_the_demo_is_what_its_program_writes() {
    let made = make_stop_sign::recording().unwrap();
    assert!(made == stop_sign(), "run `cargo run -p lapwing-cli --example make_stop_sign` and commit what it writes");
}
