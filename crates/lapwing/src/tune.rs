//! Which value of a named number or duration fits recordings that are marked good and bad.

use std::path::Path;

use lapwing_react::backtest::Tried;
use lapwing_syntax::ast::{Expr, ExprKind, ItemKind, Number};
use lapwing_syntax::{FileId, parse};

use crate::spec::{Spec, SpecError};

/// The first round looks at the value in the specification times these powers of two.
const POWERS: std::ops::RangeInclusive<i32> = -10..=10;

/// So many values lie between two in the rounds that follow.
const BETWEEN: usize = 15;

/// So many rounds follow: the result is exact to a part in some thousands.
const ROUNDS: usize = 3;

/// A number or duration that a specification gives a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Tunable {
    /// The name.
    pub name: String,
    /// Its value, in its unit.
    pub value: f64,
    /// Its unit, as written.
    pub unit: Option<String>,
    /// Where it stands in the text of the specification.
    place: std::ops::Range<usize>,
}

impl Tunable {
    /// Finds a name in a specification; an error says why it cannot be tuned.
    pub fn find(spec: &Spec, name: &str) -> Result<Tunable, String> {
        let (_, text) = spec.texts().next().unwrap_or_default();
        let mut known = Vec::new();
        for item in parse(FileId(0), text).file.items {
            let ItemKind::Definition(definition) = item.kind else { continue };
            let number = literal(&definition.body);
            if definition.name.name != name {
                known.extend(number.map(|_| definition.name.name));
                continue;
            }
            let Some((value, number)) = number else {
                return Err(format!(
                    "`{name}` is computed: give the number that is to be tuned a name of its own, as in `{name} = 0.3`"
                ));
            };
            if value == 0.0 {
                return Err(format!("`{name}` is zero: give it a value to begin with"));
            }
            let place = definition.body.span.start as usize..definition.body.span.end as usize;
            let unit = number.unit.map(|u| u.name().to_owned());
            return Ok(Tunable { name: name.to_owned(), value, unit, place });
        }
        let names =
            if known.is_empty() { "it names no number".to_owned() } else { format!("there are {}", known.join(", ")) };
        Err(format!("{} has no `{name} = …`: {names}", spec.name()))
    }

    /// The specification with another value, under a name of its own. Files that it uses are looked for beside it.
    pub fn with(&self, spec: &Spec, value: f64, label: &str) -> Result<Spec, SpecError> {
        let (name, text) = spec.texts().next().unwrap_or_default();
        let unit = self.unit.as_ref().map(|u| format!(" {u}")).unwrap_or_default();
        let number = plain(value);
        let text = format!("{}{number}{unit}{}", &text[..self.place.start], &text[self.place.end..]);
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        Spec::parse(label, &text, &|used| std::fs::read_to_string(folder.join(used)).ok())
    }

    /// The lines of the properties that depend on it, in whatever way.
    pub fn lines(&self, spec: &Spec) -> Vec<usize> {
        let (_, text) = spec.texts().next().unwrap_or_default();
        let items = parse(FileId(0), text).file.items;
        let mut names = vec![self.name.clone()];
        let mut lines = Vec::new();
        // Each round finds what depends on what the round before found.
        for _ in 0..=items.len() {
            let before = names.len();
            for item in &items {
                let source = text.get(item.span.start as usize..item.span.end as usize).unwrap_or_default();
                if !words(source).any(|word| names.iter().any(|n| n == word)) {
                    continue;
                }
                let line = text[..item.span.start as usize].matches('\n').count() + 1;
                if !lines.contains(&line) {
                    lines.push(line);
                }
                let own = match &item.kind {
                    ItemKind::Definition(d) => Some(&d.name.name),
                    ItemKind::Property(p) => p.name.as_ref().map(|n| &n.name),
                    ItemKind::Pattern(p) => Some(&p.name.name),
                    ItemKind::Machine(m) => Some(&m.name.name),
                    ItemKind::Event(e) => Some(&e.name.name),
                    _ => None,
                };
                if let Some(own) = own.filter(|own| !names.contains(own)) {
                    names.push(own.clone());
                }
            }
            if names.len() == before {
                break;
            }
        }
        lines
    }
}

/// The number that an expression is, with the sign that may stand before it.
fn literal(body: &Expr) -> Option<(f64, &Number)> {
    match &body.kind {
        ExprKind::Number(number) => Some((number.value, number)),
        ExprKind::Neg(operand) => match &operand.kind {
            ExprKind::Number(number) => Some((-number.value, number)),
            _ => None,
        },
        _ => None,
    }
}

