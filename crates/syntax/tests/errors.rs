//! What is said of a text that is wrong: the code, the place and the message, and nothing more than once.

mod common;

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::{FileId, parse};

/// Each text has exactly one fault: its code, the text at its place, its message.
fn check(table: &[(&str, Code, &str, &str)]) {
    for (text, code, place, message) in table {
        let diagnostics = parse(FileId(0), text).diagnostics;
        let [only] = diagnostics.as_slice() else { panic!("{text}\n{diagnostics:#?}") };
        assert_eq!((only.code, at(text, only), only.message.as_str()), (*code, *place, *message), "{text}");
    }
}

fn at<'a>(text: &'a str, diagnostic: &Diagnostic) -> &'a str {
    &text[diagnostic.primary.span.start as usize..diagnostic.primary.span.end as usize]
}

/// Each text, cured as its only diagnostic proposes, is the second.
fn check_cures(table: &[(&str, &str)]) {
    for (text, cured) in table {
        let diagnostics = parse(FileId(0), text).diagnostics;
        let [only] = diagnostics.as_slice() else { panic!("{text}\n{diagnostics:#?}") };
        let (span, replacement) = only.fix.as_ref().unwrap_or_else(|| panic!("{text}: no cure"));
        let result = format!("{}{replacement}{}", &text[..span.start as usize], &text[span.end as usize..]);
        assert_eq!(result, *cured);
        common::parsed(&result);
    }
}

#[test]
fn misspelt_words() {
    let none = |word: &str| format!("`{word}` is no word of the language here");
    for (text, word) in [
        ("nevr x > 2", "nevr"),
        ("NEVER x > 2", "NEVER"),
        ("p: alwasy x", "alwasy"),
        ("dcl rotor /t T.x", "dcl"),
        ("never x > 2 adn y > 3", "adn"),
        ("never x > 2 AND y < 3", "AND"),
        ("x implise y", "implise"),
        ("G x > 2", "G"),
        ("if x > 2, eventually y", "if"),
        ("decl x /odom T.x defalt 3", "defalt"),
        ("machine m {\n stat a when x\n}", "stat"),
        ("machine m {\n state a whn x\n}", "whn"),
        ("event e = cal A::f", "cal"),
        ("on violation of p { publsh /t T {} }", "publsh"),
        ("ltl(G p)", "G"),
    ] {
        check(&[(text, Code::UnknownWord, word, &none(word))]);
    }
}

/// What somebody who is new writes, and what the help says to do.
#[test]
fn helps() {
    for (text, help) in [
        ("always eventually x < 0.1 within 3 s", "a time bound stands before what it bounds"),
        ("always x for 2 s", "a time bound stands before what it bounds"),
        ("whenever x > 0 for 0.5 s, y > 0", "`held for 2 s (X)`"),
        ("// x\nnever y > 2", "a comment begins with `#`"),
        ("never x > 1,5", "a point: `1.5`"),
        ("never x > 1.5 mph", "if `mph` is meant as a unit: the units are `ns`"),
    ] {
        let diagnostics = parse(FileId(0), text).diagnostics;
        let said = diagnostics.iter().flat_map(|d| &d.help).any(|said| said.contains(help));
        assert!(said, "{text}\n{diagnostics:#?}");
    }
}

