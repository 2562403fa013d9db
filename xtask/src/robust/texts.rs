//! Texts of specifications, through parser, formatter, checker and compiler.

use lapwing_check::checked::Spec;
use lapwing_check::{TraceShape, check as check_spec, load};
use lapwing_diag::{SourceMap, Style, has_errors, render, render_short};
use lapwing_reference::generate::generate;
use lapwing_syntax::{FileId, parse as parse_text};

/// What comes out of the parser has places inside the text, and every sign of the text is in a token.
pub fn parse(data: &[u8]) {
    let text = &*String::from_utf8_lossy(data);
    let parsed = parse_text(FileId::default(), text);
    for diagnostic in &parsed.diagnostics {
        let (start, end) = (diagnostic.primary.span.start as usize, diagnostic.primary.span.end as usize);
        assert!(text.get(start..end).is_some(), "{start}..{end} is no place in {text:?}");
    }
    let mut at = 0;
    for token in &parsed.tokens {
        let between = text.get(at..token.span.start as usize).expect("tokens come in order");
        assert!(between.chars().all(|c| c.is_whitespace() || c == '\u{feff}'), "{between:?} is in no token");
        at = token.span.end as usize;
    }
}

/// What was laid out once stays as it is, and still parses.
pub fn format(data: &[u8]) {
    let text = &*String::from_utf8_lossy(data);
    let Ok(once) = lapwing_syntax::format(text) else { return };
    assert_eq!(lapwing_syntax::format(&once).as_ref(), Ok(&once), "no fixed point: {text:?}");
}

/// The first byte chooses a shape, the rest is the text; what has no errors also runs for a few samples.
pub fn check(data: &[u8]) {
    let Some((&choice, text)) = data.split_first() else { return };
    let mut shape = generate(0, 1).shape;
    shape.live = choice & 1 == 1;
    shape.schemaless = choice & 2 == 0;
    shape.columns_open = choice & 4 == 4;
    let Some(spec) = checked(&String::from_utf8_lossy(text), &shape) else { return };
    super::hostile::run_for_a_while(&spec, u64::from(choice));
}

/// The meaning of a text on traces of a shape, unless it is wrong whatever the trace; what is found can be shown.
pub fn checked(text: &str, shape: &TraceShape) -> Option<Spec> {
    let mut sources = SourceMap::default();
    let file = sources.add("fuzz.rv", text);
    let parsed = parse_text(file, text);
    let loaded = load(&mut sources, parsed.file, &|_| Some("limit = 2\nslow = always x < limit\n".to_owned()));
    let alone = check_spec(&sources, &loaded, None);
    let against = check_spec(&sources, &loaded, Some(shape));
    for found in parsed.diagnostics.iter().chain(&alone.diagnostics).chain(&against.diagnostics) {
        assert!(!render(&sources, found, Style::Plain).is_empty() && !render_short(&sources, found).is_empty());
    }
    (!has_errors(&parsed.diagnostics) && !alone.has_errors()).then_some(against.spec)
}
