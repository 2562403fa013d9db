//! Components as texts, and runs of them.

#![allow(dead_code)]

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lapwing_components::{Codels, Happening, Observer, Run, Setup, Teller, What, request};
use lapwing_diag::{SourceMap, Style, render};
use lapwing_genom::{Files, Model, Options, load};
use lapwing_stream::Duration;

/// Files that are only texts.
struct Texts(BTreeMap<PathBuf, String>);

impl Files for Texts {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(path).map(|t| t.clone().into_bytes()).ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

/// A specification without errors.
pub fn model(text: &str) -> (Arc<Model>, SourceMap) {
    let texts = Texts(BTreeMap::from([(PathBuf::from("t.gen"), text.to_owned())]));
    let loaded = load(&texts, &[PathBuf::from("t.gen")], &Options::default()).unwrap();
    let said: String = loaded.diagnostics.iter().map(|d| render(&loaded.sources, d, Style::Plain)).collect();
    assert!(!loaded.has_errors(), "{said}");
    (Arc::new(loaded.model), loaded.sources)
}

/// In logical time, for so many milliseconds.
pub fn setup(ms: i64) -> Setup {
    Setup { duration: Some(millis(ms)), ..Setup::default() }
}

pub fn millis(ms: i64) -> Duration {
    Duration::from_nanos(ms * 1_000_000)
}

/// A run with the requests of a file.
pub fn start(model: &Arc<Model>, setup: Setup, codels: Codels, requests: &str) -> Run {
    let mut run = Run::new(model.clone(), setup, codels).unwrap();
    let requests = request::file(model, run.types(), requests).unwrap();
    requests.into_iter().for_each(|(time, request)| run.schedule(time, request));
    run
}

/// Everything that happens.
pub fn all(run: &mut Run) -> Vec<Happening> {
    std::iter::from_fn(|| run.advance()).collect()
}

/// Who keeps what happens.
#[derive(Default)]
struct Seen(Vec<Happening>);

impl Observer for Seen {
    fn see(&mut self, _: &mut Run, happening: &Happening) {
        self.0.push(happening.clone());
    }
}

/// Everything that happens in real time.
pub fn all_real(run: Run) -> (Run, Vec<Happening>) {
    let (run, seen) = run.carry_out(Seen::default());
    (run, seen.0)
}

/// The lines about it.
pub fn lines(run: &mut Run, sources: &SourceMap) -> Vec<String> {
    let (model, types) = (run.model().clone(), run.types().clone());
    let teller = Teller { model: &model, types: &types, sources, is_verbose: true };
    all(run).iter().filter_map(|h| teller.line(h)).map(|l| l.trim_start().to_owned()).collect()
}

/// What happened of a kind.
pub fn count(happenings: &[Happening], is_it: impl Fn(&What) -> bool) -> usize {
    happenings.iter().filter(|h| is_it(&h.what)).count()
}
