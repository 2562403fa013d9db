//! The codes: stable names of kinds of faults, each with a page.

use crate::Severity;

macro_rules! codes {
    ($($variant:ident $severity:ident $name:literal,)*) => {
        /// The kind of a diagnostic. Its name is stable and can be searched for; its page is `codes/NAME.md`.
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        #[allow(missing_docs)]
        pub enum Code { $($variant,)* }

        impl Code {
            /// All codes, in the order of their declaration.
            pub const ALL: &'static [Code] = &[$(Code::$variant,)*];

            /// The stable name: `unknown-name`.
            pub fn name(self) -> &'static str {
                match self { $(Code::$variant => $name,)* }
            }

            /// How bad a fault of this kind is.
            pub fn severity(self) -> Severity {
                match self { $(Code::$variant => Severity::$severity,)* }
            }

            /// The page that explains it, in Markdown.
            pub fn page(self) -> &'static str {
                match self { $(Code::$variant => include_str!(concat!("../codes/", $name, ".md")),)* }
            }
        }
    };
}

codes! {
    Syntax Error "syntax",
    UnclosedBracket Error "unclosed-bracket",
    UnknownWord Error "unknown-word",
    ReservedWord Error "reserved-word",
    MissingComma Error "missing-comma",
    ForeignOperator Error "foreign-operator",
    LtlNotation Error "ltl-notation",
    SingleEquals Error "single-equals",
    ChainedComparison Error "chained-comparison",
    BareMargin Error "bare-margin",
    BareDuration Error "bare-duration",
    DurationRange Error "duration-range",
    BoundNotAllowed Error "bound-not-allowed",
    BadNumber Error "bad-number",
    UnknownUnit Error "unknown-unit",
    BadText Error "bad-text",
    BadName Error "bad-name",
    BadSetting Error "bad-setting",
    StrayCharacter Error "stray-character",
    TooDeep Error "too-deep",
    UnknownName Error "unknown-name",
    UnknownFunction Error "unknown-function",
    UnknownField Error "unknown-field",
    UnknownState Error "unknown-state",
    UnknownLibrary Error "unknown-library",
    DuplicateName Error "duplicate-name",
    RecursiveName Error "recursive-name",
    TypeMismatch Error "type-mismatch",
    DimensionMismatch Error "dimension-mismatch",
    WrongArguments Error "wrong-arguments",
    FutureInside Error "future-inside",
    EmptyBound Error "empty-bound",
    NotADuration Error "not-a-duration",
    NotConstant Error "not-constant",
    ClockConflict Error "clock-conflict",
    OverSignals Error "over-signals",
    Misplaced Error "misplaced",
    NotJudged Error "not-judged",
    NotGenerated Error "not-generated",
    NoInitialState Error "no-initial-state",
    WorldSource Error "world-source",
    TooLarge Error "too-large",
    MissingTopic Warning "missing-topic",
    MissingColumn Warning "missing-column",
    MissingEvent Warning "missing-event",
    TopicType Warning "topic-type",
    UnknownType Warning "unknown-type",
    FloatEquality Warning "float-equality",
    MixedAndOr Warning "mixed-and-or",
    UnusedName Warning "unused-name",
    LibraryProperty Warning "library-property",
    JudgedOnce Warning "judged-once",
    BoundUnderThreePeriods Warning "bound-under-three-periods",
    CannotFail Warning "cannot-fail",
    CannotHold Warning "cannot-hold",
    LatchedAfter Warning "latched-after",
    SamplingUnseen Warning "sampling-unseen",
    AssumedFlat Note "assumed-flat",
    MissingInclude Error "missing-include",
    BadDirective Error "bad-directive",
    MissingSource Error "missing-source",
    MissingStart Error "missing-start",
    MissingTask Error "missing-task",
    UnknownPort Error "unknown-port",
    UnknownTask Error "unknown-task",
    UnknownService Error "unknown-service",
    UnknownEvent Error "unknown-event",
    UndeclaredException Error "undeclared-exception",
    BadProperty Error "bad-property",
    CodelClash Error "codel-clash",
    UnreachableCodel Error "unreachable-codel",
    StopWithoutEther Error "stop-without-ether",
    PauseEther Error "pause-ether",
    UnusualSyntax Warning "unusual-syntax",
    AsyncSharesData Warning "async-shares-data",
    TaskWithoutPeriod Warning "task-without-period",
    WcetOverPeriod Warning "wcet-over-period",
    PeriodOverrun Warning "period-overrun",
    AmbiguousPort Warning "ambiguous-port",
    BipClauseOrder Error "bip-clause-order",
    BipUnknownName Error "bip-unknown-name",
    BipUnknownPackage Error "bip-unknown-package",
    BipType Error "bip-type",
    BipArguments Error "bip-arguments",
    BipConst Error "bip-const",
    BipClock Error "bip-clock",
    BipTwoWindows Error "bip-two-windows",
    BipComponentTwice Error "bip-component-twice",
    BipInteraction Error "bip-interaction",
    BipRecursive Error "bip-recursive",
    BipRoot Error "bip-root",
    BipExternal Error "bip-external",
    BipPriorityCycle Error "bip-priority-cycle",
    BipNotConnected Warning "bip-not-connected",
    ImportSyntax Error "import-syntax",
    ImportRefused Error "import-refused",
    ImportEvent Warning "import-event",
    ImportDiffers Warning "import-differs",
    ImportFirstPosition Warning "import-first-position",
    ImportParameter Warning "import-parameter",
    ImportTrigger Note "import-trigger",
    ImportCode Note "import-code",
    ImportRenamed Note "import-renamed",
}

impl Code {
    /// The code of that name.
    pub fn from_name(name: &str) -> Option<Code> {
        Code::ALL.iter().copied().find(|c| c.name() == name)
    }
}
