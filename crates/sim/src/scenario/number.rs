//! The numbers of a scenario: given, or to be drawn anew for every run.

use std::fmt;
use std::ops::Deref;

use serde::Deserialize;
use serde::de::{self, Deserializer, MapAccess, Visitor};

use crate::random::Random;

/// No number of a scenario is farther from zero.
const LARGEST: f64 = 1e6;

/// A number of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// Always this: `0.2`.
    Given(f64),
    /// Anything between the two: `{ between = [0.1, 0.3] }`.
    Between(f64, f64),
    /// One of these: `{ one-of = [0.1, 0.3] }`.
    OneOf(Vec<f64>),
}

impl Number {
    /// Its value in one run.
    pub fn draw(&self, random: &mut Random) -> f64 {
        match self {
            Number::Given(value) => *value,
            Number::Between(low, high) => random.between(*low, *high),
            Number::OneOf(values) => values.get(random.below(values.len())).copied().unwrap_or_default(),
        }
    }

    /// The least that it can be.
    pub fn least(&self) -> f64 {
        match self {
            Number::Given(value) => *value,
            Number::Between(low, _) => *low,
            Number::OneOf(values) => values.iter().copied().fold(f64::INFINITY, f64::min),
        }
    }

    /// The greatest that it can be.
    pub fn greatest(&self) -> f64 {
        match self {
            Number::Given(value) => *value,
            Number::Between(_, high) => *high,
            Number::OneOf(values) => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// The values of a point, or of two sides, in one run.
pub fn draw_point([x, y]: &[impl AsRef<Number>; 2], random: &mut Random) -> [f64; 2] {
    [x.as_ref().draw(random), y.as_ref().draw(random)]
}

/// A number that is not negative: a time, a speed, a distance.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Number")]
pub struct Amount(Number);

/// A number that is greater than nearly nothing: a length, a mass.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Number")]
pub struct Size(Number);

/// The least size.
const SMALLEST: f64 = 0.001;

impl Amount {
    /// That amount, or none where it is negative.
    pub const fn given(value: f64) -> Amount {
        Amount(Number::Given(value.max(0.0)))
    }
}

impl TryFrom<Number> for Amount {
    type Error = String;

    fn try_from(number: Number) -> Result<Amount, String> {
        match number.least() {
            least if least >= 0.0 => Ok(Amount(number)),
            least => Err(format!("{least} is negative, which makes no sense here")),
        }
    }
}

impl TryFrom<Number> for Size {
    type Error = String;

    fn try_from(number: Number) -> Result<Size, String> {
        match number.least() {
            least if least >= SMALLEST => Ok(Size(number)),
            least => Err(format!("{least} is too small: the least is {SMALLEST}")),
        }
    }
}

impl Deref for Amount {
    type Target = Number;

    fn deref(&self) -> &Number {
        &self.0
    }
}

impl Deref for Size {
    type Target = Number;

    fn deref(&self) -> &Number {
        &self.0
    }
}

impl AsRef<Number> for Number {
    fn as_ref(&self) -> &Number {
        self
    }
}

impl AsRef<Number> for Size {
    fn as_ref(&self) -> &Number {
        self
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Number, D::Error> {
        from.deserialize_any(NumberVisitor)
    }
}

struct NumberVisitor;

impl<'de> Visitor<'de> for NumberVisitor {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, `{ between = [0.1, 0.3] }` or `{ one-of = [0.1, 0.3] }`")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Number, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Number, E> {
        self.visit_f64(value as f64)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Number, E> {
        usable(value).map(Number::Given)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Number, A::Error> {
        let number = match map.next_key::<String>()?.as_deref() {
            Some("between") => {
                let [low, high]: [f64; 2] = map.next_value()?;
                if usable::<A::Error>(low)? > usable::<A::Error>(high)? {
                    return Err(de::Error::custom(format!(
                        "{low} is greater than {high}: the lower limit comes first"
                    )));
                }
                Number::Between(low, high)
            }
            Some("one-of") => {
                let values: Vec<f64> = map.next_value()?;
                if values.is_empty() {
                    return Err(de::Error::custom("there must be at least one number to choose from"));
                }
                values.iter().try_for_each(|v| usable::<A::Error>(*v).map(|_| ()))?;
                Number::OneOf(values)
            }
            Some(other) => return Err(de::Error::unknown_field(other, &["between", "one-of"])),
            None => return Err(de::Error::invalid_length(0, &self)),
        };
        match map.next_key::<String>()? {
            None => Ok(number),
            Some(_) => Err(de::Error::custom("a number to be drawn has one key: `between` or `one-of`")),
        }
    }
}

/// Numbers that the physics can work with.
fn usable<E: de::Error>(value: f64) -> Result<f64, E> {
    match value.abs() <= LARGEST {
        true => Ok(value),
        false => Err(E::custom(format!(
            "{value} cannot be used: a number may be at most {LARGEST}, and not less than -{LARGEST}"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    struct Table {
        x: Number,
    }

    fn read(text: &str) -> Result<Number, String> {
        toml::from_str::<Table>(&format!("x = {text}")).map(|t| t.x).map_err(|e| e.message().to_owned())
    }

    #[test]
    fn numbers_are_given_or_drawn() {
        assert_eq!(read("2"), Ok(Number::Given(2.0)));
        assert_eq!(read("-0.5"), Ok(Number::Given(-0.5)));
        let mut random = Random::new(1, "test", 0);
        let between = read("{ between = [1, 2.5] }").unwrap();
        assert!((0..100).all(|_| (1.0..2.5).contains(&between.draw(&mut random))));
        assert_eq!((between.least(), between.greatest()), (1.0, 2.5));
        let one_of = read("{ one-of = [3, 1, 2] }").unwrap();
        let drawn: Vec<f64> = (0..100).map(|_| one_of.draw(&mut random)).collect();
        assert!([1.0, 2.0, 3.0].iter().all(|v| drawn.contains(v)), "{drawn:?}");
        assert_eq!((one_of.least(), one_of.greatest()), (1.0, 3.0));
    }

    #[test]
    fn what_is_no_number_is_refused_in_words() {
        for (text, part) in [
            ("'a'", "a number, `{ between"),
            ("nan", "cannot be used"),
            ("{ between = [2, 1] }", "the lower limit comes first"),
            ("{ between = [1, inf] }", "cannot be used"),
            ("{ one-of = [] }", "at least one"),
            ("{ betwen = [1, 2] }", "expected `between` or `one-of`"),
            ("{ between = [1, 2], one-of = [1] }", "has one key"),
            ("{}", "a number"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
