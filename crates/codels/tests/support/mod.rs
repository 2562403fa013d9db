//! Components of a text, and libraries of their codels that a C compiler makes.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_genom::model::Model;
use lapwing_genom::{Files, Options, emit};

struct Text(&'static str);

impl Files for Text {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Ok(self.0.as_bytes().to_vec())
    }
}

/// The model of a specification.
pub fn model(specification: &'static str) -> Model {
    let loaded = lapwing_genom::load(&Text(specification), &[PathBuf::from("c.gen")], &Options::default()).unwrap();
    assert!(!loaded.has_errors());
    loaded.model
}

/// Writes what codels in C are compiled with.
pub fn write_glue(model: &Model, folder: &Path) {
    for file in emit::c_files(model).unwrap() {
        std::fs::write(folder.join(file.name), file.text).unwrap();
    }
}

/// The library of a component's codels, in the folder with its glue.
pub fn compiled(folder: &Path, component: &str, codels: &str) -> PathBuf {
    std::fs::write(folder.join(format!("{component}.c")), codels).unwrap();
    let library = format!("lib{component}.so");
    let mut compiler = Command::new("cc");
    compiler.current_dir(folder).args(["-shared", "-fPIC", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror"]);
    compiler.args(["-o", &library, &format!("{component}_glue.c"), &format!("{component}.c")]);
    let output = compiler.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(library)
}