#[test]
fn cures() {
    check_cures(&[
        ("nevr x > 2", "never x > 2"),
        ("never x > 2 adn y", "never x > 2 and y"),
        ("after x never y", "after x, never y"),
        ("event e = call Kicker.play", "event e = call Kicker::play"),
        ("event e = set A.x below Kicker.play", "event e = set A.x below Kicker::play"),
        ("whenever x == 0 eventually y", "whenever x == 0, eventually y"),
        ("never x =< 2", "never x <= 2"),
        ("after_until x, y > 2 eventually z", "after_until x, y > 2, eventually z"),
        ("always x && y", "always x and y"),
        ("x => y", "x implies y"),
        ("always !x", "always not x"),
        ("never x = 3", "never x == 3"),
        ("never x == 0.05 y", "never x == {0.05} y"),
        ("always within 2 x", "always within 2 s x"),
        ("never x > .5", "never x > 0.5"),
        ("never x > 5.", "never x > 5.0"),
        ("never x > 5 sec", "never x > 5 s"),
        ("never x > 5hz", "never x > 5Hz"),
        ("never x ≤ 2", "never x <= 2"),
        ("never x == 'a'", "never x == \"a\""),
        ("__rat__ = 30", "__rate__ = 30"),
        ("@{x, 3} > 2", "@{x, -3} > 2"),
        ("property p = never x", "property p : never x"),
        ("model r:\n position /odom O.p\nnever x", "model r:\n position /odom O.p ;\nnever x"),
        ("ltl(p -> q)", "ltl(p => q)"),
        ("ltl(always p)", "ltl([] p)"),
        ("on violatoin of p { stop }", "on violation of p { stop }"),
        ("always: never x", "`always`: never x"),
    ]);
}

#[test]
fn scopes_and_their_commas() {
    check(&[
        ("after x never y", Code::MissingComma, "", "a comma is missing before `never`"),
        ("whenever x == 0 eventually y", Code::MissingComma, "", "a comma is missing before `eventually`"),
        ("after x > 2 y > 3", Code::MissingComma, "", "a comma is missing before `y`"),
        ("after_until x, y not z", Code::MissingComma, "", "a comma is missing before `not`"),
        (
            "after_until x > 2, eventually z",
            Code::Syntax,
            "",
            "expected a comma and the next part of `after_until`, but the file ends",
        ),
        ("never x > 2, y", Code::Syntax, ",", "expected the end of the line, found `,`"),
    ]);
}

#[test]
fn operators_of_other_languages() {
    check(&[
        ("x && y", Code::ForeignOperator, "&&", "`&&` is written `and` here"),
        ("x & y", Code::ForeignOperator, "&", "`&` is written `and` here"),
        ("x || y", Code::ForeignOperator, "||", "`||` is written `or` here"),
        ("x -> y", Code::ForeignOperator, "->", "`->` is written `implies` here"),
        ("never x =< y", Code::ForeignOperator, "=<", "`=<` is written `<=` here"),
        ("x <=> y", Code::ForeignOperator, "<=>", "`<=>` is written `iff` here"),
        ("not !x", Code::ForeignOperator, "!", "`!` is written `not` here"),
        ("[] x", Code::LtlNotation, "[]", "`[]` is understood inside `ltl(…)` only"),
        ("[*] x", Code::LtlNotation, "[*]", "`[*]` is understood inside `ltl(…)` only"),
        ("p: <> x", Code::LtlNotation, "<>", "`<>` is understood inside `ltl(…)` only"),
        ("<*> x", Code::LtlNotation, "<*>", "`<*>` is understood inside `ltl(…)` only"),
        ("(*) x", Code::LtlNotation, "(*)", "`(*)` is understood inside `ltl(…)` only"),
        ("ltl(p -> q)", Code::LtlNotation, "->", "inside `ltl(…)`, `->` is written `=>`"),
        ("ltl(p until q)", Code::LtlNotation, "until", "inside `ltl(…)`, `until` is written `U`"),
        ("ltl(once p)", Code::LtlNotation, "once", "inside `ltl(…)`, `once` is written `<*>`"),
        ("ltl(p and U)", Code::LtlNotation, "U", "inside `ltl(…)`, `U` is an operator"),
        ("never x = 3", Code::SingleEquals, "=", "`=` gives something a name; it does not compare"),
        ("never x < y < 3", Code::ChainedComparison, "<", "comparisons do not chain"),
        ("never x ** 2 > 3", Code::Syntax, "*", "expected a value or a formula, found `*`"),
        ("never x % 2 == 0", Code::StrayCharacter, "%", "`%` has no meaning here"),
        ("never rotor1\\_vel > 3", Code::StrayCharacter, "\\", "`\\` has no meaning here"),
        ("never x > 2 // comment", Code::Syntax, "/", "expected a value or a formula, found `/`"),
        ("never x > 2;", Code::Syntax, ";", "expected the end of the line, found `;`"),
    ]);
}

