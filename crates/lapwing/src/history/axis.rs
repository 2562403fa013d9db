//! One axis of time for a recording whose time may jump.

use lapwing_react::history::Piece;
use lapwing_stream::Time;

/// The recording's own time up to the first jump; from there it goes on counting.
#[derive(Clone, Debug, Default)]
pub(super) struct Axis {
    pieces: Vec<Piece>,
}

impl Axis {
    /// Something has this stamp, in the latest piece.
    pub fn see(&mut self, stamp: Time) {
        match self.pieces.last_mut() {
            None => self.pieces.push(Piece { from: stamp, to: stamp, stamp }),
            Some(piece) => piece.to = piece.to.max(place(piece, stamp)),
        }
    }

    /// Time jumped to this stamp: a new piece begins.
    pub fn jump(&mut self, stamp: Time) {
        let from = self.pieces.last().map_or(stamp, |piece| piece.to);
        self.pieces.push(Piece { from, to: from, stamp });
    }

    /// Where a stamp of the latest piece is.
    pub fn now(&self, stamp: Time) -> Time {
        self.pieces.last().map_or(stamp, |piece| place(piece, stamp))
    }

    /// Where a stamp of any piece is.
    pub fn at(&self, piece: usize, stamp: Time) -> Time {
        self.pieces.get(piece).map_or(stamp, |piece| place(piece, stamp))
    }

    /// The number of the latest piece.
    pub fn piece(&self) -> usize {
        self.pieces.len().saturating_sub(1)
    }

    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }
}

fn place(piece: &Piece, stamp: Time) -> Time {
    Time(piece.from.0.saturating_add(stamp.0.saturating_sub(piece.stamp.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_a_jump_the_axis_goes_on() {
        let mut axis = Axis::default();
        [100, 150, 200].iter().for_each(|t| axis.see(Time(*t)));
        assert_eq!(axis.now(Time(150)), Time(150));
        axis.jump(Time(20));
        axis.see(Time(50));
        assert_eq!(
            [axis.now(Time(50)), axis.at(0, Time(150)), axis.at(1, Time(20))],
            [Time(230), Time(150), Time(200)]
        );
        assert_eq!(axis.pieces()[1], Piece { from: Time(200), to: Time(230), stamp: Time(20) });
    }
}
