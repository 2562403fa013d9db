//! What a live run sees besides messages: who publishes, what cannot be seen and why, when it ends. Its recording keeps that on a topic of
//! its own, so that a check of the recording judges by the same stream of things as the live run did.
//!
//! Each message of [`TOPIC`] is a JSON object whose `kind` says what it is; `docs/live.md` lists them. Its stamp is that of the message.

use std::fmt;

use serde_json::{Value, json};

/// The topic of a recording that has them.
pub const TOPIC: &str = "/lapwing/status";

/// What a recording says of the type of these messages.
pub(crate) const SCHEMA: &str =
    r#"{"type":"object","title":"lapwing.status","properties":{"kind":{"type":"string"}},"required":["kind"]}"#;

/// The version of the format. A reader passes over kinds that it does not know, but refuses a later version.
const VERSION: u64 = 1;

/// Something besides messages that a run sees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Status {
    /// The run begins.
    Began {
        /// What is watched: `ROS 2, domain 7`.
        source: String,
        /// Whether stamps are simulated time.
        is_simulated: bool,
    },
    /// A stream of messages is there, or more is known of it: a topic, and the type that somebody publishes on it.
    Offered {
        /// Which.
        of: Stream,
        /// Whether its definition is known, so that it can be read from here on.
        is_defined: bool,
        /// Whether those who come late are handed its last message.
        is_latched: bool,
    },
    /// So many publish a stream now.
    Publishers(Stream, u64),
    /// So many messages of a stream were lost.
    Lost(Stream, u64),
    /// From now on a topic cannot be seen, or not whole; without a topic: nothing can.
    Blind(Option<String>, Cause),
    /// That cause is no more.
    Sees(Option<String>, Cause),
    /// Simulated time leapt forward. (That it went back shows in the stamps.)
    Leapt {
        /// The stamp before, in nanoseconds.
        from: i64,
    },
    /// The monitor of a property started afresh, because a reaction said so.
    Reset(String),
    /// Nothing happened; time went on.
    Alive,
    /// The run ends here. Without a cause it was meant to.
    Ended(Option<String>),
}

/// A topic with a type, as they are published.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Stream {
    /// The topic.
    pub topic: String,
    /// The type, as the graph spells it.
    pub type_name: String,
}

/// Why a topic cannot be seen.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Cause {
    /// What kind of cause.
    pub kind: Kind,
    /// What else there is to say of it; may be empty.
    pub detail: String,
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $variant:ident $word:literal $sentence:literal,)*) => {
        /// The kinds of causes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Kind { $($(#[$doc])* $variant,)* }

        impl Kind {
            const ALL: &'static [Kind] = &[$(Kind::$variant,)*];

            /// The word in recordings.
            pub fn word(self) -> &'static str {
                match self { $(Kind::$variant => $word,)* }
            }

            fn sentence(self) -> &'static str {
                match self { $(Kind::$variant => $sentence,)* }
            }
        }
    };
}

kinds! {
    /// Nobody publishes it.
    NoPublisher "no-publisher" "nobody publishes it",
    /// What publishers offer and what is asked for do not go together.
    Incompatible "incompatible" "its quality of service does not fit",
    /// There is no definition of its type.
    Undefined "undefined" "its type has no definition",
    /// The connection to a publisher or a master is broken.
    Disconnected "disconnected" "the connection is broken",
    /// It is published with another type than the one that is read.
    OtherType "other-type" "it is published with another type",
    /// A message could not be decoded.
    Undecodable "undecodable" "a message could not be decoded",
    /// Messages were lost.
    Lost "lost" "messages were lost",
    /// Simulated time leapt forward.
    Leapt "leapt" "the clock leapt forward",
}

impl Cause {
    /// A cause of that kind.
    pub fn new(kind: Kind, detail: impl Into<String>) -> Cause {
        Cause { kind, detail: detail.into() }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind.sentence())?;
        if self.detail.is_empty() { Ok(()) } else { write!(f, ": {}", self.detail) }
    }
}

impl Status {
    /// As the text of a message.
    pub fn text(&self) -> String {
        let object = match self {
            Status::Began { source, is_simulated } => json!({
                "kind": "began", "version": VERSION, "lapwing": env!("CARGO_PKG_VERSION"), "source": source,
                "clock": if *is_simulated { "simulated" } else { "wall" },
            }),
            Status::Offered { of, is_defined, is_latched } => json!({
                "kind": "offered", "topic": of.topic, "type": of.type_name, "defined": is_defined, "latched": is_latched,
            }),
            Status::Publishers(of, count) => {
                json!({ "kind": "publishers", "topic": of.topic, "type": of.type_name, "count": count })
            }
            Status::Lost(of, count) => {
                json!({ "kind": "lost", "topic": of.topic, "type": of.type_name, "count": count })
            }
            Status::Blind(topic, cause) => about("blind", topic.as_deref(), cause),
            Status::Sees(topic, cause) => about("sees", topic.as_deref(), cause),
            Status::Leapt { from } => json!({ "kind": "leapt", "from_ns": from }),
            Status::Reset(property) => json!({ "kind": "reset", "property": property }),
            Status::Alive => json!({ "kind": "alive" }),
            Status::Ended(cause) => json!({ "kind": "ended", "cause": cause }),
        };
        object.to_string()
    }