/// The words of a text that may be names.
fn words(source: &str) -> impl Iterator<Item = &str> {
    source
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default())
        .flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_'))
        .filter(|word| !word.is_empty())
}

/// A number as a specification writes it: in decimals, with nine digits that count.
fn plain(value: f64) -> String {
    let digits = (8 - value.abs().log10().floor() as i32).clamp(0, 17) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// What came of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// The smallest value that fits, and the largest.
    pub fits: Option<(Tried, Tried)>,
    /// What the values of the first round did.
    pub tried: Vec<Tried>,
}

/// Searches around a value. `judge` says of several values, in ascending order, what each of them does.
///
/// Between two neighbours of the first round, which differ by a factor of two, verdicts are taken to change at most once.
pub fn search<E>(current: f64, mut judge: impl FnMut(&[f64]) -> Result<Vec<Tried>, E>) -> Result<Search, E> {
    let mut grid: Vec<f64> = POWERS.map(|power| current * f64::powi(2.0, power)).collect();
    grid.sort_by(f64::total_cmp);
    let mut tried = judge(&grid)?;
    let first_round = tried.clone();
    if !tried.iter().any(Tried::fits) {
        // Between a value that alarms too often and one that misses something there may be one that does neither.
        for _ in 0..ROUNDS {
            let Some(gap) = tried.windows(2).position(|pair| is_crossing(&pair[0], &pair[1])) else { break };
            let points = between(tried[gap].value, tried[gap + 1].value);
            let inner = judge(&points)?;
            tried.splice(gap + 1..gap + 1, inner);
        }
    }
    let (Some(first), Some(last)) = (tried.iter().position(Tried::fits), tried.iter().rposition(Tried::fits)) else {
        return Ok(Search { fits: None, tried: first_round });
    };
    let smallest = match first {
        0 => tried[0],
        _ => edge(tried[first - 1].value, tried[first], &mut judge)?,
    };
    let largest = match tried.get(last + 1) {
        None => tried[last],
        Some(beyond) => edge(beyond.value, tried[last], &mut judge)?,
    };
    Ok(Search { fits: Some((smallest, largest)), tried: first_round })
}

/// Whether one of the two alarms on what is good and the other misses what is bad.
fn is_crossing(a: &Tried, b: &Tried) -> bool {
    let only = |x: &Tried, y: &Tried| x.false_alarms > 0 && x.missed == 0 && y.false_alarms == 0 && y.missed > 0;
    only(a, b) || only(b, a)
}

fn between(from: f64, to: f64) -> Vec<f64> {
    (1..=BETWEEN).map(|k| from + (to - from) * k as f64 / (BETWEEN + 1) as f64).collect()
}

/// The value nearest to `beyond`, which does not fit, that does, with few digits where such a one fits.
fn edge<E>(beyond: f64, fitting: Tried, judge: &mut impl FnMut(&[f64]) -> Result<Vec<Tried>, E>) -> Result<Tried, E> {
    let (mut beyond, mut fitting) = (beyond, fitting);
    for _ in 0..ROUNDS {
        let is_below = beyond < fitting.value;
        let mut points = between(beyond.min(fitting.value), beyond.max(fitting.value));
        let mut judged = judge(&points)?;
        if !is_below {
            points.reverse();
            judged.reverse();
        }
        match judged.iter().position(Tried::fits) {
            Some(at) => {
                beyond = if at == 0 { beyond } else { points[at - 1] };
                fitting = judged[at];
            }
            None => beyond = points[BETWEEN - 1],
        }
    }
    let tries = [shortest(beyond, fitting.value), round(fitting.value, beyond < fitting.value)];
    let judged = judge(&tries)?;
    Ok(judged.into_iter().find(Tried::fits).unwrap_or(fitting))
}

/// The number with the fewest digits between a value that does not fit and one that does.
fn shortest(beyond: f64, fitting: f64) -> f64 {
    let magnitude = fitting.abs().log10().floor() as i32;
    let rounded = |digits: i32| {
        let scale = f64::powi(10.0, digits - 1 - magnitude);
        let scaled = fitting * scale;
        (if beyond < fitting { scaled.floor() } else { scaled.ceil() }) / scale
    };
    let lies_between = |x: &f64| (beyond < *x && *x <= fitting) || (fitting <= *x && *x < beyond);
    (1..=9).map(rounded).find(lies_between).unwrap_or(fitting)
}

