//! Patterns: a call stands for the pattern's formula, with the arguments in place of the parameters.
//!
//! The formula's own names mean what they mean where the pattern is written, those of the arguments what they mean where it is
//! used; so a parameter never catches a name of the caller, nor the other way round.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast::{self, Ident};

use crate::context::{Cx, Env, Site};
use crate::term::Term;

impl Cx<'_> {
    /// The formula that a call of a pattern stands for.
    pub(super) fn expand(&mut self, env: &Env, name: &Ident, args: &[ast::Expr], written: Span) -> Term {
        let span = env.place(written);
        let names = self.names;
        let (Some(&item), Some(pattern)) = (names.patterns.get(name.name.as_str()), names.pattern(&name.name)) else {
            return Term::poison(span);
        };
        self.expanded.insert(item);
        if self.graph.is_cyclic(item) {
            self.found.failed = true;
            self.found.blame(format!("the pattern `{}` uses itself", name.name));
            return Term::poison(span);
        }
        if pattern.params.len() != args.len() {
            self.wrong_count(env, pattern, args, written);
            return Term::poison(span);
        }
        let params = pattern.params.iter().map(|p| p.name.as_str()).zip(args).collect();
        let site = env.site.unwrap_or(Site { pattern: &pattern.name, span });
        let inner = Env { params, caller: Some(env), site: Some(site), ..env.of_definition() };
        self.lower(&inner, &pattern.body)
    }

    fn wrong_count(&mut self, env: &Env, pattern: &ast::Pattern, args: &[ast::Expr], span: Span) {
        let params: Vec<&str> = pattern.params.iter().map(|p| p.name.as_str()).collect();
        let name = &pattern.name.name;
        let message = format!("the pattern `{name}` takes {}, not {}", arguments(params.len()), args.len());
        let label = match args.len() < params.len() {
            true => format!("`{}` is missing", params[args.len()..].join("`, `")),
            false => format!("{} too many", args.len() - params.len()),
        };
        let diagnostic = Diagnostic::new(Code::WrongArguments, span, message)
            .label(label)
            .also(pattern.name.span, "declared here")
            .help(format!("it is called as `{name}({})`", params.join(", ")));
        self.report(env, diagnostic);
    }
}

fn arguments(count: usize) -> String {
    match count {
        0 => "no arguments".to_owned(),
        1 => "one argument".to_owned(),
        n => format!("{n} arguments"),
    }
}
