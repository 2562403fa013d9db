//! Groups with segments or future operators idle while nothing happens to them; what comes of it is what comes of stepping them.

mod support;

use support::{program, run, toggling};

const SPECS: [&str; 15] = [
    "a: whenever p, eventually within 7 ms q\n",
    "a: after r, whenever p, eventually within 9 ms q\nb: after r, always p or q\n",
    "a: after_until p, q, always r\nb: after_until p, q, eventually r\n",
    "a: while p, whenever q, eventually within 5 ms r\n",
    "a: until r, whenever p, q until within 9 ms r\n",
    "a: whenever p, whenever q, eventually within 4 ms r\nb: whenever r, always within 3 ms (p or q)\n",
    "a: whenever once within 20 ms p, eventually within 6 ms q\n",
    "a: after_until p, q, after r, never p and q and r\n",
    "a: whenever p and r, eventually q\n",
    "a: whenever becomes p, eventually within [3 ms, 90 ms] q\nb: whenever becomes q, always within (2 ms, 60 ms) r\n",
    "a: whenever becomes p, q until within [2 ms, 40 ms] r\nb: whenever becomes r, q until p\n",
    "a: whenever becomes p, eventually within 40 ms (q and eventually within 30 ms r)\n",
    "a: whenever becomes p, (eventually within 30 ms q) and (eventually within [5 ms, 80 ms] r)\n",
    "a: after r, whenever becomes p, eventually within 60 ms q\nb: while r, whenever becomes p, eventually q\n",
    "_rate_ = 800\na: whenever p, eventually within 7 ms q\nb: while q, always p or r\n",
];

#[test]
fn idling_changes_nothing() {
    for (n, text) in SPECS.iter().enumerate() {
        let quick = program(text, &["p", "q", "r"]);
        assert!(quick.groups.iter().any(|group| group.idles), "{text} never idles");
        let mut plain = quick.clone();
        plain.groups.iter_mut().for_each(|group| group.idles = false);
        for seed in 0..30 {
            let rows = toggling(n as u64 * 1000 + seed, 16, 600);
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{text}, seed {seed}");
        }
    }
}
