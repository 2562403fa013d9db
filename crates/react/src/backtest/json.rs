//! A backtest as JSON.

use serde_json::{Value, json};

use super::{Backtest, Mark, Record, Tried, Tuned, histogram};
use crate::json::number;

/// One object, with its newline.
pub fn json(backtest: &Backtest) -> String {
    let runs = backtest
        .runs
        .iter()
        .map(|r| json!({ "trace": r.trace, "mark": mark(r.mark), "alarms": r.alarms, "gaps": r.gaps }));
    let object = json!({
        "lapwing": 1,
        "spec": backtest.specs,
        "recordings": runs.collect::<Vec<_>>(),
        "properties": backtest.properties.iter().map(|p| record(backtest, p)).collect::<Vec<_>>(),
        "tune": backtest.tuned.as_ref().map(tuned),
    });
    format!("{object}\n")
}

fn record(backtest: &Backtest, record: &Record) -> Value {
    let traces = |numbers: &[usize]| -> Vec<&str> {
        numbers.iter().filter_map(|n| backtest.runs.get(*n)).map(|r| r.trace.as_str()).collect()
    };
    let margins = record.margins.iter().filter_map(|(run, margin)| {
        Some(json!({ "trace": backtest.runs.get(*run)?.trace, "margin": number(*margin) }))
    });
    let bars = histogram(&record.margins).into_iter();
    json!({
        "name": record.name, "file": record.file, "line": record.line,
        "alarms": record.alarms,
        "fired_in": traces(&record.fired_in),
        "inconclusive_in": traces(&record.open_in),
        "exercised_in": traces(&record.tested_in),
        "margins": margins.collect::<Vec<_>>(),
        "histogram": bars.map(|b| json!({ "from": b.from, "to": b.to, "count": b.count })).collect::<Vec<_>>(),
    })
}

fn tuned(tuned: &Tuned) -> Value {
    json!({
        "name": tuned.name, "unit": tuned.unit, "properties": tuned.properties,
        "good": tuned.marked.0, "bad": tuned.marked.1,
        "current": tried(&tuned.current),
        "smallest": tuned.fits.map(|(smallest, _)| smallest.value),
        "largest": tuned.fits.map(|(_, largest)| largest.value),
        "searched": { "from": tuned.searched.0, "to": tuned.searched.1 },
        "tried": tuned.tried.iter().map(tried).collect::<Vec<_>>(),
    })
}

fn tried(tried: &Tried) -> Value {
    json!({ "value": tried.value, "false_alarms": tried.false_alarms, "missed": tried.missed })
}

fn mark(mark: Mark) -> Value {
    match mark {
        Mark::Good => json!("good"),
        Mark::Bad => json!("bad"),
        Mark::Unmarked => Value::Null,
    }
}
