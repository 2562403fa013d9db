//! Literate tests: Markdown in which specifications, traces and verdicts stand side by side, run in every home.
//!
//! A fence `rv` begins a case. The fences after it, up to the next `rv` or heading, say what is expected of it:
//!
//! - `csv`, `ndjson` or `trace` (either of them): a trace; `verdicts` behind it says what comes out.
//! - `errors`: what is found in the specification, and in the trace before it if there is one: a line `code: "source text"` each.
//!
//! A line of `verdicts` is `NAME: VERDICT [met/failed/open] [failed@T [began@T] [until@T] [xN]]… [vacuous] ["part of the cause"]`,
//! times in seconds; `began` and `until` are `failed` and N is 1 where they are left out; `#` begins a comment. What is left out of
//! a line is not compared, but for episodes and `vacuous`.

use std::fmt::Write as _;
use std::path::Path;

use lapwing::{Options, Session, Spec};
use lapwing_check::checked::{self, EventSource, Step};
use lapwing_check::compile::compile;
use lapwing_check::{Checked, TraceShape, TraceTopic};
use lapwing_diag::{Diagnostic, Severity};
use lapwing_record::{Cells, Format, Item, Part, Recording, Signal, Wanted};
use lapwing_reference::{Arrival, Trace};
use lapwing_stream::{Time, Verdict};

use crate::agree::{self, Drive};

/// A specification, and what is expected of it.
#[derive(Clone, Debug)]
pub struct Case {
    /// The file that it stands in.
    pub file: String,
    /// The line of its specification, from 1.
    pub line: usize,
    /// The heading above it.
    pub heading: String,
    /// The specification.
    pub spec: String,
    /// The code after `error=` of the fence.
    pub error: Option<String>,
    /// What follows.
    pub parts: Vec<Fence>,
}

/// A block of text between fences.
#[derive(Clone, Debug)]
pub struct Fence {
    /// What stands behind the opening fence.
    pub info: String,
    /// The text.
    pub text: String,
    /// The line of its first line, from 1.
    pub line: usize,
}

/// What is expected of a property, or was said of it.
#[derive(Clone, PartialEq, Debug)]
struct Line {
    name: String,
    verdict: Verdict,
    counts: Option<(usize, usize, usize)>,
    /// `(failed, began, until, count)`
    episodes: Vec<(Time, Time, Time, usize)>,
    vacuous: bool,
    cause: Option<String>,
}

/// The cases of a Markdown text.
pub fn cases(file: &str, text: &str) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    let mut heading = String::new();
    let mut open: Option<Fence> = None;
    let mut attached = false;
    for (number, line) in text.lines().enumerate() {
        match &mut open {
            Some(fence) if line.trim_end() == "```" => {
                let fence = std::mem::replace(fence, Fence { info: String::new(), text: String::new(), line: 0 });
                open = None;
                let mut words = fence.info.split_whitespace();
                if words.next() == Some("rv") {
                    attached = true;
                    cases.push(Case {
                        file: file.to_owned(),
                        line: fence.line,
                        heading: heading.clone(),
                        spec: fence.text,
                        error: words.find_map(|w| w.strip_prefix("error=")).map(str::to_owned),
                        parts: Vec::new(),
                    });
                } else if let (true, Some(case)) = (attached && is_part(&fence.info), cases.last_mut()) {
                    case.parts.push(fence);
                }
            }
            Some(fence) => {
                fence.text.push_str(line);
                fence.text.push('\n');
            }
            None if line.starts_with("```") => {
                let info = line.trim_start_matches('`').trim().to_owned();
                open = Some(Fence { info, text: String::new(), line: number + 2 });
            }
            None if line.starts_with('#') => {
                heading = line.trim_start_matches('#').trim().to_owned();
                attached = false;
            }
            None => {}
        }
    }
    cases
}

fn is_part(info: &str) -> bool {
    is_trace(info) || info == "verdicts" || info == "errors"
}

fn is_trace(info: &str) -> bool {
    matches!(info, "csv" | "ndjson" | "trace")
}

