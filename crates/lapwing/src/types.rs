//! The message types that are known without a recording, for the messages that reactions write.

use std::sync::Arc;

use lapwing_check::MessageTypes;
use lapwing_record::{Library, bundled_names};
use lapwing_stream::Schema;

/// The bundled definitions of the common packages.
pub(crate) struct Bundled;

impl MessageTypes for Bundled {
    fn names(&self) -> Vec<String> {
        bundled_names().map(str::to_owned).collect()
    }

    fn schema(&self, name: &str) -> Option<Arc<Schema>> {
        Library::default().installed(name).ok().map(|layout| layout.schema().clone())
    }
}
