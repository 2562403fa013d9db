//! Who is shown what happens besides the terminal: a page, metrics, tools of others. None of them can say anything in return.

use lapwing::live::View;
use lapwing_react::Event;

/// Someone to whom everything is shown.
pub trait Audience {
    /// A new run begins.
    fn begin(&mut self);

    /// Something happened; `json` is the same as a line of JSON.
    fn event(&mut self, event: Event<'_>, json: &str);

    /// How things stand.
    fn look(&mut self, view: &View);
}
