//! What is to be done on a violation, as the check understands it.

use std::fmt;

use lapwing_diag::Span;
use lapwing_stream::{Duration, Value};

use super::Property;

/// A reaction.
#[derive(Clone, Debug, PartialEq)]
pub struct Reaction {
    /// The property's name as written, without instance.
    pub property: String,
    /// At most so often.
    pub at_most_every: Option<Duration>,
    /// What is done, in order.
    pub actions: Vec<Action>,
    /// Its place.
    pub span: Span,
}

/// What a reaction does. In words it is what `check` says of it: `publish /cmd_vel geometry_msgs/Twist`.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// `publish /topic pkg/Type { … }`
    Publish(Message),
    /// `call /service pkg/Type { … }`: the request.
    Call(Message),
    /// `request Component.Activity`
    Request(String),
    /// `run handler`: a function of the host program.
    Run(String),
    /// `reset`: the property's monitor starts afresh.
    Reset,
    /// `stop`: the run ends.
    Stop,
    /// `guard /to from /from by …`
    Guard(Guard),
}

/// A message that a reaction writes.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// The topic or the service, absolute.
    pub to: String,
    /// Its type, with its package where that is known: `geometry_msgs/Twist`.
    pub type_name: String,
    /// The type as it is written.
    pub written: String,
    /// What is given of it; fields that are not named have their defaults.
    pub value: Value,
}

/// A guard: messages go from one topic to another while a property stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// Where they go.
    pub to: String,
    /// Where they come from.
    pub from: String,
    /// What goes there instead; nothing, where there is none.
    pub instead: Option<Message>,
    /// Whether they pass where the property cannot be judged.
    pub fail_open: bool,
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Action::Publish(message) => write!(f, "publish {} {}", message.to, message.written),
            Action::Call(message) => write!(f, "call {} {}", message.to, message.written),
            Action::Request(activity) => write!(f, "request {activity}"),
            Action::Run(handler) => write!(f, "run {handler}"),
            Action::Reset => f.write_str("reset"),
            Action::Stop => f.write_str("stop"),
            Action::Guard(Guard { to, from, instead, fail_open }) => {
                write!(f, "guard {to} from {from} else ")?;
                match instead {
                    Some(message) => write!(f, "publish {}", message.written)?,
                    None => f.write_str("drop")?,
                }
                if *fail_open { f.write_str(" fail open") } else { Ok(()) }
            }
        }
    }
}

impl Reaction {
    /// Whether it is one to violations of a property: of each of its instances, where it has several.
    pub fn is_of(&self, property: &Property) -> bool {
        property.name.split('[').next() == Some(&self.property)
    }
}
