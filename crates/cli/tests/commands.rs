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
        "/odom nav_msgs/Odometry (606 messages): twist.twist.linear.x, a number",
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
}

/// A specification with everything that a picture may show, and texts that mean something to every format.
const DRAWN: &str = r#"
machine gate {
    initial shut
    state shut when x < 1 and name != "a<b>&\"c\""
    state open when x >= 1
    shut -> open
    open -> shut
    open -> open
}
event kick
answer: whenever kick, eventually within 2 s (x > 1 and always for 1 s y > 0)
after_until x > 3, x < 1, (never y > 2) and eventually y == 0
until x > 5, x < 6
next x > 0 implies (x > 1) until (y > 1)
"#;

#[test]
fn explain_draws_what_every_property_asks_and_when() {
    let folder = Folder::new(&[("a.rv", DRAWN), ("none.rv", "limit = 2\n")]);
    let dot = folder.lapwing("explain a.rv --format dot").stdout;
    let mut clusters = 0;
    let (mut nodes, mut arrows) = (Vec::new(), Vec::new());
    for line in dot.lines().map(str::trim) {
        clusters += usize::from(line.starts_with("subgraph \"cluster_"));
        if !line.starts_with('"') {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[1] {
            "->" => arrows.push((words[0], words[2].trim_end_matches(';'))),
            _ => nodes.push(words[0]),
        }
        let quotes = line.replace("\\\\", "").replace("\\\"", "").matches('"').count();
        assert!(quotes.is_multiple_of(2) && line.ends_with(';'), "{line}");
    }
    assert_eq!(clusters, 5, "{dot}");
    assert!(arrows.iter().all(|(a, b)| nodes.contains(a) && nodes.contains(b)), "{dot}");
    assert_eq!(dot.matches('{').count(), dot.matches('}').count());
    for said in
        ["at every instant of the recording\\nwith kick", "eventually within 2 s", "eventually x > 5", "all the while"]
    {
        assert!(dot.contains(said), "{said}\n{dot}");
    }
    let mermaid = folder.lapwing("explain a.rv --format mermaid").stdout;
    assert!(mermaid.starts_with("flowchart TD\n"), "{mermaid}");
    assert_eq!(mermaid.matches("  subgraph ").count(), mermaid.matches("  end\n").count());
    let none = folder.lapwing("explain none.rv --format svg");
    assert!(none.code == 2 && none.stderr.contains("no property to draw"), "{}", none.stderr);
}

#[test]
fn explain_draws_svg_that_is_well_formed_and_in_which_no_boxes_overlap() {
    use quick_xml::events::Event;

    let folder = Folder::new(&[("a.rv", DRAWN)]);
    let svg = folder.lapwing("explain a.rv --format svg").stdout;
    let mut reader = quick_xml::Reader::from_str(&svg);
    let mut boxes: Vec<Vec<[f64; 4]>> = Vec::new();
    let mut texts = String::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Eof => break,
            // A title begins a picture.
            Event::Start(tag) if tag.name().as_ref() == "text" && tag.try_get_attribute("class").unwrap().is_some() => {
                boxes.push(Vec::new());
            }
            Event::Empty(tag) if tag.name().as_ref() == "rect" => {
                let number =
                    |name: &str| -> f64 { tag.try_get_attribute(name).unwrap().unwrap().value.parse().unwrap() };
                boxes.last_mut().unwrap().push(["x", "y", "width", "height"].map(number));
            }
            Event::Text(text) => texts += &text,
            Event::GeneralRef(_) => texts.push('&'),
            _ => {}
        }
    }
    assert_eq!(boxes.len(), 5);
    for picture in &boxes {
        for (k, a) in picture.iter().enumerate() {
            let apart = |b: &[f64; 4], side: usize| {
                a[side] + a[side + 2] <= b[side] + 0.2 || b[side] + b[side + 2] <= a[side] + 0.2
            };
            assert!(picture[..k].iter().all(|b| apart(b, 0) || apart(b, 1)), "{picture:?}\n{svg}");
        }
    }
    assert!(texts.contains("turn") || texts.contains("shut"), "{texts}");
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
    let fresh = folder.lapwing("check robot.rv run.mcap");
    assert_eq!((fresh.code, &*fresh.stderr), (0, ""), "what was just written has nothing to be warned of");
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

