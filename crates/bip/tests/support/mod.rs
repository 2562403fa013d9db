//! What the tests share: models from text, and runs whose log is kept.

#![allow(dead_code)]

pub mod large;

use lapwing_bip::{
    Checked, Detail, Engine, FileId, Host, Log, Model, Monotonic, Options, Pace, Policy, Rules, Run, Schedule,
    Simulated, Sink, check, parse, standard,
};
use lapwing_diag::{Diagnostic, SourceMap, Style, render};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// How a model is run.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    pub seed: u64,
    pub asap: bool,
    pub real_time: bool,
    pub silent: bool,
    pub all: bool,
    pub warn: bool,
    pub limit: Option<u64>,
}

impl Setting {
    pub fn read(words: &str) -> Setting {
        let mut setting = Setting { seed: 1, ..Setting::default() };
        for word in words.split_whitespace() {
            match word {
                "asap" => setting.asap = true,
                "real-time" => setting.real_time = true,
                "silent" => setting.silent = true,
                "all" => setting.all = true,
                "warn" => setting.warn = true,
                other => match other.strip_prefix("limit=") {
                    Some(limit) => setting.limit = limit.parse().ok(),
                    None => panic!("`{other}` is no word for a run"),
                },
            }
        }
        setting
    }

    pub fn options(&self) -> Options {
        Options {
            schedule: Schedule { asap: self.asap, first_enabled: false },
            seed: self.seed,
            limit: self.limit,
            rules: Rules { without_maximal_progress: self.all },
            // The machine may be busy with other tests.
            tolerance: 40_000_000,
            relaxed: false,
        }
    }
}

/// What came of a run.
pub struct Outcome {
    pub log: String,
    pub code: u8,
}

impl Outcome {
    /// The lines of the log, without what they all begin with.
    pub fn lines(&self) -> Vec<&str> {
        self.log.lines().map(|l| l.strip_prefix("[BIP ENGINE]: ").unwrap_or(l)).collect()
    }
}

pub fn checked(name: &str, text: &str) -> (Checked, SourceMap) {
    let mut sources = SourceMap::default();
    let file = sources.add(name, text);
    let parsed = parse(file, text);
    let mut checked = check(&parsed.package, &[]);
    let mut all = parsed.diagnostics;
    all.append(&mut checked.diagnostics);
    checked.diagnostics = all;
    (checked, sources)
}

pub fn shown(sources: &SourceMap, diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().map(|d| render(sources, d, Style::Plain)).collect()
}

/// A model that has no fault.
pub fn model(name: &str, text: &str) -> Arc<Model> {
    let (checked, sources) = checked(name, text);
    match checked.model(None) {
        Ok(model) => Arc::new(model),
        Err(diagnostics) => panic!("{name}:\n{}", shown(&sources, &diagnostics)),
    }
}

pub fn run(name: &str, text: &str, setting: &Setting) -> Outcome {
    let model = model(name, text);
    let buffer = Rc::new(RefCell::new(Vec::new()));
    let sink: Sink<'_> = buffer.clone();
    let pace = if setting.real_time { Pace::RealTime } else { Pace::Simulated };
    let host = standard(&sink, pace).bind(&model).unwrap_or_else(|d| panic!("{name}: {d:?}"));
    let detail = if setting.silent { Detail::Silent } else { Detail::Verbose };
    let log = Log::new(sink, detail);
    let policy = if setting.warn { Policy::Warn } else { Policy::Stop };
    let ending = match setting.real_time {
        true => Run::new(setting.options(), Monotonic::start(), log).policy(policy).run(model, host),
        false => Run::new(setting.options(), Simulated::default(), log).policy(policy).run(model, host),
    };
    let log = String::from_utf8_lossy(&buffer.borrow()).into_owned();
    Outcome { log, code: ending.code() }
}

/// An engine with the standard functions, whose output nobody sees.
pub fn engine(text: &str) -> Engine<impl Host + use<>> {
    let model = model("a model", text);
    let sink: Sink<'static> = Rc::new(RefCell::new(std::io::sink()));
    let host = standard(&sink, Pace::Simulated).bind(&model).unwrap_or_else(|d| panic!("{d:?}"));
    Engine::new(model, host, Rules::default()).unwrap_or_else(|f| panic!("{f}"))
}

/// Whether a text is as a pattern says, in which `*` stands for anything.
pub fn matches(pattern: &str, text: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or("");
    let Some(mut rest) = text.strip_prefix(first) else { return false };
    let mut last = None;
    for part in parts {
        if let Some(part) = last.replace(part) {
            match rest.find(part) {
                Some(at) => rest = &rest[at + str::len(part)..],
                None => return false,
            }
        }
    }
    match last {
        None => rest.is_empty(),
        Some(end) => rest.ends_with(end),
    }
}

/// Where a diagnostic is: for tests that look at it.
pub const FILE: FileId = FileId(0);
