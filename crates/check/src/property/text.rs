//! The source text of a property, as reports show it.

/// The text without comments and outer blanks; line ends are kept.
pub(super) fn source_text(text: &str) -> String {
    let lines: Vec<String> = text.split('\n').map(without_comment).collect();
    lines.join("\n").trim().to_owned()
}

/// One line up to its comment. A `#` in a text or between backquotes begins none.
fn without_comment(line: &str) -> String {
    let mut quote = None;
    let mut escaped = false;
    for (at, c) in line.char_indices() {
        match quote {
            Some(_) if escaped => escaped = false,
            Some('"') if c == '\\' => escaped = true,
            Some(q) if c == q => quote = None,
            Some(_) => {}
            None if c == '#' => return line[..at].trim_end().to_owned(),
            None if c == '"' || c == '`' => quote = Some(c),
            None => {}
        }
    }
    line.trim_end_matches('\r').to_owned()
}

#[cfg(test)]
mod tests {
    use super::source_text;

    #[test]
    fn comments_go_and_line_ends_stay() {
        assert_eq!(source_text("never x > 2 # fast\n  and y == \"#1\""), "never x > 2\n  and y == \"#1\"");
        assert_eq!(source_text("always `a#b` > 0 # c"), "always `a#b` > 0");
    }
}
