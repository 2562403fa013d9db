//! A backtest for people.

use lapwing_diag::Style;
use lapwing_stream::Value;

use super::{Backtest, Mark, Record, Tuned, histogram};
use crate::shown::{cell, count};
use crate::text::Paint;

/// The width of the longest bar, in characters.
const WIDEST: usize = 30;

/// So many recordings are named where a property fired.
const NAMED: usize = 5;

/// How often each property fired and by how much it missed, then what was never exercised, then the value that was searched for.
pub fn text(backtest: &Backtest, style: Style) -> String {
    let paint = Paint(style);
    let mut out = paint.heading(&heading(backtest)) + "\n";
    for record in &backtest.properties {
        out += &one(backtest, record, paint);
    }
    let idle: Vec<&str> =
        backtest.properties.iter().filter(|p| p.tested_in.is_empty()).map(|p| p.name.as_str()).collect();
    if !idle.is_empty() {
        out += &format!("\n{} {}\n", paint.doubt("Never exercised:"), idle.join(", "));
        out += "  nothing in these recordings put them to the test, or they could not be judged\n";
    }
    for run in backtest.runs.iter().filter(|r| !r.gaps.is_empty()) {
        out += &format!("\n{}: not everything was looked at: {}\n", run.trace, run.gaps.join("; "));
    }
    if let Some(tuned) = &backtest.tuned {
        out += &format!("\n{}", self::tuned(tuned, paint));
    }
    out
}

fn heading(backtest: &Backtest) -> String {
    let (good, bad) = (backtest.marked(Mark::Good), backtest.marked(Mark::Bad));
    let marks = if good + bad > 0 { format!(" ({good} marked good, {bad} bad)") } else { String::new() };
    let runs = count(backtest.runs.len() as u64, "recording", "recordings");
    format!("{} on {runs}{marks}", backtest.specs.join(", "))
}

fn one(backtest: &Backtest, record: &Record, paint: Paint) -> String {
    let runs = backtest.runs.len();
    let fired = match record.fired_in.len() {
        0 => "never fired".to_owned(),
        n => {
            let alarms = count(record.alarms as u64, "alarm", "alarms");
            paint.alarm(&format!("fired in {n} of {runs}, {alarms}"))
        }
    };
    let mut parts = vec![fired, format!("exercised in {}", record.tested_in.len())];
    if !record.open_in.is_empty() {
        parts.push(paint.doubt(&format!("not judged in {}", record.open_in.len())));
    }
    let mut out = format!("\n{}: {}\n", paint.heading(&record.name), parts.join("; "));
    let named = record.fired_in.iter().take(NAMED).filter_map(|n| backtest.runs.get(*n));
    named.for_each(|run| out += &format!("  in {}{}\n", run.trace, marked(run.mark)));
    let more = record.fired_in.len().saturating_sub(NAMED);
    if more > 0 {
        out += &format!("  and {more} more\n");
    }
    out + &margins(record)
}

fn marked(mark: Mark) -> &'static str {
    match mark {
        Mark::Good => " (good)",
        Mark::Bad => " (bad)",
        Mark::Unmarked => "",
    }
}

fn margins(record: &Record) -> String {
    let bars = histogram(&record.margins);
    let most = bars.iter().map(|b| b.count).max().unwrap_or(0).max(1);
    let shown = |x: f64| cell(&Value::Num(x));
    let edges: Vec<String> = bars.iter().map(|b| format!("{} to {}", shown(b.from), shown(b.to))).collect();
    let width = edges.iter().map(|e| e.chars().count()).max().unwrap_or(0);
    let line = |(bar, edge): (&super::Bar, &String)| {
        let length = (bar.count * WIDEST).div_ceil(most);
        format!("    {edge:>width$}  {}\n", format!("{} {}", "#".repeat(length), bar.count).trim_start())
    };
    match bars.is_empty() {
        true => String::new(),
        false => format!("  margins (below 0 it failed):\n{}", bars.iter().zip(&edges).map(line).collect::<String>()),
    }
}

fn tuned(tuned: &Tuned, paint: Paint) -> String {
    let unit = tuned.unit.as_ref().map(|u| format!(" {u}")).unwrap_or_default();
    let value = |x: f64| format!("{x}{unit}");
    let (good, bad) = tuned.marked;
    let name = &tuned.name;
    let current = tuned.current;
    let mut out = paint.heading(&format!("{name} = {}:", value(current.value)));
    out += &format!(
        " an alarm in {} of {}, {} of {} caught (judged by {})\n",
        current.false_alarms,
        count(good as u64, "good recording", "good recordings"),
        bad - current.missed.min(bad),
        count(bad as u64, "bad one", "bad ones"),
        tuned.properties.join(", ")
    );
    let (from, to) = tuned.searched;
    match tuned.fits {
        Some((smallest, largest)) => {
            out += &format!(
                "The smallest {name} with no alarm on what is good while all that is bad is caught: {}\n",
                paint.heading(&value(smallest.value))
            );
            let open = if largest.value >= to { "; larger ones were not tried" } else { "" };
            out += &format!("Everything up to {} fits{open}.\n", value(largest.value));
        }
        None => {
            out += &paint.alarm(&format!("No {name} from {} to {} fits.", value(from), value(to)));
            out += " What each of them does:\n";
            for tried in &tuned.tried {
                out += &format!(
                    "  {:>12}  {} in what is good, {} missed\n",
                    value(tried.value),
                    count(tried.false_alarms as u64, "alarm", "alarms"),
                    tried.missed
                );
            }
        }
    }
    out
}