/// Runs a case. Gives what is wrong, one text each.
pub fn run(case: &Case, folder: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut trace: Option<&Fence> = None;
    let has_errors = case.error.is_some() || case.parts.iter().any(|p| p.info == "errors");
    if !has_errors {
        let loud: Vec<String> = findings(&case.spec, None, Severity::Error);
        wrong.extend(loud.into_iter().map(|e| format!("{}: {e}", place(case, case.line))));
    }
    if let Some(code) = &case.error {
        let found = findings(&case.spec, None, Severity::Note);
        if !found.iter().any(|f| f.starts_with(&format!("{code}: "))) {
            wrong.push(format!("{}: {code} was expected, found {found:?}", place(case, case.line)));
        }
    }
    for part in &case.parts {
        match part.info.as_str() {
            "verdicts" => match trace {
                None => wrong.push(format!("{}: no trace stands before these verdicts", place(case, part.line))),
                Some(trace) => wrong.extend(verdicts(case, trace, part, folder)),
            },
            "errors" => {
                let shape = trace.and_then(|t| shape(&write(t, folder).ok()?));
                let found = findings(&case.spec, shape.as_ref(), Severity::Note);
                let expected: Vec<&str> = part.text.lines().filter(|l| !l.is_empty()).collect();
                if found != expected {
                    let (found, expected) = (found.join("\n  "), expected.join("\n  "));
                    wrong.push(format!("{}: expected\n  {expected}\nfound\n  {found}", place(case, part.line)));
                }
            }
            _ => trace = Some(part),
        }
    }
    wrong
}

/// The traces of a case on which verdicts are expected, each with the specification as it is checked against it.
pub fn runs(case: &Case, folder: &Path) -> Vec<(checked::Spec, Trace)> {
    let mut runs = Vec::new();
    let mut last: Option<&Fence> = None;
    for part in &case.parts {
        match (part.info.as_str(), last) {
            ("verdicts", Some(fence)) => runs.extend(run_of(case, fence, folder)),
            ("verdicts" | "errors", _) => {}
            _ => last = Some(part),
        }
    }
    runs
}

fn run_of(case: &Case, fence: &Fence, folder: &Path) -> Option<(checked::Spec, Trace)> {
    let path = write(fence, folder).ok()?;
    let recording = lapwing_record::open(&path, lapwing_record::Options::default()).ok()?;
    let spec = checked(&case.spec, &shape_of(&recording))?.spec;
    let trace = trace(&spec, recording).ok()?;
    Some((spec, trace))
}

fn place(case: &Case, line: usize) -> String {
    format!("{}:{line}: {}", case.file, case.heading)
}

/// What is found in a specification, from that severity on: `code: "source text"`.
fn findings(text: &str, shape: Option<&TraceShape>, least: Severity) -> Vec<String> {
    let (sources, mut diagnostics) = match Spec::parse("case.rv", text, &|_| None) {
        Err(lapwing::SpecError::Wrong(findings)) => (findings.sources, findings.diagnostics),
        Err(_) => return vec!["unreadable".to_owned()],
        Ok(spec) => (spec.findings().sources.clone(), spec.findings().diagnostics.clone()),
    };
    if let Some(checked) = shape.and_then(|shape| checked(text, shape)) {
        diagnostics.extend(checked.beyond(&diagnostics.clone()).cloned());
    }
    let one = |d: &Diagnostic| format!("{}: {:?}", d.code.name(), sources.slice(d.primary.span));
    diagnostics.iter().filter(|d| d.severity <= least).map(one).collect()
}

/// A specification against the shape of a trace; `None` where it cannot be used.
fn checked(text: &str, shape: &TraceShape) -> Option<Checked> {
    Some(Spec::parse("case.rv", text, &|_| None).ok()?.against(shape))
}

/// The trace as a file.
fn write(trace: &Fence, folder: &Path) -> std::io::Result<std::path::PathBuf> {
    let is_lines = trace.text.trim_start().starts_with('{');
    let path = folder.join(if is_lines { "trace.ndjson" } else { "trace.csv" });
    std::fs::write(&path, &trace.text)?;
    Ok(path)
}

