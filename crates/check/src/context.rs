//! What is carried through the check: the specification as far as it is built, what was found wrong, and where in the text we are.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_diag::{Code, Diagnostic, Label, Severity, SourceMap, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast::{self, ExprKind};

use crate::checked::{Dim, Expr, Kind, Spec};
use crate::definitions::Definitions;
use crate::graph::Graph;
use crate::machine::MachineTable;
use crate::names::Names;
use crate::service::ServiceHalf;
use crate::trace::TraceShape;
use crate::walk;

/// Expressions nested more deeply, after expansion, are refused: everything behind the check may recurse.
const DEEPEST: usize = 600;

/// A specification that grows beyond this many nodes, after expansion, is refused.
pub(crate) const MOST_NODES: usize = 200_000;

/// The state of a check.
pub(crate) struct Cx<'a> {
    pub sources: &'a SourceMap,
    pub names: &'a Names<'a>,
    pub graph: &'a Graph,
    /// The messages that reactions write.
    pub definitions: &'a Definitions,
    pub trace: Option<&'a TraceShape>,
    pub machines: MachineTable,
    /// The default margin, where one is set.
    pub margin: Option<f64>,
    /// What is built.
    pub spec: Spec,
    pub diagnostics: Vec<Diagnostic>,
    /// What was found of the thing that is being read now.
    pub found: Found,
    /// What was found wrong with each declared event.
    pub event_found: Vec<Found>,
    /// The events that are a half of a service.
    pub halves: BTreeMap<usize, ServiceHalf>,
    /// How many `any` and `all` we are inside.
    pub lambdas: usize,
    /// How many nodes may still be built.
    pub budget: usize,
    /// The patterns that have been expanded.
    pub expanded: BTreeSet<usize>,
}

/// What was found wrong with one property, machine or event.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    /// Why it cannot be judged on this trace.
    pub causes: Vec<String>,
    /// Whether there was an error: then what has been built means nothing.
    pub failed: bool,
}

impl Found {
    /// One more cause, said once.
    pub fn blame(&mut self, cause: String) {
        if !self.causes.contains(&cause) {
            self.causes.push(cause);
        }
    }

    /// All causes in one sentence.
    pub fn problem(&self) -> Option<String> {
        (!self.causes.is_empty()).then(|| self.causes.join("; "))
    }
}

impl<'a> Cx<'a> {
    /// Runs `read` with a clean slate and gives back what was found meanwhile.
    pub fn apart<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> (T, Found) {
        let before = std::mem::take(&mut self.found);
        let value = read(self);
        (value, std::mem::replace(&mut self.found, before))
    }

    /// The same, where what is read on the way is wanted of no recording.
    pub fn aside<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> (T, Found) {
        let spec = self.spec.clone();
        let read = self.apart(read);
        self.spec = spec;
        read
    }

    /// A diagnostic about the place that `env` describes. An error is also the cause why what is being read cannot be judged.
    pub fn report(&mut self, env: &Env, diagnostic: Diagnostic) {
        let diagnostic = env.relocate(diagnostic);
        if diagnostic.severity == Severity::Error {
            self.found.failed = true;
            self.found.blame(diagnostic.message.clone());
        }
        self.diagnostics.push(diagnostic);
    }

    /// Whether names of columns need no declaration.
    pub fn schemaless(&self) -> bool {
        self.trace.is_some_and(|t| t.schemaless)
    }

    /// Whether the trace is known and its topics have types.
    pub fn has_schemas(&self) -> bool {
        self.trace.is_some_and(|t| !t.schemaless)
    }

    /// Counts a node; `false`, once reported, where too many have been built or the nesting is too deep.
    pub fn allows(&mut self, env: &Env, span: Span) -> bool {
        if env.depth > DEEPEST {
            let d = Diagnostic::new(
                Code::TooDeep,
                span,
                format!("nested more than {DEEPEST} deep, counting what the names in it stand for"),
            )
            .help("give its parts names, or break it up into several properties");
            self.report(env, d);
            return false;
        }
        match self.budget {
            0 => self.found.failed = true,
            1 => {
                self.budget = 0;
                let d = Diagnostic::new(
                    Code::TooLarge,
                    span,
                    format!("the specification grows beyond {MOST_NODES} parts when its names are expanded"),
                )
                .label("here the limit is reached")
                .help("names that stand for names twice over double with every step");
                self.report(env, d);
            }
            _ => self.budget -= 1,
        }
        self.budget > 0
    }
}

