//! What is wrong with specifications: each fault with its code, at its place.

mod common;

use common::{codes, files, shown, text};
use lapwing_genom::Options;

/// What is found in a component with a task `t` and internal data `a` and `b`.
fn component(inside: &str) -> Vec<String> {
    codes(&text(&format!(
        "struct s {{ long m; }}; component c {{ ids {{ long a; s b; }}; port in s p; port out s q; task t {{ period 10 ms; }}; {inside} }};"
    )))
}

#[track_caller]
fn finds(inside: &str, expected: &[&str]) {
    assert_eq!(component(inside), expected, "{inside}");
}

/// What is found in an activity with these codels.
#[track_caller]
fn activity(codels: &str, expected: &[&str]) {
    finds(&format!("activity A() {{ task t; {codels} }};"), expected);
}

#[test]
fn state_machines() {
    activity("codel<start> f() yield ether;", &[]);
    activity("codel<start> f() yield pause::ether;", &["pause-ether: ether"]);
    activity("codel<start> f() yield mian; codel<main> g() yield ether;", &["unknown-event: mian"]);
    activity("codel<main> f() yield ether;", &["missing-start: A"]);
    activity("codel<start> f() yield ether; codel<main> g() yield pause::main, ether;", &["unreachable-codel: g"]);
    activity("codel<start> f() yield pause::start; codel<stop> g() yield start;", &["stop-without-ether: g"]);
    activity(
        "codel<start> f() yield pause::start, ether; codel<stop> g() yield h; codel<h> k() yield ether, stop;",
        &[],
    );
    activity("codel<start, start> f() yield ether;", &["duplicate-name: start"]);
    activity("codel<start, ether> f() yield ether;", &["unknown-event: ether"]);
    // A codel without an event of its own is not said to be out of reach as well.
    activity("codel<start> f() yield ether; codel<pause::stop> g() yield ether;", &["unknown-event: stop"]);
    activity("codel<start> f() yield ether; codel<start> g() yield ether;", &["duplicate-name: start"]);
}

#[test]
fn sources_of_parameters() {
    activity("codel<start> f(in a, out q, in b.m::other, in ::all) yield ether;", &[]);
    activity("codel<start> f(in nowhere) yield ether;", &["missing-source: nowhere"]);
    activity("codel<start> f(port in z) yield ether;", &["unknown-port: z"]);
    activity("codel<start> f(out p) yield ether;", &["unknown-port: p"]);
    activity("codel<start> f(inout p) yield ether;", &[]);
    activity("codel<start> f(port in p.m) yield ether;", &["unknown-field: m"]);
    activity("codel<start> f(in b.n) yield ether;", &["unknown-field: n"]);
    activity("codel<start> f(in a[1]) yield ether;", &["type-mismatch: 1"]);
    activity("codel<start> f(in a, in b.m::a) yield ether;", &["duplicate-name: b.m::a"]);
    finds("activity A(in long a) { task t; codel<start> f(in a) yield ether; };", &["missing-source: a"]);
    finds("activity A(in long a) { task t; codel<start> f(local in a, ids in a::b) yield ether; };", &[]);
    finds("function F() { codel f(port in p); };", &["missing-source: p"]);
    finds("function F(in long x) { codel f(local in y); };", &["unknown-name: y"]);
}

#[test]
fn names_that_are_not_there() {
    finds("activity A() { task tt; codel<start> f() yield ether; };", &["unknown-task: tt"]);
    finds("activity A() { codel<start> f() yield ether; };", &["missing-task: A"]);
    finds("function F() { interrupts G; };", &["unknown-service: G"]);
    finds("function F() { interrupts all; after F; };", &[]);
    finds("function F() { throw BAD; };", &["undeclared-exception: BAD"]);
    finds("exception BAD; function F() { throw BAD, bad_transition; };", &[]);
    finds("port in tt r;", &["unknown-name: tt"]);
    finds("provides nothing;", &["unknown-name: nothing"]);
    finds("uses s;", &["unknown-name: s"]);
    assert_eq!(
        codes(&text("module m { struct t { long a; }; }; component c { uses m; port in t p; };")),
        ["unusual-syntax: m"]
    );
    assert_eq!(
        codes(&text("interface i { port in long p; }; component c { uses i; provides i; };")),
        ["unusual-syntax: p"]
    );
    assert_eq!(codes(&text("const long n = m;")), ["unknown-name: m"]);
}