fn shape(path: &Path) -> Option<TraceShape> {
    Some(shape_of(&lapwing_record::open(path, lapwing_record::Options::default()).ok()?))
}

fn shape_of(recording: &Recording) -> TraceShape {
    let topics = recording.topics().iter().map(|topic| TraceTopic {
        name: format!("/{}", topic.name.trim_start_matches('/')),
        type_name: topic.type_name.clone(),
        schema: topic.schema.as_ref().ok().cloned(),
    });
    TraceShape {
        topics: topics.collect(),
        columns: recording.columns().iter().map(|c| c.to_string()).collect(),
        schemaless: recording.is_schemaless(),
        columns_open: recording.format() == Format::Ndjson,
        events: recording.events().iter().map(|e| e.to_string()).collect(),
        ..TraceShape::default()
    }
}

/// Compares what every home says of a case with what is written down.
fn verdicts(case: &Case, trace: &Fence, expected: &Fence, folder: &Path) -> Vec<String> {
    let mut wanted = Vec::new();
    let mut wrong = Vec::new();
    for (number, line) in expected.text.lines().enumerate() {
        match parse_line(line) {
            Ok(Some(line)) => wanted.push(line),
            Ok(None) => {}
            Err(why) => wrong.push(format!("{}: {why}", place(case, expected.line + number))),
        }
    }
    let path = match write(trace, folder) {
        Ok(path) => path,
        Err(error) => return vec![format!("{}: {error}", place(case, trace.line))],
    };
    for (home, said) in homes(&case.spec, &path) {
        match said {
            Err(why) => wrong.push(format!("{}: {home}: {why}", place(case, expected.line))),
            Ok(said) if matches(&wanted, &said) => {}
            Ok(said) => {
                let mut text = format!("{}: {home}\n", place(case, expected.line));
                for line in &wanted {
                    let _ = writeln!(text, "  expected  {}", show(line));
                }
                for line in &said {
                    let _ = writeln!(text, "  said      {}", show(line));
                }
                wrong.push(text);
            }
        }
    }
    wrong
}

fn matches(wanted: &[Line], said: &[Line]) -> bool {
    let one = |(w, s): (&Line, &Line)| {
        let cause = match (&w.cause, &s.cause) {
            (Some(part), Some(whole)) => whole.contains(part.as_str()),
            _ => true,
        };
        let counts = w.counts.is_none() || w.counts == s.counts;
        w.name == s.name
            && w.verdict == s.verdict
            && counts
            && w.episodes == s.episodes
            && w.vacuous == s.vacuous
            && cause
    };
    wanted.len() == said.len() && wanted.iter().zip(said).all(one)
}

/// What the homes say.
fn homes(text: &str, path: &Path) -> Vec<(&'static str, Result<Vec<Line>, String>)> {
    let options = lapwing_record::Options::default();
    let recording = match lapwing_record::open(path, options) {
        Ok(recording) => recording,
        Err(error) => return vec![("the recording", Err(error.to_string()))],
    };
    let shape = shape_of(&recording);
    let Some(checked) = checked(text, &shape) else {
        return vec![("the check", Err("the specification has errors".to_owned()))];
    };
    let spec = checked.spec;
    let trace = match trace(&spec, recording) {
        Ok(trace) => trace,
        Err(why) => return vec![("the recording", Err(why))],
    };
    let program = compile(&spec);
    let lines = |said: Vec<agree::Said>| Ok(said.into_iter().map(line_of_said).collect());
    let (library, printed) = match session(text, path) {
        Ok((library, printed)) => (Ok(library), Ok(printed)),
        Err(why) => (Err(why.clone()), Err(why)),
    };
    vec![
        ("the reference", lines(agree::reference(&spec, &trace))),
        ("the engine with margins", lines(agree::engine(&program, &trace, Drive::Measured))),
        ("the engine", lines(agree::engine(&program, &trace, Drive::Plain))),
        ("the engine from saved states", lines(agree::engine(&program, &trace, Drive::Saved))),
        ("the library", library),
        ("the printed report", printed),
    ]
}

