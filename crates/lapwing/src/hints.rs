//! What to look at: remarks on a verdict that only a run can make.

use lapwing_check::checked::{self, Body, Connective, Expr, Kind, Scope};
use lapwing_react::Property;
use lapwing_stream::Verdict;

use crate::eval;
use crate::spec::Spec;

/// The `after X, φ` of a property.
#[derive(Clone, Debug)]
pub(crate) struct Latch {
    /// Its X.
    pub x: Expr,
    /// The texts of X and of φ.
    texts: (String, String),
}

impl Latch {
    /// The outermost `after` of a property whose X can be looked at.
    pub fn of(spec: &Spec, property: &checked::Property) -> Option<Latch> {
        let Body::Formula(formula) = &property.body else { return None };
        let (x, body) = after(formula)?;
        let text = |e: &Expr| spec.slice(e.span).split_whitespace().collect::<Vec<_>>().join(" ");
        eval::is_plain(x).then(|| Latch { x: x.clone(), texts: (text(x), text(body)) })
    }

    /// What to say where the property failed although X had ceased to hold.
    pub fn hint(&self) -> String {
        let (x, body) = &self.texts;
        format!(
            "`{x}` had become false again before the failure, but `after` looks at everything from the first time on.\n\
             Where only the time during which it holds is meant: `while {x}, {body}`;\n\
             where it must have held for a while: `whenever held for 0.5 s ({x}), {body}`"
        )
    }
}

fn after(formula: &Expr) -> Option<(&Expr, &Expr)> {
    match &formula.kind {
        Kind::Scope(Scope::After, x, body) => Some((x, body)),
        Kind::Scope(_, _, body) | Kind::Always(_, body) => after(body),
        Kind::Connective(Connective::And, l, r) => after(l).or_else(|| after(r)),
        _ => None,
    }
}

/// Remarks on a property's verdict.
pub(crate) fn of(property: &Property) -> Vec<String> {
    let mut hints = Vec::new();
    if property.vacuous {
        hints.push(
            "nothing in this recording put it to the test: check the condition, or record a run in which it happens"
                .to_owned(),
        );
    }
    if property.nans > 0 && property.verdict != Verdict::Inconclusive {
        hints.push(
            "a comparison with NaN is false whatever it compares (but for `!=`): guard it with `not isnan(…)`"
                .to_owned(),
        );
    }
    hints
}
