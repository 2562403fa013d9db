//! Each kind of fault is found, where it is.

mod support;

use lapwing_diag::Code;
use support::{checked, shown};

/// A package around declarations that many tests need.
fn package(decls: &str) -> String {
    format!(
        "package p
port type Go()
port type Data(int n)
port type Show(const int n)
connector type Pair(Go p, Go q) define p q end
atom type A()
  export data int n
  clock x
  export port Go p(), q()
  export port Data d(n)
  port Go hidden()
  place a, b
  initial to a
  on p from a to b
end
{decls}
end
"
    )
}

/// The codes of the faults, and the texts that they point at.
fn faults(decls: &str) -> Vec<(Code, String)> {
    let text = package(decls);
    let (checked, sources) = checked("p.bip", &text);
    checked.diagnostics.iter().map(|d| (d.code, sources.slice(d.primary.span).to_owned())).collect()
}

#[track_caller]
fn one(decls: &str, code: Code, at: &str) {
    let found = faults(decls);
    let text = package(decls);
    let (checked, sources) = checked("p.bip", &text);
    assert_eq!(found, [(code, at.to_owned())], "{}", shown(&sources, &checked.diagnostics));
}

fn atom(body: &str) -> String {
    format!("atom type B() data int n data bool ok clock x, y port Go p() place a, b initial to a {body} end")
}

fn top(body: &str) -> String {
    format!("compound type Top() component A A1(), A2() {body} end")
}

#[test]
fn nothing_is_wrong_with_what_is_right() {
    assert_eq!(faults(&top("connector Pair c(A1.p, A2.q)")), []);
    // Remarks for compilers in front of the parts of a connector, and numbers without a digit on one side of the point.
    let noted = "@a connector type C(Data p, Go q) @b(c, d=\"e\") data float f = 1. + .5 @g export port Go r() define p q @h(i) on p q up { f = 2.e3; } end";
    assert_eq!(faults(noted), []);
    assert_eq!(faults(&atom("on p from a to b provided (n < 3 && (ok || x <= 1.5)) eager do { n = n + 1; }")), []);
    assert_eq!(faults(&atom("on p from a to b provided (!(x > 5 || ok)) do { x = 2; }")), []);
}

#[test]
fn names_that_nothing_declares() {
    one(&atom("on q from a to b"), Code::BipUnknownName, "q");
    one(&atom("on p from a to c"), Code::BipUnknownName, "c");
    one(&atom("on p from a to b do { m = 1; }"), Code::BipUnknownName, "m");
    one(&atom("on p from a to b provided (m > 1)"), Code::BipUnknownName, "m");
    one(&atom("on p from a to b do { go(); }"), Code::BipUnknownName, "go");
    one(&top("connector Pair c(A1.p, A2.r)"), Code::BipUnknownName, "r");
    one(&top("connector Pair c(A1.p, A2.hidden)"), Code::BipUnknownName, "hidden");
    one(&top("connector Pair c(A1.p, A3.p)"), Code::BipUnknownName, "A3");
    one(&top("connector Pare c(A1.p, A2.p)"), Code::BipUnknownName, "Pare");
    one("atom type B() place a initial to a port Gone p() end", Code::BipUnknownName, "Gone");
    one("compound type C() component B b() end", Code::BipUnknownName, "B");
    one(&top("connector Pair c(A1.p, A2.p) priority r d:* < c:*"), Code::BipUnknownName, "d");
}

#[test]
fn a_misspelt_name_is_recognised() {
    let text = package(&top("connector Pair c(A1.p, A2.p) priority r c:* < cc:*"));
    let (checked, _) = checked("p.bip", &text);
    let helps: Vec<&String> = checked.diagnostics.iter().flat_map(|d| &d.help).collect();
    assert_eq!(helps, ["did you mean `c`?"]);
}

#[test]
fn types_that_do_not_fit() {
    one(&atom("on p from a to b do { n = true; }"), Code::BipType, "true");
    one(&atom("on p from a to b do { n = 1.5; }"), Code::BipType, "1.5");
    one(&atom("on p from a to b provided (n)"), Code::BipType, "n");
    one(&atom("on p from a to b provided (n < ok)"), Code::BipType, "n < ok");
    one(&atom("on p from a to b provided (x < ok)"), Code::BipType, "ok");
    one("const data bool c = 3", Code::BipType, "3");
    one("atom type B() data Go g place a initial to a end", Code::BipType, "Go");
    one(&top("connector Pair c(A1.p, A2.d)"), Code::BipType, "A2.d");
    one("atom type B() data bool b port Data p(b) place a initial to a end", Code::BipType, "b");
}

