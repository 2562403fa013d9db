//! Monitors of JavaMOP: what becomes of events, formulas, automata and handlers, and that these judge as the originals do.

mod common;

use common::{imported, imported_with};
use expect_test::expect;
use lapwing::{Monitor, Spec, Unseen};
use lapwing_import::Parameters;
use lapwing_stream::{Sample, Time, What};

/// A monitor of these events and that formula.
fn monitor(events: &str, rest: &str) -> String {
    format!("M(Robot r) {{\n{events}\n{rest}\n}}\n")
}

/// Events `a`, `b` and `c` before functions of these names.
const ABC: &str = "event a before(Robot r): call(void R.a()) {}\nevent b before(Robot r): call(void R.b()) {}\n\
                   event c before(Robot r): call(void R.c()) {}";

/// The line of a text that begins so.
fn line<'t>(text: &'t str, begin: &str) -> &'t str {
    text.lines().find(|l| l.starts_with(begin)).unwrap_or("")
}

#[test]
fn the_monitors_of_the_soccer_robot_are_carried_over() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/soccer/javamop");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    assert_eq!(files.len(), 6);
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let came = imported(name, &text).sound();
        assert!(
            !came.found.contains("import-event") && !came.found.contains("import-syntax"),
            "{name}\n{}",
            came.found
        );
        for parameters in [Parameters::Each, Parameters::One] {
            imported_with(name, &text, parameters).sound();
        }
    }
}

#[test]
fn pointcuts_become_events() {
    for (event, becomes) in [
        (
            "after(Robot r) returning(boolean res): call(public boolean R.isReady()) && condition(res)",
            "= return R::is_ready when result == true",
        ),
        (
            "after(Robot r) returning(double d): call(double R.speed()) && condition(d > 2.5 && d != 7)",
            "= return R::speed when result > 2.5 and result != 7",
        ),
        ("before(Robot r): execution(* a.b.R.GoTo(..)) && target(r)", "= call R::go_to"),
        ("before(): call(R.new(int, String))", "= call R::new"),
        ("before(): call(* stop())", "= call stop"),
        (
            "after(Robot r, int v): set(private int R.maxSpeed) && args(v) && condition(v >= 3)",
            "= set R.max_speed when max_speed >= 3",
        ),
        (
            "after(Robot r): set(int R.x) && cflowbelow(call(boolean R.ballInFront()))",
            "= set R.x below R::ball_in_front",
        ),
        ("before(int n): call(void R.kick(int)) && args(n) && if(n == 2)", "= call R::kick when n == 2"),
        ("before(): call(void R.kick()) && !execution(void R.other()) && !call(void Q.kick())", "= call R::kick"),
        ("before(): execution(void R.kick()) && within(R) && !adviceexecution()", "= call R::kick"),
        ("before(): call(void R+.kick()) && (target(R))", "= call R::kick"),
        // What cannot be said makes an event that is told by its name.
        ("before(): call(* R.get*(..))", "import-event: \"call(* R.get*(..))\""),
        ("after(): get(int R.x)", "import-event: \"event e after(): get(int R.x)\""),
        ("before(): call(void R.kick()) && within(Test)", "import-event: \"within(Test)\""),
        ("before(): call(void R.kick()) && !cflow(call(void R.a()))", "import-event: \"cflow(call(void R.a()))\""),
        (
            "before(): call(void R.kick()) && cflow(call(void R.a())) && cflow(call(void R.b()))",
            "import-event: \"cflow(call(void R.b()))\"",
        ),
        ("before(): call(void R.kick()) && !call(void R.kick())", "import-event: \"call(void R.kick())\""),
        ("before(): call(void R.kick()) && execution(void R.kick())", "import-event: \"execution(void R.kick())\""),
        ("before(): call(void R.kick()) && condition(r.energy() > 3)", "import-event: \"r.energy\""),
        ("before(): call(void R.kick()) && target(Other)", "import-event: \"target(Other)\""),
        ("after() throwing(Exception e): call(void R.kick())", "import-event: \"throwing\""),
        ("before(): endProgram()", "import-event: \"event e before(): endProgram()\""),
        ("before()", "import-event: \"event e before()\""),
    ] {
        let came = imported("m.mop", &monitor(&format!("event e {event} {{}}"), "ltl: [] !e")).sound();
        let told = match came.found.lines().find(|l| l.starts_with("import-event")) {
            Some(found) => {
                assert_eq!(line(&came.text, "event e"), "event e", "{event}");
                found
            }
            None => line(&came.text, "event e").strip_prefix("event e ").unwrap_or(""),
        };
        assert_eq!(told, becomes, "{event}");
    }
}

