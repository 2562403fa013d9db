//! What is drawn, as it goes.

use lapwing_engine::inputs::Inputs;
use lapwing_react::history::{Shape, Track};
use lapwing_stream::{Time, Value};

use super::curve::Curve;
use super::plan::{Source, Wanted};
use super::steps::Steps;
use crate::eval;
use crate::witness::Now;

/// The longest text that is shown of a value, in characters.
const LONGEST: usize = 40;

/// How everything that is drawn went so far.
#[derive(Debug)]
pub(super) struct Tracks {
    tracks: Vec<Noted>,
    most: usize,
}

/// How one thing went.
#[derive(Debug)]
enum Noted {
    /// It had no value so far.
    Nothing,
    Curve(Curve),
    Steps(Steps),
    Ticks(Curve),
}

impl Tracks {
    /// Keeps at most so many buckets of each.
    pub fn new(wanted: &[Wanted], most: usize) -> Tracks {
        let noted = |w: &Wanted| match w.source {
            Source::Event(_) => Noted::Ticks(Curve::new(most)),
            _ => Noted::Nothing,
        };
        Tracks { tracks: wanted.iter().map(noted).collect(), most }
    }

    /// An instant is over.
    pub fn instant(&mut self, inputs: &Inputs, now: Time, wanted: &[Wanted]) {
        let most = self.most;
        for (track, wanted) in self.tracks.iter_mut().zip(wanted) {
            match &wanted.source {
                Source::Expr(expr) => {
                    if let Some(value) = eval::eval(expr, &Now(inputs)) {
                        track.note(&value, now, most);
                    }
                }
                Source::Machine(machine, labels) => {
                    let state = inputs.state(*machine).and_then(|s| labels.get(s)).map_or("undefined", String::as_str);
                    track.step(state, now, most);
                }
                Source::Event(event) => {
                    if let (Noted::Ticks(ticks), Some(_)) = (track, inputs.event(*event)) {
                        ticks.push(now, 0.0);
                    }
                }
            }
        }
    }

    /// What reads this track fails now.
    pub fn keep(&mut self, track: usize) {
        if let Some(Noted::Curve(curve)) = self.tracks.get_mut(track) {
            curve.keep();
        }
    }

    /// Whether it came as numbers.
    pub fn is_curve(&self, track: usize) -> bool {
        matches!(self.tracks.get(track), Some(Noted::Curve(_)))
    }

    /// All of it, and whether there was more of it; values last until the end.
    pub fn finish(self, end: Option<Time>, wanted: &[Wanted]) -> Vec<Track> {
        let track = |(noted, wanted): (Noted, &Wanted)| {
            let (shape, is_thinned) = noted.shape(end);
            Track { name: wanted.name.clone(), unit: wanted.unit.clone(), shape, is_thinned }
        };
        self.tracks.into_iter().zip(wanted).map(track).collect()
    }
}

impl Noted {
    fn note(&mut self, value: &Value, now: Time, most: usize) {
        match value {
            Value::Num(x) => {
                if let Noted::Nothing = self {
                    *self = Noted::Curve(Curve::new(most));
                }
                if let Noted::Curve(curve) = self {
                    curve.push(now, *x);
                }
            }
            Value::Bool(b) => self.step(if *b { "true" } else { "false" }, now, most),
            Value::Str(text) => self.step(&text.chars().take(LONGEST).collect::<String>(), now, most),
            _ => {}
        }
    }

    fn step(&mut self, label: &str, now: Time, most: usize) {
        if let Noted::Nothing = self {
            *self = Noted::Steps(Steps::new(most));
        }
        if let Noted::Steps(steps) = self {
            steps.push(now, label);
        }
    }

    fn shape(self, end: Option<Time>) -> (Shape, bool) {
        match self {
            Noted::Nothing => (Shape::Curve(Vec::new()), false),
            Noted::Curve(curve) => {
                let (mut points, is_thinned) = curve.points();
                if let (Some(end), Some(&(last, value))) = (end, points.last())
                    && last < end
                {
                    points.push((end, value));
                }
                (Shape::Curve(points), is_thinned)
            }
            Noted::Steps(steps) => {
                let shape = Shape::Steps { changes: steps.changes().to_vec(), labels: steps.labels().to_vec() };
                (shape, steps.is_thinned())
            }
            Noted::Ticks(ticks) => {
                let (points, is_thinned) = ticks.points();
                (Shape::Ticks(points.into_iter().map(|(time, _)| time).collect()), is_thinned)
            }
        }
    }
}
