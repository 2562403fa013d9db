//! No text makes the parser panic, overflow its stack or take long.

mod common;

use common::{EXAMPLES, Random};
use lapwing_diag::Code;
use lapwing_syntax::{FileId, Parsed, format, parse};
use std::time::{Duration, Instant};

/// Parses; what came out has places inside the text, and can be shown and dropped.
fn survives(text: &str) -> Parsed {
    let parsed = parse(FileId(0), text);
    for diagnostic in &parsed.diagnostics {
        let span = diagnostic.primary.span;
        assert!(span.start <= span.end && span.end as usize <= text.len(), "{span:?} in {text:?}");
        assert!(text.is_char_boundary(span.start as usize) && text.is_char_boundary(span.end as usize), "{text:?}");
    }
    let covered: usize = parsed.tokens.iter().map(|t| (t.span.end - t.span.start) as usize).sum();
    let blank: usize = text.chars().filter(|c| c.is_whitespace() || *c == '\u{feff}').map(char::len_utf8).sum();
    assert!(covered + blank >= text.len(), "every sign is in a token: {text:?}");
    if let Ok(once) = format(text) {
        assert_eq!(format(&once).as_ref(), Ok(&once), "a fixed point: {text:?}");
    }
    let _ = format!("{:?}", parsed.file);
    let _ = parsed.file == parsed.file.clone();
    parsed
}

fn codes(text: &str) -> Vec<Code> {
    survives(text).diagnostics.iter().map(|d| d.code).collect()
}

#[test]
fn every_prefix_of_every_example_survives() {
    for (_, text) in EXAMPLES {
        for (end, _) in text.char_indices() {
            survives(&text[..end]);
        }
    }
}

#[test]
fn every_example_without_one_of_its_characters_survives() {
    for (_, text) in EXAMPLES {
        for (at, c) in text.char_indices() {
            survives(&format!("{}{}", &text[..at], &text[at + c.len_utf8()..]));
        }
    }
}

#[test]
fn random_characters_survive() {
    let alphabet: Vec<char> = "ab_S oXU09.,:;()[]{}<>=!&|+-*/@#\"`\\'\n\r\t é→\u{feff}🤖".chars().collect();
    let mut random = Random(1);
    for _ in 0..20_000 {
        let length = random.below(60);
        let text: String = (0..length).map(|_| random.pick(&alphabet)).collect();
        survives(&text);
    }
}

#[test]
fn random_tokens_survive() {
    let words: Vec<&str> = "decl model world event machine pattern use on violation of guard property clock events \
        always never eventually next previously once historically becomes after until before while whenever after_until \
        since held for each in topics within not and or implies iff true false ltl running default stale sample when \
        initial state else stay at most least every publish call request run reset stop from by drop fail open closed \
        over below message set return reply write start end report x a.b /scan /{r}/odom Type.field 1 2.5 3 s 100 ms \
        \"text\" `q` ( ) [ ] { } , : :: ; . @{ -3} = == != < <= > >= + - * / -> => <=> | || & && ! ~ # o X U S [] <> <*> \
        (*) [*] __rate__"
        .split(' ')
        .collect();
    let mut random = Random(2);
    for _ in 0..20_000 {
        let length = random.below(40);
        let mut text = String::new();
        for _ in 0..length {
            text.push_str(random.pick(&words));
            text.push_str(random.pick(&[" ", " ", " ", "", "\n", "\n    "]));
        }
        survives(&text);
    }
}

#[test]
fn deep_nesting_is_an_error() {
    let n = 10_000;
    for (open, close) in [
        ("(", ")"),
        ("not ", ""),
        ("-", ""),
        ("always ", ""),
        ("after x, ", ""),
        ("f(", ")"),
        ("@{", ", -1}"),
        ("x implies ", ""),
        ("held for 1 s ", ""),
        ("x == {(", ")} 0"),
        ("(x + ", ")"),
        ("ltl(", ")"),
    ] {
        let text = format!("never {}x{}", open.repeat(n), close.repeat(n));
        assert_eq!(codes(&text), [Code::TooDeep], "{open}");
    }
    for symbols in ["[]", "<>", "!", "o ", "x U ", "x => ", "("] {
        let text = format!("ltl({}x{})", symbols.repeat(n), if symbols == "(" { ")".repeat(n) } else { String::new() });
        assert_eq!(codes(&text), [Code::TooDeep], "{symbols}");
    }
    assert_eq!(
        codes(&format!("on violation of p {{ publish /t T {}{} }}", "{ a: ".repeat(n), "}".repeat(n))),
        [Code::TooDeep]
    );
    assert_eq!(
        codes(&format!("on violation of p {{ publish /t T {{ a: {}{} }} }}", "[".repeat(n), "]".repeat(n))),
        [Code::TooDeep]
    );
    assert_eq!(codes(&"(".repeat(n)).len(), 1);
}

#[test]
fn the_deepest_formula_takes_little_stack() {
    let text = format!("never {}x{}", "(a and f(b, x == 2 * ".repeat(48), "))".repeat(48));
    let small = std::thread::Builder::new().stack_size(512 << 10);
    let parsed = small.spawn(move || codes(&text)).unwrap().join();
    assert_eq!(parsed.unwrap(), []);
}

#[test]
fn long_chains_are_an_error() {
    let n = 10_000;
    for link in [" and x", " or x", " iff x", " + x", " * x", " until x", " since x", "[1]"] {
        assert_eq!(codes(&format!("never x{}", link.repeat(n))), [Code::TooDeep], "{link}");
    }
    for link in [" and x", " || x", " <=> x"] {
        assert_eq!(codes(&format!("ltl(x{})", link.repeat(n))), [Code::TooDeep], "{link}");
    }
    // A dotted name is no chain: it is one node.
    assert_eq!(codes(&format!("never x{}", ".x".repeat(n))), []);
}

#[test]
fn chains_and_nesting_within_the_limits_are_fine() {
    assert_eq!(codes(&format!("never x{}", " or x".repeat(300))), []);
    assert_eq!(codes(&format!("never {}x{}", "(".repeat(60), ")".repeat(60))), []);
    let balanced = format!("({})", vec!["a and b"; 40].join(" or "));
    assert_eq!(codes(&format!("never {}", vec![balanced; 40].join(" implies "))), []);
}

#[test]
fn big_files_take_little_time() {
    let repeated = |line: &str| line.repeat(1_000_000 / line.len());
    let started = Instant::now();
    let texts = [
        repeated("never robot.velocity > 2.0 m/s  # a comment\n"),
        repeated("# c\n"),
        repeated("nevr robot.velocity > 2.0\n"),
        repeated("never (x > 2\n"),
        repeated("machine m {\n"),
        repeated("(x "),
        repeated("x "),
        repeated("x) "),
        repeated("{"),
        repeated("}"),
        repeated("( {"),
        format!("{}{}", "(".repeat(500_000), "}".repeat(500_000)),
        format!("{{{}{}", "(".repeat(500_000), "}".repeat(500_000)),
        repeated("1"),
        repeated("\""),
        repeated("`"),
        repeated("\n"),
        repeated("/"),
        repeated("a."),
        repeated("- "),
        repeated("@{"),
        repeated("f(x, "),
        format!("x == \"{}\"", repeated("\\q")),
    ];
    for text in &texts {
        survives(text);
    }
    let each = started.elapsed() / texts.len() as u32;
    assert!(each < Duration::from_secs(2), "{each:?} for a megabyte");
}
