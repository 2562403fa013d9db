//! Styles and scripts of the page, and the policy that lets only them act.

use std::sync::LazyLock;

use plotly::Plot;
use sha2::{Digest, Sha256};

/// The styles.
pub(crate) const STYLE: &str = include_str!("../assets/page.css");

/// Our scripts, each a part of one function: they see each other and nobody sees them.
const PARTS: &[&str] = &[
    include_str!("../assets/js/theme.js"),
    include_str!("../assets/js/text.js"),
    include_str!("../assets/js/window.js"),
    include_str!("../assets/js/lanes.js"),
    include_str!("../assets/js/curve.js"),
    include_str!("../assets/js/figure.js"),
    include_str!("../assets/js/chart.js"),
    include_str!("../assets/js/run.js"),
    include_str!("../assets/js/page.js"),
];

/// The script that draws, with its notice of copyright and licence (MIT).
pub(crate) static PLOTLY: LazyLock<String> = LazyLock::new(|| {
    // The crate hands its scripts out as elements, plotly.js first; the others we do not need.
    let elements = Plot::offline_js_sources();
    let begins = elements.find('>').map_or(0, |at| at + 1);
    let ends = elements.find("</script>").unwrap_or(elements.len());
    elements.get(begins..ends).unwrap_or_default().to_owned()
});

/// Our script.
pub(crate) static SCRIPT: LazyLock<String> =
    LazyLock::new(|| format!("(() => {{\n\"use strict\";\n{}\n}})();\n", PARTS.join("\n")));

/// What the page may do: run these two scripts and style itself. It may load nothing and send nothing.
pub(crate) fn policy() -> String {
    let scripts = [&*PLOTLY, &*SCRIPT].map(|script| format!("'{}'", hash(script)));
    format!(
        "default-src 'none'; script-src {}; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'",
        scripts.join(" ")
    )
}

/// A script, as a policy names it.
pub(crate) fn hash(script: &str) -> String {
    format!("sha256-{}", base64(&Sha256::digest(script.as_bytes())))
}

/// Bytes in base64.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for chunk in bytes.chunks(3) {
        let group = chunk.iter().chain([&0, &0]).take(3).fold(0_u32, |all, byte| all << 8 | u32::from(*byte));
        for place in 0..4 {
            match place <= chunk.len() {
                true => out.push(char::from(DIGITS[(group >> (18 - 6 * place) & 63) as usize])),
                false => out.push('='),
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_in_base64() {
        let of = |text: &str| base64(text.as_bytes());
        assert_eq!([of(""), of("f"), of("fo"), of("foo"), of("foob")], ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg=="]);
        assert_eq!(base64(&[0xff, 0xfe, 0xfd]), "//79");
    }

    #[test]
    fn the_library_is_whole_and_says_whose_it_is() {
        assert!(PLOTLY.len() > 1_000_000, "{} bytes", PLOTLY.len());
        assert!(PLOTLY.contains("plotly.js v") && PLOTLY.contains("Licensed under the MIT license"));
        // A script element ends at the first such text, wherever it stands.
        assert!(!PLOTLY.contains("</script") && !SCRIPT.contains("</script") && !STYLE.contains("</style"));
    }
}
