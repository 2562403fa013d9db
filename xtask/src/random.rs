//! Agreement on specifications and traces at random, through the whole pipeline: text, checker, compiler, engine.

use lapwing_check::checked::Spec;
use lapwing_check::{check, load};
use lapwing_diag::{Code, Severity, SourceMap, Style, render};
use lapwing_reference::Trace;
use lapwing_reference::generate::{Case, generate, shrink};

use crate::agree::{Drive, agree};

/// How long the traces and how deep the formulas are, about.
const SIZE: usize = 24;

/// What became of a case.
pub enum Told {
    /// Both say the same.
    Agreed,
    /// The checker refuses the text for its dimensions: the generator knows nothing of them.
    Refused,
    /// They differ, or the generated text does not check for another reason: what is wrong, made small, to be read.
    Differed(String),
}

/// Generates the case of a seed and compares.
pub fn run(seed: u64) -> Told {
    let case = generate(seed, SIZE);
    match compare(&case) {
        Ok(()) => Told::Agreed,
        Err(Failure::Dimensions) => Told::Refused,
        Err(Failure::Check(why)) => {
            Told::Differed(format!("seed {seed}: the text does not check\n{}\n{why}", case.text()))
        }
        Err(Failure::Differ(_)) => Told::Differed(smallest(seed, &case)),
    }
}

/// The specification of a seed, the trace to check it on, and its text; `None` where the checker refuses it.
pub fn checked_case(seed: u64) -> Option<(Spec, Trace, String)> {
    let case = generate(seed, SIZE);
    let spec = checked(&case).ok()?;
    let trace = case.trace(&spec);
    Some((spec, trace, case.text()))
}

enum Failure {
    Dimensions,
    Check(String),
    Differ(String),
}

/// The smallest case found that still differs, and how.
fn smallest(seed: u64, case: &Case) -> String {
    let small = shrink(case, |c| matches!(compare(c), Err(Failure::Differ(_))));
    let how = match compare(&small) {
        Err(Failure::Differ(how)) => how,
        _ => "it no longer differs once it is small".to_owned(),
    };
    let samples: String = small.samples.iter().map(|(t, raw)| format!("  {:>12} {raw:?}\n", t.0)).collect();
    format!("seed {seed}:\n{}\n{samples}{how}", small.text())
}

fn compare(case: &Case) -> Result<(), Failure> {
    let spec = checked(case)?;
    agree(&spec, &case.trace(&spec), &Drive::ALL).map_err(|d| Failure::Differ(format!("driven {:?}\n{d}", d.drive)))
}

fn checked(case: &Case) -> Result<Spec, Failure> {
    let text = case.text();
    let mut sources = SourceMap::default();
    let file = sources.add("case.rv", text.clone());
    let parsed = lapwing_syntax::parse(file, &text);
    let mut diagnostics = parsed.diagnostics.clone();
    let loaded = load(&mut sources, parsed.file, &|_| None);
    let checked = check(&sources, &loaded, Some(&case.shape));
    diagnostics.extend(checked.diagnostics.iter().cloned());
    let mut errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).peekable();
    if errors.peek().is_some() && errors.all(|d| d.code == Code::DimensionMismatch) {
        return Err(Failure::Dimensions);
    }
    if lapwing_diag::has_errors(&diagnostics) {
        let shown: String = diagnostics.iter().map(|d| render(&sources, d, Style::Plain)).collect();
        return Err(Failure::Check(shown));
    }
    Ok(checked.spec)
}