#[test]
fn margins() {
    check(&[
        ("never x == 0.05 y", Code::BareMargin, "0.05", "a margin stands in curly brackets"),
        ("never x != 0.05 0", Code::BareMargin, "0.05", "a margin stands in curly brackets"),
        ("never x == 5 kg", Code::BareMargin, "5", "a margin stands in curly brackets"),
        ("never x =={} 0", Code::Syntax, "}", "expected a value or a formula, found `}`"),
    ]);
}

#[test]
fn durations_and_bounds() {
    check(&[
        ("always within 2 x", Code::BareDuration, "2", "`2` is no duration"),
        ("always within 2 m x", Code::BareDuration, "2 m", "`2 m` is no duration"),
        ("always within (0 s, 2] x", Code::BareDuration, "2", "`2` is no duration"),
        ("held for 0.5 x", Code::BareDuration, "0.5", "`0.5` is no duration"),
        ("decl x /t T.x stale after 2", Code::BareDuration, "2", "`2` is no duration"),
        ("always within 0.1 ns x", Code::DurationRange, "0.1 ns", "this duration is shorter than a nanosecond"),
        ("always x < 0.5 ns", Code::DurationRange, "0.5 ns", "this duration is shorter than a nanosecond"),
        ("late = 3 * 1e-4 us", Code::DurationRange, "1e-4 us", "this duration is shorter than a nanosecond"),
        ("always x =={0.9 ns} y", Code::DurationRange, "0.9 ns", "this duration is shorter than a nanosecond"),
        ("always within 1e20 h x", Code::DurationRange, "1e20 h", "this duration is too long"),
        ("always within -2 s x", Code::Syntax, "-", "expected a duration, such as `2 s`, found `-`"),
        ("always within (2 s) x", Code::Syntax, ")", "expected a comma and the upper end of the interval, found `)`"),
        ("never within 2 s x", Code::BoundNotAllowed, "within 2 s", "`never` takes no time bound"),
        ("next within 2 s x", Code::BoundNotAllowed, "within 2 s", "`next` takes no time bound"),
        ("becomes within [1 s, 2 s] x", Code::BoundNotAllowed, "within [1 s, 2 s]", "`becomes` takes no time bound"),
        ("eventually for 2 s x", Code::BoundNotAllowed, "for", "`eventually` takes no `for`"),
        ("after within 2 s x, y", Code::BoundNotAllowed, "within", "`after` takes no time bound"),
        ("within 2 s y", Code::Syntax, "within", "expected a value or a formula, found `within`"),
        ("x and within 2 s y", Code::Syntax, "within", "expected a value or a formula, found `within`"),
    ]);
}

#[test]
fn numbers_and_units() {
    let point = "a number has digits on both sides of its point";
    check(&[
        ("never x > .5", Code::BadNumber, ".5", point),
        ("never x > 5.", Code::BadNumber, "5.", point),
        ("never x > 5. and y", Code::BadNumber, "5.", point),
        ("never x > -.5 m", Code::BadNumber, ".5", point),
        ("never x > 1.2.3", Code::BadNumber, "1.2.3", "`1.2.3` is no number"),
        ("never x > 1e999", Code::BadNumber, "1e999", "`1e999` is too large a number"),
        ("never x > 5 sec", Code::UnknownUnit, "sec", "`sec` is no unit"),
        ("never x > 5mps2", Code::UnknownUnit, "mps2", "`mps2` is no unit"),
        ("never x > 5kg", Code::UnknownUnit, "kg", "`kg` is no unit"),
        ("never x > 5 meters and y", Code::UnknownUnit, "meters", "`meters` is no unit"),
        ("x.5 > 3", Code::Syntax, "5", "expected a name after the dot, found the number `5`"),
        ("never a[1.5] > 3", Code::Syntax, "1.5", "expected the number of an entry, from 0, found the number `1.5`"),
    ]);
}

