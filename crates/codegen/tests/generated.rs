//! What is generated, and what is refused. That generated monitors say what the engine says is held by `xtask/tests/codegen.rs`.

use std::process::Command;

use lapwing_check::checked::Spec;
use lapwing_check::{check, load};
use lapwing_codegen::{CAPACITY, Generated, Language, Options, generate};
use lapwing_diag::{Code, Diagnostic, SourceMap};

fn spec(text: &str) -> (SourceMap, Spec) {
    let mut sources = SourceMap::default();
    let file = sources.add("robot.rv", text);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, text).file, &|_| None);
    let checked = check(&sources, &loaded, None);
    assert!(!checked.has_errors(), "{text}: {:?}", checked.diagnostics);
    (sources, checked.spec)
}

fn options(language: Language) -> Options {
    Options { language, name: "robot".to_owned(), capacity: CAPACITY, properties: Vec::new() }
}

fn generated(text: &str, language: Language) -> Generated {
    generate(&spec(text).1, "robot.rv", &options(language)).unwrap_or_else(|why| panic!("{text}: {why:?}"))
}

/// What is refused of a specification: the source text of each, and the message.
fn refused(text: &str) -> Vec<(String, String)> {
    let (sources, spec) = spec(text);
    let Err(found) = generate(&spec, "robot.rv", &options(Language::C)) else { return Vec::new() };
    let one = |d: &Diagnostic| {
        assert_eq!(d.code.name(), "not-generated");
        (sources.slice(d.primary.span).to_owned(), d.message.clone())
    };
    found.iter().map(one).collect()
}

const SPEC: &str = "\
decl speed /odom Odometry.twist.twist.linear.x
decl mode /mode String.data default \"auto\"
decl estop /estop Bool.data stale after 2 s
event kick
limit = 2.0 * 1.5
never speed > limit
whenever mode == \"hand\", eventually within 2 s (speed < 0.1)
property shots over (kick): always once kick
always norm(speed, delta(speed)) < 10 and not estop
always once within [1 s, 3 s] (speed >= 0)
";

#[test]
fn the_example_on_the_page_of_the_code_is_refused() {
    let example = Code::NotGenerated.page().split("```\n").nth(1).unwrap_or_default();
    assert_eq!(refused(example).len(), 1, "{example}");
}

#[test]
fn members_are_named_after_signals_and_events() {
    let interface = generated(SPEC, Language::C).interface;
    let names: Vec<_> = interface.members.iter().map(|m| (m.name.as_str(), m.has.as_deref())).collect();
    let expected = [
        ("speed", Some("has_speed")),
        ("mode", Some("has_mode")),
        ("estop", Some("has_estop")),
        ("kick", None),
        ("got_estop", None),
    ];
    assert_eq!(names, expected);
    assert_eq!(interface.texts.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["TEXT_HAND", "TEXT_AUTO"]);
    assert_eq!(interface.properties.len(), 5);
}

#[test]
fn rust_is_a_module_for_crates_without_a_standard_library() {
    no_std(SPEC);
    no_std(HANDED);
}

