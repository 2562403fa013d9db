//! What monitoring costs is measured at every place and in every way; how much it is depends on the machine. The program for the brick runs.

mod common;

use std::fs;
use std::process::{Command, Stdio};

use common::soccer;
use soccer::costs::{Place, Way};

#[test]
fn every_place_is_measured_in_every_way() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("costs.html");
    let tables = soccer(&["costs", "--matches", "1", "--no-sizes", "--page", page.to_str().unwrap()]);
    let ways = Way::all().unwrap();
    assert_eq!(ways.len(), 9);
    for place in Place::ALL {
        let (name, figure) = place.name();
        let table =
            tables.split_once(&format!("**{name}** (figure {figure}")).unwrap_or_else(|| panic!("{name}: {tables}")).1;
        let rows: Vec<&str> = table.split("\n\n").nth(1).unwrap().lines().skip(2).collect();
        assert_eq!(rows.len(), ways.len(), "{name}");
        for (row, way) in rows.iter().zip(&ways) {
            assert!(row.starts_with(&format!("| {} |", way.name())), "{name}: {row}");
        }
    }
    let page = fs::read_to_string(page).unwrap();
    assert_eq!(page.matches("<rect class=\"box\"").count(), Place::ALL.len() * ways.len());
}

#[test]
fn the_brick_without_devices_asks_for_them_and_violates_init() {
    let folder = tempfile::tempdir().unwrap();
    let mut brick = Command::new(env!("CARGO_BIN_EXE_brick"));
    let output = brick.arg(folder.path()).stdin(Stdio::null()).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && said.contains("init: violated"), "{said}");
}
