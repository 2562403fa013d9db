//! The distributions as box plots, one drawing for each place: a page with nothing in it but text and SVG.

use std::fmt::Write as _;

use super::boxes::{of_place, shown};
use super::{Box, Place, Times, Way};

/// The drawing, in its own units: where names end, how wide the axis is, how high a row.
const NAMES: f64 = 190.0;
const AXIS: f64 = 620.0;
const ROW: f64 = 24.0;
/// At most so many outliers are drawn of a row: the longest.
const DOTS: usize = 60;

const STYLE: &str = "body{font:15px system-ui,sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#1c2430;background:#fff}\
svg{width:100%;height:auto}text{font-size:12px;fill:currentColor}.grid{stroke:#d5dae1}.box{fill:#7fb2d9;stroke:#1d4f77}.base .box{fill:#c9ced6;stroke:#4b5563}\
.line{stroke:#1d4f77}.base .line{stroke:#4b5563}.median{stroke:#0b1f30;stroke-width:2.5}.dot{fill:none;stroke:#1d4f77;opacity:.5}pre{overflow-x:auto}\
@media(prefers-color-scheme:dark){body{color:#e6e9ee;background:#14181f}.grid{stroke:#39414d}.median{stroke:#fff}}";

/// The page.
pub fn html(measured: &[(Way, Times)]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>What monitoring costs</title><style>{STYLE}</style>\n\
         <h1>What monitoring costs</h1>\n<p>The time of each call at the places where the thesis measured, without what the brick takes. The scale is \
         logarithmic; boxes are quartiles, whiskers reach one and a half times as far, circles are calls beyond.</p>\n"
    );
    for place in Place::ALL {
        let boxes: Vec<(&Way, Box)> = of_place(measured, place).collect();
        let (name, figure) = place.name();
        // Writing to a text does not fail.
        let _ = writeln!(page, "<h2>{name} (figure {figure})</h2>\n{}", drawing(name, &boxes));
    }
    page + "</html>\n"
}

/// A logarithmic axis.
struct Axis {
    from: f64,
    to: f64,
}

impl Axis {
    /// From the power of ten below all of them to the one above.
    fn over(boxes: &[(&Way, Box)]) -> Axis {
        let least = boxes.iter().map(|(_, of)| of.whiskers[0].min(of.outliers.first().copied().unwrap_or(f64::MAX)));
        let longest = boxes.iter().map(|(_, of)| of.longest());
        let (least, longest) = (least.fold(f64::MAX, f64::min).max(1.0), longest.fold(1.0, f64::max));
        Axis { from: least.log10().floor(), to: longest.log10().ceil().max(least.log10().floor() + 1.0) }
    }

    fn x(&self, nanos: f64) -> f64 {
        NAMES + AXIS * (nanos.max(1.0).log10() - self.from) / (self.to - self.from)
    }

    fn powers(&self) -> impl Iterator<Item = f64> {
        (self.from as i32..=self.to as i32).map(|power| 10_f64.powi(power))
    }
}

fn drawing(name: &str, boxes: &[(&Way, Box)]) -> String {
    let axis = Axis::over(boxes);
    let height = ROW * boxes.len() as f64;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Box plots of the time of {name}, by who listens\">",
        NAMES + AXIS + 40.0,
        height + 30.0
    );
    for power in axis.powers() {
        let x = axis.x(power);
        let _ = write!(svg, "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"0\" y2=\"{height}\"/>");
        let _ =
            write!(svg, "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>", height + 16.0, round(power));
    }
    for (row, (way, of)) in boxes.iter().enumerate() {
        svg.push_str(&drawn(&axis, row, way, of));
    }
    svg + "</svg>"
}

/// A power of ten nanoseconds.
fn round(nanos: f64) -> String {
    match nanos {
        ..1e3 => format!("{nanos} ns"),
        ..1e6 => format!("{} µs", nanos / 1e3),
        _ => format!("{} ms", nanos / 1e6),
    }
}

/// A row: name, whiskers, box, median, outliers.
fn drawn(axis: &Axis, row: usize, way: &Way, of: &Box) -> String {
    let y = ROW * (row as f64 + 0.5);
    let [low, high] = of.whiskers.map(|nanos| axis.x(nanos));
    let [first, median, third] = of.quartiles.map(|nanos| axis.x(nanos));
    let class = if *way == Way::Nobody { " class=\"base\"" } else { "" };
    let told = of.quartiles.map(shown).join(", ");
    let mut svg = format!("<g{class}><title>{}: quartiles {told}; {} calls</title>", way.name(), of.count);
    let _ = write!(svg, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>", NAMES - 10.0, y + 4.0, way.name());
    let _ = write!(svg, "<line class=\"line\" x1=\"{low:.1}\" x2=\"{high:.1}\" y1=\"{y}\" y2=\"{y}\"/>");
    let (top, width) = (y - 7.0, (third - first).max(1.0));
    let _ = write!(svg, "<rect class=\"box\" x=\"{first:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"14\"/>");
    let _ = write!(
        svg,
        "<line class=\"median\" x1=\"{median:.1}\" x2=\"{median:.1}\" y1=\"{top}\" y2=\"{}\"/>",
        top + 14.0
    );
    for outlier in of.outliers.iter().rev().take(DOTS) {
        let _ = write!(svg, "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{y}\" r=\"2.5\"/>", axis.x(*outlier));
    }
    svg + "</g>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_has_its_box_at_every_place() {
        let times = |factor: u64| Place::ALL.map(|place| (place, vec![100 * factor, 120 * factor, 90 * factor])).into();
        let measured = [(Way::Nobody, times(1)), (Way::All, times(20))];
        let page = html(&measured);
        assert_eq!(page.matches("<rect class=\"box\"").count(), 2 * Place::ALL.len());
        assert_eq!(page.matches("quartiles 95 ns, 100 ns, 110 ns; 3 calls").count(), Place::ALL.len());
        assert!(!page.contains("NaN") && !page.contains("inf"), "{page}");
    }
}