fn line_of_said(said: agree::Said) -> Line {
    let agree::Said { name, verdict, vacuous, counts, episodes, margin: _ } = said;
    Line { name, verdict, counts: Some(counts), episodes, vacuous, cause: None }
}

/// What the library says, and what `lapwing check --format json` prints of it.
fn session(text: &str, path: &Path) -> Result<(Vec<Line>, Vec<Line>), String> {
    let spec = [Spec::parse("case.rv", text, &|_| None).map_err(|e| e.to_string())?];
    let report = Session::open(&spec, path, &Options::default()).map_err(|e| e.to_string())?.run(&mut ());
    let printed = lapwing_react::render(&report, lapwing_react::Format::Json, lapwing_diag::Style::Plain);
    let line = |p: lapwing_react::Property| Line {
        name: p.name,
        verdict: p.verdict,
        counts: Some((p.obligations.met as usize, p.obligations.failed as usize, p.obligations.open as usize)),
        episodes: p.violations.iter().map(|v| (v.failed, v.began, v.until, v.count as usize)).collect(),
        vacuous: p.vacuous,
        cause: p.cause,
    };
    Ok((report.properties.into_iter().map(line).collect(), printed_lines(&printed)?))
}

/// The properties of a printed report.
fn printed_lines(printed: &str) -> Result<Vec<Line>, String> {
    let report: serde_json::Value = serde_json::from_str(printed).map_err(|e| e.to_string())?;
    let properties = report["properties"].as_array().ok_or("no properties are printed")?;
    properties
        .iter()
        .map(|p| printed_line(p).ok_or_else(|| format!("a property without what belongs to it: {p}")))
        .collect()
}

fn printed_line(property: &serde_json::Value) -> Option<Line> {
    let count = |name: &str| Some(property["obligations"][name].as_u64()? as usize);
    let episode = |v: &serde_json::Value| {
        let time = |name: &str| v[name].as_i64().map(Time);
        Some((time("failed_ns")?, time("began_ns")?, time("until_ns")?, v["count"].as_u64()? as usize))
    };
    Some(Line {
        name: property["name"].as_str()?.to_owned(),
        verdict: verdict(property["verdict"].as_str()?)?,
        counts: Some((count("met")?, count("failed")?, count("open")?)),
        episodes: property["violations"].as_array()?.iter().map(episode).collect::<Option<_>>()?,
        vacuous: property["vacuous"].as_bool()?,
        cause: property["cause"].as_str().map(str::to_owned),
    })
}

/// A recording as the trace of one specification.
fn trace(spec: &checked::Spec, recording: Recording) -> Result<Trace, String> {
    let wanted: Vec<Wanted> = spec
        .topics
        .iter()
        .map(|t| Wanted { topic: t.name.clone(), fields: t.fields.iter().map(path).collect() })
        .collect();
    let mut reader = recording.read(&wanted);
    let mut trace = Trace::default();
    while let Some(item) = reader.next() {
        let item = item.map_err(|e| e.to_string())?;
        trace.samples.push((item.time(), arrival(spec, &item)));
    }
    match reader.losses() {
        [] => Ok(trace),
        losses => Err(format!("the trace cannot be read whole: {losses:?}")),
    }
}

fn path(path: &checked::Path) -> lapwing_record::Path {
    lapwing_record::Path::new(path.iter().map(|step| match step {
        Step::Field(name) => Part::Name(name.as_str().into()),
        Step::Index(index) => Part::Index(*index),
    }))
}

fn arrival(spec: &checked::Spec, item: &Item<'_>) -> Arrival {
    let named = |cells: &Cells<'_>, name: &str| Signal::new(name).find_in(*cells).unwrap_or_default().into_owned();
    match item {
        Item::Message { wanted: Some(topic), values, .. } => {
            Arrival::Message { topic: *topic, values: values.to_vec() }
        }
        Item::Message { .. } => Arrival::Other,
        Item::Row { cells, .. } => Arrival::Row { cells: spec.columns.iter().map(|c| named(cells, c)).collect() },
        Item::Event { name, fields, .. } => {
            let is_it =
                |e: &checked::Event| matches!(e.source, EventSource::Named | EventSource::Point(_)) && e.name == **name;
            let Some(event) = spec.events.iter().position(is_it) else { return Arrival::Other };
            let follow = |way: &checked::Path| named(fields, &path(way).to_string());
            Arrival::Event { event, values: spec.events[event].fields.iter().map(|f| follow(&f.path)).collect() }
        }
    }
}

