//! What to look at: remarks on a verdict that only a run can make.

use lapwing_check::checked::{self, Body, Connective, Expr, InputSource, Kind, ReadOf, Scope};
use lapwing_react::Property;
use lapwing_stream::{Duration, Verdict};

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
        (!x.has_future()).then(|| Latch { x: x.clone(), texts: (text(x), text(body)) })
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

/// A silence so many times as long as the usual one is worth a word, where it lasts so many nanoseconds.
const UNUSUAL: i64 = 5;
const LONG: i64 = 100_000_000;

/// The topics that a property gets its signals from, but for those whose silence it looks at itself.
pub(crate) fn topics(meaning: &checked::Spec, property: &checked::Property) -> Vec<usize> {
    let of_signal = |read: &checked::Read| match read.what {
        ReadOf::Input(input) => match meaning.inputs.get(input)?.source {
            InputSource::Field { topic, .. } => Some(topic),
            _ => None,
        },
        ReadOf::Topic(_) => None,
    };
    let watched = |topic: &usize| property.reads.iter().any(|r| r.what == ReadOf::Topic(*topic));
    let mut topics: Vec<usize> = property.reads.iter().filter_map(of_signal).filter(|t| !watched(t)).collect();
    topics.sort_unstable();
    topics.dedup();
    topics
}

/// A topic that had been silent for long when a property failed, in a recording of that length.
pub(crate) fn silence(topic: &str, messages: u64, silent: Duration, span: Duration) -> Option<String> {
    let usual = Duration::from_nanos(span.nanos() / i64::try_from(messages).ok().filter(|n| *n > 2)?);
    let is_unusual = silent.nanos() >= LONG && silent.nanos() > usual.nanos().saturating_mul(UNUSUAL);
    is_unusual.then(|| {
        format!(
            "the last message of {topic} was {:.3} s old when this failed, and there is one every {:.3} s on average: \
             was the robot at fault, or did nothing arrive? `stale after` in its `decl` tells them apart",
            silent.seconds(),
            usual.seconds()
        )
    })
}

/// Remarks on a property's verdict.
pub(crate) fn of(property: &Property) -> Vec<String> {
    let mut hints = Vec::new();
    if property.vacuous {
        hints.push(
            "nothing here put it to the test: check the condition, or record a run in which it happens".to_owned(),
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