#[test]
fn arguments_that_are_too_many_or_too_few() {
    one(&top("connector Pair c(A1.p)"), Code::BipArguments, "c");
    one("compound type C() component A a(3) end", Code::BipArguments, "a");
    one("atom type B() port Data p() place a initial to a end", Code::BipArguments, "p");
    one(
        "extern function int f(int) atom type B() data int n place a initial to a do { n = f(); } end",
        Code::BipArguments,
        "f()",
    );
}

#[test]
fn what_may_only_be_read() {
    let connector = |body: &str| format!("connector type C(Show p, Data q) data int m define p q on p q {body} end");
    assert_eq!(faults(&connector("up { m = p.n; } down { q.n = p.n; }")), []);
    one(&connector("down { p.n = q.n; }"), Code::BipConst, "p.n");
    one(&connector("up { q.n = 1; }"), Code::BipConst, "q.n");
    one("atom type B(int k) place a initial to a do { k = 1; } end", Code::BipConst, "k");
    one("const data int c = 1 atom type B() place a initial to a do { c = 2; } end", Code::BipConst, "c");
    one("const data int c = 1 / 0", Code::BipConst, "1 / 0");
}

#[test]
fn clocks_are_for_guards() {
    one(&atom("on p from a to b do { n = x; }"), Code::BipClock, "x");
    one(&atom("on p from a to b provided (x + 1 < 5)"), Code::BipClock, "x + 1 < 5");
    one(&atom("on p from a to b provided (x < y)"), Code::BipClock, "x < y");
    one(&atom("on p from a to b do { x' = n; }"), Code::BipClock, "n");
    one(&atom("on p from a to b do { n' = 2.0; }"), Code::BipClock, "n");
    one(&atom("on p from a to b do { x' = -1; }"), Code::BipClock, "-1");
}

#[test]
fn a_guard_is_one_window() {
    one(&atom("on p from a to b provided (x < 5 || y > 10)"), Code::BipTwoWindows, "x < 5 || y > 10");
    one(&atom("on p from a to b provided (!(x < 5 && y > 10))"), Code::BipTwoWindows, "x < 5 && y > 10");
    one(&atom("on p from a to b provided (x != 5)"), Code::BipTwoWindows, "x != 5");
    one(&atom("on p from a to b provided (!(x == 5))"), Code::BipTwoWindows, "(x == 5)");
}

#[test]
fn clauses_in_their_order() {
    one(&atom("on p from a to b do { n = 1; } provided (ok)"), Code::BipClauseOrder, "provided");
    one(&atom("on p from a to b eager lazy"), Code::BipClauseOrder, "lazy");
    one(&atom("internal from a to b eager"), Code::BipClauseOrder, "internal from a to b eager");
}

#[test]
fn connectors_and_their_sets() {
    one("connector type C(Go p, Go q) define p q on p provided (true) end", Code::BipInteraction, "p");
    one("connector type C(Go p, Go q) define p end", Code::BipInteraction, "q");
    one("connector type C(Go p, Go q) define p (q p') end", Code::BipInteraction, "p");
    one("connector type C(Go p) define p on p provided (true) on p provided (false) end", Code::BipInteraction, "p");
    one(&top("connector Pair c(A1.p, A1.q)"), Code::BipComponentTwice, "A1.q");
    let many: Vec<String> = (0..16).map(|n| format!("Go p{n}")).collect();
    let define: Vec<String> = (0..16).map(|n| format!("p{n}'")).collect();
    one(&format!("connector type Big({}) define {} end", many.join(", "), define.join(" ")), Code::TooLarge, "Big");
}

#[test]
fn what_is_made_of_itself() {
    one("compound type C() component C c() end", Code::BipRecursive, "C");
    let export = "connector type E(Go p, Go q) export port Go e() define p q end";
    one(&format!("{export} {}", top("connector E c(A1.p, c)")), Code::BipRecursive, "c");
}

#[test]
fn what_nobody_is_connected_to() {
    let export = "connector type E(Go p, Go q) export port Go e() define p q end";
    one(&format!("{export} {}", top("connector E c(A1.p, A2.p)")), Code::BipNotConnected, "c");
    assert_eq!(faults(&format!("{export} {}", top("connector E c(A1.p, A2.p) export port c.e as out"))), []);
}

#[test]
fn priorities_in_a_circle() {
    let connectors = "connector Pair c(A1.p, A2.p), d(A1.q, A2.q)";
    one(&top(&format!("{connectors} priority r c:* < c:*")), Code::BipPriorityCycle, "priority r c:* < c:*");
    let circle = top(&format!("{connectors} priority r c:* < d:* priority s d:* < c:*"));
    let text = package(&circle);
    let (checked, _) = checked("p.bip", &text);
    assert_eq!(faults(&circle), [(Code::BipPriorityCycle, "priority r c:* < d:*".to_owned())]);
    assert!(checked.model(None).is_ok(), "a circle is an error only where all of it is possible");
}

