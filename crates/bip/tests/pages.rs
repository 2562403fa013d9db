//! The example on the page of each code of this crate has the fault that the page explains.

mod support;

use lapwing_diag::Code;
use support::checked;

/// What the examples take for granted.
fn surroundings(example: &str) -> String {
    let atom =
        "atom type A() data int n port Go work() export port Go go(), left(), right() place busy, idle initial to busy";
    let context = "port type Go() connector type Single(Go p) define p end";
    let compound = "compound type Top() component A A(), B()";
    let example = example.trim();
    if example.starts_with("package") {
        return example.to_owned();
    }
    let pair = "connector type Pair(Go p, Go q) define p q end";
    if let Some(body) = example.strip_prefix("connector type Pair(Go p, Go q) define p q end\n") {
        return format!("package p {context} {pair} {atom} end {compound} {body} end end");
    }
    match example.split_whitespace().next() {
        Some("on" | "clock" | "data") => format!("package p {context} {atom} {} end end", in_order(example)),
        Some("connector") if !example.starts_with("connector type") => {
            format!(
                "package p {context} {pair} connector type Sync(Go p, Go q) define p q end {atom} end {compound} {example} end end"
            )
        }
        Some("priority") => {
            format!("package p {context} {atom} end {compound} connector Single a(A.go), b(B.go) {example} end end")
        }
        _ => {
            let user = "compound type Top() component A A(), B() connector Pair c(A.go, B.go) end";
            let user = if example.contains("export port Go both") { user } else { "" };
            format!("package p {context} {atom} end {example} {user} end")
        }
    }
}

/// Clocks and variables may stand anywhere in an atom.
fn in_order(example: &str) -> String {
    if example.contains("x < 5") { format!("clock x {example}") } else { example.to_owned() }
}

#[test]
fn examples_have_the_fault() {
    let ours = Code::ALL.iter().filter(|c| c.name().starts_with("bip-"));
    for code in ours {
        let example = code.page().split("```bip\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap_or("");
        assert!(!example.is_empty(), "{} has no example", code.name());
        let text = surroundings(example);
        let (checked, _) = checked("page.bip", &text);
        let mut found: Vec<Code> = checked.diagnostics.iter().map(|d| d.code).collect();
        if found.iter().all(|c| c != code) {
            match checked.model(None) {
                Err(diagnostics) => found.extend(diagnostics.iter().map(|d| d.code)),
                Ok(model) => {
                    let missing = lapwing_bip::Registry::default().bind(&model).err().unwrap_or_default();
                    found.extend(missing.iter().map(|d| d.code));
                }
            }
        }
        assert!(found.contains(code), "{}: {found:?}\n{text}", code.name());
    }
}
