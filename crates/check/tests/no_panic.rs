//! Whatever the text, the check comes to an end and says what it thinks.

mod support;

use support::shapes::{csv, ndjson, robot};
use support::{against, alone};

/// A small generator of pseudo-random numbers: the same ones on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

/// The words of a text, with the blanks and line ends between them.
fn words(text: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let kind = |c: char| (c.is_alphanumeric() || c == '_', c.is_whitespace() && c != '\n');
        let end = rest.find(|c| kind(c) != kind(first)).unwrap_or(rest.len());
        let end = if kind(first) == (false, false) { first.len_utf8() } else { end };
        let (word, after) = rest.split_at(end);
        words.push(word);
        rest = after;
    }
    words
}

/// The text with a few words left out, doubled, swapped or taken from elsewhere.
fn mutated(words: &[&str], random: &mut Random) -> String {
    let mut words = words.to_vec();
    for _ in 0..1 + random.below(4) {
        let (a, b) = (random.below(words.len()), random.below(words.len()));
        match random.below(4) {
            0 => _ = words.remove(a),
            1 => words.insert(a, words[b]),
            2 => words.swap(a, b),
            _ => words[a] = words[b],
        }
    }
    words.concat()
}

#[test]
fn mutations_of_the_examples_do_no_harm() {
    let examples = support::examples::ALL.concat();
    let statements = words(&examples);
    let traces =
        [robot(), csv(&["x", "robot.velocity", "odom.x"]), ndjson(&["x"], &[("/odom", "nav_msgs/Odometry")], true)];
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for round in 0..300 {
        let text = mutated(&statements, &mut random);
        let spec = alone(&text);
        assert!(spec.checked.spec.properties.iter().all(|p| p.line > 0), "round {round}");
        let spec = against(&text, &traces[round % traces.len()]);
        spec.messages();
    }
}

#[test]
fn short_texts_do_no_harm() {
    let examples = support::examples::ALL.concat();
    let all = words(&examples);
    let mut random = Random(42);
    for _ in 0..3000 {
        let count = 1 + random.below(12);
        let text: String = (0..count).map(|_| format!("{} ", all[random.below(all.len())])).collect();
        alone(&text).messages();
    }
}

#[test]
fn deep_texts_do_no_harm() {
    for text in [
        "(".repeat(5000),
        "not ".repeat(5000) + "x",
        "x".to_owned() + &" + x".repeat(5000) + " > 1",
        "always ".repeat(3000) + "x",
    ] {
        alone(&text).messages();
    }
}