/// A line of `verdicts`; `None` for an empty one.
fn parse_line(line: &str) -> Result<Option<Line>, String> {
    let (line, cause) = match line.split_once('"') {
        Some((before, rest)) => (before, Some(rest.split_once('"').ok_or("a quote is not closed")?.0.to_owned())),
        None => (line.split('#').next().unwrap_or_default(), None),
    };
    if line.trim().is_empty() {
        return Ok(None);
    }
    let (name, rest) = line.split_once(':').ok_or_else(|| format!("no colon in `{line}`"))?;
    let mut words = rest.split_whitespace();
    let verdict = words.next().and_then(verdict).ok_or_else(|| format!("no verdict in `{line}`"))?;
    let mut said =
        Line { name: name.trim().to_owned(), verdict, counts: None, episodes: Vec::new(), vacuous: false, cause };
    for word in words {
        let wrong = || format!("`{word}` is not understood");
        if word == "vacuous" {
            said.vacuous = true;
        } else if let Some(time) = word.strip_prefix("failed@") {
            let time = seconds(time).ok_or_else(wrong)?;
            said.episodes.push((time, time, time, 1));
        } else if let Some((met, rest)) = word.split_once('/') {
            let (failed, open) = rest.split_once('/').ok_or_else(wrong)?;
            let number = |text: &str| text.parse().map_err(|_| wrong());
            said.counts = Some((number(met)?, number(failed)?, number(open)?));
        } else {
            let episode = said.episodes.last_mut().ok_or_else(wrong)?;
            if let Some(time) = word.strip_prefix("began@") {
                episode.1 = seconds(time).ok_or_else(wrong)?;
            } else if let Some(time) = word.strip_prefix("until@") {
                episode.2 = seconds(time).ok_or_else(wrong)?;
            } else if let Some(count) = word.strip_prefix('x') {
                episode.3 = count.parse().map_err(|_| wrong())?;
            } else {
                return Err(wrong());
            }
        }
    }
    Ok(Some(said))
}

fn verdict(word: &str) -> Option<Verdict> {
    let all = [Verdict::Violated, Verdict::Inconclusive, Verdict::Unmet, Verdict::Holds, Verdict::Satisfied];
    all.into_iter().find(|v| v.word() == word)
}

/// Decimal seconds, exactly.
fn seconds(text: &str) -> Option<Time> {
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    let nanos = format!("{part:0<9}");
    if nanos.len() > 9 {
        return None;
    }
    Some(Time(whole.parse::<i64>().ok()? * 1_000_000_000 + nanos.parse::<i64>().ok()?))
}

fn show(line: &Line) -> String {
    let seconds = |time: Time| {
        let text = format!("{}.{:09}", time.0.div_euclid(1_000_000_000), time.0.rem_euclid(1_000_000_000));
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    let mut text = format!("{}: {}", line.name, line.verdict);
    if let Some((met, failed, open)) = line.counts {
        let _ = write!(text, " {met}/{failed}/{open}");
    }
    for (failed, began, until, count) in &line.episodes {
        let _ = write!(text, " failed@{}", seconds(*failed));
        if began != failed {
            let _ = write!(text, " began@{}", seconds(*began));
        }
        if until != failed {
            let _ = write!(text, " until@{}", seconds(*until));
        }
        if *count != 1 {
            let _ = write!(text, " x{count}");
        }
    }
    if line.vacuous {
        text.push_str(" vacuous");
    }
    if let Some(cause) = &line.cause {
        let _ = write!(text, " {cause:?}");
    }
    text
}

/// The Markdown files below a folder, in order.
pub fn pages(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<_> = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            found.extend(pages(&path));
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
    found
}
