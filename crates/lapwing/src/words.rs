//! The words of the language that reports use.

use lapwing_check::checked::Scope;

/// The word of a scope.
pub(crate) fn scope(scope: Scope) -> &'static str {
    match scope {
        Scope::After => "after",
        Scope::Until => "until",
        Scope::Before => "before",
        Scope::While => "while",
        Scope::Whenever => "whenever",
    }
}
