//! Guards: messages pass from one topic to another while a property stands.
//!
//! Whether a message passes is decided when it has been judged: the property must have its first position behind it, see all of its
//! topics, and none of its obligations may have failed since the guarded message before. What cannot be judged does not pass, unless the
//! specification says `fail open`. If Lapwing dies, nothing passes: it is the only publisher of the guarded topic.

use bytes::Bytes;
use lapwing_check::checked::{self, Action};
use lapwing_record::RawChannel;
use lapwing_ros::connector::{Connector, PublisherId};

use super::course::Course;
use super::graph::absolute;
use super::reactions::{Reach, Reactions, encoded};
use crate::spec::Spec;

/// A guard.
#[derive(Debug)]
pub(crate) struct Guard {
    spec: usize,
    property: String,
    plan: checked::Guard,
    /// The topic that it guards, absolute.
    from: String,
    /// What stands in the place of a message that does not pass.
    instead: Option<Vec<u8>>,
    publisher: Option<PublisherId>,
    is_dry: bool,
    /// How many obligations had failed when a message was decided on.
    failed: u64,
    /// Whether the last message passed: a change is told.
    passed: Option<bool>,
}

/// What became of a guarded message.
#[derive(Debug, Default)]
pub(crate) struct Decision {
    /// Whether something was handed to the transport.
    pub is_sent: bool,
    /// What is to be told.
    pub note: Option<String>,
}

/// All guards of the specifications. An error says what of them cannot be made ready.
pub(crate) fn guards(
    specs: &[Spec],
    reach: &Reach,
    reactions: &mut Reactions,
    connector: &mut dyn Connector,
) -> Result<Vec<Guard>, String> {
    let mut guards = Vec::new();
    for (number, spec) in specs.iter().enumerate() {
        for reaction in &spec.alone().spec.reactions {
            for action in &reaction.actions {
                let Action::Guard(plan) = action else { continue };
                let wrong = |why: String| format!("{}: `{action}` cannot be done: {why}", spec.name());
                let mut guard = Guard {
                    spec: number,
                    property: reaction.property.clone(),
                    plan: plan.clone(),
                    from: absolute(&plan.from),
                    instead: None,
                    publisher: None,
                    is_dry: reach.dry,
                    failed: 0,
                    passed: None,
                };
                if let Some(message) = &plan.instead {
                    let (channel, payload) = encoded(message, connector).map_err(wrong)?;
                    guard.instead = Some(payload);
                    guard.advertise(&channel, reactions, connector).map_err(wrong)?;
                }
                guards.push(guard);
            }
        }
    }
    Ok(guards)
}

impl Guard {
    /// Whether it decides on messages of that topic, which is absolute.
    pub fn is_from(&self, topic: &str) -> bool {
        self.from == topic
    }

    /// The type of what is to be guarded is known: what passes has the same.
    pub fn advertise(
        &mut self,
        from: &RawChannel,
        reactions: &mut Reactions,
        connector: &mut dyn Connector,
    ) -> Result<(), String> {
        if self.publisher.is_none() && !self.is_dry {
            let channel = RawChannel { topic: self.plan.to.clone(), ..from.clone() };
            self.publisher = Some(reactions.advertise(&channel, connector)?);
        }
        Ok(())
    }

    /// Decides on a message that has just been judged.
    pub fn decide(&mut self, course: &Course<'_>, payload: &Bytes, connector: &mut dyn Connector) -> Decision {
        let stand = course.stand(self.spec, &self.property);
        // Time jumped back where fewer have failed than before.
        let before = if stand.failed < self.failed { 0 } else { self.failed };
        let passes = match stand.is_judged {
            true => stand.failed == before,
            false => self.plan.fail_open,
        };
        self.failed = stand.failed;
        let mut decision = Decision { note: self.changed(passes, stand.is_judged), ..Decision::default() };
        let bytes = if passes { Some(&payload[..]) } else { self.instead.as_deref() };
        if let (Some(bytes), Some(publisher)) = (bytes, self.publisher) {
            match connector.publish(publisher, bytes) {
                Ok(()) => decision.is_sent = true,
                Err(why) => decision.note = Some(format!("{} could not be published: {why}", self.plan.to)),
            }
        }
        decision
    }

    /// What is to be told where messages begin to pass, or do no more.
    fn changed(&mut self, passes: bool, is_judged: bool) -> Option<String> {
        if self.passed.replace(passes) == Some(passes) {
            return None;
        }
        let checked::Guard { to, from, .. } = &self.plan;
        let dry = if self.is_dry { " (it would, without --dry-run)" } else { "" };
        Some(match (passes, is_judged) {
            (true, _) => format!("guard: {from} passes to {to}{dry}"),
            (false, true) => format!("guard: {from} does not pass to {to} while {} fails{dry}", self.property),
            (false, false) => format!("guard: {from} does not pass to {to} until {} can be judged{dry}", self.property),
        })
    }
}