/// To four digits that count, up or down.
fn round(value: f64, up: bool) -> f64 {
    let scale = f64::powi(10.0, 3 - value.abs().log10().floor() as i32);
    let scaled = value * scale;
    // What is a round number but for the last bits stays it.
    let nearest = scaled.round();
    let whole = match () {
        () if (scaled - nearest).abs() < 1e-6 => nearest,
        () if up => scaled.ceil(),
        () => scaled.floor(),
    };
    whole / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Alarms on what is good below `quiet`, misses what is bad from `deaf` on.
    fn searched(current: f64, quiet: f64, deaf: f64) -> Option<(f64, f64)> {
        let judge = |values: &[f64]| -> Result<Vec<Tried>, ()> {
            let one = |&value: &f64| Tried {
                value,
                false_alarms: usize::from(value < quiet),
                missed: usize::from(value >= deaf),
            };
            Ok(values.iter().map(one).collect())
        };
        search(current, judge).unwrap().fits.map(|(a, b)| (a.value, b.value))
    }

    #[test]
    fn the_smallest_and_the_largest_value_that_fit_are_found() {
        let (smallest, largest) = searched(100.0, 40.0, 160.0).unwrap();
        assert!(smallest == 40.0 && (159.0..160.0).contains(&largest), "{smallest} {largest}");
        // They lie between two neighbours of the first round.
        let (smallest, largest) = searched(100.0, 120.0, 121.0).unwrap();
        assert!((120.0..120.5).contains(&smallest) && (120.5..121.0).contains(&largest), "{smallest} {largest}");
        // Below zero the smallest value is the one that is farthest from it.
        let (smallest, largest) = searched(-100.0, -121.0, -40.0).unwrap();
        assert!((-121.0..-120.5).contains(&smallest) && (-40.5..-40.0).contains(&largest), "{smallest} {largest}");
        assert_eq!(searched(100.0, 130.0, 110.0), None);
        let (smallest, largest) = searched(1.0, 0.0, f64::INFINITY).unwrap();
        assert_eq!((smallest, largest), (1.0 / 1024.0, 1024.0));
    }

    #[test]
    fn names_are_found_with_what_depends_on_them() {
        let text = "limit = 0.3\ngap = 100 ms  # limit\nfast = v > limit\ncalm: never fast\n\
                    property slow: whenever v > 1,\n    eventually within gap v < 1\nnever w > 2\ntwice = limit * 2\n";
        let spec = Spec::parse("t.rv", text, &|_| None).unwrap();
        let limit = Tunable::find(&spec, "limit").unwrap();
        assert_eq!((limit.value, limit.unit.as_deref(), limit.lines(&spec)), (0.3, None, vec![1, 3, 4, 8]));
        let gap = Tunable::find(&spec, "gap").unwrap();
        assert_eq!((gap.value, gap.unit.as_deref(), gap.lines(&spec)), (100.0, Some("ms"), vec![2, 5]));
        let other = gap.with(&spec, 12.5, "t.rv, 12.5").unwrap();
        assert!(other.texts().next().unwrap().1.contains("gap = 12.5 ms  # limit\n"));
        let below = Spec::parse("t.rv", "low = -3 m  # low\nnever x < low\n", &|_| None).unwrap();
        let low = Tunable::find(&below, "low").unwrap();
        assert_eq!((low.value, low.unit.as_deref(), low.lines(&below)), (-3.0, Some("m"), vec![1, 2]));
        for (value, written) in [(-1.5, "low = -1.5 m  # low\n"), (2.0, "low = 2 m  # low\n")] {
            let other = low.with(&below, value, "t.rv").unwrap();
            assert!(other.texts().next().unwrap().1.starts_with(written), "{value}");
        }
        assert!(Tunable::find(&spec, "twice").unwrap_err().contains("is computed"));
        assert!(Tunable::find(&spec, "limt").unwrap_err().contains("there are limit, gap"));
    }

    #[test]
    fn numbers_are_written_in_decimals_and_rounded_to_few_digits() {
        assert_eq!([0.1, 1e-7, 123456.75, 40.0].map(plain), ["0.1", "0.0000001", "123456.75", "40"]);
        assert_eq!([round(40.031, true), round(40.031, false), round(0.12, true)], [40.04, 40.03, 0.12]);
        assert_eq!([shortest(39.98, 40.004), shortest(161.2, 159.8), shortest(0.2, 0.3)], [40.0, 160.0, 0.3]);
    }
}
