//! `lapwing genom run`, `headers` and `bip --spec`: components that run, in Rust's hands and in C's.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const COMPONENT: &str = r#"
module t {
  enum mode { SLOW, FAST };
  struct point { double x; float y; };
  struct all {
    boolean b; octet o; char c; short s; unsigned short us; long l; unsigned long ul; long long ll; unsigned long long ull;
    mode m; string<8> name; string text; point p; point pair[2]; sequence<point> many; sequence<long, 4> few; optional<double> maybe;
  };
  union number switch (mode) { case SLOW: long whole; default: double real; };
};
component C {
  native handle;
  exception NO_LUCK { long tries; };
  ids { handle h; t::all a; t::number u; long n; };
  port out t::all Out;
  port multiple out t::point Many;
  task k { period 10 ms; };
  attribute Get(out n);
  function Fill(in t::all from, in t::number kind, out long sum, inout string<8> word) {
    codel CFill(local in from, local in kind, local out sum, local inout word, ids out a, ids out u, ids inout h) wcet 1 ms;
  };
  activity Go(in long until) {
    task k;
    codel<start> CStart(ids out n, ids inout h) yield main wcet 1 ms;
    codel<main> CMain(ids inout n, ids in a, local in until, port out Out, port out Many, ids in h) yield pause::main, ether wcet 2 ms;
    codel<stop> CStop() yield ether wcet 1 ms;
    throw NO_LUCK;
    interrupts Go;
  };
};
"#;

const CODELS: &str = r#"
#include "acC.h"
#include <stdio.h>

struct C_handle { int marks; };

genom_event CFill(const t_all *from, const t_number *kind, int32_t *sum, char word[8], t_all *a, t_number *u, C_handle **h,
                  const genom_context self) {
  (void)self;
  if (!*h) *h = calloc(1, sizeof(**h));
  (*h)->marks++;
  a->b = from->b; a->o = from->o; a->c = from->c; a->s = from->s; a->us = from->us; a->l = from->l; a->ul = from->ul;
  a->ll = from->ll; a->ull = from->ull; a->m = from->m; a->p = from->p;
  memcpy(a->name, from->name, sizeof(a->name));
  free(a->text);
  a->text = strdup(from->text);
  memcpy(a->pair, from->pair, sizeof(a->pair));
  a->few = from->few;
  a->maybe = from->maybe;
  genom_sequence_reserve(&a->many, from->many._length + 1);
  a->many._length = from->many._length + 1;
  for (uint32_t i = 0; i < from->many._length; i++) a->many._buffer[i] = from->many._buffer[i];
  a->many._buffer[from->many._length].x = 99;
  *u = *kind;
  *sum = from->l + (kind->_d == t_SLOW ? kind->_u.whole : (int32_t)kind->_u.real);
  for (uint32_t i = 0; i < from->few._length; i++) *sum += from->few._buffer[i];
  word[0] = word[0] ? word[0] + 1 : 'a';
  return genom_ok;
}

genom_event CStart(int32_t *n, C_handle **h, const genom_context self) {
  (void)self;
  *n = *h ? 100 * (*h)->marks : 0;
  return C_main;
}

genom_event CMain(int32_t *n, const t_all *a, int32_t until, const C_Out *Out, const C_Many *Many, const C_handle *h,
                  const genom_context self) {
  t_all *out = Out->data(self);
  (*n)++;
  out->l = *n;
  out->m = t_FAST;
  strcpy(out->name, "eight888");
  free(out->text);
  out->text = strdup(a->text ? a->text : "");
  Out->write(self);
  Many->data("one", self)->x = *n;
  Many->write("one", self);
  if (until == -1) *(volatile int *)0 = 1;
  if (until == -2) for (;;) {}
  if (until == -3) return "a lie";
  if (until == -4) lapwing_elapse(30000000u, self);
  if (until == -5) { C_NO_LUCK_detail detail = { *n }; return C_NO_LUCK(&detail, self); }
  printf("codel %d %d\n", (int)*n, h ? h->marks : -1);
  return *n % 100 >= until ? C_ether : C_pause_main;
}

genom_event CStop(const genom_context self) { (void)self; return C_ether; }
"#;

struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Bench {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("c.gen"), COMPONENT).unwrap();
        std::fs::write(folder.path().join("codels.c"), CODELS).unwrap();
        Bench { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn file(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn lapwing(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_lapwing")).current_dir(self.folder.path()).args(arguments).output().unwrap()
    }

    /// Writes the headers and compiles the library, without a warning.
    fn compiled(self) -> Bench {
        let written = self.lapwing(&["genom", "headers", "c.gen", "-o", "made"]);
        assert!(written.status.success(), "{}", said(&written));
        self.compile("codels.c");
        self
    }

    fn compile(&self, source: &str) {
        let mut compiler = Command::new("cc");
        compiler
            .current_dir(self.folder.path())
            .args(["-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-I", "made"]);
        let output = compiler.args(["-o", "libc.so", "made/C_glue.c", source]).output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
    }

    /// A run of a request or several.
    fn run(&self, requests: &str, more: &[&str]) -> Output {
        self.file("requests", requests);
        let usual = ["genom", "run", "c.gen", "--requests", "requests", "--codels", "libc.so", "--verbose"];
        let duration = if more.contains(&"--duration") { &[][..] } else { &["--duration", "200ms"] };
        self.lapwing(&[&usual, duration, more].concat())
    }
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

const FILL: &str = "@0s C.Fill(from={b=true, o=200, c=-3, s=-300, us=60000, l=7, ul=4000000000, ll=-9000000000000000001, \
ull=18000000000000000001, m=FAST, name=\"eight888\", text=\"any lengthy text\", p={x=0.1, y=1.5}, pair=[{x=1, y=2}, {x=3, y=4}], \
many=[{x=5, y=6}, {x=7, y=8}], few=[10, 20], maybe=2.5}, kind={real=0.5}, word=\"q\")\n";

#[test]
fn codels_in_c_are_given_every_type_and_give_it_back() {
    let bench = Bench::new().compiled();
    for isolated in [&[][..], &["--isolate"][..]] {
        let output = bench.run(&format!("{FILL}@20ms C.Go(until=3)\n@150ms C.Get()\n"), isolated);
        let text = said(&output);
        assert_eq!(output.status.code(), Some(0), "{text}");
        assert!(text.contains("report #1 C.Fill done") && text.contains("sum=37, word=\"r\""), "{text}");
        // The handle that the first codel made is there for those of the activity.
        assert!(text.contains("report #3 C.Get done (n=103)"), "{text}");
        assert!(text.contains("\"m\":\"FAST\",\"name\":\"eight888\",\"text\":\"any lengthy text\""), "{text}");
        assert!(text.contains("write C.Many[one] {\"x\":103.0,\"y\":0.0}"), "{text}");
        assert_eq!(text.matches("write C.Out ").count(), 3, "{text}");
        assert!(text.contains("codel 103 1"), "{text}");
        assert!(text.contains("report #2 C.Go done"), "{text}");
    }
}

#[test]
fn the_answers_of_c_are_events_exceptions_and_lies() {
    let bench = Bench::new().compiled();
    let text = said(&bench.run("@0s C.Go(until=-5)\n@50ms C.Go(until=-3)\n@100ms C.Go(until=-4)\n", &[]));
    assert!(text.contains("report #1 C.Go NO_LUCK (until=-5)"), "{text}");
    assert!(text.contains("report #2 C.Go bad_transition (a lie) (until=-3)"), "{text}");
    assert!(text.contains("overrun C.Go.main CMain took 3") && text.contains("2 ms is its wcet (c.gen:25)"), "{text}");
}

#[test]
fn a_codel_that_crashes_or_hangs_in_its_own_process_is_named_with_its_line() {
    let bench = Bench::new().compiled();
    for (until, words) in [("-1", "its process died: signal: 11"), ("-2", "it has not returned for 1 s")] {
        for time in [&[][..], &["--real-time"][..]] {
            let more = [&["--isolate", "--patience", "1s", "--duration", "60s"][..], time].concat();
            let output = bench.run(&format!("@0s C.Go(until={until})\n"), &more);
            let text = said(&output);
            assert_eq!(output.status.code(), Some(1), "{text}");
            let name = "the codel `CMain` of C.Go.main (c.gen:25) could not be run: ";
            assert!(text.contains(name) && text.contains(words), "{text}");
        }
    }
}

#[test]
fn a_library_that_does_not_fit_is_refused() {
    let bench = Bench::new().compiled();
    bench.file("c.gen", &COMPONENT.replace("long n;", "long long n;"));
    let output = bench.run("", &[]);
    assert!(said(&output).contains("was compiled for another specification of `C`"), "{}", said(&output));
    assert_eq!(output.status.code(), Some(2));
    let output = bench.run("", &["--isolate"]);
    assert!(said(&output).contains("was compiled for another specification of `C`"), "{}", said(&output));
    bench.file("libc.so", "no library");
    let output = bench.run("", &[]);
    assert!(said(&output).contains("libc.so cannot be loaded"), "{}", said(&output));
    assert_eq!(output.status.code(), Some(2));
}

fn navigation() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/navigation/robot_navigation.gen").display().to_string()
}

const MISSION: &str =
    "@0s LaserDriver.Acquire()\n@0s SafetyPilot.StopIfObstacle()\n@500ms Navigation.GotoPosition(x=3, y=1)\n";

const SPEC: &str = "use std.robot
event laser = write LaserDriver.Laser
property Scan_Fail: keeps_coming(laser, running Navigation.GotoPosition, 100 ms)
on violation of Scan_Fail { request SafetyPilot.Stop  stop }
property fresh: age(LaserDriver.Laser) <= 300 ms
";

#[test]
fn a_run_is_watched_recorded_and_judged_again() {
    let bench = Bench::new();
    bench.file("spec.rv", SPEC);
    bench.file("requests", MISSION);
    let gen_file = navigation();
    let run = |record: &str| {
        let usual = ["genom", "run", &gen_file, "--spec", "spec.rv", "--requests", "requests", "--duration", "20s"];
        bench.lapwing(&[&usual[..], &["--record", record, "--format", "json"]].concat())
    };
    let (first, second) = (run("a.mcap"), run("b.ndjson"));
    assert_eq!(first.stdout, second.stdout);
    assert_eq!(first.status.code(), Some(1), "{}", said(&first));
    run("c.mcap");
    assert_eq!(std::fs::read(bench.path("a.mcap")).unwrap(), std::fs::read(bench.path("c.mcap")).unwrap());
    let facts = |json: &[u8]| {
        let all: serde_json::Value = serde_json::from_slice(json).unwrap();
        let of =
            |p: &serde_json::Value| ["name", "verdict", "obligations", "violations"].map(|key| p[key].clone()).to_vec();
        all[0]["properties"].as_array().unwrap().iter().map(of).collect::<Vec<_>>()
    };
    let live = facts(&first.stdout);
    for record in ["a.mcap", "b.ndjson"] {
        let again = bench.lapwing(&["check", "spec.rv", record, "--format", "json"]);
        assert_eq!(facts(&again.stdout), live, "{record}");
    }
    let text = said(&bench.lapwing(&[
        "genom",
        "run",
        &gen_file,
        "--spec",
        "spec.rv",
        "--requests",
        "requests",
        "--duration",
        "20s",
    ]));
    assert!(text.contains("violation Scan_Fail: ") && text.contains("SafetyPilot.Stop(), by Scan_Fail"), "{text}");
}

/// As the README of the case study says; what a model cannot judge is said at its place.
#[test]
fn the_model_of_the_case_study_is_watched_as_the_run_is() {
    let bench = Bench::new();
    let beside = |name: &str| Path::new(&navigation()).with_file_name(name).display().to_string();
    let model = |spec: &str| {
        let (gen_file, requests, spec) = (navigation(), beside("mission.txt"), beside(spec));
        bench.lapwing(&["genom", "bip", &gen_file, "--requests", &requests, "--spec", &spec])
    };
    let watched = model("scan_fail.rv");
    assert_eq!(watched.status.code(), Some(0), "{}", said(&watched));
    bench.file("watched.bip", std::str::from_utf8(&watched.stdout).unwrap());
    let run = bench.lapwing(&["bip", "run", "watched.bip", "--limit", "500"]);
    assert!(said(&run).contains("stop (reached limit of 500 states)"), "{}", said(&run));
    let refused = model("navigation.rv");
    assert!(said(&refused).contains("`stands` cannot be a monitor in BIP"), "{}", said(&refused));
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn what_components_do_not_have_is_an_error_before_anything_runs() {
    let bench = Bench::new();
    let gen_file = navigation();
    for (spec, words) in [
        ("event l = write LaserDriver.Lasr\nnever l\n", "did you mean /LaserDriver/Laser?"),
        ("property p: never running Navigation.Goto\n", "Navigation/Goto/running"),
        (
            "property p: never running Navigation.GotoPosition\non violation of p { request SafetyPilot.Halt }\n",
            "has no service `Halt`; it has",
        ),
        (
            "property p: never running Navigation.GotoPosition\non violation of p { request Navigation.GotoPosition }\n",
            "needs a value for `x`",
        ),
        ("never LaserDriver.Laser.took > 1\n", "took"),
    ] {
        bench.file("spec.rv", spec);
        let output = bench.lapwing(&["genom", "run", &gen_file, "--spec", "spec.rv"]);
        assert!(said(&output).contains(words), "{}", said(&output));
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    }
    bench.file("requests", "@1s Navigation.GotoPosition(x=1)\n@2s Gone.Away()\n");
    let output = bench.lapwing(&["genom", "run", &gen_file, "--requests", "requests"]);
    let text = said(&output);
    assert!(text.contains("requests:1:5: ") && text.contains("requests:2:5: there is no component `Gone`"), "{text}");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn requests_come_on_standard_input_while_it_runs() {
    use std::io::Write as _;
    use std::process::Stdio;
    let bench = Bench::new();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lapwing"));
    command.current_dir(bench.folder.path()).args(["genom", "run", "c.gen", "--real-time", "--requests", "-"]);
    bench.file("spec.rv", "event done = report C.Get\nproperty told: never done\non violation of told { stop }\n");
    command
        .args(["--spec", "spec.rv", "--duration", "60s"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = child.stdin.take().unwrap();
    lines.write_all(b"C.Gone()\nC.Get()\n").unwrap();
    // The answer ends the run: nobody has to wait for it.
    let output = child.wait_with_output().unwrap();
    drop(lines);
    let text = said(&output);
    assert!(text.contains("standard input:1:1: `C` has no service `Gone`"), "{text}");
    assert!(text.contains("request #1 C.Get()\n") && text.contains("report #1 C.Get done (n=0)"), "{text}");
    assert_eq!(output.status.code(), Some(1), "{text}");
}

/// A laser that sometimes rests, and somebody who drives on and on.
const DRIVING: &str = "
component Laser {
  port out double Scan;
  task t { period 40 ms; };
  activity Acquire() {
    task t;
    codel<start> A1() yield main wcet 1 ms;
    codel<main> A2(port out Scan) yield pause::main, pause::idle wcet 10 ms;
    codel<idle> A3() yield pause::main wcet 1 ms;
  };
};
component Nav {
  task plan { period 50 ms; };
  activity Goto() { task plan; codel<start> N1() yield pause::start wcet 10 ms; interrupts Goto; };
  function Stop() { interrupts Goto; };
};
";

#[test]
fn a_model_with_monitors_and_a_client_runs_in_the_bip_engine() {
    let bench = Bench::new();
    bench.file("d.gen", DRIVING);
    let spec = "use std.robot\nevent scan = write Laser.Scan\nproperty Scan_Fail: keeps_coming(scan, running Nav.Goto, 60 ms)\n";
    bench.file("spec.rv", &format!("{spec}on violation of Scan_Fail {{ request Nav.Stop }}\n"));
    bench.file("requests", "@0s Laser.Acquire()\n@300ms Nav.Goto()\n@1s Nav.Goto()\n");
    let model = bench.lapwing(&["genom", "bip", "d.gen", "--spec", "spec.rv", "--requests", "requests"]);
    assert!(model.status.success(), "{}", said(&model));
    std::fs::write(bench.path("m.bip"), &model.stdout).unwrap();
    let ran = bench.lapwing(&["bip", "run", "m.bip", "--seed", "1", "--limit", "4000"]);
    let log = said(&ran);
    assert_eq!(ran.status.code(), Some(0), "{}", &log[log.len().saturating_sub(2000)..]);
    let chosen = |name: &str| log.lines().position(|l| l.contains("choose") && l.contains(&format!("ROOT.{name}:")));
    let order = ["Scan_Fail", "Scan_Fail_debt_1_request"].map(|name| chosen(name).unwrap_or_else(|| panic!("{log}")));
    assert!(order[0] < order[1], "{order:?}");
    let wrong = bench.lapwing(&["genom", "bip", "d.gen", "--exceptions"]);
    assert_eq!(wrong.status.code(), Some(2), "{}", said(&wrong));
}
