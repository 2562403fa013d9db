//! Every example of the language's documents parses without errors.

mod common;

use common::{EXAMPLES, parsed};

#[test]
fn every_example_parses() {
    for (name, text) in EXAMPLES {
        println!("{name}");
        let file = parsed(text);
        assert!(!file.items.is_empty());
    }
}
