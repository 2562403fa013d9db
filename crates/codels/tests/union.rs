//! Unions through C and back: the member that is there is the same on both sides, and one that has none comes back as well.

mod support;

use lapwing_codels::load;
use lapwing_components::codel::{Argument, Held};
use lapwing_components::{Answer, Call, Datum, Types};
use lapwing_genom::model::{Direction, Type, TypeDefKind};
use lapwing_stream::Time;

const COMPONENT: &str = "
enum m { A, B };
union by_name switch (m) { case B: double d; case A: string s; };
union with_rest switch (long) { case 2: long n; case 1: default: double d; };
union without switch (long) { case 1: long n; };
component C {
  ids { by_name a; with_rest b; without c; };
  function F() { codel CF(ids inout a, ids inout b, ids inout c); };
};
";

const CODEL: &str = r#"
#include "acC.h"

genom_event CF(by_name *a, with_rest *b, without *c, const genom_context self) {
  (void)self;
  if (a->_d == B) a->_u.d += 1.5;
  if (b->_d == 2) { b->_d = 1; b->_u.d = 0.25; } else { b->_d = 9; b->_u.d *= 2; }
  if (c->_d == 1) c->_d = 7;
  return genom_ok;
}
"#;

fn union(tag: i128, number: usize, value: Datum) -> Datum {
    Datum::Union(tag, Some((number, Box::new(value))))
}

#[test]
fn the_member_that_is_there_is_the_same_on_both_sides() {
    let model = support::model(COMPONENT);
    let types = Types::new(&model).unwrap();
    let folder = tempfile::tempdir().unwrap();
    support::write_glue(&model, folder.path());
    let codels = load(&support::compiled(folder.path(), "C", CODEL), &model).unwrap();
    let codel = codels.get("C", "CF").unwrap();

    let ids = model.components[0].ids.map(|id| &model.types[id.0].kind);
    let Some(TypeDefKind::Struct(fields)) = ids else { panic!("internal data are a structure") };
    let first = types.initial(&Type::Named(model.components[0].ids.unwrap()));
    let Datum::Struct(mut values) = first else { panic!("a structure has members") };
    // The first member, and what tells of it: B, 2, 1.
    assert_eq!(values, [union(1, 0, 0.0.into()), union(2, 0, Datum::Int(0)), union(1, 0, Datum::Int(0))]);

    let call = |values: &mut Vec<Datum>| {
        let given = fields.iter().zip(values.drain(..)).map(|(field, value)| Argument {
            name: field.name.as_str().into(),
            direction: Direction::InOut,
            ty: field.ty.clone().into(),
            value: Held::Data(value),
        });
        let mut call = Call::new("C".into(), "CF".into(), Time(0), given.collect(), types.clone());
        assert_eq!(codel.call(&mut call), Ok(Answer::Ok));
        values.extend(call.arguments.into_iter().map(|argument| match argument.value {
            Held::Data(datum) => datum,
            other => panic!("{other:?}"),
        }));
    };
    call(&mut values);
    assert_eq!(values, [union(1, 0, 1.5.into()), union(1, 1, 0.25.into()), Datum::Union(7, None)]);
    call(&mut values);
    assert_eq!(values, [union(1, 0, 3.0.into()), union(9, 1, 0.5.into()), Datum::Union(7, None)]);
}
