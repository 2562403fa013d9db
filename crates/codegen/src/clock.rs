//! Clocks: since when parts of a formula wait whose bounds began later than the obligation itself.
//!
//! `always within 2 s eventually within 1 s q` waits, at every position without q, for a q of its own. But who waits longest is the first to be
//! disappointed, and all are satisfied by the same q: one clock says it all, which begins where q was missing first. [`Rest::join`] drops what
//! another part implies ([`Rest::implies`]); what is left runs by few clocks, or the formula has no monitor of a fixed size.

use lapwing_engine::program::Bound;

use crate::residual::{Atom, Rest};

/// A clock of an obligation, by its place in the order of age: the older, the smaller.
pub(crate) type Clock = u8;

/// The clock that began with the obligation.
pub(crate) const BEGUN: Clock = 0;
/// The clock that begins at the position that is seen.
pub(crate) const NOW: Clock = u8::MAX;
/// So many clocks an obligation may have beside [`BEGUN`].
pub(crate) const MOST: usize = 4;

/// What waits for further positions, by a bound or by none.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Wait {
    /// The formula.
    pub id: usize,
    /// What its bound runs by; `None` where there is no bound.
    pub clock: Option<Clock>,
    order: Order,
}

/// Which of two that wait for the same, one longer than the other, implies the other.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
enum Order {
    /// Neither.
    None,
    /// Its bound ends sooner: what satisfies the older satisfies the younger.
    Older,
    /// Its bound begins later, and never ends: what satisfies the younger satisfies the older.
    Younger,
}

impl Wait {
    /// What has a bound that begins now.
    pub fn by(id: usize, bound: &Bound) -> Wait {
        let order = match (bound.contains(0), bound.has_end()) {
            (true, _) => Order::Older,
            (false, false) => Order::Younger,
            (false, true) => Order::None,
        };
        Wait { id, clock: (*bound != Bound::ALL).then_some(NOW), order }
    }

    /// What waits without a bound.
    pub fn forever(id: usize) -> Wait {
        Wait { id, clock: None, order: Order::None }
    }

    /// As [`Rest::implies`].
    fn implies(&self, other: &Wait) -> bool {
        self.id == other.id
            && match self.order {
                Order::None => self.clock == other.clock,
                Order::Older => self.clock <= other.clock,
                Order::Younger => self.clock >= other.clock,
            }
    }
}

impl Rest {
    /// Whether it never lies above the other in the order false, unknown, true, whatever comes. Where it says so it is so; it does not
    /// find everything.
    pub fn implies(&self, other: &Rest) -> bool {
        match (self, other) {
            (Rest::Any(of), _) => of.iter().all(|part| part.implies(other)),
            (_, Rest::All(of)) => of.iter().all(|part| self.implies(part)),
            (Rest::All(of), Rest::Any(others)) => {
                of.iter().any(|part| part.implies(other)) || others.iter().any(|part| self.implies(part))
            }
            (Rest::All(of), _) => of.iter().any(|part| part.implies(other)),
            (_, Rest::Any(others)) => others.iter().any(|part| self.implies(part)),
            (Rest::Open(a, false), Rest::Open(b, false)) => a.implies(b),
            (Rest::Open(a, true), Rest::Open(b, true)) => b.implies(a),
            _ => self == other,
        }
    }

    /// The clocks in use beside [`BEGUN`], the oldest first.
    pub fn clocks(&self) -> Vec<Clock> {
        let mut clocks = Vec::new();
        self.waits(&mut |wait| clocks.extend(wait.clock.filter(|&clock| clock != BEGUN)));
        clocks.sort_unstable();
        clocks.dedup();
        clocks
    }

    /// Whether it matters when the obligation began.
    pub fn asks_begin(&self) -> bool {
        let mut asks = false;
        self.waits(&mut |wait| asks |= wait.clock == Some(BEGUN));
        asks
    }

    fn waits(&self, see: &mut dyn FnMut(&Wait)) {
        match self {
            Rest::Known(_) | Rest::Open(Atom::Next(_) | Atom::Each(_, None), _) => {}
            Rest::Open(Atom::Still(wait), _) => see(wait),
            Rest::Open(Atom::UpTo(_, of) | Atom::Each(_, Some(of)), _) => of.waits(see),
            Rest::All(of) | Rest::Any(of) => of.iter().for_each(|part| part.waits(see)),
        }
    }

    /// The same by other clocks, in the same order of age.
    pub fn by(&self, name: &dyn Fn(Clock) -> Clock) -> Rest {
        match self {
            Rest::Known(_) => self.clone(),
            Rest::Open(atom, negated) => Rest::Open(atom.by(name), *negated),
            Rest::All(of) => Rest::All(of.iter().map(|part| part.by(name)).collect()),
            Rest::Any(of) => Rest::Any(of.iter().map(|part| part.by(name)).collect()),
        }
    }
}

impl Atom {
    fn implies(&self, other: &Atom) -> bool {
        match (self, other) {
            (Atom::Still(a), Atom::Still(b)) => a.implies(b),
            (Atom::UpTo(a, x), Atom::UpTo(b, y)) | (Atom::Each(a, Some(x)), Atom::Each(b, Some(y))) => {
                a == b && x.implies(y)
            }
            _ => self == other,
        }
    }

    fn by(&self, name: &dyn Fn(Clock) -> Clock) -> Atom {
        match self {
            Atom::Still(wait) => Atom::Still(Wait { clock: wait.clock.map(name), ..*wait }),
            Atom::UpTo(id, of) => Atom::UpTo(*id, Box::new(of.by(name))),
            Atom::Each(id, Some(of)) => Atom::Each(*id, Some(Box::new(of.by(name)))),
            Atom::Next(_) | Atom::Each(_, None) => self.clone(),
        }
    }
}
