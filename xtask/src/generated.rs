//! Pages, or parts of pages, that are generated: a test holds that they are up to date, and writes them where the variable `BLESS` is set.

use std::fs;
use std::path::Path;

/// Whether a page is as it should be; with `BLESS` it is made so. `test` is the test of `xtask` that asks.
pub fn holds(page: &Path, wanted: &str, test: &str) -> Result<(), String> {
    if fs::read_to_string(page).is_ok_and(|there| there == wanted) {
        return Ok(());
    }
    let page_name = page.display();
    if std::env::var_os("BLESS").is_none() {
        return Err(format!("{page_name} is out of date: `BLESS=1 cargo test -p xtask --test {test}` writes it"));
    }
    fs::write(page, wanted).map_err(|e| format!("{page_name}: {e}"))
}

/// The same of a part of a page, between `<!-- NAME -->` and `<!-- /NAME -->`.
pub fn part_holds(page: &Path, name: &str, part: &str, test: &str) -> Result<(), String> {
    let there = fs::read_to_string(page).map_err(|e| format!("{}: {e}", page.display()))?;
    let wanted = with_part(&there, name, part).ok_or_else(|| format!("{}: no place for {name}", page.display()))?;
    holds(page, &wanted, test)
}

fn with_part(page: &str, name: &str, part: &str) -> Option<String> {
    let (before, rest) = page.split_once(&format!("<!-- {name} -->\n"))?;
    let (_, after) = rest.split_once(&format!("<!-- /{name} -->"))?;
    Some(format!("{before}<!-- {name} -->\n{part}<!-- /{name} -->{after}"))
}
