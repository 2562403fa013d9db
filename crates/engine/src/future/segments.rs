//! The segments in which formulas stand: opened and closed by scopes, position by position.

use serde::{Deserialize, Serialize};

use crate::node::View;
use crate::pack::packed;
use crate::program::{Context, ContextKind};
use crate::times::Pos;

/// Where a context stands after a position.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Segment {
    /// Whether a segment is open: the position, if it closed none, belongs to it.
    pub open: bool,
    /// Whether the latest position belongs to a segment.
    pub active: bool,
    /// Whether it is the first of its segment.
    pub first: bool,
    /// Whether a segment closed just before it.
    pub closes: bool,
    /// Whether it was the scope's own X or Y that closed it, and not the end of the segment around it.
    pub closed_by_own: bool,
    /// The first position of the latest segment, and its stamp.
    pub start: Pos,
    pub start_stamp: i64,
    /// Whether this context can have no further segment inside the current segment of its parent.
    pub spent: bool,
}

packed!(Segment { open, active, first, closes, closed_by_own, start, start_stamp, spent });

/// Takes position `n` into all contexts, the outer before the inner. Returns whether any segment closed.
pub(crate) fn step_segments(contexts: &[Context], segments: &mut [Segment], n: Pos, view: &View<'_>) -> bool {
    let mut any_closed = false;
    for i in 0..contexts.len() {
        let (outer, rest) = segments.split_at_mut(i);
        let segment = &mut rest[0];
        match contexts[i].kind {
            ContextKind::Whole => {
                segment.first = !segment.open;
                (segment.open, segment.active) = (true, true);
            }
            kind => step_inner(segment, kind, &outer[contexts[i].parent as usize], view),
        }
        if segment.first {
            (segment.start, segment.start_stamp) = (n, view.now);
        }
        any_closed |= segment.closes;
    }
    any_closed
}

/// One inner context: which of its own conditions hold only matters inside a segment of the parent.
fn step_inner(segment: &mut Segment, kind: ContextKind, parent: &Segment, view: &View<'_>) {
    let was_open = segment.open;
    segment.closes = was_open && parent.closes;
    segment.closed_by_own = false;
    segment.first = false;
    if parent.first || segment.closes {
        segment.spent = false;
    }
    let was_open = was_open && !segment.closes;
    let open = parent.active
        && match kind {
            ContextKind::Whole => true,
            ContextKind::After { x } => was_open || view.bool(x),
            ContextKind::Until { x, again } => {
                let here = !view.bool(x);
                let may = here && (again || !segment.spent);
                segment.spent |= !here;
                may
            }
            ContextKind::AfterUntil { x, y } => {
                let closing = view.bool(y);
                !closing && (was_open || view.bool(x))
            }
            ContextKind::While { x } => view.bool(x),
        };
    if was_open && !open {
        segment.closes = true;
        segment.closed_by_own = parent.active;
    }
    segment.first = open && !was_open;
    if let ContextKind::After { .. } = kind {
        segment.spent |= open;
    }
    (segment.open, segment.active) = (open, open);
}
