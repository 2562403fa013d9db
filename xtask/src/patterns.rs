//! The page of the shipped patterns, made of what the libraries say of themselves.

use lapwing_check::{LIBRARIES, ShippedPattern};

/// The page.
pub fn page() -> String {
    let mut page = String::from(
        "# Pattern libraries\n\nA pattern is a formula with parameters that somebody has thought through before. `use std.robot` \
         brings in the patterns of that library; then a property is\n\n\
         ```rv\nuse std.robot\nwheels: tracks(cmd, odom, 0.05, 1 s)\n```\n\n\
         A violation is reported at the line of the property. A pattern of your own with the name of a shipped one takes its place. Each pattern is \
         tested on healthy and on faulty traces ([suite/std](../suite/std)), and those with a formula against that formula.\n\n\
         This page is generated from the libraries themselves: `BLESS=1 cargo test -p xtask --test patterns` writes it.\n",
    );
    for library in LIBRARIES {
        page.push_str(&format!("\n## {}\n\n{}\n", library.name, library.preface().join("\n")));
        let mut section = "";
        for pattern in library.patterns() {
            if pattern.section != section {
                section = pattern.section;
                page.push_str(&format!("\n### {section}\n\n| pattern | means | as a formula |\n| --- | --- | --- |\n"));
            }
            page.push_str(&if section.is_empty() { chapter(&pattern) } else { row(&pattern) });
        }
    }
    page
}

/// A pattern that is described at length.
fn chapter(pattern: &ShippedPattern) -> String {
    let example = pattern.example.iter().map(|e| format!("\nFor example `{e}`.\n")).collect::<String>();
    let body = pattern.body.join("\n    ");
    let words = pattern.words.join("\n");
    format!("\n### {}\n\n{words}\n{example}\n```rv\npattern {}:\n    {body}\n```\n", pattern.name, pattern.call)
}

/// A pattern in a table.
fn row(pattern: &ShippedPattern) -> String {
    let escaped = |text: &str| text.replace('|', "\\|");
    let formula = pattern.formula.iter().map(|f| format!("`{}`", escaped(f))).collect::<String>();
    format!("| `{}` | {} | {formula} |\n", pattern.call, escaped(&pattern.words.join(" ")))
}
