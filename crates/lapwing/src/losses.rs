//! What could not be read, and what that means for verdicts.

use std::collections::BTreeMap;

use lapwing_check::checked::Topic;
use lapwing_engine::Ending;
#[cfg(feature = "recordings")]
use lapwing_record::{Loss, ReadError};
#[cfg(feature = "recordings")]
use lapwing_stream::Time;

/// What could not be read or was not looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Damage {
    /// Everything, in words.
    pub gaps: Vec<String>,
    /// Why the recording ended before its end.
    pub broke_off: Option<String>,
    /// A part from its middle that may have held anything.
    pub hole: Option<String>,
    /// What was lost of a topic alone.
    pub topics: BTreeMap<String, String>,
}

impl Damage {
    /// From what a reader says. A loss after the last message means that the recording broke off there.
    #[cfg(feature = "recordings")]
    pub fn new(losses: &[Loss], error: Option<&ReadError>, last: Option<Time>) -> Damage {
        let mut damage = Damage { gaps: losses.iter().map(Loss::to_string).collect(), ..Damage::default() };
        for loss in losses {
            match &loss.topic {
                Some(topic) => {
                    damage.topics.entry(topic.trim_start_matches('/').to_owned()).or_insert_with(|| loss.what.clone());
                }
                None if loss.after >= last => damage.broke_off = Some(loss.what.clone()),
                None => damage.hole = damage.hole.or_else(|| Some(loss.what.clone())),
            }
        }
        if let Some(error) = error {
            damage.break_off(error.to_string());
        }
        damage
    }

    /// The recording goes on, but is not looked at any further.
    pub fn break_off(&mut self, why: String) {
        self.gaps.push(why.clone());
        self.broke_off = Some(why);
    }

    /// What the engine is to know of it: `topics` are those that it knows, in its order.
    pub fn ending(&self, topics: &[Topic]) -> Ending {
        let lost = topics.iter().enumerate().filter_map(|(number, topic)| {
            let what = self.topics.get(topic.name.trim_start_matches('/'))?;
            Some((number, format!("messages of {} are lost: {what}", topic.name)))
        });
        Ending { broke_off: self.broke_off.clone(), lost: lost.collect() }
    }
}

#[cfg(all(test, feature = "recordings"))]
mod tests {
    use super::*;
    use lapwing_record::{Place, Position};

    fn loss(topic: Option<&str>, after: Option<i64>) -> Loss {
        let at = Place { file: "run.mcap".into(), position: Position::Byte(7) };
        Loss { at, topic: topic.map(str::to_owned), what: "gone".to_owned(), after: after.map(Time) }
    }

    #[test]
    fn a_loss_after_the_last_message_is_a_break_and_one_before_it_a_hole() {
        let of = |loss| Damage::new(&[loss], None, Some(Time(5)));
        assert_eq!(of(loss(None, Some(5))).broke_off.as_deref(), Some("gone"));
        assert_eq!(of(loss(None, Some(4))).hole.as_deref(), Some("gone"));
        assert_eq!(of(loss(None, None)).hole.as_deref(), Some("gone"));
        assert_eq!(Damage::new(&[loss(None, None)], None, None).broke_off.as_deref(), Some("gone"));
    }

    #[test]
    fn a_topic_that_lost_something_is_known_to_the_engine_by_its_number() {
        let damage = Damage::new(&[loss(Some("odom"), Some(4))], None, Some(Time(5)));
        let topic =
            |name: &str| Topic { name: name.to_owned(), type_name: None, fields: Vec::new(), span: Default::default() };
        let ending = damage.ending(&[topic("/scan"), topic("/odom")]);
        assert_eq!(ending.lost, [(1, "messages of /odom are lost: gone".to_owned())]);
        assert!(ending.broke_off.is_none() && damage.gaps == ["run.mcap, byte 7: gone (topic odom)"]);
    }
}
