//! A specification made ready for traces of one shape: what stays the same from one run to the next.

use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};

use lapwing_check::{Checked, TraceShape, checked, compile};
use lapwing_diag::Diagnostic;
use lapwing_engine::Program;
use lapwing_react::Property;

use crate::hints::{self, Latch};
use crate::spec::Spec;
use crate::trail::Positions;
use crate::witness::Interest;
use crate::{account, explain, shown};

/// A specification made ready for traces of one shape.
#[derive(Debug)]
pub(crate) struct Fitted {
    /// What the shape revealed of the specification.
    pub diagnostics: Vec<Diagnostic>,
    /// What the specification means there.
    pub meaning: checked::Spec,
    /// What the engine runs.
    pub program: Program,
    /// For each property its `after X`, where it has one.
    pub latches: Vec<Option<Latch>>,
    /// The properties as they are before anything is known of them.
    pub blanks: Vec<Property>,
    /// What is to be noted of each property.
    pub interests: Arc<[Interest]>,
}

impl Fitted {
    /// What a specification has been checked to mean, made ready; `open_limit` says how many runs of obligations a property may have open, where
    /// it is not as many as usual.
    pub fn new(spec: &Spec, checked: Checked, open_limit: Option<NonZeroUsize>) -> Fitted {
        let diagnostics = checked.beyond(&spec.findings().diagnostics).cloned().collect();
        let meaning = checked.spec;
        let mut program = compile::compile(&meaning);
        program.open_limit = open_limit.map_or(program.open_limit, NonZeroUsize::get);
        let latches: Vec<_> = meaning.properties.iter().map(|p| Latch::of(spec, p)).collect();
        let interest = |(property, latch): (&checked::Property, &Option<Latch>)| Interest {
            shown: shown::everything(spec, &meaning, property),
            positions: Positions::of(&meaning, property),
            latch: latch.clone(),
            latency: explain::latency(&meaning, property),
            topics: hints::topics(&meaning, property),
        };
        let interests = meaning.properties.iter().zip(&latches).map(interest).collect();
        let blanks = meaning.properties.iter().map(|p| account::blank(spec, &meaning, p)).collect();
        Fitted { diagnostics, meaning, program, latches, blanks, interests }
    }
}

/// The latest that a specification was fitted to. Of a folder of recordings, and of a campaign, most have the shape of the one before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Latest(Arc<Mutex<Option<Fitting>>>);

/// A shape and a limit, and the specification made ready for them.
#[derive(Debug)]
struct Fitting {
    shape: TraceShape,
    open_limit: Option<NonZeroUsize>,
    fitted: Arc<Fitted>,
}

impl Latest {
    /// The specification made ready for traces of that shape: the latest, if it was for such, else by `new`.
    pub fn get(
        &self,
        shape: &TraceShape,
        open_limit: Option<NonZeroUsize>,
        new: impl FnOnce() -> Fitted,
    ) -> Arc<Fitted> {
        let locked = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = locked()
            .as_ref()
            .filter(|of| of.open_limit == open_limit && of.shape == *shape)
            .map(|of| of.fitted.clone());
        known.unwrap_or_else(|| {
            // Nobody waits meanwhile: two at once make it twice.
            let fitted = Arc::new(new());
            *locked() = Some(Fitting { shape: shape.clone(), open_limit, fitted: fitted.clone() });
            fitted
        })
    }
}

#[cfg(test)]
mod tests {
    use lapwing_check::TraceTopic;

    use super::*;

    #[test]
    fn what_has_the_same_shape_is_fitted_once() {
        let spec = Spec::parse("a.rv", "decl x /odom Odometry.pose.pose.position.x\nalways x < 1\n", &|_| None);
        let spec = spec.expect("it is right");
        let topic = TraceTopic { name: "/odom".into(), type_name: "nav_msgs/Odometry".into(), schema: None };
        let shape = TraceShape { topics: vec![topic], ..TraceShape::default() };
        let first = spec.fitted(&shape, None);
        assert!(Arc::ptr_eq(&first, &spec.clone().fitted(&shape, None)), "clones share it");
        let limited = spec.fitted(&shape, NonZeroUsize::new(7));
        assert_eq!((limited.program.open_limit, first.program.open_limit == 7), (7, false));
        let without = spec.fitted(&TraceShape::default(), None);
        let has_problem =
            |fitted: &Fitted| fitted.meaning.properties.iter().map(|p| p.problem.is_some()).collect::<Vec<_>>();
        assert_eq!((has_problem(&first), has_problem(&without)), (vec![false], vec![true]));
    }
}
