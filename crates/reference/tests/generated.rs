//! Generated cases: every one is a valid specification, and what is true of all traces is true of them.

use lapwing_check::checked::{Clock, Spec};
use lapwing_check::{TraceShape, check, load};
use lapwing_diag::SourceMap;
use lapwing_reference::generate::{self, Case, exhaustive};
use lapwing_reference::{Arrival, Outcome, Trace, evaluate};
use lapwing_stream::{Time, Verdict};

/// Parses and checks a text; the errors in words where there are any.
fn checked(text: &str, shape: &TraceShape) -> Result<Spec, String> {
    let mut sources = SourceMap::default();
    let file = sources.add("case.rv", text);
    let parsed = lapwing_syntax::parse(file, text);
    let loaded = load(&mut sources, parsed.file, &|_| None);
    let checked = check(&sources, &loaded, Some(shape));
    let errors: Vec<String> = parsed
        .diagnostics
        .iter()
        .chain(&checked.diagnostics)
        .filter(|d| d.severity == lapwing_diag::Severity::Error)
        .map(|d| format!("{} at `{}`", d.message, sources.slice(d.primary.span)))
        .collect();
    if errors.is_empty() { Ok(checked.spec) } else { Err(errors.join("\n")) }
}

fn seeds() -> impl Iterator<Item = Case> {
    (0..400).map(|seed| generate::generate(seed, 24))
}

fn spec_of(case: &Case) -> Spec {
    checked(&case.text(), &case.shape).unwrap_or_else(|errors| panic!("{errors}\n\n{}", case.text()))
}

#[test]
fn every_case_is_a_valid_specification() {
    for case in seeds() {
        let spec = spec_of(&case);
        assert!(spec.properties.len() >= case.properties.len(), "{}", case.text());
        for property in &spec.properties {
            assert_eq!(property.problem, None, "{}", case.text());
        }
    }
}

#[test]
fn counts_and_verdicts_agree() {
    let mut verdicts = Vec::new();
    for case in seeds() {
        let spec = spec_of(&case);
        for outcome in evaluate(&spec, &case.trace(&spec)) {
            let counted: usize = outcome.episodes.iter().map(|e| e.count).sum();
            assert_eq!(outcome.failed, counted, "{}", case.text());
            assert_eq!(outcome.verdict == Verdict::Violated, outcome.failed > 0, "{}", case.text());
            assert_eq!(outcome.cause.is_some(), outcome.verdict == Verdict::Inconclusive, "{}", case.text());
            for episode in &outcome.episodes {
                assert!(episode.began <= episode.failed && episode.failed <= episode.until, "{}", case.text());
            }
            verdicts.push(outcome.verdict);
        }
    }
    // The cases are worth something only if they come out in all ways.
    for verdict in [Verdict::Violated, Verdict::Inconclusive, Verdict::Unmet, Verdict::Holds, Verdict::Satisfied] {
        let share = verdicts.iter().filter(|v| **v == verdict).count() * 100 / verdicts.len();
        assert!(share >= 1, "{verdict}: {share} %");
    }
}

/// What does not depend on when the trace begins.
fn shifted(outcomes: &[Outcome], by: i64) -> String {
    let mut all = outcomes.to_vec();
    for episode in all.iter_mut().flat_map(|o| &mut o.episodes) {
        for time in [&mut episode.began, &mut episode.failed, &mut episode.until] {
            time.0 -= by;
        }
    }
    format!("{all:?}")
}

#[test]
fn nothing_depends_on_when_the_trace_begins() {
    for case in seeds().take(150) {
        let spec = spec_of(&case);
        let trace = case.trace(&spec);
        let by = 12_345_678_901;
        let samples = trace.samples.iter().map(|(t, a)| (Time(t.0 + by), a.clone())).collect();
        let later = Trace { samples, ..trace.clone() };
        assert_eq!(shifted(&evaluate(&spec, &trace), 0), shifted(&evaluate(&spec, &later), by), "{}", case.text());
    }
}

#[test]
fn what_failed_in_the_recording_failed_live_by_then_and_stays() {
    for case in seeds().take(200) {
        let spec = spec_of(&case);
        let whole = case.trace(&spec);
        if whole.samples.windows(2).any(|w| w[1].0 < w[0].0) {
            continue;
        }
        let at_the_end = evaluate(&spec, &whole);
        for length in 1..whole.samples.len() {
            let begun = Trace { samples: whole.samples[..length].to_vec(), ..whole.clone() };
            let now = whole.samples[length - 1].0;
            // An instant of a rate waits for all samples with its stamp.
            if matches!(spec.clock, Clock::Rate(_)) && whole.samples[length].0 == now {
                continue;
            }
            for live in evaluate(&spec, &begun) {
                let Some(end) = at_the_end.iter().find(|o| o.name == live.name) else { continue };
                let surely: usize = end.episodes.iter().filter(|e| e.until < now).map(|e| e.count).sum();
                let shown = || format!("{}\nafter {length} samples {live:?}\nat the end {end:?}", case.text());
                assert!(live.failed <= end.failed, "{}", shown());
                assert!(live.failed >= surely, "{}", shown());
                assert!(
                    live.verdict != Verdict::Satisfied || end.verdict == Verdict::Satisfied || blind(end),
                    "{}",
                    shown()
                );
            }
        }
    }
}

/// Silence can make inconclusive what was satisfied before.
fn blind(outcome: &Outcome) -> bool {
    outcome.verdict == Verdict::Inconclusive
}

#[test]
fn every_short_formula_is_judged_on_every_short_trace() {
    let text = exhaustive::text(3);
    let shape = TraceShape { columns: vec!["p".into(), "q".into()], schemaless: true, ..TraceShape::default() };
    let spec = checked(&text, &shape).unwrap_or_else(|errors| panic!("{errors}"));
    for rows in exhaustive::traces(3) {
        let case = Case {
            statements: vec![],
            properties: vec![],
            samples: exhaustive::samples(&rows),
            broke_off: None,
            shape: shape.clone(),
        };
        let trace = case.trace(&spec);
        assert!(trace.samples.iter().all(|(_, a)| *a != Arrival::Other));
        let outcomes = evaluate(&spec, &trace);
        assert_eq!(outcomes.len(), exhaustive::formulas(3).len());
        // Position by position: `never p` and `always not p` in any words agree, `after` and `whenever` are never unmet here.
        assert!(outcomes.iter().all(|o| o.verdict != Verdict::Inconclusive));
    }
}
