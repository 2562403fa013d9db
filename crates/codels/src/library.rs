//! A shared library in this process: the only module of Lapwing that calls what Rust has not compiled.
//!
//! What it relies on: the functions whose names begin with `lapwing_` are those of the glue that Lapwing has written, which reads no further than
//! the bytes that it is given, and gives back memory that it has allocated itself. What the codels behind it do is theirs.

#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_int, c_uchar};
use std::path::Path;
use std::ptr;

use lapwing_components::{Trouble, TroubleKind};

use crate::{Border, LoadError};

type Interface = unsafe extern "C" fn() -> *const c_char;
type CallFunction = unsafe extern "C" fn(u32, *const c_uchar, usize, *mut *mut c_uchar, *mut usize) -> c_int;
type Free = unsafe extern "C" fn(*mut c_uchar);

/// A library that has been loaded; it stays until the end of the process, since its threads may.
pub struct Library {
    inner: &'static libloading::Library,
}

impl Library {
    /// Loads a library.
    ///
    /// # Errors
    ///
    /// The operating system cannot load it.
    pub fn open(path: &Path) -> Result<Library, LoadError> {
        // A bare name would be looked for in the system's folders.
        let whole = path.canonicalize().map_err(|e| LoadError(format!("{} cannot be read: {e}", path.display())))?;
        // SAFETY: loading runs the library's initialisers, which are the user's code, as its codels are; that they may be run is what the user
        // has asked for by naming the file.
        let loaded = unsafe { libloading::Library::new(&whole) };
        let inner = loaded.map_err(|e| LoadError(format!("{} cannot be loaded: {e}", path.display())))?;
        Ok(Library { inner: Box::leak(Box::new(inner)) })
    }

    /// What the library says of the interface that it was compiled for; `None` where it has no codels of the component.
    pub fn interface(&self, component: &str) -> Option<String> {
        let name = format!("lapwing_interface_{component}\0");
        // SAFETY: a function of that name is the glue's, with that type.
        let function = unsafe { self.inner.get::<Interface>(name.as_bytes()) }.ok()?;
        // SAFETY: it returns a literal, which ends in a zero and is there as long as the library, that is for ever.
        let text = unsafe { CStr::from_ptr(function()) };
        Some(text.to_string_lossy().into_owned())
    }

    /// The codels of a component.
    ///
    /// # Errors
    ///
    /// A function of the glue is not there.
    pub(crate) fn component(&self, name: &str) -> Result<Component, LoadError> {
        let absent = |what: &str| LoadError(format!("the library has no function `{what}_{name}`"));
        let (call_name, free_name) = (format!("lapwing_call_{name}\0"), format!("lapwing_free_{name}\0"));
        // SAFETY: a function of that name is the glue's, with that type, and is there as long as the library, that is for ever.
        let call = unsafe { self.inner.get::<CallFunction>(call_name.as_bytes()) };
        // SAFETY: as above.
        let free = unsafe { self.inner.get::<Free>(free_name.as_bytes()) };
        Ok(Component {
            call: *call.map_err(|_| absent("lapwing_call"))?,
            free: *free.map_err(|_| absent("lapwing_free"))?,
        })
    }
}

/// The codels of a component in a library: who calls them, and who takes back what they have answered.
#[derive(Clone, Copy)]
pub(crate) struct Component {
    call: CallFunction,
    free: Free,
}

impl Border for Component {
    fn cross(&self, codel: u32, call: &[u8]) -> Result<Vec<u8>, Trouble> {
        let (mut answer, mut size) = (ptr::null_mut(), 0);
        // SAFETY: the glue reads `call.len()` bytes from `call`, and sets `answer` and `size` where it returns 0.
        let code = unsafe { (self.call)(codel, call.as_ptr(), call.len(), &raw mut answer, &raw mut size) };
        let why = match code {
            0 => None,
            1 => Some("the library has no such codel"),
            2 => Some("the library cannot read its parameters"),
            _ => Some("there was no memory for the call"),
        };
        if let Some(why) = why {
            return Err(Trouble { kind: TroubleKind::Wrong, message: why.to_owned() });
        }
        if answer.is_null() {
            return Ok(Vec::new());
        }
        // SAFETY: the glue has allocated `size` bytes at `answer`, and written all of them; they are ours until they are freed below.
        let bytes = unsafe { std::slice::from_raw_parts(answer, size) }.to_vec();
        // SAFETY: it is what the glue has allocated, and is not used any more.
        unsafe { (self.free)(answer) };
        Ok(bytes)
    }
}
