//! What the charts of a recording draw, as JSON for the scripts. Times are seconds from the report's origin.

use lapwing_react::Report;
use lapwing_react::history::{Course, History, Phase, Piece, Plot, Shape, Stand, Track};
use lapwing_react::shown::Origin;
use lapwing_stream::Time;
use serde_json::{Value, json};

/// The significant digits of a value that is drawn.
const DIGITS: usize = 9;

/// All charts of a recording. `histories` are those of its specifications.
pub(crate) fn charts(report: &Report, histories: &[History]) -> Value {
    let origin = Origin::of(report);
    let seconds = Seconds { origin };
    let tracks = histories.iter().flat_map(|h| &h.tracks).map(|t| seconds.track(t));
    let mut courses = Vec::new();
    let mut first = 0;
    for history in histories {
        courses.extend(history.courses.iter().map(|course| (first, course)));
        first += history.tracks.len();
    }
    let properties = report.properties.iter().zip(courses);
    let pieces = histories.first().map_or(&[][..], |h| &h.pieces);
    json!({
        "range": seconds.range(report, pieces),
        "pieces": pieces.iter().map(|p| seconds.piece(p)).collect::<Vec<_>>(),
        "tracks": tracks.collect::<Vec<_>>(),
        "properties": properties.map(|(property, (first, course))| seconds.property(property, course, first)).collect::<Vec<_>>(),
    })
}

/// From when seconds count.
#[derive(Clone, Copy)]
struct Seconds {
    origin: Origin,
}

impl Seconds {
    fn at(self, time: Time) -> Value {
        // To the nanosecond: what is left to a double of a time that counts from the origin is exact enough.
        json!((i128::from(time.0) - i128::from(self.origin.0.0)) as f64 / 1e9)
    }

    fn range(self, report: &Report, pieces: &[Piece]) -> Value {
        let span = match (pieces.first(), pieces.last()) {
            (Some(first), Some(last)) => Some((first.from, last.to)),
            _ => report.span,
        };
        span.map_or(Value::Null, |(from, to)| json!([self.at(from), self.at(to)]))
    }

    fn piece(self, piece: &Piece) -> Value {
        json!([self.at(piece.from), self.at(piece.to), self.at(piece.stamp)])
    }

    fn track(self, track: &Track) -> Value {
        let mut out = json!({ "name": track.name, "unit": track.unit, "thinned": track.is_thinned });
        let (kind, xs, more): (_, Vec<Value>, _) = match &track.shape {
            Shape::Curve(points) => {
                let ys: Vec<Value> = points.iter().map(|(_, y)| number(*y)).collect();
                ("curve", points.iter().map(|(t, _)| self.at(*t)).collect(), json!({ "y": ys }))
            }
            Shape::Steps { changes, labels } => {
                let states: Vec<_> = changes.iter().map(|(_, state)| *state).collect();
                let more = json!({ "states": states, "labels": labels });
                ("steps", changes.iter().map(|(t, _)| self.at(*t)).collect(), more)
            }
            Shape::Ticks(times) => ("ticks", times.iter().map(|t| self.at(*t)).collect(), json!({})),
        };
        out["kind"] = json!(kind);
        out["x"] = json!(xs);
        if let (Value::Object(out), Value::Object(more)) = (&mut out, more) {
            out.extend(more);
        }
        out
    }

    /// A property; its tracks are counted from `first` on.
    fn property(self, property: &lapwing_react::Property, course: &Course, first: usize) -> Value {
        let scopes = property.scopes.iter().zip(&course.scopes).map(|(scope, open)| {
            let open = open.as_ref().map(|open| open.iter().map(|(a, b)| self.stretch(*a, *b)).collect::<Vec<_>>());
            json!({ "name": scope.text, "open": open })
        });
        let marks = course.marks.iter().map(|m| json!([self.at(m.began), self.at(m.failed), self.at(m.until)]));
        json!({
            "name": property.name,
            "text": property.text,
            "verdict": property.verdict.word(),
            "phases": course.phases.iter().map(|p| self.phase(p)).collect::<Vec<_>>(),
            "scopes": scopes.collect::<Vec<_>>(),
            "lanes": course.lanes.iter().map(|t| t + first).collect::<Vec<_>>(),
            "plots": course.plots.iter().map(|p| plot(p, first)).collect::<Vec<_>>(),
            "margin": course.margin.as_ref().map(|m| self.track(m)),
            "marks": marks.take(crate::property::LISTED).collect::<Vec<_>>(),
        })
    }

    fn stretch(self, from: Time, to: Time) -> Value {
        json!([self.at(from), self.at(to)])
    }

    fn phase(self, phase: &Phase) -> Value {
        json!([self.at(phase.from), self.at(phase.to), stand(phase.stand)])
    }
}

fn plot(plot: &Plot, first: usize) -> Value {
    let limits = plot.limits.iter().map(|l| json!([l.value, l.text]));
    json!({
        "tracks": plot.tracks.iter().map(|t| t + first).collect::<Vec<_>>(),
        "limits": limits.collect::<Vec<_>>(),
    })
}

/// What the scripts call it.
fn stand(stand: Stand) -> &'static str {
    match stand {
        Stand::NotStarted => "waiting",
        Stand::Idle => "idle",
        Stand::Holds => "holds",
        Stand::Failed => "violated",
        Stand::Unmet => "unmet",
        Stand::Unknown => "inconclusive",
    }
}

/// A value as it is drawn: a few digits less than a double has take half the room.
fn number(x: f64) -> Value {
    let rounded = format!("{x:.*e}", DIGITS - 1).parse::<f64>().unwrap_or(x);
    json!(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_count_from_the_origin_and_keep_their_nanoseconds() {
        let start = 1_700_000_000_000_000_000_i64;
        let report = Report { span: Some((Time(start), Time(start + 5_000_000_001))), ..Report::default() };
        let data = charts(&report, &[]);
        assert_eq!(data["range"], json!([0.0, 5.000000001]));
    }

    #[test]
    fn values_are_short() {
        assert_eq!(number(0.1 + 0.2).to_string(), "0.3");
        assert_eq!(number(-123456.789012345).to_string(), "-123456.789");
    }
}
