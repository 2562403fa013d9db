//! When the positions of a group or a machine begin.

use lapwing_engine::program::{Positions, Read};

use crate::code::{Block, Expr, Ty, Unit, field};
use crate::past::looks_back;
use crate::scene::Scene;

/// Leaves the function where the instant is no position and nothing looks at it. Gives whether it is one, where that is not certain from
/// there on.
pub(crate) fn enter(scene: &Scene<'_>, at: &Positions, prefix: &str, unit: &mut Unit, b: &mut Block) -> Expr {
    if let Some(alphabet) = &at.alphabet {
        let any = alphabet.iter().map(|&e| field(scene.event_field(e))).fold(Expr::Bool(false), |a, b| a | b);
        b.when(!any, Block::leave);
        return Expr::Bool(true);
    }
    let started = unit.field(&format!("{prefix}_started"), Ty::Bool, false.into(), "Whether position 0 has come.");
    b.when(!started.clone(), |b| {
        let ready = at.reads.iter().enumerate().fold(Expr::Bool(true), |all, (i, &(read, depth))| {
            all & is_ready(scene, (read, depth), &format!("{prefix}_waited{i}"), unit, b)
        });
        b.when(ready, |b| b.set(&started, true));
    });
    if looks_back(at) {
        return started;
    }
    b.when(!started, Block::leave);
    Expr::Bool(true)
}

/// Whether something has been defined for more than so many instants.
fn is_ready(scene: &Scene<'_>, (read, depth): (Read, usize), name: &str, unit: &mut Unit, b: &mut Block) -> Expr {
    let defined = scene.is_defined(read);
    if depth == 0 {
        return defined;
    }
    let waited = unit.field(name, Ty::U32, 0.into(), "For how many instants a signal has been defined.");
    b.when(defined & waited.clone().le(depth as i64), |b| b.add(&waited, 1));
    waited.gt(depth as i64)
}
