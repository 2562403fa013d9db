//! Who is shown what happens besides the terminal: a page, metrics, tools of others. None of them can say anything in return.

use lapwing::live::View;
use lapwing_react::Event;

use super::serve::Board;

/// Someone to whom everything is shown.
pub trait Audience {
    /// A new run begins.
    fn begin(&mut self);

    /// Something happened; `json` is the same as a line of JSON.
    fn event(&mut self, event: Event<'_>, json: &str);

    /// How things stand.
    fn look(&mut self, view: &View);
}

impl Audience for Board {
    fn begin(&mut self) {
        Board::begin(self);
    }

    fn event(&mut self, _: Event<'_>, json: &str) {
        Board::event(self, json);
    }

    fn look(&mut self, view: &View) {
        self.view(view);
    }
}
