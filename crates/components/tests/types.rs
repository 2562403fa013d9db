//! Types of components: those of which no value can be kept, and what monitors see of large and recursive ones.

mod common;

use std::sync::Arc;

use common::model;
use lapwing_components::{Codels, Datum};
use lapwing_components::{Run, Setup, Signals, Types, request};
use lapwing_genom::Model;
use lapwing_stream::Type;

fn with_port(types: &str, ty: &str) -> Arc<Model> {
    model(&format!("{types}\ncomponent C {{ port out {ty} P; }};")).0
}

/// Structures, each of two members made of the one before: `t60` is made of as many as 2 to the power of 60.
fn tower(member: &str) -> String {
    let one = |n: usize| {
        let inner = member.replace('?', &format!("t{}", n - 1));
        format!("struct t{n} {{ {inner} a; {inner} b; }};\n")
    };
    std::iter::once("struct t0 { double a; };\n".to_owned()).chain((1..=60).map(one)).collect()
}

#[test]
fn a_type_of_which_no_value_can_be_kept_is_told() {
    for (types, ty) in [
        ("struct s { s a; s b; };".to_owned(), "s"),
        ("union u switch (boolean) { case TRUE: u again; case FALSE: long n; };".to_owned(), "u"),
        ("struct s { sequence<s, 2> more; s own[0]; };".to_owned(), "s"),
        ("struct big { double x[2000000]; };".to_owned(), "big"),
        ("struct big { double x[2000000]; }; struct s { sequence<big> some; };".to_owned(), "s"),
        (tower("?"), "t60"),
        (tower("?") + "typedef t60 none[0];", "none"),
    ] {
        let model = with_port(&types, ty);
        let error = Types::new(&model).unwrap_err();
        assert!(error.contains(&format!("`{ty}` of `C`")) && error.contains("cannot be kept"), "{error}");
        assert!(Run::new(model, Setup::default(), Codels::new()).is_err(), "{types}");
    }
}

/// How many members a type is told with.
fn members(ty: &Type) -> usize {
    match ty {
        Type::Message(schema) => schema.fields.iter().map(|f| 1 + members(&f.ty)).sum(),
        Type::Array(inner) => members(inner),
        _ => 0,
    }
}

#[test]
fn a_type_that_contains_itself_by_sequences_is_told_once_and_a_tower_as_far_as_it_is_of_use() {
    let told = |types: &str, ty: &str| {
        let model = with_port(types, ty);
        let signals = Signals::new(&model, &Types::new(&model).unwrap());
        let topic = signals.topics().iter().find(|t| t.name == "/C/P").unwrap();
        members(&Type::Message(topic.schema.clone()))
    };
    assert_eq!(told("struct n { long v; sequence<n> a; sequence<n> b; };", "n"), 3);
    assert_eq!(told("struct p { long v; }; struct q { p a; p b; };", "q"), 4);
    let many = told(&tower("sequence<?>"), "t60");
    assert!((1000..100_000).contains(&many), "{many}");
}

#[test]
fn defaults_of_elements_far_out_make_no_more_than_may_be_kept() {
    let types = "struct row { double x[1000]; };";
    let text = format!(
        "{types} component C {{ function F(in sequence<row> rows = {{ [900000] = {{ .x = {{ [1] = 2. }} }} }}) {{}}; }};"
    );
    let model = model(&text).0;
    let request = request::request(&model, &Types::new(&model).unwrap(), "C.F()").unwrap();
    assert_eq!(request.values, [Datum::List(Vec::new())]);
}