    /// Reads the text of a message. `None` is a kind that this version does not know; an error says what is wrong with the text.
    pub fn read(text: &[u8]) -> Result<Option<Status>, String> {
        let object: Value = serde_json::from_slice(text).map_err(|e| format!("it is no JSON: {e}"))?;
        let word = |key: &str| object.get(key).and_then(Value::as_str).map(str::to_owned);
        let needed = |key: &str| word(key).ok_or_else(|| format!("it has no text `{key}`"));
        let count = || object.get("count").and_then(Value::as_u64).ok_or("it has no number `count`");
        let flag = |key: &str| object.get(key).and_then(Value::as_bool).unwrap_or_default();
        let stream = || Ok::<_, String>(Stream { topic: needed("topic")?, type_name: needed("type")? });
        Ok(Some(match needed("kind")?.as_str() {
            "began" => {
                let version = object.get("version").and_then(Value::as_u64).unwrap_or_default();
                if version != VERSION {
                    return Err(format!("it is of version {version}; this Lapwing reads version {VERSION}"));
                }
                let is_simulated = word("clock").is_some_and(|clock| clock == "simulated");
                Status::Began { source: word("source").unwrap_or_default(), is_simulated }
            }
            "offered" => Status::Offered { of: stream()?, is_defined: flag("defined"), is_latched: flag("latched") },
            "publishers" => Status::Publishers(stream()?, count()?),
            "lost" => Status::Lost(stream()?, count()?),
            "blind" => Status::Blind(word("topic"), cause(&object)?),
            "sees" => Status::Sees(word("topic"), cause(&object)?),
            "leapt" => Status::Leapt { from: object.get("from_ns").and_then(Value::as_i64).unwrap_or_default() },
            "reset" => Status::Reset(needed("property")?),
            "alive" => Status::Alive,
            "ended" => Status::Ended(word("cause")),
            _ => return Ok(None),
        }))
    }
}

fn about(kind: &str, topic: Option<&str>, cause: &Cause) -> Value {
    json!({ "kind": kind, "topic": topic, "cause": cause.kind.word(), "detail": cause.detail })
}

fn cause(object: &Value) -> Result<Cause, String> {
    let word = object.get("cause").and_then(Value::as_str).ok_or("it has no text `cause`")?;
    let kind = Kind::ALL.iter().find(|kind| kind.word() == word);
    let kind = kind.ok_or_else(|| format!("`{word}` is no cause that is known"))?;
    Ok(Cause::new(*kind, object.get("detail").and_then(Value::as_str).unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_status_is_read_as_it_was_written() {
        let of = || Stream { topic: "/odom".to_owned(), type_name: "nav_msgs/msg/Odometry".to_owned() };
        let cause = || Cause::new(Kind::Incompatible, "offers \"volatile\"");
        let mut all = vec![
            Status::Began { source: "ROS 2, domain 7".to_owned(), is_simulated: true },
            Status::Offered { of: of(), is_defined: true, is_latched: false },
            Status::Offered { of: of(), is_defined: false, is_latched: true },
            Status::Publishers(of(), 2),
            Status::Lost(of(), 17),
            Status::Blind(Some("/odom".to_owned()), cause()),
            Status::Sees(None, cause()),
            Status::Leapt { from: -5 },
            Status::Reset("calm".to_owned()),
            Status::Alive,
            Status::Ended(None),
            Status::Ended(Some("stopped".to_owned())),
        ];
        all.extend(Kind::ALL.iter().map(|kind| Status::Blind(None, Cause::new(*kind, ""))));
        for status in all {
            assert_eq!(Status::read(status.text().as_bytes()), Ok(Some(status)));
        }
    }

    #[test]
    fn what_is_wrong_with_a_text_is_said_and_what_is_new_is_passed_over() {
        let read = |text: &str| Status::read(text.as_bytes());
        assert_eq!(read(r#"{"kind":"sings"}"#), Ok(None));
        for (text, word) in [
            ("{", "JSON"),
            ("{}", "`kind`"),
            (r#"{"kind":"began","version":2}"#, "version 2"),
            (r#"{"kind":"lost","topic":"/a","type":"T"}"#, "`count`"),
            (r#"{"kind":"blind","cause":"fog"}"#, "fog"),
        ] {
            assert!(read(text).unwrap_err().contains(word), "{text}");
        }
    }
}