#[test]
fn alternatives_become_events_of_their_own() {
    let events = "event e before(Robot r): (call(void R.a()) || call(void R.b())) && target(r) {}\nevent f before(): !(!call(void R.c())) {}";
    let came = imported("m.mop", &monitor(events, "ltl: [](e => <*> f)")).sound();
    expect![[r#"
        # Imported from m.mop by `lapwing import`.

        event e_1 = call R::a
        event e_2 = call R::b
        event f = call R::c

        property m: ltl([] (e_1 or e_2 => <*> f))
    "#]]
    .assert_eq(&came.text);
    let many = (0..9).map(|n| format!("call(void R.f{n}())")).collect::<Vec<_>>().join(" || ");
    let came = imported("m.mop", &monitor(&format!("event e before(): {many} {{}}"), "ltl: [] e"));
    assert!(came.found.starts_with("import-event"), "{}", came.found);
}

#[test]
fn formulas_are_read_in_all_their_spellings() {
    for (mop, ltl) in [
        ("[](a => <*> b)", "[] (a => <*> b)"),
        ("[] (a && !b) || <>c", "[] (a and !b) or <> c"),
        ("[](not a implies b /\\ c)", "[] (!a => b and c)"),
        ("[](a -> b U c U a)", "[] (a => b U c U a)"),
        ("[](a <-> b S (*) c)", "[] (a <=> b S (*) c)"),
        ("[](a xor b)", "[] !(a <=> b)"),
        ("[](a ^ b)", "[] !(a <=> b)"),
        ("[](o a => [*] b)", "[] (o a => [*] b)"),
        ("[](true => ~ ~ a)", "[] (true => a)"),
        ("[](a and not (b or c))", "[] (a and !(b or c))"),
        // Without `[]`: the past is asked everywhere anyway, what leads on is too, and what is to happen once is not.
        ("a => (*) b", "a => (*) b"),
        ("a => <> b", "[] (a => <> b)"),
        ("(a => (*) b) and (b => <> c)", "[] (a => (*) b) and [] (b => <> c)"),
        ("[] a and (b => (*) c)", "[] a and [] (b => (*) c)"),
        ("<> a", "<> a"),
        ("a U b", "a U b"),
        ("<> a and o b", "<> a and o b"),
    ] {
        let came = imported("m.mop", &monitor(ABC, &format!("ltl: {mop}"))).sound();
        let body = line(&came.text, "property").split_once("ltl(").unwrap().1.strip_suffix(')').unwrap();
        assert_eq!(body, ltl, "{mop}");
        let is_said = came.found.contains("import-first-position");
        let differs =
            !mop.contains("[]") && !["<> a", "a U b", "<> a and o b"].contains(&mop) || mop.contains("[] a and");
        assert_eq!(is_said, differs, "{mop}\n{}", came.found);
    }
}

#[test]
fn parameters_are_one_object_or_slices() {
    let text = "U(Coll c, Iter i) {\n  event create after(Coll c) returning(Iter i): call(Iter Coll.iter()) && target(c) {}\n  \
                event update before(Coll c): call(void Coll.add()) && target(c) {}\n  event use before(Iter i): call(void Iter.next()) && target(i) {}\n  \
                ltl: [](create => !<>(update and <> use))\n}\n";
    let auto = imported("u.mop", text).sound();
    assert_eq!(
        line(&auto.text, "property"),
        "property u: for each c of create.c: for each i of create.i: ltl([] (create => !<> (update and <> use)))"
    );
    assert_eq!(auto.found, "import-parameter: \"c\"\nimport-parameter: \"i\"\n", "by which fields they are told apart");
    let one = imported_with("u.mop", text, Parameters::One).sound();
    assert_eq!(line(&one.text, "property"), "property u: ltl([] (create => !<> (update and <> use)))");
    // An object for which no event is enough: the first is taken, and what is not seen is said.
    let events = "event e before(Robot r): call(void R.e()) && target(r) {}\nevent f before(Robot r): call(void R.f()) && target(r) {}";
    let each = imported_with("m.mop", &monitor(events, "ltl: [](e and f)"), Parameters::Each).sound();
    assert_eq!(line(&each.text, "property"), "property m: for each r of e.r: ltl([] (e and f))");
    assert_eq!(each.found, "import-parameter: \"r\"\n", "a robot that does `f` alone goes unseen");
    // No event binds it: JavaMOP has one monitor, and so has the import.
    let unbound = imported_with("m.mop", &monitor(ABC, "ltl: [] a"), Parameters::Each).sound();
    assert_eq!(line(&unbound.text, "property"), "property m over (b, c): ltl([] a)");
}

/// The verdict of the first property on a word of events, each a second after the other.
fn verdict(spec: &Spec, word: &[&str]) -> String {
    let mut monitor = Monitor::new(spec.clone());
    for (at, name) in word.iter().enumerate() {
        let event = monitor.event(name).unwrap();
        monitor.feed(Sample { time: Time(at as i64 * 1_000_000_000), what: What::Event { event, values: &[] } });
    }
    monitor.finish(&Unseen::default()).properties[0].verdict.to_string()
}

/// All words over the letters up to that length, but for the empty one.
fn words<'l>(letters: &[&'l str], length: usize) -> Vec<Vec<&'l str>> {
    let mut last: Vec<Vec<&str>> = vec![Vec::new()];
    let mut all = Vec::new();
    for _ in 0..length {
        last = last.iter().flat_map(|w| letters.iter().map(|l| [w.as_slice(), &[*l]].concat())).collect();
        all.extend(last.clone());
    }
    all
}

