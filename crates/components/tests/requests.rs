//! Requests as they are written, and what is said of those that are wrong.

mod common;

use std::io;

use common::model;
use lapwing_components::{Datum, Types, request};
use lapwing_stream::Time;

const SERVICES: &str = "
  enum mode { FAST, SLOW };
  struct point { double x, y; };
component C {
  ids { long n; };
  function Go(in point to = { .x = 1.5 }, in mode how = SLOW, in sequence<double, 3> via = { [0] = 9. }, in string<8> name = \"r\") {};
  function Plain(in long n, in unsigned short most = 7, out double sum) {};
  attribute Set(in n = 4);
};
";

#[test]
fn values_are_given_by_name_and_by_place_and_defaults_fill_the_rest() {
    let (model, _) = model(SERVICES);
    let types = Types::new(&model).unwrap();
    let read = |text: &str| request::request(&model, &types, text).map(|r| r.values).unwrap();
    let point = |x: f64, y: f64| Datum::Struct(vec![Datum::Float(x), Datum::Float(y)]);
    assert_eq!(read("C.Set"), [Datum::Int(4)]);
    assert_eq!(read("C.Plain(3)"), [Datum::Int(3), Datum::Int(7), Datum::Float(0.0)]);
    assert_eq!(read("C.Plain(n=-3, most=2)")[..2], [Datum::Int(-3), Datum::Int(2)]);
    let all = read("C.Go(to={y=2}, how=FAST, via=[1, 2.5], name=\"a \\\"b\\\"\")  # there");
    assert_eq!(all[0], point(1.5, 2.0));
    assert_eq!(all[1], Datum::Int(0));
    assert_eq!(all[2], Datum::List(vec![Datum::Float(1.0), Datum::Float(2.5)]));
    assert_eq!(all[3], Datum::Text("a \"b\"".to_owned()));
    assert_eq!(read("C.Go()")[..2], [point(1.5, 0.0), Datum::Int(1)]);
}

#[test]
fn a_wrong_request_is_told_with_its_place_and_what_would_be_right() {
    let (model, _) = model(SERVICES);
    let types = Types::new(&model).unwrap();
    for (text, column, words) in [
        ("D.Go()", 1, "there is no component `D`; there are C"),
        ("C.Gone()", 1, "`C` has no service `Gone`; it has Go, Plain, Set"),
        ("C.Plaiin()", 1, "`C` has no service `Plaiin`; it has Go, Plain, Set: did you mean `Plain`?"),
        ("C.Plain()", 1, "`Plain` needs a value for `n`"),
        ("C.Plain(n=1.5)", 1, "a whole number is wanted"),
        ("C.Plain(n=1, most=70000)", 1, "70000 is not between 0 and 65535"),
        ("C.Plain(n=1, sum=2)", 1, "`sum` only comes out"),
        ("C.Plain(m=1)", 1, "no parameter `m`; its parameters are n, most, sum"),
        ("C.Go(how=QUICK)", 1, "`QUICK` is none of FAST, SLOW"),
        ("C.Go(via=[1,2,3,4])", 1, "4 elements are more than"),
        ("C.Go(name=\"123456789\")", 1, "longer than 8 bytes"),
        ("C.Go(to={z=1})", 1, "there is no `z` in it; there are x, y"),
        ("C.Go(to=1)", 1, "a structure"),
        ("C.Plain(n=1) and more", 14, "the request has ended"),
        ("C.Plain(n=1", 12, "`,` or `)` is wanted"),
        ("C.Go(name=\"a", 12, "the text has no end"),
    ] {
        let error = request::request(&model, &types, text).unwrap_err();
        assert!(error.message.contains(words), "{text}: {error}");
        assert_eq!(error.column, column, "{text}: {error}");
    }
    let deep = format!("C.Go(via={}", "[".repeat(10_000));
    assert!(request::request(&model, &types, &deep).unwrap_err().message.contains("too deep"));
}

#[test]
fn a_file_gives_its_requests_in_the_order_of_their_times_and_all_its_errors() {
    let (model, _) = model(SERVICES);
    let types = Types::new(&model).unwrap();
    let read = request::file(&model, &types, "# a mission\n@20ms C.Set(n=2)\n\n@1.5us C.Set(n=1)\nC.Set(n=0) # now\n")
        .unwrap();
    let found: Vec<(Time, &Datum)> = read.iter().map(|(time, request)| (*time, &request.values[0])).collect();
    let wanted = [(Time(0), &Datum::Int(0)), (Time(1500), &Datum::Int(1)), (Time(20_000_000), &Datum::Int(2))];
    assert_eq!(found, wanted);
    let errors = request::file(&model, &types, "@soon C.Set()\n@1s C.Set(n=x)\n").unwrap_err();
    assert_eq!(errors.iter().map(|e| e.line).collect::<Vec<_>>(), [1, 2]);
    assert!(errors[0].message.contains("`soon` is no time"), "{}", errors[0]);
}

#[test]
fn lines_that_come_may_be_anything() {
    let endless = "x".repeat(3 << 20);
    let text = [b"@1s C.F()\r\n\xff\xfe\n".as_slice(), endless.as_bytes(), b"\n\nC.G()"].concat();
    let lines = request::Lines::new(io::Cursor::new(text));
    let said: Vec<String> = lines
        .map(|(number, line)| {
            format!("{number} {}", line.unwrap_or_else(|error| format!("{}: {}", error.line, error.message)))
        })
        .collect();
    assert_eq!(
        said,
        [
            "1 @1s C.F()",
            "2 2: the line is no text in UTF-8",
            "3 3: the line has more than 1048576 bytes",
            "4 ",
            "5 C.G()"
        ]
    );
}

#[test]
fn a_short_text_cannot_ask_for_long_values() {
    let (model, _) = model(
        "struct big { double values[10000]; };
         component C { function F(in sequence<big> all); };",
    );
    let types = Types::new(&model).unwrap();
    let few = request::request(&model, &types, "C.F(all=[{}, {}])").unwrap();
    assert_eq!(few.values.len(), 1);
    let many = format!("C.F(all=[{}])", vec!["{}"; 5000].join(", "));
    let error = request::request(&model, &types, &many).unwrap_err();
    assert!(error.message.contains("too many parts"), "{error}");
}
