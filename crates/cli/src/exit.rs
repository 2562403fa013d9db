//! Exit codes: scripts rely on them.

use std::process::ExitCode;

use lapwing_react::Standing;

/// How a command ends, with its code.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Exit {
    /// Every property came out well: 0.
    Good,
    /// A property failed: 1.
    Failed,
    /// The command line or a specification is wrong, whatever the recording: 2. Nothing was checked.
    Wrong,
    /// None failed, but something could not be judged or was not looked at: 3.
    Open,
    /// A model came to its end: the codes of the BIP engine.
    Bip(u8),
}

impl Exit {
    /// After recordings that stand like this, all of which were looked at, or not.
    pub fn of(standing: Standing, all_looked_at: bool) -> Exit {
        match (standing, all_looked_at) {
            (Standing::Failed, _) => Exit::Failed,
            (Standing::Open, _) | (Standing::Good, false) => Exit::Open,
            (Standing::Good, true) => Exit::Good,
        }
    }

    /// The code.
    pub fn code(self) -> u8 {
        match self {
            Exit::Good => 0,
            Exit::Failed => 1,
            Exit::Wrong => 2,
            Exit::Open => 3,
            Exit::Bip(code) => code,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_outweighs_doubt_and_doubt_outweighs_success() {
        let codes = [Standing::Good, Standing::Open, Standing::Failed]
            .map(|s| [Exit::of(s, true).code(), Exit::of(s, false).code()]);
        assert_eq!(codes, [[0, 3], [3, 3], [1, 1]]);
        assert_eq!(Exit::Wrong.code(), 2);
    }
}