#[test]
fn automata_are_violated_where_their_handlers_would_run() {
    type Runs = fn(&str) -> bool;
    // By the letters of a word: whether the handler runs somewhere in it.
    let cases: [(&str, Runs); 6] = [
        // `b` only directly behind an `a`.
        ("fsm: s [ a -> t, b -> bad ] t [ a -> t b -> s ] bad [ b -> bad a -> t ] @bad { __RESET; }", |w| {
            w.replace("ab", "").contains('b') || w.contains("bb") || w.starts_with('b')
        }),
        ("fsm: s [ a -> t ] t [ default s ] @fail { r.x(); __RESET; }", |w| w.bytes().step_by(2).any(|l| l == b'b')),
        ("fsm: s [ a -> t b -> s ] t [ a -> u b -> s ] u [ ] alias two = u @two { __RESET; }", |w| w.contains("aa")),
        ("ere: (a b)+ @fail { __RESET; }", |w| !"abababab".starts_with(w)),
        ("ere: b* a a @match { __RESET; }", |w| w.contains("aa") && w.find("aa") == w.find('a')),
        ("ere: ~((a|b)* b b (a|b)*) @fail { __RESET; }", |w| w.contains("bb")),
    ];
    let events = "event a before(Robot r): call(void R.a()) {}\nevent b before(Robot r): call(void R.b()) {}";
    for (rest, runs) in cases {
        let came = imported("m.mop", &monitor(events, rest)).sound();
        let spec = Spec::parse("m.rv", &came.text, &|_| None).unwrap();
        for word in words(&["a", "b"], 5) {
            let letters = word.concat();
            assert_eq!(verdict(&spec, &word) == "violated", runs(&letters), "{rest}: {letters}\n{}", came.text);
        }
    }
}