/// Topics whose names come out alike, cannot be written, or would be statements if they were believed.
#[test]
fn new_writes_what_can_be_checked_whatever_topics_are_called() {
    let topic = |name: &str| {
        format!("{{\"t\": 0, \"topic\": \"{name}\", \"type\": \"std_msgs/Float64\", \"msg\": {{\"data\": 1}}}}\n")
    };
    let lines: String = ["/a/b", "/a_b", "/x-y", "/n\\nnever 1 > 0\\n"].map(topic).concat();
    let folder = Folder::new(&[("odd.ndjson", &lines), ("odd.csv", "time,my col,always\n0,1,2\n")]);
    assert_eq!(folder.lapwing("new odd.ndjson -o odd.rv").code, 0);
    let text = folder.read("odd.rv");
    assert!(text.contains("decl a_b /a/b ") && text.contains("decl a_b_2 /a_b "), "{text}");
    assert!(text.contains("# /x-y std_msgs/Float64\n# Its name, or that of its type, is one that"), "{text}");
    assert!(text.contains("# always age(/a/b) < 1 s\n") && !text.contains("\nnever"), "{text}");
    let run = folder.lapwing("check odd.rv odd.ndjson");
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let text = folder.lapwing("new odd.csv").stdout;
    assert!(text.contains("# never `my col` > 1.5\n# never `always` > 1.5\n"), "{text}");
}

#[test]
fn demo_shows_a_violation_and_succeeds() {
    let folder = Folder::new(&[]);
    let run = folder.lapwing("demo playground");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert!(run.stdout.contains("Error at line 6:\n  stops: after_until"), "{}", run.stdout);
    assert!(run.stdout.contains("Error at line 8:\n  moves: whenever"), "{}", run.stdout);
    for name in ["stop_sign", "docking"] {
        assert_eq!(folder.lapwing(&format!("check playground/{name}.rv playground/{name}.mcap")).code, 1);
        assert_eq!(folder.lapwing(&format!("fmt --check playground/{name}.rv")).code, 0);
    }
    let page = std::fs::read_to_string(folder.path("playground/report.html")).unwrap();
    assert!(page.contains("stop_sign.mcap") && page.contains("docking.mcap"));
    // What the closing lines propose works, and a healthy car stops.
    let healthy = folder.lapwing("sim stop-sign --check playground/stop_sign.rv");
    assert_eq!(healthy.code, 0, "{}", healthy.stdout);
}

#[test]
fn the_recording_of_the_demo_is_what_its_program_writes() {
    let made = make_stop_sign::recording().unwrap();
    assert!(made == stop_sign(), "run `cargo run -p lapwing-cli --example make_stop_sign` and commit what it writes");
}

#[test]
fn explain_shows_what_the_libraries_ship() {
    let folder = Folder::new(&[]);
    let robot = folder.lapwing("explain std.robot");
    assert!(
        robot.code == 0 && robot.stdout.contains("tracks(command, response, tolerance, settle)"),
        "{}",
        robot.stdout
    );
    let tracks = folder.lapwing("explain std.robot.tracks");
    assert!(tracks.stdout.contains("It stands for:\n    whenever held for settle"), "{}", tracks.stdout);
    let response = folder.lapwing("explain std.dwyer.response");
    assert!(response.stdout.contains("As a formula: "), "{}", response.stdout);
    let misspelt = folder.lapwing("explain std.robt");
    assert!(misspelt.code == 2 && misspelt.stderr.contains("did you mean `std.robot`?"), "{}", misspelt.stderr);
    let unknown = folder.lapwing("explain std.robot.trakcs");
    assert!(unknown.code == 2 && unknown.stderr.contains("did you mean `tracks`?"), "{}", unknown.stderr);
}

#[test]
fn explain_finds_the_instances_that_a_check_finds() {
    let line = |t: usize, robot: &str| {
        format!("{{\"t\":{t},\"topic\":\"/{robot}/v\",\"type\":\"std_msgs/Float64\",\"msg\":{{\"data\":1}}}}\n")
    };
    let late: String = (0..20_000).map(|t| line(t, "r1")).chain([line(20_000, "r2")]).collect();
    let spec = "decl v /r1/v std_msgs/Float64.data\nv: for each r in topics /{r}/v: age(/{r}/v) < 5\nv2: v > 0\n"
        .replace("v: for", "fresh: for");
    let folder = Folder::new(&[("a.rv", spec.as_str()), ("late.ndjson", late.as_str())]);
    let explained = folder.lapwing("explain a.rv late.ndjson");
    assert!(explained.stdout.contains("fresh[r1]") && explained.stdout.contains("fresh[r2]"), "{}", explained.stdout);
}
