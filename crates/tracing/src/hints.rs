//! What a function or a field that nobody has seen was perhaps meant to be.
//!
//! Most often it is there under another module than the specification says: methods that stand in the module `robot` are called `robot::play`, whatever
//! the type is called that they belong to.

use lapwing_diag::suggest::nearest;
use tracing::Metadata;

/// The end of a message: a function that was seen and is called alike, with its place; nothing where there is none.
pub(crate) fn function(wanted: &str, known: &[&'static Metadata<'static>]) -> String {
    let spans = known.iter().filter(|m| m.is_span());
    let functions = spans.map(|m| Seen { name: format!("{}::{}", m.target(), m.name()), site: m });
    told(wanted, "::", functions.collect())
}

/// The same for a field.
pub(crate) fn field(wanted: &str, known: &[&'static Metadata<'static>]) -> String {
    let fields = known.iter().flat_map(|m| {
        let name = |field: tracing::field::Field| format!("{}.{}", m.target(), field.name());
        m.fields().iter().map(name).map(|name| Seen { name, site: m })
    });
    told(wanted, ".", fields.collect())
}

/// A function or a field that was seen.
struct Seen {
    /// With the modules around it.
    name: String,
    site: &'static Metadata<'static>,
}

fn told(wanted: &str, joint: &str, seen: Vec<Seen>) -> String {
    let last = |name: &str| name.rsplit(joint).next().map(str::to_owned);
    let of_that_name = seen.iter().find(|s| last(&s.name) == last(wanted));
    let parts = wanted.split(joint).count();
    let written = |s: &Seen| tail(&s.name, parts).join(joint);
    let like_it = || {
        let all: Vec<String> = seen.iter().map(written).collect();
        let near = nearest(wanted, all.iter().map(String::as_str))?;
        seen.iter().find(|s| written(s) == near)
    };
    of_that_name.or_else(like_it).map_or_else(String::new, |s| {
        let place = s.site.file().zip(s.site.line()).map(|(file, line)| format!(" ({file}:{line})"));
        format!("; `{}` was seen{}", s.name, place.unwrap_or_default())
    })
}

/// The last parts of a name, of which its modules are as many as it takes.
fn tail(name: &str, parts: usize) -> Vec<&str> {
    let all: Vec<&str> = name.split("::").flat_map(|part| part.split('.')).collect();
    all[all.len().saturating_sub(parts)..].to_vec()
}
