//! SafetyPilot's codels, which are in C: the headers are written, the C compiler makes a library of them, and that is loaded.

use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_components::Codels;
use lapwing_genom::Model;
use lapwing_genom::emit::c_files;

/// Compiles the codels into a folder, and loads them.
///
/// # Errors
///
/// What the C compiler said, or why the library cannot be loaded.
pub fn codels(model: &Model, folder: &Path) -> Result<Codels, String> {
    lapwing_codels::load(&compile(model, folder)?, model).map_err(|e| e.to_string())
}

fn compile(model: &Model, folder: &Path) -> Result<PathBuf, String> {
    for file in c_files(model).map_err(|e| e.to_string())? {
        std::fs::write(folder.join(&file.name), &file.text).map_err(|e| format!("{}: {e}", file.name))?;
    }
    let library = folder.join("libSafetyPilot.so");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("codels/safety_pilot.c");
    let mut compiler = Command::new(std::env::var("CC").unwrap_or_else(|_| "cc".to_owned()));
    compiler.args(["-shared", "-fPIC", "-O1", "-Wall", "-Wextra", "-Werror", "-I"]).arg(folder).arg("-o").arg(&library);
    let output = compiler.arg(folder.join("SafetyPilot_glue.c")).arg(source).output();
    let output = output.map_err(|e| format!("the C compiler cannot be run: {e}; set CC to the one that you have"))?;
    match output.status.success() {
        true => Ok(library),
        false => {
            Err(format!("the codels of SafetyPilot cannot be compiled:\n{}", String::from_utf8_lossy(&output.stderr)))
        }
    }
}
