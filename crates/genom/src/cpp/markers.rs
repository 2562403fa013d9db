//! Markers of lines: `# 12 "file.gen" 1`, which another preprocessor leaves behind to say where the next line came from.

/// A part of a text, and the file that it came from.
pub(crate) struct Part {
    pub name: String,
    /// The part, after as many empty lines as its number asks for.
    pub text: String,
}

/// Empty lines that markers may ask for, all together. Without a limit ten bytes could ask for a gigabyte.
const MOST_PADDING: usize = 4 << 20;

/// The parts of a text. One without markers is one part.
pub(crate) fn parts(name: &str, text: &str) -> Vec<Part> {
    let mut parts = vec![Part { name: name.to_owned(), text: String::new() }];
    // Never more than MOST_PADDING.
    let mut padding = 0;
    for line in text.split_inclusive('\n') {
        let Some(last) = parts.last_mut() else { break };
        match marker(line) {
            Some((number, file)) if number <= MOST_PADDING - padding => {
                padding += number;
                let name = file.map_or_else(|| last.name.clone(), str::to_owned);
                parts.push(Part { name, text: "\n".repeat(number.saturating_sub(1)) });
            }
            _ => last.text.push_str(line),
        }
    }
    if parts.len() > 1 {
        parts.retain(|part| !part.text.trim().is_empty());
    }
    parts
}

/// The number and the file of a marker.
fn marker(line: &str) -> Option<(usize, Option<&str>)> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start();
    let rest = rest.strip_prefix("line").map_or(rest, str::trim_start);
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let number = rest.get(..digits)?.parse().ok()?;
    let file = rest.split('"').nth(1);
    Some((number, file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_marker_moves_what_follows() {
        let found = parts("all.i", "a\n# 3 \"b.gen\" 1\nb\n#line 7\nc\n# 4000000000 \"d\"\n");
        let shown: Vec<(&str, &str)> = found.iter().map(|p| (p.name.as_str(), p.text.as_str())).collect();
        assert_eq!(shown, [("all.i", "a\n"), ("b.gen", "\n\nb\n"), ("b.gen", "\n\n\n\n\n\nc\n# 4000000000 \"d\"\n")]);
    }

    #[test]
    fn numbers_are_added_up_without_overflow() {
        let found = parts("all.i", "# 3 \"b\"\nx\n# 18446744073709551614 \"c\"\ny");
        let shown: Vec<(&str, &str)> = found.iter().map(|p| (p.name.as_str(), p.text.as_str())).collect();
        assert_eq!(shown, [("b", "\n\nx\n# 18446744073709551614 \"c\"\ny")]);
    }
}
