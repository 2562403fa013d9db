//! What could not be seen, since when and until when, and what that means for a property.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_react::shown::{Origin, seconds};
use lapwing_stream::{Duration, Time};

use crate::status::{Cause, Kind};

/// So many spells of one cause are kept one by one; of further ones only their number and length.
const KEPT: usize = 1000;

/// So many causes are told apart; after that those of one kind and topic count as one, whatever their details.
const CAUSES: usize = 256;

/// So many causes are named in a verdict.
const NAMED: usize = 3;

/// A topic, or everything.
type Of = Option<String>;

/// The times at which something could not be seen.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    /// What cannot be seen now, and since when.
    open: BTreeMap<(Of, Cause), Time>,
    /// What could not be seen, in the order in which it was first so.
    past: Vec<Spells>,
}

/// The times at which one thing could not be seen for one cause.
#[derive(Debug)]
struct Spells {
    of: Of,
    cause: Cause,
    kept: Vec<(Time, Time)>,
    /// How many further ones there were, and how long they were together.
    further: (u64, Duration),
}

impl Ledger {
    /// From `at` on something cannot be seen. Whether that is new.
    pub fn begin(&mut self, at: Time, of: &Of, cause: &Cause) -> bool {
        let key = (of.clone(), cause.clone());
        let is_new = !self.open.contains_key(&key);
        self.open.entry(key).or_insert(at);
        is_new
    }

    /// Until `at` it could not. Gives since when that was, where it was so.
    pub fn end(&mut self, at: Time, of: &Of, cause: &Cause) -> Option<Time> {
        let since = self.open.remove(&(of.clone(), cause.clone()))?;
        self.note(of, cause, since, at.max(since));
        Some(since)
    }

    /// At one moment something could not be seen.
    pub fn moment(&mut self, at: Time, of: &Of, cause: &Cause) {
        self.note(of, cause, at, at);
    }

    /// Time went back: what cannot be seen still cannot, on both sides.
    pub fn jump(&mut self, from: Time, to: Time) {
        let open: Vec<(Of, Cause)> = self.open.keys().cloned().collect();
        self.end_all(from);
        self.open = open.into_iter().map(|key| (key, to)).collect();
    }

    /// The run ends, and with it all that cannot be seen.
    pub fn end_all(&mut self, at: Time) {
        for ((of, cause), since) in std::mem::take(&mut self.open) {
            self.note(&of, &cause, since, at.max(since));
        }
    }

    /// Why a topic cannot be seen now, if it cannot.
    pub fn now(&self, topic: &str) -> impl Iterator<Item = &Cause> {
        let open = self.open.keys().filter(move |(of, _)| of.as_deref().is_none_or(|of| of == topic));
        open.map(|(_, cause)| cause)
    }

    /// Whether a topic cannot be seen now for a cause of that kind.
    pub fn is_open(&self, topic: &str, kind: Kind) -> bool {
        self.now(topic).any(|cause| cause.kind == kind)
    }

    /// In words, what a property that reads those topics could not see, if there was anything. That nobody published a topic is no
    /// harm until `unstarted`: it had not begun then, and there was nothing that could have been missed. Times are counted from the origin, as
    /// in the rest of the report.
    pub fn doubts(&self, topics: &BTreeSet<String>, unstarted: Option<Time>, origin: Origin) -> Option<String> {
        let concerns = |s: &&Spells| s.of.as_ref().is_none_or(|topic| topics.contains(topic));
        let mut words: Vec<String> =
            self.past.iter().filter(concerns).filter_map(|s| s.words(unstarted, origin)).collect();
        let more = words.len().saturating_sub(NAMED);
        words.truncate(NAMED);
        if more > 0 {
            words.push(format!("and {more} more"));
        }
        (!words.is_empty()).then(|| words.join("; "))
    }

    fn note(&mut self, of: &Of, cause: &Cause, from: Time, to: Time) {
        let is_full = self.past.len() >= CAUSES;
        let is_alike = |s: &Spells| s.cause == *cause || is_full && s.cause.kind == cause.kind;
        let known = self.past.iter().position(|s| s.of == *of && is_alike(s));
        let at = known.unwrap_or_else(|| {
            self.past.push(Spells {
                of: of.clone(),
                cause: cause.clone(),
                kept: Vec::new(),
                further: (0, Duration::ZERO),
            });
            self.past.len() - 1
        });
        let Some(spells) = self.past.get_mut(at) else { return };
        if spells.kept.len() < KEPT {
            spells.kept.push((from, to));
        } else {
            spells.further.0 += 1;
            spells.further.1 = Duration::from_nanos(spells.further.1.nanos().saturating_add(to.since(from).nanos()));
        }
    }
}

