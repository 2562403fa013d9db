//! Rules of the repository that no compiler holds. Each function lists what breaks one; an empty list is what a test wants.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use lapwing_diag::{Code, Severity};

/// What each crate may depend on: others of the workspace, then those of others. Tests may use more.
///
/// The order is that of the layers: a crate knows only crates above it.
pub const LAYERS: &[(&str, &[&str], &[&str])] = &[
    ("diag", &[], &["annotate-snippets", "strsim"]),
    ("draw", &[], &[]),
    ("stream", &[], &["serde"]),
    ("syntax", &["diag", "stream"], &["strsim"]),
    ("engine", &["stream"], &["libm", "postcard", "serde"]),
    ("check", &["diag", "stream", "syntax", "engine"], &[]),
    ("reference", &["diag", "stream", "check"], &["libm"]),
    ("codegen", &["diag", "stream", "engine", "check"], &[]),
    (
        "record",
        &["stream"],
        &[
            "bzip2",
            "crc32fast",
            "memchr",
            "glob",
            "lz4",
            "rusqlite",
            "serde_json",
            "strsim",
            "tempfile",
            "thiserror",
            "zstd",
        ],
    ),
    (
        "sim",
        &["stream", "record"],
        &["libm", "mcap", "rand_pcg", "rapier2d-f64", "serde", "strsim", "thiserror", "toml"],
    ),
    ("ros", &["stream", "record"], &["bytes", "md5", "quick-xml", "rustdds", "sha2"]),
    ("react", &["diag", "draw", "stream"], &["anstyle", "quick-xml", "serde_json"]),
    ("page", &["draw", "stream", "react"], &["plotly", "serde_json", "sha2"]),
    ("bip", &["diag"], &["rand_pcg"]),
    ("genom", &["diag", "draw", "bip"], &[]),
    ("import", &["diag", "syntax"], &["quick-xml"]),
    (
        "lapwing",
        &["diag", "draw", "stream", "syntax", "engine", "check", "record", "ros", "react"],
        &["bytes", "mcap", "serde_json"],
    ),
    ("components", &["diag", "stream", "check", "react", "bip", "genom", "lapwing"], &["mcap", "rand_pcg"]),
    ("codels", &["stream", "genom", "components"], &["libloading"]),
    ("tracing", &["diag", "stream", "check", "react", "lapwing"], &["log", "tracing", "tracing-subscriber"]),
    (
        "cli",
        &[
            "diag",
            "draw",
            "stream",
            "syntax",
            "codegen",
            "record",
            "sim",
            "ros",
            "react",
            "page",
            "bip",
            "genom",
            "import",
            "lapwing",
            "components",
            "codels",
        ],
        &["anstream", "clap", "ctrlc", "foxglove", "indicatif", "ratatui", "serde_json", "signal-hook", "strsim"],
    ),
];

/// How often code that is not a test may call `unwrap` or `expect`. It may only fall.
pub const PANICS: usize = 4;

/// No file is longer.
pub const MOST_LINES: usize = 700;

/// What no text may speak of: where it was written, and what is not part of the project.
const FORBIDDEN: &[&str] = &[
    concat!("/wo", "rk/"),
    concat!("../sha", "red"),
    concat!("shared/des", "ign"),
    concat!("shared/se", "eds"),
    concat!("see", "d 000"),
    concat!("see", "d 001"),
    concat!("see", "d 004"),
    concat!("LANGU", "AGE.md"),
    concat!("INTERF", "ACES.md"),
    concat!("DES", "IGN.md"),
    concat!("design docu", "ment"),
];

/// What no code may contain.
const UNFINISHED: &[&str] =
    &[concat!("tod", "o!("), concat!("unimpl", "emented!("), concat!("#[ig", "nore"), concat!("#[should_", "panic")];

/// A text file of the repository.
#[derive(Clone, Debug)]
pub struct File {
    /// Its path from the root.
    pub path: String,
    /// What is in it.
    pub text: String,
}

impl File {
    fn is_code(&self) -> bool {
        self.path.ends_with(".rs")
    }

    fn is_page(&self) -> bool {
        self.path.ends_with(".md")
    }

    fn is_test(&self) -> bool {
        self.path.contains("/tests/") || self.path.ends_with("/tests.rs") || self.path.starts_with("xtask/")
    }
}

/// All text files that people write, in the order of their paths.
pub fn files(root: &Path) -> Vec<File> {
    let mut found = Vec::new();
    for folder in ["crates", "xtask", "benches", "docs", "suite", "examples", "fuzz", "tools"] {
        collect(&root.join(folder), &mut found);
    }
    let pages = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "Cargo.toml", "test"];
    found.extend(pages.iter().map(|p| root.join(p)).filter(|p| p.is_file()));
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).ok()?;
        Some(File { path: path.strip_prefix(root).ok()?.to_string_lossy().replace('\\', "/"), text })
    };
    found.into_iter().filter_map(read).collect()
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() && name != "target" && name != "__pycache__" {
            collect(&path, found);
        } else if ["rs", "md", "rv", "toml", "txt", "sh", "py"]
            .iter()
            .any(|e| path.extension().is_some_and(|x| x == *e))
        {
            found.push(path);
        }
    }
}