#[test]
fn what_cannot_be_said() {
    finds("function F() { task t; };", &["bad-property: task"]);
    finds("attribute A(in a) { local long x; };", &["bad-property: local"]);
    finds("task u { delay 5 ms; };", &["bad-property: 5 ms"]);
    finds("task u { period 5 ms; delay 5 ms; };", &["bad-property: 5 ms"]);
    finds("task t { period 20 ms; };", &["bad-property: period"]);
    finds("clock-rate 3 ms;", &["bad-property: 3 ms"]);
    finds("clock-rate 5 ms;", &[]);
    finds("port out s r { version \"1\"; };", &["bad-property: version"]);
    finds("native n; port out n r;", &["bad-property: n"]);
    finds("function F() { async codel f(); };", &["unusual-syntax: f"]);
    finds("const string k = 3;", &["type-mismatch: 3"]);
    finds("activity A() { task t; codel f(); };", &["bad-property: codel"]);
    finds("function F() { codel<start> f() yield ether; };", &["bad-property: codel"]);
    finds("function all();", &["reserved-word: all"]);
    finds("function F(); function F(in long x);", &["duplicate-name: F"]);
    finds("function q();", &["duplicate-name: q"]);
    finds(
        "activity A() { task t; codel<start> f(in a) yield x; codel<x> f(out a) yield ether; };",
        &["codel-clash: f"],
    );
}

#[test]
fn times() {
    finds("task u { codel<start> f() yield pause::start; };", &["task-without-period: u"]);
    finds("task u; activity A() { task u; codel<start> f() yield pause::start, ether; };", &["task-without-period: u"]);
    finds("task u { codel<start> f() yield g; async codel<g> g() yield g, ether; };", &[]);
    activity("codel<start> f() yield ether wcet 11 ms;", &["wcet-over-period: f"]);
    activity(
        "codel<start> f() yield x wcet 6 ms; codel<x> g() yield pause::x, ether wcet 6 ms;",
        &["period-overrun: t"],
    );
    activity("codel<start> f() yield pause::x wcet 6 ms; codel<x> g() yield pause::x, ether wcet 6 ms;", &[]);
    let two = "activity A() { task t; codel<start> f() yield ether wcet 6 ms; }; activity B() { task t; codel<start> g() yield ether wcet 6 ms; X };";
    finds(&two.replace('X', ""), &["period-overrun: t"]);
    finds(&two.replace('X', "interrupts A;"), &[]);
    activity("codel<start> f() yield ether wcet -1 ms;", &["type-mismatch: -1 ms"]);
}

#[test]
fn codels_beside_their_task() {
    let poll = "task u { period 1 s; async codel<start> f(out a) yield ether; };";
    finds(poll, &[]);
    finds(&format!("{poll} attribute set(in a);"), &["async-shares-data: f"]);
    finds(&format!("{poll} task v {{ period 1 s; codel<start, stop> f(out a) yield ether; }};"), &[]);
}

#[test]
fn types_and_defaults() {
    assert_eq!(codes(&text("struct s { long a; }; struct s { long b; };")), ["duplicate-name: s"]);
    assert_eq!(codes(&text("struct s { long a, a; };")), ["duplicate-name: a"]);
    assert_eq!(codes(&text("typedef sequence<sequence<long>> t;")), ["unusual-syntax: >>"]);
    assert_eq!(codes(&text("module m { struct m { long a; }; module m { }; };")), ["duplicate-name: m"]);
    assert_eq!(codes(&text("const long a = 1 << \"x\";")), ["not-constant: 1 << \"x\""]);
    assert_eq!(codes(&text("typedef long t[-1];")), ["type-mismatch: -1"]);
    finds("function F(in s x = {1, 2});", &["type-mismatch: 2"]);
    finds("function F(in s x = {.n = 2});", &["unknown-field: n"]);
    finds("function F(in s x = {.m = 1, .m = 2});", &["unusual-syntax: .m = 2"]);
    finds("function F(in string x = 1);", &["type-mismatch: 1"]);
    finds("function F(in string x = \"a\" : \"what it is\", in double y = 3, in long z = : \"no default\");", &[]);
}