#[test]
fn two_of_a_name() {
    one("port type Go()", Code::DuplicateName, "Go");
    one("atom type B() data int n, n place a initial to a end", Code::DuplicateName, "n");
    one("atom type B() place a, a initial to a end", Code::DuplicateName, "a");
    one(&top("connector Pair A1(A1.p, A2.p)"), Code::DuplicateName, "A1");
}

#[test]
fn packages_that_are_not_there() {
    let (checked, _) = checked("p.bip", "package p use q.r end");
    assert_eq!(checked.diagnostics.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::BipUnknownPackage]);
}

#[test]
fn roots() {
    let root = |decls: &str, name: Option<&str>| {
        let (checked, _) = checked("p.bip", &package(decls));
        checked.model(name).err().map(|d| d.iter().map(|d| d.code).collect::<Vec<_>>())
    };
    assert_eq!(root("", None), Some(vec![Code::BipRoot]));
    assert_eq!(root("compound type C() end", None), None);
    assert_eq!(root("compound type C() end compound type D() end", None), Some(vec![Code::BipRoot]));
    assert_eq!(root("compound type C() end compound type D() end", Some("C()")), None);
    assert_eq!(root("compound type C() end compound type Root() end", None), None);
    assert_eq!(root("compound type C() end", Some("E")), Some(vec![Code::BipRoot]));
    assert_eq!(root("compound type C(int n) end", None), Some(vec![Code::BipRoot]));
}

#[test]
fn external_functions_that_nobody_provides() {
    let text = package("extern function int read_laser() compound type Top() end");
    let model = support::model("p.bip", &text);
    let found = lapwing_bip::Registry::default().bind(&model).err().unwrap_or_default();
    assert_eq!(found.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::BipExternal]);
    assert!(found[0].message.contains("read_laser"));
}

#[test]
fn several_faults_are_all_reported() {
    let decls = format!("{} {}", atom("on p from a to z on q from a to b"), "port type Broken(int) atom type C( end");
    let codes: Vec<Code> = faults(&decls).into_iter().map(|(code, _)| code).collect();
    assert!(codes.iter().filter(|c| **c == Code::BipUnknownName).count() >= 2, "{codes:?}");
    assert!(codes.contains(&Code::Syntax) || codes.contains(&Code::ReservedWord), "{codes:?}");
}

#[test]
fn faults_of_the_text() {
    for (text, code) in [
        ("package p /* never closed", Code::UnclosedBracket),
        ("package p port type Go( end", Code::ReservedWord),
        ("package p const data int n = (1 end", Code::UnclosedBracket),
        ("package p const data string s = \"abc\nend", Code::BadText),
        ("package p const data int n = 3x end", Code::BadNumber),
        ("package p const data int n = 99999999999999999999 end", Code::BadNumber),
        ("package p # end", Code::StrayCharacter),
        ("package p atom type A() clock x unit fortnight place a initial to a end end", Code::UnknownUnit),
        ("package p atoms type A() end", Code::Syntax),
    ] {
        let (checked, _) = checked("p.bip", text);
        let codes: Vec<Code> = checked.diagnostics.iter().map(|d| d.code).collect();
        assert!(codes.contains(&code), "{text}: {codes:?}");
    }
}

#[test]
fn what_is_nested_too_deeply_is_said_and_not_read() {
    for (open, close) in [("(", ")"), ("!", ""), ("-(", ")")] {
        let text = format!("package p const data int n = {}1{} end", open.repeat(20_000), close.repeat(20_000));
        let (checked, _) = checked("p.bip", &text);
        assert!(checked.diagnostics.iter().any(|d| d.code == Code::TooDeep), "{open}");
    }
    let sum = vec!["1"; 5_000].join(" + ");
    let (checked, _) = checked("p.bip", &format!("package p const data int n = {sum} end"));
    assert!(checked.diagnostics.iter().any(|d| d.code == Code::TooDeep));
}

#[test]
fn models_that_are_too_large_are_refused() {
    let mut text = String::from("package p port type Go() atom type A() place a initial to a end\n");
    text += "compound type C0() component A a0(), a1(), a2(), a3(), a4(), a5(), a6(), a7(), a8(), a9() end\n";
    for n in 1..12 {
        let inner: Vec<String> = (0..10).map(|i| format!("c{i}()")).collect();
        text += &format!("compound type C{n}() component C{} {} end\n", n - 1, inner.join(", "));
    }
    let (checked, _) = checked("p.bip", &(text + "end"));
    let codes = checked.model(Some("C11")).err().map(|d| d.iter().map(|d| d.code).collect::<Vec<_>>());
    assert_eq!(codes, Some(vec![Code::TooLarge]));
}
