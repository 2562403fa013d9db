//! The live page: the report page's sibling, which asks whoever serves it how things stand, again and again, and draws what is new.
//!
//! It is the same for every run: all that is particular comes as JSON from `state.json` beside it. Charts are drawn by the page's own scripts, as what
//! changes four times a second has to be cheap for whatever machine shows it.

use std::sync::LazyLock;

use crate::assets::{STYLE, hash};

/// Our scripts, each a part of one function.
const PARTS: &[&str] = &[
    include_str!("../assets/js/theme.js"),
    include_str!("../assets/js/text.js"),
    include_str!("../assets/live/make.js"),
    include_str!("../assets/live/past.js"),
    include_str!("../assets/live/strips.js"),
    include_str!("../assets/live/curves.js"),
    include_str!("../assets/live/cards.js"),
    include_str!("../assets/live/happened.js"),
    include_str!("../assets/live/page.js"),
];

/// What the report page has no need of.
const MORE_STYLE: &str = include_str!("../assets/live/live.css");

/// What is filled in by the scripts.
const BODY: &str = include_str!("../assets/live/body.html");

static SCRIPT: LazyLock<String> =
    LazyLock::new(|| format!("(() => {{\n\"use strict\";\n{}\n}})();\n", PARTS.join("\n")));

/// The live page as HTML, without what comes while it is shown.
pub fn live() -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta name=\"generator\" content=\"Lapwing {}\">\n<title>Lapwing</title>\n<link rel=\"icon\" href=\"data:,\">\n\
         <style>\n{STYLE}{MORE_STYLE}</style>\n</head>\n<body>\n{BODY}<script>{}</script>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        *SCRIPT
    )
}

/// What the live page may do, for the header of whoever serves it: run its own script, style itself, and ask where it came from.
pub fn live_policy() -> String {
    format!(
        "default-src 'none'; script-src '{}'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'",
        hash(&SCRIPT)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_whole_and_small() {
        let page = live();
        assert!(page.contains("<main id=\"main\"") && page.ends_with("</html>\n"));
        assert!(page.len() < 60_000, "{} bytes", page.len());
        // A script element ends at the first such text, wherever it stands.
        assert_eq!((page.matches("</script").count(), page.matches("</style").count()), (1, 1));
        assert!(live_policy().contains("'sha256-"));
    }
}
