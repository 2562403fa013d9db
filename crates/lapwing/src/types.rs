//! The message types that are known without a recording, for the messages that reactions write.

use std::path::PathBuf;
use std::sync::Arc;

use lapwing_check::MessageTypes;
#[cfg(feature = "recordings")]
use lapwing_record::Library;
use lapwing_stream::Schema;

/// The definitions of share trees, and the bundled ones of the common packages. Who reads no recordings has none: messages are then
/// taken as they are written.
pub(crate) struct Known {
    #[cfg(feature = "recordings")]
    library: Library,
}

#[cfg(feature = "recordings")]
impl Known {
    /// Those in the share trees in these folders, and the bundled ones.
    pub fn of(msgs: &[PathBuf]) -> Known {
        Known { library: Library::new(msgs) }
    }
}

#[cfg(feature = "recordings")]
impl MessageTypes for Known {
    fn names(&self) -> Vec<String> {
        self.library.names()
    }

    fn schema(&self, name: &str) -> Option<Arc<Schema>> {
        self.library.installed(name).ok().map(|layout| layout.schema().clone())
    }
}

#[cfg(not(feature = "recordings"))]
impl Known {
    /// None.
    pub fn of(_msgs: &[PathBuf]) -> Known {
        Known {}
    }
}

#[cfg(not(feature = "recordings"))]
impl MessageTypes for Known {
    fn names(&self) -> Vec<String> {
        Vec::new()
    }

    fn schema(&self, _name: &str) -> Option<Arc<Schema>> {
        None
    }
}
