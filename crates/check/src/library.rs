//! The libraries that come with Lapwing: patterns in the language itself, one file each, and what they say of themselves.

/// A library that comes with Lapwing.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// What a specification calls it: `use std.robot`.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// All libraries. Their patterns call no others and read nothing but their arguments, so that it does not matter what else a
/// specification uses or declares.
pub const LIBRARIES: &[Library] = &[
    Library { name: "std.robot", text: include_str!("../std/robot.rv") },
    Library { name: "std.dwyer", text: include_str!("../std/dwyer.rv") },
    Library { name: "std.mission", text: include_str!("../std/mission.rv") },
];

/// A pattern of a library, with the comment that stands above it.
///
/// In that comment a line `formula: …` is the formula of the literature, and a line `example: …` a property that uses the
/// pattern; a comment `== … ==` between patterns is the title of a section.
#[derive(Clone, Debug, Default)]
pub struct ShippedPattern {
    /// Its name.
    pub name: &'static str,
    /// How it is called: `response(p, s)`.
    pub call: &'static str,
    /// The title of its section in the library; empty where it has none.
    pub section: &'static str,
    /// What it says, in lines of Markdown.
    pub words: Vec<&'static str>,
    /// Its formula in the literature.
    pub formula: Option<&'static str>,
    /// A property that uses it.
    pub example: Option<&'static str>,
    /// The lines of what it stands for.
    pub body: Vec<&'static str>,
}

impl Library {
    /// What the library says of itself at its beginning, in lines of Markdown.
    pub fn preface(&self) -> Vec<&'static str> {
        self.text
            .lines()
            .map_while(|line| line.strip_prefix('#'))
            .map(|line| line.strip_prefix(' ').unwrap_or(line))
            .collect()
    }

    /// The patterns, in order.
    pub fn patterns(&self) -> Vec<ShippedPattern> {
        let (mut found, mut next) = (Vec::<ShippedPattern>::new(), ShippedPattern::default());
        for line in self.text.lines() {
            if let Some(title) = line.strip_prefix("# == ").and_then(|l| l.strip_suffix(" ==")) {
                next.section = title;
            } else if let Some(formula) = line.strip_prefix("# formula: ") {
                next.formula = Some(formula);
            } else if let Some(example) = line.strip_prefix("# example: ") {
                next.example = Some(example);
            } else if let Some(words) = line.strip_prefix('#') {
                next.words.push(words.strip_prefix(' ').unwrap_or(words));
            } else if let Some(call) = line.strip_prefix("pattern ").and_then(|l| l.strip_suffix(':')) {
                (next.call, next.name) = (call, call.split('(').next().unwrap_or_default());
                let after = ShippedPattern { section: next.section, ..ShippedPattern::default() };
                found.push(std::mem::replace(&mut next, after));
            } else if line.starts_with(' ') {
                found.iter_mut().last().into_iter().for_each(|pattern| pattern.body.push(line.trim()));
            } else {
                // A comment that stands for itself.
                next.words.clear();
            }
        }
        found
    }
}
