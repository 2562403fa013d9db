//! Physical dimensions and units: everything is counted in metres, seconds and radians.
//!
//! A dimension is known or not. A bare literal's is not, and what is not known fits everything: a false alarm would stop a
//! specification that is right. Angles are counted but never held against anyone, for `omega * radius` is a velocity.

use lapwing_syntax::ast::Unit;

use crate::checked::Dim;

/// Dimensions that have names.
#[allow(missing_docs)]
impl Dim {
    pub const UNKNOWN: Dim = Dim(None);
    pub const PLAIN: Dim = Dim(Some([0, 0, 0]));
    pub const LENGTH: Dim = Dim(Some([1, 0, 0]));
    pub const TIME: Dim = Dim(Some([0, 1, 0]));
    pub const ANGLE: Dim = Dim(Some([0, 0, 1]));
    pub const SPEED: Dim = Dim(Some([1, -1, 0]));
    pub const ACCELERATION: Dim = Dim(Some([1, -2, 0]));
    pub const TURNING: Dim = Dim(Some([0, -1, 1]));
    pub const FREQUENCY: Dim = Dim(Some([0, -1, 0]));
}

impl Dim {
    /// The dimension of a product.
    pub fn times(self, other: Dim) -> Dim {
        self.combine(other, i8::checked_add)
    }

    /// The dimension of a quotient.
    pub fn per(self, other: Dim) -> Dim {
        self.combine(other, i8::checked_sub)
    }

    fn combine(self, other: Dim, with: fn(i8, i8) -> Option<i8>) -> Dim {
        let (Some(a), Some(b)) = (self.0, other.0) else { return Dim::UNKNOWN };
        let parts: Option<Vec<i8>> = a.iter().zip(b).map(|(&x, y)| with(x, y)).collect();
        Dim(parts.and_then(|p| p.try_into().ok()))
    }

    /// The dimension of a square root.
    pub fn root(self) -> Dim {
        match self.0 {
            Some(parts) if parts.iter().all(|p| p % 2 == 0) => Dim(Some(parts.map(|p| p / 2))),
            _ => Dim::UNKNOWN,
        }
    }

    /// The dimension of either of two things that must agree.
    pub fn or(self, other: Dim) -> Dim {
        if self.0.is_some() { self } else { other }
    }

    /// Whether two things may be added or compared.
    pub fn fits(self, other: Dim) -> bool {
        match (self.0, other.0) {
            (Some([length, time, _]), Some([l, t, _])) => length == l && time == t,
            _ => true,
        }
    }

    /// The unit that things of this dimension are counted in: `m/s`.
    pub fn unit(self) -> String {
        let Some(parts) = self.0 else { return "an unknown unit".to_owned() };
        let bases = ["m", "s", "rad"];
        let power = |base: &str, exponent: i8| match exponent {
            1 => base.to_owned(),
            e => format!("{base}^{e}"),
        };
        let side = |wanted: fn(i8) -> bool| {
            let pick = bases.iter().zip(parts).filter(|(_, e)| wanted(*e));
            pick.map(|(b, e)| power(b, e.saturating_abs())).collect::<Vec<_>>().join(" ")
        };
        match (side(|e| e > 0), side(|e| e < 0)) {
            (above, below) if above.is_empty() && below.is_empty() => "a plain number".to_owned(),
            (above, below) if below.is_empty() => above,
            (above, below) if above.is_empty() => format!("1/{below}"),
            (above, below) => format!("{above}/{below}"),
        }
    }
}

/// A literal's value in metres, seconds and radians, and its dimension.
pub(crate) fn in_si(value: f64, unit: Unit) -> (f64, Dim) {
    match unit {
        Unit::Ns => (value / 1e9, Dim::TIME),
        Unit::Us => (value / 1e6, Dim::TIME),
        Unit::Ms => (value / 1e3, Dim::TIME),
        Unit::S => (value, Dim::TIME),
        Unit::Min => (value * 60.0, Dim::TIME),
        Unit::H => (value * 3600.0, Dim::TIME),
        Unit::Mm => (value / 1e3, Dim::LENGTH),
        Unit::Cm => (value / 1e2, Dim::LENGTH),
        Unit::M => (value, Dim::LENGTH),
        Unit::Km => (value * 1e3, Dim::LENGTH),
        Unit::MPerS => (value, Dim::SPEED),
        Unit::MPerS2 => (value, Dim::ACCELERATION),
        Unit::Rad => (value, Dim::ANGLE),
        Unit::RadPerS => (value, Dim::TURNING),
        Unit::Deg => (value.to_radians(), Dim::ANGLE),
        Unit::DegPerS => (value.to_radians(), Dim::TURNING),
        Unit::Hz => (value, Dim::FREQUENCY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_combine() {
        assert_eq!(Dim::LENGTH.per(Dim::TIME), Dim::SPEED);
        assert_eq!(Dim::SPEED.times(Dim::SPEED).root(), Dim::SPEED);
        assert_eq!(Dim::LENGTH.root(), Dim::UNKNOWN);
        assert!(Dim::ANGLE.fits(Dim::PLAIN) && !Dim::LENGTH.fits(Dim::PLAIN));
        assert!(Dim::TURNING.times(Dim::LENGTH).fits(Dim::SPEED));
        assert_eq!([Dim::ACCELERATION.unit(), Dim::FREQUENCY.unit()], ["m/s^2", "1/s"]);
    }

    #[test]
    fn huge_powers_become_unknown() {
        let mut dim = Dim::LENGTH;
        for _ in 0..20 {
            dim = dim.times(dim);
        }
        assert_eq!(dim, Dim::UNKNOWN);
    }
}