impl Spells {
    /// When and how long, and why: `/odom could not be seen from 3 s to 4.5 s: nobody publishes it`.
    fn words(&self, unstarted: Option<Time>, origin: Origin) -> Option<String> {
        let forgiven = |to: Time| self.cause.kind == Kind::NoPublisher && unstarted.is_some_and(|until| to <= until);
        let counted: Vec<(Time, Time)> = self.kept.iter().copied().filter(|(_, to)| !forgiven(*to)).collect();
        let (from, to) = *counted.first()?;
        let of = self.of.as_deref().unwrap_or("nothing");
        let verb = if self.of.is_some() { "could not be seen" } else { "could be trusted" };
        let number = counted.len() as u64 + self.further.0;
        let time = |at: Time| origin.time(at);
        if number == 1 {
            return Some(match from == to {
                true => format!("{of} {verb} at {}: {}", time(from), self.cause),
                false => {
                    let lasted = seconds(i128::from(to.since(from).nanos()));
                    format!("{of} {verb} from {} to {} ({lasted}): {}", time(from), time(to), self.cause)
                }
            });
        }
        let sum = counted.iter().map(|(from, to)| to.since(*from).nanos()).fold(0_i64, i64::saturating_add);
        let sum = Duration::from_nanos(sum.saturating_add(self.further.1.nanos()));
        let last = counted.last().map_or(to, |(_, to)| *to);
        let words = format!("{of} {verb} {number} times from {} to {}", time(from), time(last));
        Some(match sum {
            Duration::ZERO => format!("{words}: {}", self.cause),
            sum => format!("{words}, for {} in all: {}", seconds(i128::from(sum.nanos())), self.cause),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ZERO: Origin = Origin(Time(0));

    fn at(seconds: i64) -> Time {
        Time(seconds * 1_000_000_000)
    }

    fn odom() -> Of {
        Some("/odom".to_owned())
    }

    fn topics() -> BTreeSet<String> {
        BTreeSet::from(["/odom".to_owned()])
    }

    #[test]
    fn a_spell_is_told_with_its_ends_its_length_and_its_cause() {
        let mut ledger = Ledger::default();
        let cause = Cause::new(Kind::Disconnected, "reset by peer");
        assert!(ledger.begin(at(3), &odom(), &cause) && !ledger.begin(at(4), &odom(), &cause));
        assert!(ledger.is_open("/odom", Kind::Disconnected) && !ledger.is_open("/scan", Kind::Disconnected));
        assert_eq!(ledger.end(at(5), &odom(), &cause), Some(at(3)));
        assert_eq!(ledger.end(at(6), &odom(), &cause), None);
        let doubts = ledger.doubts(&topics(), None, ZERO).unwrap();
        assert_eq!(doubts, "/odom could not be seen from 3 s to 5 s (2 s): the connection is broken: reset by peer");
        assert_eq!(ledger.doubts(&BTreeSet::new(), None, ZERO), None);
        let later = ledger.doubts(&topics(), None, Origin(at(1))).unwrap();
        assert!(later.contains("from 2 s to 4 s (2 s)"), "as the rest of the report counts: {later}");
    }

    #[test]
    fn that_nobody_published_does_no_harm_before_the_property_starts() {
        let mut ledger = Ledger::default();
        let nobody = Cause::new(Kind::NoPublisher, "");
        ledger.begin(at(1), &odom(), &nobody);
        ledger.end(at(3), &odom(), &nobody);
        assert_eq!(ledger.doubts(&topics(), Some(at(3)), ZERO), None);
        assert!(ledger.doubts(&topics(), Some(at(2)), ZERO).is_some());
        ledger.begin(at(7), &odom(), &nobody);
        ledger.end_all(at(9));
        assert!(ledger.doubts(&topics(), Some(at(3)), ZERO).unwrap().contains("from 7 s to 9 s (2 s)"));
    }

    #[test]
    fn what_concerns_everything_concerns_each() {
        let mut ledger = Ledger::default();
        ledger.moment(at(2), &None, &Cause::new(Kind::Leapt, "by 60 s"));
        assert!(ledger.doubts(&topics(), None, ZERO).unwrap().starts_with("nothing could be trusted at 2 s"));
    }

    #[test]
    fn many_spells_are_added_up_in_bounded_memory() {
        let mut ledger = Ledger::default();
        let lost = Cause::new(Kind::Lost, "");
        for second in 0..5000 {
            ledger.begin(at(2 * second), &odom(), &lost);
            ledger.end(at(2 * second + 1), &odom(), &lost);
        }
        let doubts = ledger.doubts(&topics(), None, ZERO).unwrap();
        assert!(doubts.contains("5000 times") && doubts.contains("for 5000 s in all"), "{doubts}");
        assert_eq!(ledger.past[0].kept.len(), KEPT);
    }
}