/// Crates that depend on what their layer must not know, or that no layer has.
pub fn layers(files: &[File]) -> Vec<String> {
    let mut wrong = Vec::new();
    for file in files {
        let Some(name) = file.path.strip_prefix("crates/").and_then(|p| p.strip_suffix("/Cargo.toml")) else {
            continue;
        };
        let Some((_, own, others)) = LAYERS.iter().find(|(n, ..)| *n == name) else {
            wrong.push(format!("{}: the crate has no layer: add it to the table of xtask/src/tidy.rs", file.path));
            continue;
        };
        for dependency in dependencies(&file.text) {
            let short = dependency.strip_prefix("lapwing-").unwrap_or(&dependency);
            let is_own =
                LAYERS.iter().any(|(n, ..)| *n == short) && (dependency.starts_with("lapwing-") || short == "lapwing");
            let allowed = if is_own { own.contains(&short) } else { others.contains(&dependency.as_str()) };
            if !allowed {
                wrong.push(format!("{}: depends on {dependency}, which its layer must not know", file.path));
            }
        }
    }
    wrong.extend(not_upwards());
    wrong
}

/// Lines of the table that name a crate below their own.
fn not_upwards() -> Vec<String> {
    let place = |name: &str| LAYERS.iter().position(|(n, ..)| *n == name);
    let upwards = |(name, own, _): &(&str, &[&str], &[&str])| {
        let down =
            own.iter().filter(|o| place(o) >= place(name)).map(|o| format!("{name} knows {o}, which is not above it"));
        down.collect::<Vec<_>>()
    };
    LAYERS.iter().flat_map(upwards).collect()
}

/// The names below `[dependencies]`.
fn dependencies(manifest: &str) -> Vec<String> {
    let mut inside = false;
    let mut found = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            inside = line.trim() == "[dependencies]";
        } else if inside
            && let Some(name) = line.split(['=', '.', ' ']).next().filter(|n| !n.is_empty() && !n.starts_with('#'))
        {
            found.push(name.to_owned());
        }
    }
    found
}

/// Modules that do not begin by saying what they are for.
pub fn silent_modules(files: &[File]) -> Vec<String> {
    let silent = |f: &&File| f.is_code() && !f.text.starts_with("//!");
    files.iter().filter(silent).map(|f| format!("{}: begins without `//!`", f.path)).collect()
}

/// Files that are too long.
pub fn long_files(files: &[File]) -> Vec<String> {
    let lines = |f: &File| (f.path.clone(), f.text.lines().count());
    let written = files.iter().filter(|f| f.is_code() || f.is_page());
    written.map(lines).filter(|(_, n)| *n >= MOST_LINES).map(|(path, n)| format!("{path}: {n} lines")).collect()
}

/// Code that is not finished, and tests that do not run.
pub fn unfinished(files: &[File]) -> Vec<String> {
    files.iter().filter(|f| f.is_code()).flat_map(|f| mentions(f, UNFINISHED)).collect()
}

/// Texts that speak of what is not part of the project.
pub fn foreign(files: &[File]) -> Vec<String> {
    files.iter().flat_map(|f| mentions(f, FORBIDDEN)).collect()
}

fn mentions(file: &File, words: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for (number, line) in file.text.lines().enumerate() {
        let has = words.iter().filter(|w| line.contains(**w));
        found.extend(has.map(|w| format!("{}:{}: `{w}`", file.path, number + 1)));
    }
    found
}

/// Calls of `unwrap` and `expect` in code that is no test.
pub fn panics(files: &[File]) -> Vec<String> {
    let mut found = Vec::new();
    for file in files
        .iter()
        .filter(|f| f.is_code() && f.path.starts_with("crates/") && f.path.contains("/src/") && !f.is_test())
    {
        let code = file.text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        for (number, line) in code.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            let expects = code.contains(".expect(\"") && !code.contains("self.expect(");
            if expects || [".unwrap()", "panic!(", "unreachable!("].iter().any(|call| code.contains(call)) {
                found.push(format!("{}:{}: {}", file.path, number + 1, line.trim()));
            }
        }
    }
    found
}

/// What would give the engine a clock, an environment or an order of its own.
pub fn impure_engine(files: &[File]) -> Vec<String> {
    let engine: Vec<&File> = files.iter().filter(|f| f.path.starts_with("crates/engine/src/") && f.is_code()).collect();
    let mut wrong: Vec<String> =
        engine.iter().flat_map(|f| mentions(f, &["use std::", "extern crate std", "HashMap", "HashSet"])).collect();
    let root = engine.iter().find(|f| f.path == "crates/engine/src/lib.rs");
    if !root.is_some_and(|f| f.text.contains("#![no_std]")) {
        wrong.push("crates/engine/src/lib.rs: is not `#![no_std]`".to_owned());
    }
    wrong
}

