//! The other process: it loads the library, and calls codels as it is told on the socket that is its standard input.

use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::thread;

use crate::Border;
use crate::isolated::{lock, read_frame, write_frame};
use crate::library::Library;

/// Serves the codels of a component until nobody asks any more. Returns whether it could.
pub fn serve(library: &Path, component: &str) -> bool {
    let Ok(socket) = std::io::stdin().as_fd().try_clone_to_owned().map(UnixStream::from) else { return false };
    let Ok(mut from) = socket.try_clone() else { return false };
    let to = Arc::new(Mutex::new(socket));
    let found = Library::open(library).and_then(|library| match library.interface(component) {
        Some(print) => Ok(Some((print, library.component(component)?))),
        None => Ok(None),
    });
    let (codels, hello) = match found {
        Ok(Some((print, codels))) => (Some(codels), format!("has {print}")),
        Ok(None) => (None, "none".to_owned()),
        Err(error) => (None, format!("error {error}")),
    };
    write_frame(&mut lock(&to), hello.as_bytes());
    // Who has asked for codels that are not here asks no more.
    let Some(codels) = codels else { return false };
    while let Ok(frame) = read_frame(&mut from) {
        let Some((number, rest)) = frame.split_first_chunk::<8>() else { return false };
        let Some((codel, call)) = rest.split_first_chunk::<4>() else { return false };
        let (number, codel, call) = (*number, u32::from_ne_bytes(*codel), call.to_vec());
        let to = to.clone();
        // Codels of different tasks run at the same time; who asks sees to it that those of one do not.
        let work = move || {
            let (kind, bytes) = match codels.cross(codel, &call) {
                Ok(answer) => (0, answer),
                Err(trouble) => (1, trouble.message.into_bytes()),
            };
            let mut frame = number.to_vec();
            frame.push(kind);
            frame.extend(bytes);
            write_frame(&mut lock(&to), &frame);
        };
        if thread::Builder::new().spawn(work).is_err() {
            return false;
        }
    }
    true
}
