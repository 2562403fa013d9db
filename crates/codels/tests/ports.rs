//! Ports of arrays and texts: codels in C have the address of their first element, and what they write comes back.

mod support;

use lapwing_codels::load;
use lapwing_components::{Answer, Datum, Run, Setup, What, request};
use lapwing_stream::Duration;

const COMPONENT: &str = "
typedef double vector[3];
typedef double matrix[2][3];
typedef string<8> name;
typedef string line;
typedef name names[2];
component Sends {
  port out vector V;
  port out matrix M;
  port out name N;
  port out line L;
  port multiple out names Many;
  task t { period 10 ms; };
  activity Go() { task t; codel<start> Send(port out V, port out M, port out N, port out L, port out Many) yield ether; };
};
component Takes {
  ids { double sum; string text; };
  port in vector V;
  port in matrix M;
  port in name N;
  port in line L;
  port multiple in names Many;
  task t { period 10 ms; };
  activity Go() {
    task t;
    codel<start> Take(port in V, port in M, port in N, port in L, port in Many, ids out sum, ids out text) yield ether;
  };
};
";

const SENDS: &str = r#"
#include "acSends.h"

genom_event Send(const Sends_V *V, const Sends_M *M, const Sends_N *N, const Sends_L *L, const Sends_Many *Many,
                 const genom_context self) {
  double *v = V->data(self);
  Sends_M_element *m = M->data(self);
  int i, k;
  for (i = 0; i < 3; i++) v[i] = i + 1;
  for (i = 0; i < 2; i++) for (k = 0; k < 3; k++) m[i][k] = 10 * i + k;
  strcpy(N->data(self), "lapwing");
  *L->data(self) = strdup("a longer line");
  strcpy(Many->data("left", self)[1], "peewit");
  V->write(self);
  M->write(self);
  N->write(self);
  L->write(self);
  Many->write("left", self);
  return Sends_ether;
}
"#;

const TAKES: &str = r#"
#include <stdio.h>
#include "acTakes.h"

genom_event Take(const Takes_V *V, const Takes_M *M, const Takes_N *N, const Takes_L *L, const Takes_Many *Many,
                 double *sum, char **text, const genom_context self) {
  const double *v = V->data(self);
  Takes_M_element *m = M->data(self);
  if (!v || !m) return Takes_ether;
  *sum = 100 * v[2] + m[1][2];
  *text = malloc(64);
  snprintf(*text, 64, "%s, %s, %s", N->data(self), *L->data(self), Many->data("left", self)[1]);
  return Takes_ether;
}
"#;

#[test]
fn arrays_and_texts_go_through_ports() {
    let model = std::sync::Arc::new(support::model(COMPONENT));
    let folder = tempfile::tempdir().unwrap();
    support::write_glue(&model, folder.path());
    let mut codels = load(&support::compiled(folder.path(), "Sends", SENDS), &model).unwrap();
    codels.join(load(&support::compiled(folder.path(), "Takes", TAKES), &model).unwrap());
    let setup = Setup { duration: Some(Duration::from_nanos(200_000_000)), ..Setup::default() };
    let mut run = Run::new(model.clone(), setup, codels).unwrap();
    for line in ["@0s Sends.Go()", "@100ms Takes.Go()"] {
        let (time, request) = request::timed(&model, run.types(), line, 1).unwrap().unwrap();
        run.schedule(time, request);
    }
    let mut written = 0;
    while let Some(happening) = run.advance() {
        match happening.what {
            What::Written { .. } => written += 1,
            What::Failed(failure) => panic!("{}", failure.trouble),
            What::Returned { answer, .. } => assert_eq!(Answer::event(&answer), Answer::event("ether")),
            _ => {}
        }
    }
    assert_eq!(written, 5);
    assert_eq!(run.ids("Takes", "sum"), Some(Datum::Float(312.0)));
    assert_eq!(run.ids("Takes", "text"), Some(Datum::Text("lapwing, a longer line, peewit".to_owned())));
}
