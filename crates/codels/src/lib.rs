//! Codels in C.
//!
//! A shared library is compiled from codels as GenoM3 has them, and from the glue that [`lapwing_genom::emit::c_files`] writes. What goes over the
//! border are bytes (`wire`), whether the library is in this process (`library`) or in one of its own (`isolated`), where a codel that crashes or
//! hangs takes nothing along.
//!
//! ```text
//! Call ──wire──▶ bytes ──▶ glue, in C ──▶ codel          in this process
//!                  └─socket─▶ serve ──▶ glue ──▶ codel    in another
//! ```

#![warn(missing_docs)]

mod library;
mod wire;

#[cfg(unix)]
mod isolated;
#[cfg(unix)]
mod serve;

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use lapwing_components::{Answer, Call, Codel, Codels, Trouble, TroubleKind};
use lapwing_genom::Model;
use lapwing_genom::emit::{c_codels, fingerprint};

pub use library::Library;
pub use wire::{read_answer, write_call};

#[cfg(unix)]
pub use isolated::Isolation;
#[cfg(unix)]
pub use serve::serve;

/// Why the codels of a library cannot be used.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LoadError(pub String);

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for LoadError {}

/// The frames of a conversation with another process, as far as it can be understood.
#[cfg(unix)]
pub fn frames(from: &mut impl std::io::Read) -> Vec<Vec<u8>> {
    std::iter::from_fn(|| isolated::read_frame(from).ok()).collect()
}

/// Where the bytes of a call go, and those of its answer come from.
trait Border: Send + Sync {
    fn cross(&self, codel: u32, call: &[u8]) -> Result<Vec<u8>, Trouble>;
}

/// A codel beyond a border.
struct CCodel {
    border: Arc<dyn Border>,
    number: u32,
}

impl Codel for CCodel {
    fn call(&self, call: &mut Call) -> Result<Answer, Trouble> {
        let mut bytes = Vec::new();
        wire::write_call(call, &mut bytes).map_err(Trouble::wrong)?;
        let answer = self.border.cross(self.number, &bytes)?;
        wire::read_answer(call, &answer).map_err(|why| Trouble {
            kind: TroubleKind::Wrong,
            message: format!("what `{}` has answered cannot be understood: {why}", call.function),
        })
    }
}

/// The codels of a library, in this process: one that crashes ends it.
///
/// # Errors
///
/// The library cannot be loaded, has no codels of these components, or was compiled for another specification.
pub fn load(path: &Path, model: &Model) -> Result<Codels, LoadError> {
    let library = Library::open(path)?;
    let mut codels = Codels::new();
    for component in &model.components {
        if has_codels(&library, model, component, path)? {
            let border: Arc<dyn Border> = Arc::new(library.component(&component.name)?);
            add(&mut codels, component, &border);
        }
    }
    found(codels, path)
}

/// The codels of a library, those of each component in a process of its own.
///
/// # Errors
///
/// As for [`load`], or a process cannot be started.
#[cfg(unix)]
pub fn isolate(path: &Path, model: &Model, isolation: &Isolation) -> Result<Codels, LoadError> {
    // What the library has is asked in the first process that is started, for loading it may run code of its own.
    let mut codels = Codels::new();
    for component in model.components.iter().filter(|c| !c_codels(c).is_empty()) {
        let process = isolated::Process::start(isolation, path, &component.name)?;
        let Some(print) = process.interface() else { continue };
        expect(model, component, path, print)?;
        let border: Arc<dyn Border> = Arc::new(process);
        add(&mut codels, component, &border);
    }
    found(codels, path)
}

fn has_codels(
    library: &Library,
    model: &Model,
    component: &lapwing_genom::model::Component,
    path: &Path,
) -> Result<bool, LoadError> {
    match library.interface(&component.name) {
        None => Ok(false),
        Some(print) => expect(model, component, path, &print).map(|()| true),
    }
}

fn expect(
    model: &Model,
    component: &lapwing_genom::model::Component,
    path: &Path,
    print: &str,
) -> Result<(), LoadError> {
    let wanted = fingerprint(model, component).map_err(|e| LoadError(e.to_string()))?;
    if wanted == print {
        return Ok(());
    }
    let name = &component.name;
    Err(LoadError(format!(
        "{} was compiled for another specification of `{name}`: write its headers again by `lapwing genom headers`, and compile it",
        path.display()
    )))
}

fn add(codels: &mut Codels, component: &lapwing_genom::model::Component, border: &Arc<dyn Border>) {
    for (number, codel) in c_codels(component) {
        codels.add(&component.name, &codel.function, Arc::new(CCodel { border: border.clone(), number }));
    }
}

fn found(codels: Codels, path: &Path) -> Result<Codels, LoadError> {
    if codels.names().next().is_some() {
        return Ok(codels);
    }
    Err(LoadError(format!(
        "{} has no codels of these components: compile the files that `lapwing genom headers` writes into it",
        path.display()
    )))
}