/// What would make the simulator's recordings differ between machines: functions whose last bits the platform chooses, clocks, and orders
/// by chance.
const INEXACT: &str = ".sin() .cos() .tan() .sin_cos() .asin( .acos( .atan( .atan2( .exp() .ln() .powf( .hypot( .mul_add( \
                       HashMap HashSet SystemTime Instant::now";

/// Places in the simulator that may not be the same on every machine.
pub fn inexact_simulator(files: &[File]) -> Vec<String> {
    let words: Vec<&str> = INEXACT.split_whitespace().collect();
    let simulator = files.iter().filter(|f| f.path.starts_with("crates/sim/src/") && f.is_code());
    simulator.flat_map(|f| mentions(f, &words)).collect()
}

/// Codes without a page worth reading, or that no test mentions.
pub fn codes(files: &[File]) -> Vec<String> {
    let tests: String =
        files.iter().filter(|f| f.is_test() || f.path.starts_with("suite/")).map(|f| f.text.as_str()).collect();
    let mut wrong = Vec::new();
    for code in Code::ALL {
        let page = code.page();
        if !page.starts_with(&format!("# {}\n", code.name())) || page.len() < 100 {
            wrong.push(format!("{}: its page says nothing", code.name()));
        }
        if !tests.contains(&format!("Code::{code:?}")) && !has_word(&tests, code.name()) {
            wrong.push(format!("{}: no test mentions it", code.name()));
        }
    }
    wrong
}

/// Whether the word occurs, and not as a part of a longer one.
fn has_word(text: &str, word: &str) -> bool {
    let is_part = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '-');
    text.match_indices(word)
        .any(|(at, _)| !is_part(text[..at].chars().next_back()) && !is_part(text[at + word.len()..].chars().next()))
}

/// The page that lists all codes.
pub fn errors_page() -> String {
    let mut page = String::from(
        "# Diagnostics\n\nEvery diagnostic has a code that stays, and a page that explains it: `lapwing explain CODE` shows it. \
         An error makes a specification unusable; a warning does not.\n\n\
         This page is generated: `BLESS=1 cargo test -p xtask --test tidy` writes it.\n",
    );
    for (severity, title) in [(Severity::Error, "Errors"), (Severity::Warning, "Warnings"), (Severity::Note, "Notes")] {
        page.push_str(&format!("\n## {title}\n\n| code | |\n| --- | --- |\n"));
        for code in Code::ALL.iter().filter(|c| c.severity() == severity) {
            let what = code.page().lines().skip(1).find(|l| !l.is_empty()).unwrap_or_default();
            page.push_str(&format!(
                "| [`{name}`](../crates/diag/codes/{name}.md) | {} |\n",
                what.replace('|', "\\|"),
                name = code.name()
            ));
        }
    }
    page
}

/// Links of pages that lead nowhere.
pub fn dead_links(root: &Path, files: &[File]) -> Vec<String> {
    let anchors: BTreeMap<&str, BTreeSet<String>> =
        files.iter().filter(|f| f.is_page()).map(|f| (f.path.as_str(), headings(&f.text))).collect();
    let mut wrong = Vec::new();
    for file in files.iter().filter(|f| f.is_page()) {
        for link in links(&file.text) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (path, anchor) = link.split_once('#').map_or((link.as_str(), None), |(p, a)| (p, Some(a)));
            let target = if path.is_empty() { file.path.clone() } else { beside(&file.path, path) };
            let leads = root.join(&target).exists();
            let known = anchor.is_none_or(|a| anchors.get(target.as_str()).is_some_and(|all| all.contains(a)));
            if !leads || !known {
                wrong.push(format!("{}: {link}", file.path));
            }
        }
    }
    wrong
}

/// A path as seen from a file, from the root.
fn beside(file: &str, path: &str) -> String {
    let mut parts: Vec<&str> = file.split('/').collect();
    parts.pop();
    for part in path.split('/').filter(|p| !p.is_empty() && *p != ".") {
        if part == ".." {
            parts.pop();
        } else {
            parts.push(part);
        }
    }
    parts.join("/")
}

/// The lines of a page that stand outside of fences.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut fenced = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        fenced ^= is_fence;
        !fenced && !is_fence
    })
}

fn links(text: &str) -> Vec<String> {
    let one = |line: &str| {
        let targets =
            line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned());
        targets.collect::<Vec<_>>()
    };
    prose(text).flat_map(one).collect()
}

/// The anchors of a page's headings.
fn headings(text: &str) -> BTreeSet<String> {
    let anchor = |line: &str| {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    prose(text).filter(|l| l.starts_with('#')).map(anchor).collect()
}
