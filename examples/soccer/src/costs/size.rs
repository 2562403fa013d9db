//! The size of the robot's program with and without monitors, as the thesis's figure 4.1 has it: the program `brick`, which is what would be put on the
//! robot, built both ways.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The sizes of a program, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Of the file, without symbols.
    pub file: u64,
    /// Of the code in it, and of what it reads.
    pub loaded: u64,
}

/// Builds the robot's program without monitors and with them, by cargo in the same profile, and gives the sizes of both.
pub fn measure() -> Result<[Size; 2], String> {
    Ok([build(&[])?, build(&["--features", "monitors"])?])
}

fn build(features: &[&str]) -> Result<Size, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root).args(["rustc", "--release", "--quiet", "--package", "soccer", "--bin", "brick"]);
    cargo.args(["--no-default-features", "--message-format", "json"]).args(features);
    // Symbols and line tables are no part of what is loaded.
    let output = cargo.args(["--", "-C", "strip=symbols"]).output().map_err(|e| format!("cargo: {e}"))?;
    if !output.status.success() {
        return Err(format!("the robot's program cannot be built: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let built = executable(&output.stdout).ok_or("cargo does not say where the program is")?;
    let bytes = fs::read(&built).map_err(|e| format!("{}: {e}", built.display()))?;
    let loaded = loaded(&bytes).ok_or_else(|| format!("{} is no 64-bit ELF file", built.display()))?;
    Ok(Size { file: bytes.len() as u64, loaded })
}

/// Where cargo says that the program is.
fn executable(messages: &[u8]) -> Option<PathBuf> {
    let lines = messages.split(|byte| *byte == b'\n');
    let messages = lines.filter_map(|line| serde_json::from_slice::<serde_json::Value>(line).ok());
    let built = |message: serde_json::Value| Some(PathBuf::from(message.get("executable")?.as_str()?));
    messages.filter_map(built).reduce(|_, later| later)
}

/// What of a 64-bit little-endian ELF file is loaded from it: the file sizes of its loadable segments.
fn loaded(elf: &[u8]) -> Option<u64> {
    const LOAD: u64 = 1;
    let number = |at: usize, length: usize| {
        let bytes = elf.get(at..at.checked_add(length)?)?;
        Some(bytes.iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte)))
    };
    if elf.get(..6)? != b"\x7fELF\x02\x01" {
        return None;
    }
    let (table, entry, count) = (number(0x20, 8)? as usize, number(0x36, 2)? as usize, number(0x38, 2)? as usize);
    let mut all = 0_u64;
    for i in 0..count {
        let at = table.checked_add(i * entry)?;
        if number(at, 4)? == LOAD {
            all = all.checked_add(number(at.checked_add(0x20)?, 8)?)?;
        }
    }
    Some(all)
}

/// Both sizes as a table.
pub fn table([without, with]: &[Size; 2]) -> String {
    let row = |what: &str, size: &Size| format!("| {what} | {} | {} |\n", kilobytes(size.file), kilobytes(size.loaded));
    let more =
        Size { file: with.file.saturating_sub(without.file), loaded: with.loaded.saturating_sub(without.loaded) };
    format!(
        "| | file | loaded |\n| --- | ---: | ---: |\n{}{}{}",
        row("the robot's program", without),
        row("with `soccer.rv` and its handlers", with),
        row("more", &more)
    )
}

fn kilobytes(bytes: u64) -> String {
    format!("{} KB", bytes.div_ceil(1000))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_added_up_and_what_is_no_program_has_none() {
        let this = fs::read(std::env::current_exe().unwrap()).unwrap();
        let all = loaded(&this).unwrap();
        assert!(all > 100_000 && all < this.len() as u64, "{all}");
        assert_eq!([loaded(b""), loaded(b"MZ"), loaded(&this[..100])], [None; 3]);
    }

    #[test]
    fn the_last_executable_counts() {
        let told = b"{\"executable\":null}\n{\"executable\":\"/a/brick\"}\nnoise\n{\"reason\":\"build-finished\"}\n";
        assert_eq!(executable(told), Some(PathBuf::from("/a/brick")));
    }
}
