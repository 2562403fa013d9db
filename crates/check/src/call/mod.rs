//! Calls: of a function, or of a pattern.

mod geometry;
mod past;
mod pattern;
mod topic;
mod value;

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast::{self, Ident};

use crate::checked::{Dim, Expr, Func, Kind};
use crate::context::{Cx, Env};
use crate::term::Term;
use lapwing_diag::suggest;

/// Every function: its name, how it is called, and what reads such a call.
const FUNCTIONS: &[(&str, &str, Reader)] = &[
    ("abs", "abs(number)", value::same_dim),
    ("sign", "sign(number)", value::plain_number),
    ("min", "min(number, number, …) or min(array)", value::extreme),
    ("max", "max(number, number, …) or max(array)", value::extreme),
    ("sqrt", "sqrt(number)", value::sqrt),
    ("sin", "sin(angle)", value::plain_number),
    ("cos", "cos(angle)", value::plain_number),
    ("atan2", "atan2(y, x)", value::atan2),
    ("norm", "norm(vector) or norm(x, y, …)", geometry::norm),
    ("distance", "distance(vector, vector) or distance(x, y, x, y)", geometry::distance),
    ("roll", "roll(quaternion) or roll(x, y, z, w)", geometry::turn),
    ("pitch", "pitch(quaternion) or pitch(x, y, z, w)", geometry::turn),
    ("yaw", "yaw(quaternion) or yaw(x, y, z, w)", geometry::turn),
    ("angle_diff", "angle_diff(angle, angle)", value::angle_diff),
    ("angle_between", "angle_between(quaternion, quaternion)", geometry::angle_between),
    ("deg", "deg(angle)", value::deg),
    ("rad", "rad(degrees)", value::rad),
    ("isnan", "isnan(number)", value::isnan),
    ("len", "len(array) or len(text)", value::len),
    ("lookup", "lookup(names, values, \"name\")", value::lookup),
    ("starts_with", "starts_with(text, beginning)", value::text_test),
    ("ends_with", "ends_with(text, end)", value::text_test),
    ("contains", "contains(text, part)", value::text_test),
    ("any", "any(array, v => condition)", value::quantified),
    ("all", "all(array, v => condition)", value::quantified),
    ("delta", "delta(number)", past::delta),
    ("rate", "rate(number)", past::rate),
    ("min_over", "min_over(number, 5 s)", past::window),
    ("max_over", "max_over(number, 5 s)", past::window),
    ("mean_over", "mean_over(number, 5 s)", past::window),
    ("count", "count(condition, 5 s)", past::window),
    ("age", "age(/topic)", topic::age),
    ("frequency", "frequency(/topic, 2 s)", topic::frequency),
    ("fresh", "fresh(/topic)", topic::fresh),
    ("publishers", "publishers(/topic)", topic::publishers),
    ("running", "running(Component.Activity)", topic::running),
    ("entered", "entered(machine.state)", crate::machine::entered_or_left),
    ("left", "left(machine.state)", crate::machine::entered_or_left),
    ("updated", "updated(signal)", crate::machine::updated),
];

/// Reads a call; `None` where its arguments are wrong in number, which is then reported with the signature.
pub(crate) type Reader = fn(&mut Cx, &Env, &Call) -> Option<Term>;

/// A call of a function.
pub(crate) struct Call<'c> {
    pub name: &'c str,
    pub args: &'c [ast::Expr],
    /// The whole call, in the source.
    pub written: Span,
    /// The place that it is reported at.
    pub span: Span,
}

/// Whether a function has that name.
pub(crate) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|(n, ..)| *n == name)
}

impl Cx<'_> {
    /// What a call means.
    pub fn call(&mut self, env: &Env, name: &Ident, args: &[ast::Expr], written: Span) -> Term {
        let span = env.place(written);
        if let Some((_, signature, read)) = FUNCTIONS.iter().find(|(n, ..)| *n == name.name) {
            let inside = env.inside("a function", written);
            let call = Call { name: &name.name, args, written, span };
            return read(self, &inside, &call).unwrap_or_else(|| {
                self.wrong_arguments(env, name, args.len(), signature, written);
                Term::poison(span)
            });
        }
        if self.names.pattern(&name.name).is_some() {
            return self.expand(env, name, args, written);
        }
        self.unknown_function(env, name);
        Term::poison(span)
    }

    fn wrong_arguments(&mut self, env: &Env, name: &Ident, given: usize, signature: &str, span: Span) {
        let arguments = if given == 1 { "one argument".to_owned() } else { format!("{given} arguments") };
        let message = format!("`{}` cannot be called with {arguments} like this", name.name);
        let diagnostic = Diagnostic::new(Code::WrongArguments, span, message)
            .label("does not fit the signature")
            .help(format!("it is called as `{signature}`"));
        self.report(env, diagnostic);
    }

    fn unknown_function(&mut self, env: &Env, name: &Ident) {
        let functions = FUNCTIONS.iter().map(|(n, ..)| *n);
        let guess = suggest::nearest(&name.name, functions.clone().chain(self.names.patterns.keys().copied()));
        let message = format!("there is no function or pattern `{}`{}", name.name, suggest::or_else(guess));
        let mut diagnostic = Diagnostic::new(Code::UnknownFunction, name.span, message).label("unknown");
        if let Some(guess) = guess {
            diagnostic = diagnostic.fix(name.span, guess);
        } else {
            let all = functions.collect::<Vec<_>>().join(" ");
            diagnostic = diagnostic.help(format!("the functions are {all}"));
        }
        if matches!(self.names.get(&name.name), Some(crate::names::Named::Formula(_))) {
            diagnostic =
                diagnostic.help(format!("`{}` is a name without parameters: leave the brackets out", name.name));
        }
        self.report(env, diagnostic);
    }

    /// The arguments of a call as numbers.
    pub fn numbers(&mut self, env: &Env, args: &[ast::Expr]) -> Vec<Expr> {
        args.iter().map(|arg| self.lower(env, arg).number(self, env)).collect()
    }
}

/// A number that a function gives.
fn number(func: Func, args: Vec<Expr>, float: bool, dim: Dim, span: Span) -> Term {
    Term::Expr(Expr { kind: Kind::Call(func, args), ty: Type::Num { float }, dim, span })
}