#[test]
fn texts_and_names() {
    check(&[
        ("never x == \"abc", Code::BadText, "\"abc", "this text has no closing quotation mark"),
        ("never x == \"a\\qb\"", Code::BadText, "\\q", "`\\q` is no escape"),
        ("never x == 'abc'", Code::BadText, "'abc'", "a text stands in double quotation marks"),
        ("never `abc > 2", Code::BadName, "`abc > 2", "a name that begins with a backquote ends with one"),
        ("never `` > 2", Code::BadName, "``", "there is no name between these backquotes"),
        ("never next > 3", Code::ReservedWord, "next", "`next` is a word of the language, not a name"),
        ("never and x", Code::ReservedWord, "and", "`and` is a word of the language, not a value"),
        ("always = 3", Code::ReservedWord, "always", "`always` is a word of the language, not a name"),
        ("a: and x", Code::ReservedWord, "and", "`and` is a word of the language, not a value"),
        ("a: x and", Code::Syntax, "", "expected a value or a formula, but the file ends"),
        ("a: x and and y", Code::ReservedWord, "and", "`and` is a word of the language, not a value"),
        ("a: x and within (0 s, 2 s] y", Code::Syntax, "within", "expected a value or a formula, found `within`"),
        ("and x > 3", Code::Syntax, "and", "there is nothing before this `and` that it could join"),
        ("never robot velocity > 2", Code::Syntax, "velocity", "expected the end of the line, found `velocity`"),
        ("never x == not y", Code::Syntax, "not", "`not …` stands in brackets where a value is expected"),
        ("never /scan > 3", Code::Syntax, "/", "expected a value or a formula, found `/`"),
    ]);
}

#[test]
fn brackets() {
    check(&[
        ("never (x > 2", Code::UnclosedBracket, "(", "this `(` is never closed"),
        ("never (x > 2\nnever y > 3\nz = 3", Code::UnclosedBracket, "(", "this `(` is never closed"),
        ("never f(x\ndecl y /t T.x", Code::UnclosedBracket, "(", "this `(` is never closed"),
        ("never x > 2)", Code::UnclosedBracket, ")", "this `)` closes nothing"),
        ("never (x > 2]", Code::UnclosedBracket, "]", "`(` is closed by `]`"),
        (
            "machine m {\n initial a\n state a\nnever x > 1\nproperty p: never x",
            Code::UnclosedBracket,
            "{",
            "this `{` is never closed",
        ),
        ("on violation of p {\n stop\nevent e = message /t", Code::UnclosedBracket, "{", "this `{` is never closed"),
        ("always within (0 s, 2 s x", Code::UnclosedBracket, "(", "this `(` is never closed"),
        ("never f(x, ) > 2", Code::Syntax, ")", "expected a value or a formula, found `)`"),
        ("never f(x y) > 2", Code::Syntax, "y", "expected an operator, a comma or `)`, found `y`"),
    ]);
}

#[test]
fn statements_that_break_off() {
    let value = "expected a value or a formula, but the";
    check(&[
        ("never x >", Code::Syntax, "", &format!("{value} file ends")),
        ("limit = 2 +\nother = 3", Code::Syntax, "", &format!("{value} line ends")),
        ("p: never x >\nq: never y", Code::Syntax, "", &format!("{value} line ends")),
        ("never x >\nnever y", Code::Syntax, "", "expected a value or a formula after `>`"),
        ("held for 2 s\n(x)", Code::Syntax, "", &format!("{value} line ends")),
        ("never x.\ny", Code::Syntax, "", "expected a name after the dot, but the line ends"),
        ("decl x", Code::Syntax, "", "expected a topic, as in `/odom`, but the file ends"),
        (
            "decl x /odom\ny",
            Code::Syntax,
            "",
            "expected a message type, as in `Odometry` or `nav_msgs/Odometry`, but the line ends",
        ),
        ("event\nx", Code::Syntax, "", "expected the event's name, but the line ends"),
        ("guard /a from /b by p", Code::Syntax, "", "expected `else`, but the file ends"),
    ]);
}