/// Where in the text we are.
#[derive(Clone, Default)]
pub(crate) struct Env<'e> {
    /// The parameters of the pattern that is being expanded, with their arguments.
    pub params: Vec<(&'e str, &'e ast::Expr)>,
    /// Where those arguments stand.
    pub caller: Option<&'e Env<'e>>,
    /// The outermost use of the pattern.
    pub site: Option<Site<'e>>,
    /// The variables of `any` and `all`, innermost last.
    pub vars: Vec<Var>,
    /// The variables of `for each … of`, outermost first.
    pub slices: &'e [String],
    /// The variables of `for each … in topics` while no trace says what they stand for.
    pub topics: &'e [String],
    /// The parameters of a pattern that is read by itself: they may stand for anything.
    pub unknown: &'e [ast::Ident],
    /// In an event's `when`: that event.
    pub event: Option<usize>,
    /// In a machine's `sample when`.
    pub sampling: bool,
    /// Why no operator about the future may stand here, and the place that forbids it.
    pub no_future: Option<(&'static str, Span)>,
    /// How deeply we are nested.
    pub depth: usize,
}

/// The use of a pattern.
#[derive(Clone, Copy)]
pub(crate) struct Site<'e> {
    pub pattern: &'e ast::Ident,
    pub span: Span,
}

/// A variable of `any` or `all`.
#[derive(Clone)]
pub(crate) struct Var {
    pub name: String,
    /// How many quantifiers stand around its own.
    pub level: usize,
    pub ty: Type,
    pub known: crate::messages::Known,
}

impl<'e> Env<'e> {
    /// The same place, inside something that forbids the future.
    pub fn inside(&self, what: &'static str, span: Span) -> Env<'e> {
        Env { no_future: self.no_future.or(Some((what, span))), ..self.deeper() }
    }

    /// Whether an expression has a parameter in it that may stand for anything.
    pub fn is_open(&self, expr: &ast::Expr) -> bool {
        let mut open = false;
        let is_unknown = |name: &str| self.unknown.iter().any(|p| p.name == name);
        walk::every(expr, |e| match &e.kind {
            ExprKind::Path(idents) => open |= idents.first().is_some_and(|head| is_unknown(&head.name)),
            _ => open |= walk::duration_names(e).into_iter().any(|name| is_unknown(&name.name)),
        });
        open
    }

    /// One level further in.
    pub fn deeper(&self) -> Env<'e> {
        Env { depth: self.depth + 1, ..self.clone() }
    }

    /// The place of something with this `span`: a pattern's parts stand where the pattern is used.
    pub fn place(&self, span: Span) -> Span {
        self.site.map_or(span, |site| site.span)
    }

    /// The scope of a name's definition, entered from here: nothing of this place can be named there.
    pub fn of_definition(&self) -> Env<'static> {
        Env { no_future: self.no_future, depth: self.depth + 1, sampling: self.sampling, ..Env::default() }
    }

    /// Points a diagnostic to the use of the pattern that we are in.
    fn relocate(&self, mut diagnostic: Diagnostic) -> Diagnostic {
        let Some(site) = self.site else { return diagnostic };
        let at = diagnostic.primary.span;
        let text = format!("in the pattern `{}`, used here", site.pattern.name);
        if at == site.span {
            diagnostic.secondary.push(Label { span: site.pattern.span, text: "from this pattern".to_owned() });
        } else if at.file == site.span.file && at.start >= site.span.start && at.end <= site.span.end {
            return diagnostic;
        } else {
            diagnostic.secondary.insert(0, diagnostic.primary);
        }
        diagnostic.primary = Label { span: site.span, text };
        diagnostic.fix = None;
        diagnostic
    }
}

/// What stands where an error has been reported: it goes with everything.
pub(crate) fn poison(span: Span) -> Expr {
    Expr { kind: Kind::Bool(false), ty: Type::Any, dim: Dim::UNKNOWN, span }
}
