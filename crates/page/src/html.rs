//! Text that may say anything, as a part of a document that must not do anything.

/// Text in an element or in an attribute with double quotes.
pub(crate) fn text(of: &str) -> String {
    let mut out = String::with_capacity(of.len());
    for c in of.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // What HTML has no place for.
            '\0'..='\x08' | '\x0b' | '\x0c' | '\x0e'..='\x1f' | '\x7f' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A name that other people chose: its direction of writing stays its own matter.
pub(crate) fn name(of: &str) -> String {
    format!("<bdi>{}</bdi>", text(of))
}

/// JSON as the content of a script element: nothing in it can end the element or begin a comment.
pub(crate) fn json(of: &serde_json::Value) -> String {
    let mut out = String::new();
    for c in of.to_string().chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => out.push_str(&format!("\\u{:04x}", c as u32)),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_hostile_is_only_text() {
        assert_eq!(text("</script><script>alert(1)"), "&lt;/script&gt;&lt;script&gt;alert(1)");
        assert_eq!(text("\" onload='x' &amp; \0"), "&quot; onload=&#39;x&#39; &amp;amp; \u{fffd}");
        let data = json(&serde_json::json!({ "</script><!--": "\u{2028}&" }));
        assert_eq!(data, r#"{"\u003c/script\u003e\u003c!--":"\u2028\u0026"}"#);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&data).unwrap()["</script><!--"], "\u{2028}&");
    }
}