#[test]
fn statements() {
    check(&[
        ("__rate__ = 30.5", Code::BadSetting, "30.5", "a rate is a whole number of instants per second"),
        ("__rate__ = 0", Code::BadSetting, "0", "a rate is a whole number of instants per second"),
        ("__foo__ = 0", Code::BadSetting, "__foo__", "there is no setting `__foo__`"),
        ("__margin__ = -1", Code::BadSetting, "-", "a setting is never negative"),
        ("clock ticks", Code::Syntax, "ticks", "expected `events` after `clock`, found `ticks`"),
        ("decl x /odom/ T.x", Code::Syntax, "/odom/", "`/odom/` is no topic"),
        (
            "model r\n position /odom O.p\n ;\nx",
            Code::Syntax,
            "",
            "expected `:` after the object's name, but the line ends",
        ),
        ("model r:\n position /odom O.p\nx = 3", Code::Syntax, "", "a model ends with `;`"),
        ("event e = message /t T.x", Code::Syntax, "x", "an event is a whole message, not a field of one"),
        ("event e = write X", Code::Syntax, "X", "expected a port, as in `LaserDriver.Laser`, found only one name"),
        ("machine m {\n a -> b c\n}", Code::Syntax, "c", "expected the end of the line, found `c`"),
        ("machine m {\n initial a\n initial b\n}", Code::Syntax, "initial", "a machine has one `initial` entry"),
        ("machine m { initial a state b\n}", Code::Syntax, "state", "expected the end of the line, found `state`"),
        ("on violation { stop }", Code::Syntax, "{", "expected `of` and the name of a property, found `{`"),
        ("on violation of p { publish /t T { a: 1 b: 2 } }", Code::Syntax, "b", "expected a comma or `}`, found `b`"),
        ("property: never x", Code::Syntax, ":", "expected the property's name, found `:`"),
        ("pattern p: always x", Code::Syntax, ":", "expected `(`, found `:`"),
        ("for each r in a: r.x", Code::Syntax, "a", "expected `(a, b)` or `topics /{r}/odom` after `in`, found `a`"),
        ("never for each r in (a): r.x", Code::Syntax, "for", "expected a formula, found `for`"),
    ]);
}

#[test]
fn every_fault_is_reported_once() {
    let text = "nevr x > 2\nnever (y > 3\ndecl z\nmachine m {\n    stat a\n    state b when c >\n    a -> \n}\nnever f(x +) > 2 and g(y +) < 3\nfine: never q > 1\n";
    let found: Vec<(Code, usize)> = parse(FileId(0), text)
        .diagnostics
        .iter()
        .map(|d| (d.code, text[..d.primary.span.start as usize].matches('\n').count() + 1))
        .collect();
    let expected = [
        (Code::UnknownWord, 1),
        (Code::UnclosedBracket, 2),
        (Code::Syntax, 3),
        (Code::UnknownWord, 5),
        (Code::Syntax, 6),
        (Code::Syntax, 7),
        (Code::Syntax, 9),
        (Code::Syntax, 9),
    ];
    assert_eq!(found, expected);
}

#[test]
fn what_follows_a_fault_is_still_understood() {
    let parsed = parse(FileId(0), "p: never x >\nq: nevr y\nr: never (z +) > 2\ns: never t > 1\n");
    assert_eq!(parsed.file.items.len(), 4);
    assert_eq!(parsed.diagnostics.len(), 3);
}