#[test]
fn automata_begin_where_the_originals_do() {
    type Runs = fn(&str) -> bool;
    let (plain, late) = ("event", "creation event");
    // The words before the monitor, those before its event `a`, and by the letters of a word: whether the handler runs.
    let cases: [(&str, &str, &str, Runs); 6] = [
        ("", plain, "ere: a a @match { __RESET; }", |w| w.starts_with("aa")),
        ("suffix ", plain, "ere: a a @match { __RESET; }", |w| w.contains("aa")),
        ("unsynchronized suffix ", plain, "ere: a b a @match { __RESET; }", |w| w.contains("aba")),
        ("suffix ", plain, "fsm: s [ a -> t b -> s ] t [ a -> t ] @fail { __RESET; }", |w| w.contains("ab")),
        ("", late, "ere: a a @match { __RESET; }", |w| w.trim_start_matches('b').starts_with("aa")),
        ("", late, "fsm: s [ a -> t ] t [ b -> s ] @fail { __RESET; }", |w| w.contains("aa") || w.contains("abb")),
    ];
    for (before, creation, rest, runs) in cases {
        let a = format!("{creation} a before(R r): call(void R.a()) {{}}");
        let text = format!("{before}M(R r) {{ {a} event b before(R r): call(void R.b()) {{}} {rest} }}");
        let came = imported("m.mop", &text).sound();
        let spec = Spec::parse("m.rv", &came.text, &|_| None).unwrap();
        for word in words(&["a", "b"], 5) {
            let letters = word.concat();
            assert_eq!(verdict(&spec, &word) == "violated", runs(&letters), "{text}: {letters}\n{}", came.text);
        }
        // After a reset it waits again, and the original does not.
        assert_eq!(came.found.contains("import-differs: \"a\""), creation == late, "{text}\n{}", came.found);
    }
}

#[test]
fn what_stands_before_a_monitor_or_an_event_is_heeded_or_mentioned() {
    let differs = |text: &str| {
        let came = imported("m.mop", text).sound();
        let differs = came.found.lines().filter(|l| l.starts_with("import-differs")).collect::<Vec<_>>();
        differs.join(" ").replace("import-differs: ", "")
    };
    let rest = "(R r) { event a before(R r): call(void R.a()) {} event b before(R r): call(void R.b()) {} ltl: [](a => (*) b) }";
    for (before, said) in [
        ("unsynchronized full-binding decentralized ", ""),
        ("perthread ", "\"perthread\""),
        ("avoid ", "\"avoid\""),
        ("enforce connected ", "\"enforce\""),
        ("suffix ", "\"suffix\""),
    ] {
        assert_eq!(differs(&format!("{before}M{rest}")), said, "{before}");
    }
    // A formula is judged from the beginning, whichever event the original begins with.
    assert_eq!(differs(&format!("M{}", rest.replacen("event", "static creation event", 1))), "\"a\"");
    assert_eq!(differs(&format!("M{}", rest.replace("event", "creation event"))), "");
    // The past alone is judged at every event, by either name; in `ltl` JavaMOP would judge the first.
    for (formalism, said) in [("ptltl", ""), ("ltl", "import-first-position: \"a => (*) b\"\n")] {
        let came = imported("m.mop", &monitor(ABC, &format!("{formalism}: a => (*) b"))).sound();
        assert_eq!((line(&came.text, "property"), &*came.found), ("property m over (c): ltl(a => (*) b)", said));
    }
}

#[test]
fn events_in_the_place_of_a_call_and_at_overloads() {
    let events = "event a Integer around(Robot r): call(Integer R.a()) { return 1; }\n\
                  event b java.util.List<int[]> around(Robot r): call(* R.b()) {}\nevent c around(): call(* R.c()) {}\n\
                  event d before(): call(void R.d(int)) || call(void R.d(int, int)) {}\n\
                  event f before(): call(* R.get*(..)) || call(* R.set*(..)) || call(void R.f()) || call(void R.f(int)) {}";
    let came = imported("m.mop", &monitor(events, "ltl: [] !(a or b or c or d or f)")).sound();
    let told: Vec<&str> = came.text.lines().filter(|l| l.starts_with("event")).collect();
    let calls = ["event a = call R::a", "event b = call R::b", "event c = call R::c", "event d = call R::d"];
    assert_eq!(told, [&calls[..], &["event f_1", "event f_2 = call R::f"]].concat());
    assert_eq!(came.found.matches("import-event").count(), 2, "each pattern is said at its place\n{}", came.found);

    // One event said several times is one; two at one place are told apart by nothing.
    let events = "event a void around(): call(* R.a()) {}\nevent a boolean around(): call(* R.a()) {}\n\
                  event b before(): call(R.new(int)) {}\nevent c before(): call(R.new()) {}";
    let came = imported("m.mop", &monitor(events, "ere: b c a @match { __RESET; }")).sound();
    assert!(came.text.contains("state match when a or b or c\n"), "{}", came.text);
    assert_eq!(came.found, "import-differs: \"c\"\n");
}

