//! Ports of arrays and texts: codels in C have the address of their first element, and what they write comes back.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_codels::load;
use lapwing_components::{Answer, Datum, Run, Setup, What, request};
use lapwing_genom::model::Model;
use lapwing_genom::{Files, Options, emit};
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

struct Text;

impl Files for Text {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Ok(COMPONENT.as_bytes().to_vec())
    }
}

fn model() -> Model {
    let loaded = lapwing_genom::load(&Text, &[PathBuf::from("c.gen")], &Options::default()).unwrap();
    assert!(!loaded.has_errors());
    loaded.model
}

/// A library of a component's codels, in a folder.
fn compiled(folder: &Path, component: &str, text: &str) -> PathBuf {
    std::fs::write(folder.join(format!("{component}.c")), text).unwrap();
    let library = format!("lib{component}.so");
    let mut compiler = Command::new("cc");
    compiler.current_dir(folder).args(["-shared", "-fPIC", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror"]);
    compiler.args(["-o", &library, &format!("{component}_glue.c"), &format!("{component}.c")]);
    let output = compiler.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(library)
}

#[test]
fn arrays_and_texts_go_through_ports() {
    let model = std::sync::Arc::new(model());
    let folder = tempfile::tempdir().unwrap();
    for file in emit::c_files(&model).unwrap() {
        std::fs::write(folder.path().join(file.name), file.text).unwrap();
    }
    let mut codels = load(&compiled(folder.path(), "Sends", SENDS), &model).unwrap();
    codels.join(load(&compiled(folder.path(), "Takes", TAKES), &model).unwrap());
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
