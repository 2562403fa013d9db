//! Hostile input: each [`Target`] makes something of any bytes, and panics only where Lapwing does or breaks a promise.
//!
//! The fuzz targets and the tests share them, so that whatever the fuzzer once found stays found.

mod components;
mod files;
mod hostile;
mod imports;
mod live;
mod models;
mod texts;

/// Tries one thing on the bytes.
pub type Target = fn(&[u8]);

/// All of them, by the names of the fuzz targets.
pub const TARGETS: &[(&str, Target)] = &[
    ("parse", texts::parse),
    ("format", texts::format),
    ("check", texts::check),
    ("gen", components::gen_file),
    ("requests", components::requests),
    ("wire", components::wire),
    ("mcap", files::mcap),
    ("bag", files::bag),
    ("db3", files::db3),
    ("csv", files::csv),
    ("ndjson", files::ndjson),
    ("definition", files::definition),
    ("tcpros", live::tcpros),
    ("ros2", live::ros2),
    ("step", hostile::step),
    ("differential", hostile::differential),
    ("bip", models::bip),
    ("import", imports::import),
];

/// The target of that name.
///
/// # Panics
/// Where there is none.
pub fn target(name: &str) -> Target {
    TARGETS.iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("no target is called {name}")).1
}

/// Choices taken from bytes, zeros where these are used up.
struct Dice<'d> {
    data: &'d [u8],
}

impl Dice<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.data.split_first() else { return 0 };
        self.data = rest;
        *first
    }

    /// A number below `n`, of at most two bytes.
    fn below(&mut self, n: usize) -> usize {
        let high = if n > 256 { usize::from(self.byte()) << 8 } else { 0 };
        (high | usize::from(self.byte())) % n.max(1)
    }

    fn long(&mut self) -> u64 {
        (0..8).fold(0, |all, _| all << 8 | u64::from(self.byte()))
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }
}