#[test]
fn what_an_event_holds_back_and_whose_subtypes_it_means_is_told() {
    let events = "event fast around(Motor m, int s): call(void Motor+.set(int)) && target(m) && args(s) && if(s > 700) { __SKIP; }\n\
                  event slow before(Motor m): call(void Motor.slow(List+)) && target(m) {}";
    let came = imported("m.mop", &monitor(events, "ltl: [] !(fast and slow)")).sound();
    assert!(
        came.text.contains("event fast = call Motor::set when s > 700\nevent slow = call Motor::slow\n"),
        "{}",
        came.text
    );
    let told: Vec<&str> = came.found.lines().filter(|l| l.starts_with("import-differs")).collect();
    assert_eq!(told, ["import-differs: \"call(void Motor+.set(int))\"", "import-differs: \"__SKIP\""]);
}

#[test]
fn a_handler_for_each_becomes_a_diagram_for_each() {
    let came = imported("m.mop", &monitor(ABC, "ere: a b* c @match { r.stop(); } @fail { System.exit(2); }")).sound();
    expect![[r#"
        # Imported from m.mop by `lapwing import`.

        event a = call R::a
        event b = call R::b
        event c = call R::c

        machine m_match {
            initial start
            state start
            state s1
            state fail
            state match when a or b or c
            start -> s1 on a
            start -> fail on b
            start -> fail on c
            s1 -> fail on a
            s1 -> s1 on b
            fail -> fail on a
            fail -> fail on b
            fail -> fail on c
        }

        machine m_fail {
            initial start
            state start
            state s1
            state match
            state fail when a or b or c
            start -> s1 on a
            s1 -> s1 on b
            s1 -> match on c
        }

        # In JavaMOP: r.stop();
        on violation of m_match {
            run stop
        }

        on violation of m_fail {
            stop
        }
    "#]]
    .assert_eq(&came.text);
    assert!(
        came.found.contains("import-differs: \"match\"") && came.found.contains("import-code: \"match\""),
        "{}",
        came.found
    );
}

#[test]
fn what_was_scanned_or_wrapped_is_read() {
    let text = "//package mop;\nimport java.io.*;\nInit(Kicker MK) {\n  Kicker currMK = null; // x\n  private void log(String m) { int[] a = {1, 2}; }\n  \
                event ready after(Kicker MK) returning(booleen res):\n    call(public boolean Kicker.Ready())\n&& condition(res) && target(MK){\n    \
                Logger.log(LogFile.INIT,\"ready\nEVENT\");\n  }\n  //Itl: [](x => o y)\n  Itl: [] !ready\n  @violation { Logger.log(F.I,\"!!!{ broken\n!!!\"); __RESET; }\n}\n";
    let came = imported("Init.mop", text).sound();
    assert_eq!(line(&came.text, "property"), "property init: ltl([] !ready)");
    assert!(came.text.ends_with("on violation of init {\n    reset\n}\n"), "{}", came.text);
    assert!(came.found.contains("import-differs: \"Itl\""), "{}", came.found);
}

#[test]
fn what_is_wrong_is_said_at_its_place() {
    for (rest, found) in [
        ("ltl: [](a => (* b)", "import-syntax: \"*\""),
        ("ltl: [](a => bb)", "import-syntax: \"bb\""),
        ("ltl: [] a b", "import-syntax: \"b\""),
        ("ltl:", "import-syntax: \"\""),
        ("ptltl: a => <> b", "import-syntax: \"a => <> b\""),
        ("cfg: S -> a S b | epsilon", "import-refused: \"cfg\""),
        ("srs: a -> b.", "import-refused: \"srs\""),
        ("fsm: s [ a -> t ]", "import-syntax: \"t\""),
        ("fsm: s [ d -> s ]", "import-syntax: \"d\""),
        ("fsm: s { a -> s }", "import-syntax: \"s\""),
        ("fsm: s [ a s ]", "import-syntax: \"a\""),
        ("ere: a (b", "import-syntax: \"\""),
        ("ere: a d", "import-syntax: \"d\""),
        ("@violation { }", "import-syntax: \"violation\""),
        ("event f instead(): call(void R.f()) { }", "import-syntax: \"instead\""),
        ("", "import-refused: \"M\""),
    ] {
        let came = imported("m.mop", &monitor(ABC, rest));
        assert_eq!(came.found.lines().next().unwrap_or(""), found, "{rest}\n{}", came.found);
        assert_eq!(came.text, "", "{rest}");
    }
    let differ = imported("m.mop", &monitor(ABC, "ltl: [] a @validation { r.x(); }"));
    assert_eq!(differ.found, "import-differs: \"validation\"\n");
    assert_eq!(imported("m.mop", "").found, "import-syntax: \"\"\n");
    // What was cut out of a page may have a brace too many, or a piece behind it.
    let twice = imported("m.mop", &(monitor(ABC, "ltl: [] a") + "}\nwhile(!x){ }")).sound();
    assert!(twice.found.contains("import-differs: \"}\"\nimport-syntax: \"while\""), "{}", twice.found);
    assert_eq!(imported("m.mop", "class X { }").found, "import-syntax: \"class\"\n");
}

#[test]
fn what_a_bracket_leaves_open_is_said() {
    let open = "event d before(Robot r): call(void R.d() && condition(x > 3) {}";
    let came = imported("m.mop", &monitor(&format!("{ABC}\n{open}"), "ltl: [](a => <> d)"));
    assert!(came.found.starts_with("import-syntax: \"(\"\nimport-event: \"event d before"), "{}", came.found);
    assert_eq!(line(&came.text, "event d"), "event d", "nobody knows what would narrow it");
    let came = imported("m.mop", "M(Robot r) {\nevent a before(): call(void R.a()) { if (x) {}\nltl: [] a\n}\n");
    assert!(came.found.starts_with("import-syntax: \"{\"\n"), "{}", came.found);
}

#[test]
fn a_parameter_is_of_its_class_whatever_that_holds() {
    let found = "M(Map<String, List<Robot>> m) {\nevent a before(Map<String, List<Robot>> m): call(void Map.a()) && target(m) {}\nltl: [] a\n}\n";
    let mut sources = lapwing_diag::SourceMap::default();
    let file = sources.add("m.mop", found);
    let options = lapwing_import::Options::default();
    let came = lapwing_import::import(&sources, file, lapwing_import::Format::JavaMop, options);
    let messages: Vec<&str> = came.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(messages, ["there is taken to be one `Map`"]);
}

#[test]
fn what_a_handler_prints_is_said_not_to_come_along() {
    let came = imported("m.mop", &monitor(ABC, "ere: a b @match { System.out.println(\"b after a\"); }")).sound();
    assert!(came.found.contains("import-code: \"match\""), "{}", came.found);
    let came = imported("m.mop", &monitor(ABC, "ltl: [] a @violation { __RESET; }")).sound();
    assert!(!came.found.contains("import-code"), "{}", came.found);
}

#[test]
fn names_that_are_taken_or_mean_something_are_others() {
    let text = "A(R r) { event next before(): call(void R.next()) {} ltl: [] !next @violation { r.reset(); } }\n\
                B(R r) { event next before(): call(void R.skip()) {} event A before(): call(void R.a()) {} ltl: [](next => A) }\n\
                C(R r) { event next before(): call(void R.next()) {} fsm: when [ next -> when ] }\n";
    let came = imported("abc.mop", text).sound();
    assert!(came.found.contains("import-renamed: \"next\""), "{}", came.found);
    assert!(came.text.contains("property b: ltl([] (b_next => A))"), "{}", came.text);
    assert!(came.text.contains("state `when`") && came.text.contains("property a: ltl([] !`next`)"), "{}", came.text);
}

#[test]
fn a_name_that_nobody_got_is_free() {
    let text = "A(R r) { event go before(): call(void R.go()) {} ltl: [] !go }\n\
                B(R r) { event go before(): call(void R.run()) {} event go_2 before(): call(void R.on()) {} ltl: [](go => go_2) }\n";
    let came = imported("ab.mop", text).sound();
    assert_eq!(came.found.matches("import-renamed").count(), 1, "{}", came.found);
    assert!(came.text.contains("property b: ltl([] (b_go => go_2))"), "{}", came.text);
}
