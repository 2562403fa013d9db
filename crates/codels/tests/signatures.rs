//! Codels as people have written them for GenoM3: the names of types without a name, of constants and of exceptions are those that they use.

mod support;

use lapwing_codels::load;
use lapwing_components::{Datum, Run, Setup, What, request};
use lapwing_stream::Duration;

const COMPONENT: &str = "
interface limits { const unsigned short most = 3; const double rate = 2; function far(in long n); };
component pads {
  uses limits;
  struct pad { long id; string<16> name; };
  enum side { left, right };
  const side first = right;
  const string greeting = \"a \\\"pad\\\"\";
  exception e_none, e_bad { string<32> what; };
  ids { sequence<pad> pads; optional<long> chosen; char mark; side where; };
  function add(in string<16> name, out sequence< string<16> > names) {
    codel pads_add(in name, inout pads, out names);
    throw e_none;
  };
  function measure(in sequence<unsigned long, 2> lengths, in char mark, in optional<double> factor, out double sum, out string text) {
    codel pads_measure(in lengths, local in mark::m, in factor, out chosen, ids out mark, out where, out sum, out text);
    throw e_none, e_bad;
  };
  task t { period 5 ms; };
  activity ask() { task t; codel<start> pads_ask(remote in far) yield ether; throw e_none; };
};
";

/// What GenoM3's users write: no type is declared here.
const CODELS: &str = r#"
#include "acpads.h"
#include "pads_c_types.h"
#include <stdio.h>

static genom_event pads_none(const genom_context self) { return pads_e_none(self); }

genom_event pads_add(const char name[16], sequence_pads_pad *pads, sequence_string16 *names, const genom_context self) {
  uint32_t i;
  if (pads->_length >= limits_most) return pads_none(self);
  if (genom_sequence_reserve(pads, pads->_length + 1)) return pads_none(self);
  snprintf(pads->_buffer[pads->_length].name, sizeof(pads->_buffer->name), "%s", name);
  pads->_length++;
  if (genom_sequence_reserve(names, pads->_length)) return pads_none(self);
  names->_length = pads->_length;
  for (i = 0; i < pads->_length; i++)
    snprintf(names->_buffer[i], sizeof(names->_buffer[i]), "%s", pads->_buffer[i].name);
  return genom_ok;
}

genom_event pads_measure(const sequence2_unsigned_long *lengths, int8_t m, const optional_double *factor,
                         optional_long *chosen, int8_t *mark, pads_side *where, double *sum, char **text,
                         const genom_context self) {
  static uint32_t kept[1] = { 7 };
  genom_event event = genom_ok;
  uint32_t i;
  *sum = 0;
  for (i = 0; i < lengths->_length; i++) *sum += lengths->_buffer[i];
  if (factor->_present) *sum *= factor->_value * limits_rate;
  chosen->_present = true;
  chosen->_value = (int32_t)kept[0];
  *mark = m;
  *where = pads_first;
  *text = strdup(pads_greeting);
  if (*sum > 100) event = pads_none(self);
  if (*sum > 200) {
    pads_e_bad_detail detail;
    snprintf(detail.what, sizeof(detail.what), "%g", *sum);
    event = pads_e_bad(&detail, self);
  }
  /* What was thrown can be told from other things that are. */
  if (event && event != pads_e_none_id && event != pads_e_bad_id) return "an unknown exception";
  return event;
}

genom_event pads_ask(const pads_far *far, const genom_context self) { return far ? pads_ether : pads_none(self); }
"#;

#[test]
fn codels_have_the_names_that_genom3_gives_them() {
    let model = std::sync::Arc::new(support::model(COMPONENT));
    let folder = tempfile::tempdir().unwrap();
    support::write_glue(&model, folder.path());
    let codels = load(&support::compiled(folder.path(), "pads", CODELS), &model).unwrap();
    let setup = Setup { duration: Some(Duration::from_nanos(1_000_000_000)), ..Setup::default() };
    let mut run = Run::new(model.clone(), setup, codels).unwrap();
    let lines = [
        "@0s pads.add(name=\"one\")",
        "@10ms pads.add(name=\"two\")",
        "@20ms pads.measure(lengths=[4, 5], mark=65, factor=0.5)",
        "@30ms pads.measure(lengths=[75, 75], mark=66, factor=0.5)",
        "@40ms pads.measure(lengths=[150, 150], mark=65, factor=0.5)",
        "@50ms pads.add(name=\"three\")",
        "@60ms pads.add(name=\"four\")",
        "@70ms pads.ask()",
    ];
    for line in lines {
        let (time, request) = request::timed(&model, run.types(), line, 1).unwrap().unwrap();
        run.schedule(time, request);
    }
    let mut told = Vec::new();
    while let Some(happening) = run.advance() {
        match happening.what {
            What::Reported { outcome, values, .. } => told.push((outcome.to_string(), values)),
            What::Failed(failure) => panic!("{}", failure.trouble),
            _ => {}
        }
    }
    let outcomes: Vec<&str> = told.iter().map(|(outcome, _)| outcome.as_str()).collect();
    assert_eq!(outcomes, ["done", "done", "done", "e_none", "e_bad", "done", "e_none", "e_none"]);
    let text = |text: &str| Datum::Text(text.to_owned());
    assert_eq!(told[1].1[1], Datum::List(vec![text("one"), text("two")]));
    assert_eq!(told[2].1[3..], [Datum::Float(9.0), text("a \"pad\"")]);
    assert_eq!(run.ids("pads", "where"), Some(Datum::Int(1)));
    assert_eq!(run.ids("pads", "mark"), Some(Datum::Int(65)));
}
