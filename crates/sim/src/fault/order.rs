//! Which fault is wanted, of which robot, and when: `frozen-scan`, `frozen-scan@10`, `robot2:frozen-scan@10..20`.

use std::fmt;
use std::str::FromStr;

use serde::Deserialize;

use super::{ALL, About, Fault};
use crate::scenario::similar;

/// A fault that is wanted, of one robot or of all, for a while or from the start to the end.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Order {
    fault: Fault,
    robot: Option<String>,
    /// In seconds.
    from: Option<f64>,
    until: f64,
}

/// A text that orders no fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OrderError(String);

impl Order {
    /// The name of the fault.
    pub fn name(&self) -> &'static str {
        self.fault.about().name
    }

    /// The robot that it is meant for.
    pub fn robot(&self) -> Option<&str> {
        self.robot.as_deref()
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(robot) = &self.robot {
            write!(f, "{robot}:")?;
        }
        f.write_str(self.name())?;
        match (self.from, self.until) {
            (None, _) => Ok(()),
            (Some(from), f64::INFINITY) => write!(f, "@{from}"),
            (Some(from), until) => write!(f, "@{from}..{until}"),
        }
    }
}

impl FromStr for Order {
    type Err = OrderError;

    fn from_str(text: &str) -> Result<Order, OrderError> {
        let (robot, rest) = text.split_once(':').map_or((None, text), |(robot, rest)| (Some(robot.to_owned()), rest));
        let (name, times) = rest.split_once('@').map_or((rest, None), |(name, times)| (name, Some(times)));
        let About { fault, .. } = find(name)?;
        let (from, until) = times.map_or(Ok((None, f64::INFINITY)), span)?;
        Ok(Order { fault: *fault, robot, from, until })
    }
}

impl TryFrom<String> for Order {
    type Error = OrderError;

    fn try_from(text: String) -> Result<Order, OrderError> {
        text.parse()
    }
}

fn find(name: &str) -> Result<&'static About, OrderError> {
    ALL.iter().find(|a| a.name == name).ok_or_else(|| {
        let help = match similar(name, ALL.iter().map(|a| a.name)) {
            Some(other) => format!("did you mean `{other}`?"),
            None => format!("there are {}", ALL.iter().map(|a| a.name).collect::<Vec<_>>().join(", ")),
        };
        OrderError(format!("there is no fault called `{name}`; {help}"))
    })
}

/// `10` or `10..20`, in seconds.
fn span(text: &str) -> Result<(Option<f64>, f64), OrderError> {
    let wrong = || {
        OrderError(format!(
            "`{text}` is no time: write when the fault begins, as in `@10`, or also when it ends, as in `@10..20`"
        ))
    };
    let number = |t: &str| t.parse::<f64>().ok().filter(|x| x.is_finite() && *x >= 0.0).ok_or_else(wrong);
    match text.split_once("..") {
        None => Ok((Some(number(text)?), f64::INFINITY)),
        Some((from, until)) => {
            let (from, until) = (number(from)?, number(until)?);
            if from < until { Ok((Some(from), until)) } else { Err(wrong()) }
        }
    }
}

/// The faults of one robot.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    list: Vec<(Fault, f64, f64)>,
}

impl Faults {
    /// Those of the orders that are meant for a robot. One that happens once does so in the middle of the run, where nobody says when.
    pub fn of(robot: &str, orders: &[Order], duration: f64) -> Faults {
        let meant = orders.iter().filter(|o| o.robot.as_ref().is_none_or(|r| r == robot));
        let list = meant.map(|order| {
            let usual = if order.fault.is_sudden() { duration / 2.0 } else { 0.0 };
            (order.fault, order.from.unwrap_or(usual), order.until)
        });
        Faults { list: list.collect() }
    }

    /// Whether a fault is there at that time, in seconds.
    pub fn has(&self, fault: Fault, now: f64) -> bool {
        self.list.iter().any(|(f, from, until)| *f == fault && (*from..*until).contains(&now))
    }

    /// When a fault begins, where it is there at any time.
    pub fn begin(&self, fault: Fault) -> Option<f64> {
        self.list.iter().find(|(f, ..)| *f == fault).map(|(_, from, _)| *from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_says_what_of_whom_and_when() {
        let order: Order = "robot2:frozen-scan@10..20".parse().unwrap();
        assert_eq!((order.name(), order.robot()), ("frozen-scan", Some("robot2")));
        for text in ["robot2:frozen-scan@10..20", "frozen-scan@1.5", "frozen-scan"] {
            assert_eq!(text.parse::<Order>().unwrap().to_string(), text);
        }
        let of = |robot| Faults::of(robot, std::slice::from_ref(&order), 30.0);
        let there = |now| of("robot2").has(Fault::FrozenScan, now);
        assert_eq!([there(9.9), there(10.0), there(19.9), there(20.0)], [false, true, true, false]);
        assert!(of("robot1").begin(Fault::FrozenScan).is_none() && of("robot2").begin(Fault::LateScan).is_none());
        let sudden = Faults::of("any", &["clock-jump".parse().unwrap()], 30.0);
        assert_eq!(sudden.begin(Fault::ClockJump), Some(15.0));
    }

    #[test]
    fn a_wrong_order_is_answered_with_what_is_right() {
        let error = |text: &str| text.parse::<Order>().unwrap_err().to_string();
        assert_eq!(error("frozen-scann"), "there is no fault called `frozen-scann`; did you mean `frozen-scan`?");
        assert!(error("explosion").contains("there are direction-inverted, docking-stuck"), "{}", error("explosion"));
        for text in ["backwards@", "backwards@x", "backwards@5..", "backwards@5..4", "backwards@-1", "backwards@nan"] {
            assert!(error(text).contains("is no time"), "{text}");
        }
    }
}
