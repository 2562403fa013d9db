//! What the tests share.

#![allow(dead_code)] // Each test file uses a part of it.

mod sexpr;

use lapwing_syntax::ast::{Expr, File, ItemKind};
use lapwing_syntax::{FileId, parse};

#[allow(unused_imports)]
pub use sexpr::{dur, sexpr};

/// The examples, by name.
pub const EXAMPLES: &[(&str, &str)] = &[
    ("declarations", include_str!("../data/declarations.rv")),
    ("settings", include_str!("../data/settings.rv")),
    ("evaluation", include_str!("../data/evaluation.rv")),
    ("events", include_str!("../data/events.rv")),
    ("machine", include_str!("../data/machine.rv")),
    ("patterns", include_str!("../data/patterns.rv")),
    ("reactions", include_str!("../data/reactions.rv")),
    ("formulas", include_str!("../data/formulas.rv")),
];

/// The statements of a text that has no errors.
pub fn parsed(text: &str) -> File {
    let parsed = parse(FileId(0), text);
    let found: Vec<String> = parsed.diagnostics.iter().map(|d| format!("{:?} {}", d.primary.span, d.message)).collect();
    assert!(found.is_empty(), "{text}\n{found:#?}");
    parsed.file
}

/// The formula of a text that is one statement: a property or a definition.
pub fn formula(text: &str) -> Expr {
    body(parsed(text), text)
}

/// The formula of a file that is one statement.
pub fn body(file: File, text: &str) -> Expr {
    let [item] = <[_; 1]>::try_from(file.items).unwrap_or_else(|items| panic!("{text}: {} statements", items.len()));
    match item.kind {
        ItemKind::Property(property) => property.body,
        ItemKind::Definition(definition) => definition.body,
        other => panic!("{text}: {other:?}"),
    }
}

/// A tree without its places, names bare: two texts say the same where it is equal.
pub fn placeless(tree: &impl std::fmt::Debug) -> String {
    let shown = format!("{tree:?}");
    let mut kept = String::new();
    let mut rest = shown.as_str();
    while let Some((before, after)) = rest.split_once("Span {") {
        kept.push_str(before.strip_suffix(", span: ").or(before.strip_suffix(", ")).unwrap_or(before));
        rest = after.split_once('}').map_or("", |(_, after)| after);
    }
    kept.push_str(rest);
    for (long, short) in [("Ident { name: ", ""), ("Topic { name: ", ""), ("\" }", "\""), ("(Span)", "")] {
        kept = kept.replace(long, short);
    }
    kept
}

/// A small generator of pseudo-random numbers (splitmix64): the same seed gives the same run everywhere.
pub struct Random(pub u64);

impl Random {
    /// Any number.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// One of them.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}
