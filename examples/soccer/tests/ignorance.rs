//! The robot's program knows nothing of monitors.

use std::fs;
use std::path::Path;

#[test]
fn the_robot_does_not_mention_what_watches_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/robot");
    let mut files = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        for word in
            ["lapwing", "monitor", "violation", " fault", "crate::field", "crate::watch", "crate::game", "soccer.rv"]
        {
            assert!(!text.to_lowercase().contains(word), "{} speaks of `{word}`", path.display());
        }
        files += 1;
    }
    assert!(files >= 7, "{files} files");
}

#[test]
fn the_robot_needs_no_more_than_tracing() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/robot");
    for entry in fs::read_dir(folder).unwrap() {
        let text = fs::read_to_string(entry.unwrap().path()).unwrap();
        let uses = text.lines().filter_map(|line| line.trim().strip_prefix("use "));
        for path in uses {
            let root = path.split("::").next().unwrap();
            assert!(["std", "tracing", "super", "libm"].contains(&root), "use {path}");
        }
    }
}
