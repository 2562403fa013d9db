//! Specifications as people write them: what is allowed, and rarely thought of.
#![allow(clippy::unwrap_used)]

mod common;

use std::path::PathBuf;

use common::{codes, files, only, shown, sound, text};
use lapwing_genom::model::{Component, Object};
use lapwing_genom::{Options, load};

/// Reads a text of which nothing is to be said.
#[track_caller]
fn clean(source: &str) -> lapwing_genom::Loaded {
    let loaded = text(source);
    assert_eq!(codes(&loaded), [""; 0], "{}", shown(&loaded));
    loaded
}

#[test]
fn one_function_for_codels_that_name_its_parameters_differently() {
    let of = |codels: &str| {
        codes(&text(&format!(
            "typedef double metres; typedef sequence<long> numbers; struct pair {{ double a; metres b; long n[2]; }};
             component c {{ ids {{ pair p; numbers s; sequence<long> q; }}; port out pair x; port out pair y; task t {{ period 5 ms; }};
               activity A(in double d) {{ task t; local long n; {codels} }}; }};"
        )))
    };
    // An alias is what it stands for, and internal data is passed as parameters and locals are.
    assert_eq!(
        of("codel<start> f(in p.a) yield m; codel<m> f(in p.b::speed) yield e; codel<e> f(in d) yield ether;"),
        [""; 0]
    );
    assert_eq!(of("codel<start> f(out s) yield m; codel<m> f(out q) yield ether;"), [""; 0]);
    assert_eq!(of("codel<start> f(in p.n[0]::i) yield m; codel<m> f(in n) yield ether;"), [""; 0]);
    assert_eq!(of("codel<start> f(in p.a) yield m; codel<m> f(in n) yield ether;"), ["codel-clash: f"]);
    assert_eq!(of("codel<start> f(in p.a) yield m; codel<m> f(in p.n) yield ether;"), ["codel-clash: f"]);
    // Each port is of a type of its own.
    assert_eq!(of("codel<start> f(out x) yield m; codel<m> f(out y::x) yield ether;"), ["codel-clash: f"]);
    assert_eq!(of("codel<start> f(out x) yield m; codel<m> f(out x::y) yield ether;"), [""; 0]);
}

#[test]
fn an_interface_may_leave_states_to_components() {
    let loaded = clean(
        "interface i { task t { period 5 ms; }; activity A() { task t; codel<work> work() yield done, pause::work; }; };
         component c { provides i; activity A() { codel<start> begin() yield work; codel<done> end() yield ether; }; };",
    );
    assert_eq!(only(&loaded).services[0].codels.len(), 3);
    let alone = "interface i { task t { period 5 ms; }; activity A() { task t; codel<work> work() yield done; }; };
                 component c { provides i; };";
    assert_eq!(codes(&text(alone)), ["unknown-event: done", "missing-start: A"]);
}

#[test]
fn a_component_speaks_for_itself_before_its_interfaces_do() {
    let loaded = clean(
        "interface i { version \"1\"; lang \"c\"; doc \"of i\"; require \"a\"; }; interface j { version \"2\"; email \"j\"; };
         component c { provides i; uses j; version \"3\"; doc \"of c\"; require \"b\"; }; component d { provides i, j; };",
    );
    let [c, d] = loaded.model.components.as_slice() else { panic!("{}", loaded.model.components.len()) };
    let said = |c: &Component| (c.version.clone(), c.email.clone(), c.requires.join(" "));
    assert_eq!(said(c), ("3".to_owned(), "j".to_owned(), "a b".to_owned()));
    assert_eq!(said(d), ("1".to_owned(), "j".to_owned(), "a".to_owned()));
    let clocks = |own: &str| {
        codes(&text(&format!(
            "interface i {{ clock-rate 1; }}; interface j {{ clock-rate 2; }}; interface k {{ extends i, j; {own} }};"
        )))
    };
    assert_eq!(clocks(""), ["bad-property: 2"]);
    assert_eq!(clocks("clock-rate 1;"), [""; 0]);
    let twice = "component c { version \"1\"; version \"2\"; };";
    assert_eq!(codes(&text(twice)), ["bad-property: version"]);
}

#[test]
fn what_is_used_is_seen_from_the_other_side() {
    let loaded = clean(
        "interface i { struct s { long n; }; ids { s kept; }; task t { period 5 ms; }; port out s p;
           attribute Set(in kept); function Do(); };
         component c { uses i; activity A() { task t; codel<start> f(inout kept, in p, in Set, in Do) yield ether; }; };",
    );
    let component = only(&loaded);
    assert_eq!(component.services.len(), 1);
    let objects: Vec<&Object> = component.codels[0].parameters.iter().map(|p| &p.object).skip(2).collect();
    assert_eq!(objects, [&Object::Remote(0), &Object::Remote(1)]);
}

#[test]
fn constants_are_of_their_type() {
    let loaded = clean(
        "const double one = 1; const unsigned short ms = 4; const boolean off = ~TRUE; module m { enum e { a, b }; const e first = a; };
         component c { task t { period one / 8 s; }; task u { period ms ms; }; function F(in m::e x = m::first, in boolean y = off); };",
    );
    let periods: Vec<Option<u64>> = only(&loaded).tasks.iter().map(|t| t.period_ns).collect();
    assert_eq!(periods, [Some(125_000_000), Some(4_000_000)]);
}

#[test]
fn services_wait_for_all_others() {
    let loaded = clean("component c { function F() { after all; }; function G() { before all; interrupts all; }; };");
    let services = &only(&loaded).services;
    assert_eq!((services[0].after.len(), services[1].before.len(), services[1].interrupts.len()), (1, 1, 2));
}

#[test]
fn texts_over_several_lines() {
    let loaded =
        sound("component c {\n  doc \"What it does,\n    and \\\"how\\\".\"\n      \" And more\";\n  lang \"c\";\n};");
    assert_eq!(only(&loaded).doc, "What it does,\n    and \"how\". And more");
    assert_eq!(
        codes(&text("component c {\n  doc \"What;\n  lang \"c\";\n};")).first().unwrap(),
        "stray-character: \"What;"
    );
}

/// GenoM3 looks for includes beside the file that it is given as well, however deep the file that includes is.
#[test]
fn includes_are_found_beside_the_main_file() {
    let all = [
        ("robot/main.gen", "#include \"idl/a.idl\"\ncomponent c { port out a p; };"),
        ("robot/idl/a.idl", "#include \"idl/b.idl\"\ntypedef b a;"),
        ("robot/idl/b.idl", "#include <deep/s.idl>\ntypedef s b;"),
        ("robot/deep/s.idl", "struct s { long n; };"),
    ];
    let map = all.iter().map(|(name, text)| (PathBuf::from(name), (*text).to_owned())).collect();
    let read = |map: &std::collections::BTreeMap<PathBuf, String>| {
        load(map, &[PathBuf::from("robot/main.gen")], &Options::default()).unwrap()
    };
    let loaded = read(&map);
    assert_eq!(codes(&loaded), [""; 0], "{}", shown(&loaded));
    // What `-I` names comes first.
    let options = Options { folders: vec!["x".into()], ..Options::default() };
    let first = files(
        &[("main.gen", "#include <s.idl>\ntypedef s t;"), ("x/s.idl", "struct s { long n; };"), ("s.idl", "")],
        &options,
    );
    assert_eq!(codes(&first), [""; 0], "{}", shown(&first));
}