/// What is handed to functions.
const HANDED: &str = "\
world robot /gt/robot Odometry
world drone /gt/drone PoseStamped
decl a /a String.data
decl b /b String.data
decl joints /joints JointState
never robot.velocity.body.x > drone.velocity or robot.distance.drone < 1
never starts_with(a, \"x\") or a == b or lookup(joints.name, joints.position, \"hip\") > 1
always all(joints.name, n => n != \"hip\") and len(joints.name) == len(joints.position)
";

/// Compiles a module without a standard library, of which the compiler has nothing to say.
fn no_std(spec: &str) {
    let generated = generated(spec, Language::Rust);
    let [(name, text)] = generated.files.as_slice() else { panic!("one file") };
    assert_eq!(name, "robot.rs");
    assert!(!text.contains("unsafe") && !text.contains("std::") && !text.contains("alloc::"), "{text}");
    let folder = tempfile::tempdir().expect("a folder to compile in");
    std::fs::write(folder.path().join(name), text).expect("the module");
    let root = "#![no_std]\n#![forbid(unsafe_code)]\n#![deny(warnings)]\npub mod robot;\n";
    std::fs::write(folder.path().join("lib.rs"), root).expect("the crate");
    let mut rustc = Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned()));
    rustc.args(["--edition", "2021", "--crate-type", "rlib", "--emit", "metadata", "-o"]);
    let output = rustc.arg(folder.path().join("robot.rmeta")).arg(folder.path().join("lib.rs")).output();
    let output = output.expect("rustc runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_square_root_that_rust_is_given_rounds_as_the_machine_does() {
    let generated = generated("always sqrt(x) == y and norm(x, y) >= 0\n", Language::Rust);
    assert_eq!(generated.interface.needs_libm, (false, true));
    let folder = tempfile::tempdir().expect("a folder to compile in");
    std::fs::write(folder.path().join("robot.rs"), &generated.files[0].1).expect("the module");
    let main = "\
mod robot;
fn main() {
    let mut monitor = robot::Monitor::new();
    let mut step = |x: f64| {
        let y = x.sqrt();
        monitor.step(0, &robot::Inputs { x, has_x: true, y, has_y: true });
    };
    let few = [0.0, f64::MIN_POSITIVE, f64::MAX, f64::INFINITY, 5e-324, 4.0, 2.0, 1.0 + f64::EPSILON, 0.25];
    few.into_iter().for_each(&mut step);
    // Xorshift (Marsaglia, 2003).
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..200_000 {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        let x = f64::from_bits(bits >> 1);
        if !x.is_nan() {
            step(x);
        }
    }
    let outcome = { monitor.end(); monitor.outcome(0).unwrap() };
    println!(\"{} {}\", outcome.failed, outcome.met > 190_000);
}
";
    std::fs::write(folder.path().join("main.rs"), main).expect("the program");
    let mut rustc = Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned()));
    rustc.current_dir(folder.path()).args([
        "--edition",
        "2024",
        "-C",
        "overflow-checks=on",
        "-A",
        "dead_code",
        "-o",
        "main",
        "main.rs",
    ]);
    let output = rustc.output().expect("rustc runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "0 true\n", "{}", String::from_utf8_lossy(&output.stderr));
}

/// Compiles monitors and a program that may drive them, which a compiler has nothing against. Gives the folder with `main` in it.
fn compile_c(generated: &Generated, program: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder to compile in");
    for (name, text) in &generated.files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    std::fs::write(folder.path().join("main.c"), format!("#include \"robot.h\"\n{program}")).expect("a file");
    let mut cc = Command::new("cc");
    cc.current_dir(folder.path()).args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-o", "main"]);
    let output = cc.args(["main.c", "robot.c", "-lm"]).output().expect("cc runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// Runs a C program that drives a monitor, and gives what it prints.
fn run_c(text: &str, capacity: usize, main: &str) -> String {
    let options = Options { capacity, ..options(Language::C) };
    let generated = generate(&spec(text).1, "robot.rv", &options).expect("a monitor");
    let folder = compile_c(
        &generated,
        &format!("#include <stdio.h>\n#include <string.h>\nint main(void) {{\n{main}\nreturn 0;\n}}\n"),
    );
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    assert!(output.status.success());
    String::from_utf8(output.stdout).expect("text")
}

const SAY: &str = "
    robot_end(&m);
    robot_outcome o = robot_get(&m, 0);
    printf(\"%d %d %d %d\", o.verdict, o.cause, (int)o.failed, (int)o.open);
";

#[test]
fn more_obligations_than_there_is_room_for_are_told() {
    let text = "whenever p, eventually within 10 s q\n";
    let main = |last: &str| {
        format!(
            "static robot_monitor m; robot_init(&m);
            for (int i = 0; i < 6; i++) {{
                robot_inputs in = {{.p = true, .has_p = true, .q = false, .has_q = true}};
                robot_step(&m, i * INT64_C(1000000000), &in);
            }}
            {last}{SAY}"
        )
    };
    // Inconclusive for want of room; with room they are open; and what failed has failed.
    assert_eq!(run_c(text, 4, &main("")), "1 3 0 4");
    assert_eq!(run_c(text, 8, &main("")), "3 0 0 6");
    assert_eq!(run_c(text, 4, &main("robot_advance(&m, INT64_C(12000000000));")), "0 0 2 2");
}

#[test]
fn what_waits_for_the_same_waits_in_one_entry() {
    // A thousand requests wait for an idle minute, of which four have room: they are one.
    let text = "whenever p, eventually always within 60 s q\n";
    let main = format!(
        "static robot_monitor m; robot_init(&m);
        for (int64_t i = 0; i < 1000; i++) {{
            robot_inputs in = {{.p = true, .has_p = true, .q = i % 3 == 0 || i == 999, .has_q = true}};
            robot_step(&m, i * INT64_C(1000000000), &in);
        }}
        robot_advance(&m, INT64_C(1058000000000)); {{{SAY}}}
        robot_advance(&m, INT64_C(1060000000000)); {{{SAY}}}"
    );
    assert_eq!(run_c(text, 4, &main), ["3 0 0 1000", "3 0 0 0"].concat());
}

#[test]
fn of_an_array_no_more_is_kept_than_what_is_asked_of_it() {
    let text = "decl ranges /scan LaserScan.ranges\nalways min(ranges) >= 0.3\nalways ranges[1] < 2 and len(ranges) <= 3\n\
                never any(ranges, v => v > 4 and v != 5)\nalways all(ranges, v => abs(v) < 9) or stopped\n";
    let interface = generated(text, Language::C).interface;
    let names: Vec<_> = interface.members.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["stopped", "min_ranges", "ranges_1", "len_ranges", "any_ranges", "any_ranges_2"]);
    assert_eq!(interface.wholes.iter().map(|a| a.setter.as_str()).collect::<Vec<_>>(), ["set_ranges"]);
    let main = "static robot_monitor m; robot_init(&m);
        const double scans[4][3] = {{1, 1.5, 3}, {1, NAN, 0.2}, {5, 4.5, 1}, {1, 1, 8}};
        for (int i = 0; i < 4; i++) {
            robot_inputs in = {0};
            in.has_stopped = true;
            robot_set_ranges(&in, scans[i], 3);
            robot_step(&m, i, &in);
        }
        robot_inputs none = {0};
        robot_set_ranges(&none, 0, 0);
        robot_step(&m, 4, &none);
        robot_end(&m);
        for (uint32_t p = 0; p < ROBOT_PROPERTIES; p++) {
            printf(\"%d/%d \", (int)robot_get(&m, p).met, (int)robot_get(&m, p).failed);
        }";
    let generated = generated(text, Language::C);
    let folder = compile_c(
        &generated,
        &format!(
            "#include <math.h>\n#include <stdio.h>\n#include <string.h>\nint main(void) {{\n{main}\nreturn 0;\n}}\n"
        ),
    );
    let output = Command::new(folder.path().join("main")).output().expect("it runs");
    // NaN is no distance: the second scan's least is 0.2, its second element below nothing; of no elements nothing is least.
    assert_eq!(String::from_utf8_lossy(&output.stdout), "3/2 2/3 3/2 5/0 ");
}

#[test]
fn objects_are_handed_over_as_their_sources_have_them() {
    let text = "world robot /gt/robot Odometry\nworld drone /gt/drone PoseStamped\nnever robot.velocity.y > 0.5\nnever drone.velocity > 2\n\
                never robot.distance.drone < 1\n";
    let interface = generated(text, Language::C).interface;
    let setters: Vec<_> = interface.objects.iter().flat_map(|o| &o.setters).map(|s| s.name.as_str()).collect();
    assert_eq!(setters, ["set_robot", "set_robot_twist", "set_drone"]);
    let main = "static robot_monitor m; robot_init(&m);
        const double half = 0.7071067811865476;
        const double turned[4] = {0, 0, half, half}, forward[3] = {1, 0, 0};
        for (int i = 0; i < 3; i++) {
            const double robot[3] = {0, 0, 0}, drone[3] = {0.5 + 2.5 * i * i, 0, 0};
            robot_inputs in = {0};
            robot_set_robot(&in, robot, turned);
            robot_set_robot_twist(&in, forward);
            robot_set_drone(&in, drone);
            robot_step(&m, i * INT64_C(1000000000), &in);
        }
        robot_end(&m);
        for (uint32_t p = 0; p < ROBOT_PROPERTIES; p++) {
            printf(\"%d/%d \", (int)robot_get(&m, p).met, (int)robot_get(&m, p).failed);
        }";
    // What goes forward and is turned to the left goes along y; the drone makes 2.5 m and 7.5 m in a second each.
    assert_eq!(run_c(text, 4, main), "0/3 0/2 2/1 ");
}

#[test]
fn of_a_text_no_more_is_kept_than_what_is_asked_of_it() {
    let text = "decl mode /mode String.data default \"auto\"\nnever starts_with(mode, \"auto \")\nalways mode == \"auto\"\n\
                always contains(mode, \"\\\"?\")\nnever kick.by == \"me\" or ends_with(kick.by, \"ü\")\nevent kick\n";
    let interface = generated(text, Language::C).interface;
    let setters: Vec<_> = interface.wholes.iter().map(|o| o.setter.as_str()).collect();
    assert_eq!(setters, ["set_mode", "set_kick_by"]);
    let main = "static robot_monitor m; robot_init(&m);
        const char *modes[4] = {\"auto\", \"auto x\", \"a\\\"?\", \"\"}, *names[4] = {\"me\", \"m\", \"\", \"g\\303\\274\"};
        for (int i = 0; i < 4; i++) {
            robot_inputs in = {0};
            in.kick = true;
            robot_set_mode(&in, modes[i], (uint32_t)strlen(modes[i]));
            robot_set_kick_by(&in, names[i], (uint32_t)strlen(names[i]));
            robot_step(&m, i, &in);
        }
        robot_end(&m);
        for (uint32_t p = 0; p < ROBOT_PROPERTIES; p++) {
            printf(\"%d/%d \", (int)robot_get(&m, p).met, (int)robot_get(&m, p).failed);
        }";
    assert_eq!(run_c(text, 4, main), "3/1 1/3 1/3 2/2 ");
}

#[test]
fn texts_that_only_a_trace_knows_are_compared_by_their_hashes() {
    let text = "decl a /a String.data\ndecl b /b String.data default \"ready\"\nalways a == b\nnever a == \"go\"\n";
    let main = "static robot_monitor m; robot_init(&m);
        const char *as[4] = {\"ready\", \"go\", \"go\", \"\"}, *bs[4] = {0, 0, \"go\", \"g\"};
        for (int i = 0; i < 4; i++) {
            robot_inputs in = {0};
            robot_set_a(&in, as[i], (uint32_t)strlen(as[i]));
            if (bs[i]) robot_set_b(&in, bs[i], (uint32_t)strlen(bs[i]));
            robot_step(&m, i, &in);
        }
        robot_inputs in = {.a = ROBOT_TEXT_GO, .has_a = true, .b = ROBOT_TEXT_GO, .has_b = true};
        robot_step(&m, 4, &in);
        robot_end(&m);
        for (uint32_t p = 0; p < ROBOT_PROPERTIES; p++) {
            printf(\"%d/%d \", (int)robot_get(&m, p).met, (int)robot_get(&m, p).failed);
        }";
    assert_eq!(run_c(text, 4, main), "3/2 2/3 ");
}

#[test]
fn numbers_are_looked_up_by_name() {
    let text = "decl joints /joints JointState\nnever lookup(joints.name, joints.position, \"hip\") > 1\n";
    let main = "static robot_monitor m; robot_init(&m);
        const char *names[3][2] = {{\"elbow\", \"hip\"}, {\"hip\", \"hip\"}, {\"hi\", \"hips\"}};
        const double positions[2] = {0, 2};
        for (int i = 0; i < 4; i++) {
            robot_inputs in = {0};
            robot_set_joints_position_by_joints_name(&in, names[i % 3], 2, positions, i < 3 ? 2 : 1);
            robot_step(&m, i, &in);
        }
        robot_end(&m);
        printf(\"%d/%d\", (int)robot_get(&m, 0).met, (int)robot_get(&m, 0).failed);";
    // The first of two of a name counts; a name without a number beside it has none.
    assert_eq!(run_c(text, 4, main), "3/1");
}

#[test]
fn time_that_jumps_back_starts_everything_anew() {
    let main = format!(
        "static robot_monitor m; robot_init(&m);
        robot_inputs in = {{.p = true, .has_p = true}};
        robot_step(&m, 5, &in);
        robot_step(&m, 1, &in);{SAY}"
    );
    assert_eq!(run_c("eventually not p\n", 4, &main), "1 4 0 2");
}

#[test]
fn what_would_need_more_than_one_fixed_size_is_refused_at_its_place() {
    let of = |text: &str| refused(text).into_iter().map(|(source, _)| source).collect::<Vec<_>>();
    let ranges = "decl r /scan LaserScan.ranges\ndecl joints /joints JointState\n";
    assert_eq!(of(&format!("{ranges}never min(r) < x\nnever any(r, v => v == x)\n")), ["any(r, v => v == x)"]);
    assert_eq!(
        of("event kick\nfor each r in (a, b): never r > 1\nfor each k of kick.robot: eventually kick\n").len(),
        1
    );
    // Each p without a q has a second of its own, in which an r may begin that has to last.
    let nested = "whenever p, always within 2 s (q or eventually within [1 s, 3 s] r)\n";
    assert_eq!(of(nested), ["eventually within [1 s, 3 s] r"]);
    assert_eq!(of("whenever p, always within 2 s (q or eventually within 3 s r)\n"), [""; 0]);
    assert_eq!(of("after (eventually p), always q\n"), ["after (eventually p), always q"]);
    let texts = "decl a /a String.data\ndecl b /b String.data\n";
    assert_eq!(of(&format!("{texts}never starts_with(a, \"x\")\nnever starts_with(a, b)\n")), ["starts_with(a, b)"]);
    assert_eq!(of(&format!("{texts}never a == b\nnever a != @{{a, -1}}\n")), [""; 0]);
}

#[test]
fn a_machine_has_as_many_states_as_a_byte_can_count() {
    let machine = |count: usize| {
        let states: String = (0..count).map(|i| format!("    state s{i} when x == {i}\n")).collect();
        format!("machine many {{\n    initial s0\n{states}    s0 -> s{}\n}}\n", count - 1)
    };
    // Along the edge to the last state, then nowhere.
    let main = format!(
        "static robot_monitor m; robot_init(&m);
        robot_inputs in = {{.x = 254, .has_x = true}};
        robot_step(&m, 0, &in);
        in.x = 255;
        robot_step(&m, 1, &in);{SAY}printf(\" %d\", (int)o.met);"
    );
    assert_eq!(run_c(&machine(255), 4, &main), "0 0 1 0 1");
    let text = machine(256) + "always many == s1 implies x > 0\n";
    let [(place, message)] = refused(&text).try_into().expect("one refusal");
    assert!(place.starts_with("machine many {"), "{place}");
    assert_eq!(message, "the state of a machine is one byte, and `many` has 256");
}

#[test]
fn hostile_names_make_no_hostile_code() {
    let text = "decl `int` /int Float64.data\ndecl mode /mode String.data\nproperty `*/ oops`: always `int` > 0\n\
                property `b\\\\`: never `int` > 9\nproperty `/*/ /* oh`: never mode == \"*/*??/\"\nproperty `q???/`: never `int` > 8\n";
    let (_, spec) = spec(text);
    let title = "a\n#error */ \\";
    for language in [Language::Rust, Language::C] {
        let generated = generate(&spec, title, &options(language)).expect("monitors");
        for (name, text) in &generated.files {
            let is_ours = |line: &str| line.contains("-fno-fast-math");
            let mut directives = text.lines().filter(|line| line.starts_with('#') && !is_ours(line));
            assert!(!directives.any(|line| line.contains("error")), "{text}");
            let comments = if name.ends_with(".h") { text.matches("/*").count() } else { 0 };
            assert!(comments == 0 || text.matches("*/").count() == comments, "{text}");
        }
        if language == Language::C {
            compile_c(&generated, "int main(void) {\nreturn 0;\n}\n");
        }
    }
}

#[test]
fn mathematics_that_knows_no_nan_is_refused_by_the_compiler() {
    let generated = generated("never speed > 2\n", Language::C);
    let folder = compile_c(&generated, "int main(void) { return 0; }\n");
    for option in ["-ffast-math", "-ffinite-math-only", "-Ofast"] {
        let mut cc = Command::new("cc");
        let output =
            cc.current_dir(folder.path()).args(["-std=c99", option, "-c", "robot.c"]).output().expect("cc runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains("-fno-fast-math"), "{option}: {said}");
    }
}