#[test]
fn what_cannot_be_read_does_not_hide_the_rest() {
    let loaded =
        text("component c { task t { period 5 ms } task; port in; port out long q; function F() { interrupts G; }; };");
    assert_eq!(loaded.model.components[0].tasks.len(), 1, "{}", shown(&loaded));
    assert_eq!(loaded.model.components[0].ports.len(), 1);
    let expected = ["syntax: ms", "syntax: }", "syntax: ;", "unknown-service: G"];
    assert_eq!(codes(&loaded), expected, "{}", shown(&loaded));
    assert_eq!(codes(&text("struct long { };")), ["reserved-word: long"]);
    assert_eq!(codes(&text("component c {")), ["unclosed-bracket: {", "syntax: {"]);
    assert_eq!(codes(&text("const long a = 10d;")), ["bad-number: 10d"]);
    assert_eq!(codes(&text("const string a = \"x;")), ["stray-character: \"x;"]);
    let deep = format!("typedef {}long{} t;", "sequence<".repeat(200), "> ".repeat(200));
    assert_eq!(text(&deep).diagnostics[0].code.name(), "too-deep");
    assert_eq!(codes(&text(&format!("typedef long t{};", "[1]".repeat(32)))), [""; 0]);
    let dimensions = format!("typedef long t{}; struct s {{ long a; long b[2]; }};", "[1]".repeat(20_000));
    assert_eq!(codes(&text(&dimensions)), ["too-deep: ["]);
    assert_eq!(text(&dimensions).model.types.len(), 1);
}

#[test]
fn the_preprocessor() {
    let included = files(
        &[("main.gen", "#include \"x/y.idl\"\n#include <z.idl>\ncomponent c { port in x::t p; };\n")],
        &Options::default(),
    );
    // What a missing file would have declared is not complained of.
    assert_eq!(codes(&included), ["missing-include: \"x/y.idl\"", "missing-include: <z.idl>"]);
    assert!(included.diagnostics[0].help[0].contains("-I"), "{:?}", included.diagnostics[0].help);
    assert_eq!(codes(&text("#endif\n#if 1\n")), ["bad-directive: #endif", "bad-directive: #if"]);
    assert_eq!(codes(&text("#if 1 / 0\n#endif\n#error no\n")), ["bad-directive: #if", "bad-directive: #error"]);
    let bomb: String = (1..40).map(|n| format!("#define a{n} a{} a{}\n", n - 1, n - 1)).collect();
    assert_eq!(codes(&text(&format!("{bomb}a39\n"))), ["too-large: a39"]);
    let doubled: String =
        (1..40).map(|n| format!("#define s{n}(x) s{}(#x)\n#define p{n}(x) p{}(x ## x)\n", n - 1, n - 1)).collect();
    assert_eq!(codes(&text(&format!("{doubled}s39(\"\")\n"))), ["too-large: s39"]);
    assert_eq!(text(&format!("{doubled}p39(a)\n")).diagnostics[0].code.name(), "too-large");
    let twice = files(&[("main.gen", "#include \"main.gen\"\n#include \"main.gen\"\n")], &Options::default());
    assert!(twice.diagnostics.iter().all(|d| ["too-deep", "too-large"].contains(&d.code.name())));
    let many: String = (0..5_000).map(|n| format!("function f{n}() {{ codel g{n}(); }};")).collect();
    assert_eq!(codes(&text(&format!("component c {{ {many} }};"))), ["too-large: c"]);
    let circle = files(&[("main.gen", "#include \"main.gen\"\n")], &Options::default());
    assert_eq!(codes(&circle), ["too-deep: \"main.gen\""]);
}

#[test]
fn files_beside_the_specification() {
    let main = "struct s { long m; }; component A { port out s P; }; component B { port out s P; };\n\
                component C { port in s P; task t { period 5 ms; codel<start> f() yield ether; }; };";
    let with = |wcet: &str, ports: &str| {
        let options = Options { wcet: Some("w".into()), ports: Some("p".into()), ..Options::default() };
        files(&[("main.gen", main), ("w", wcet), ("p", ports)], &options)
    };
    assert_eq!(codes(&with("", "")), ["ambiguous-port: P"]);
    let linked = with("C.t.start = 2 ms # why\nC/f 1.5ms", "C.P B.P // this one\n");
    assert_eq!(codes(&linked), [""; 0]);
    assert_eq!(linked.model.components[2].codels[0].wcet_ns, Some(1_500_000));
    // As in a specification, a number alone is seconds.
    let plain = with("C.f = 0.0015", "C.P B.P");
    assert_eq!(codes(&plain), [""; 0]);
    assert_eq!(plain.model.components[2].codels[0].wcet_ns, Some(1_500_000));
    assert_eq!(linked.model.links[0].writer.0, 1);
    assert_eq!(codes(&with("", "C_P A_P")), [""; 0]);
    let wrong = with("C.t.begin = 2 ms\nD.f = 1 ms\nC.f = soon\n", "C.P\nC.Q A.P\nC.P A.Q");
    let expected = [
        "unknown-name: C.t.begin",
        "unknown-name: D.f",
        "bad-setting: C.f = soon",
        "bad-setting: C.P",
        "unknown-port: C.Q",
        "unknown-port: A.Q",
        "ambiguous-port: P",
    ];
    assert_eq!(codes(&wrong), expected);
}
