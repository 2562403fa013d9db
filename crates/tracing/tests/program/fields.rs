//! Fields: whatever a program records is the number, the truth value or the text that it is.

use std::fmt;

use crate::support::{alone, said, verdict, watched};

mod battery {
    /// Tells a value in one of the ways that `tracing` has for it.
    pub fn tell(value: impl tracing::Value) {
        tracing::event!(name: "told", tracing::Level::INFO, value);
    }

    pub fn show(value: impl std::fmt::Display) {
        tracing::event!(name: "told", tracing::Level::INFO, value = %value);
    }

    pub fn debug(value: impl std::fmt::Debug) {
        tracing::event!(name: "told", tracing::Level::INFO, value = ?value);
    }
}

/// Something that shows itself as it likes.
struct Volts(f64);

impl fmt::Display for Volts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} V", self.0)
    }
}

impl fmt::Debug for Volts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Whoever is written down may have something to say.
        tracing::event!(name: "asked", tracing::Level::INFO, value = 1);
        write!(f, "{:?}", self.0)
    }
}

/// How often an event came with that value.
fn came(value: &str, tell: impl FnOnce()) -> u64 {
    let text = format!("event told when value == {value}\nproperty never_told over (told): always not told\n");
    let monitor = watched(&text);
    tell();
    said(&monitor.finish(), "never_told").obligations.failed
}

alone! {
    fn whole_numbers() {
        assert_eq!(came("7", || {
            battery::tell(7_u8);
            battery::tell(7_u64);
            battery::tell(7_i64);
            battery::tell(7_usize);
            battery::tell(7_i128);
            battery::tell(7_u128);
            battery::tell(std::num::NonZeroU32::new(7).expect("not zero"));
            battery::tell(-7_i32);
        }), 7);
    }

    fn numbers_with_a_point() {
        assert_eq!(came("-0.5", || {
            battery::tell(-0.5_f64);
            battery::tell(-0.5_f32);
            battery::show(-0.5);
            battery::debug(-0.5);
            battery::debug("-0.5");
            battery::tell(0.5);
        }), 4);
    }

    fn numbers_that_no_double_holds_are_the_nearest() {
        assert_eq!(came("170141183460469231731687303715884105728", || battery::tell(i128::MAX)), 1);
    }

    fn truth_values() {
        assert_eq!(came("true", || {
            battery::tell(true);
            battery::show(true);
            battery::debug(true);
            battery::tell(false);
            battery::tell("true");
            battery::tell(1);
        }), 3);
    }

    fn texts() {
        assert_eq!(came("\"low\"", || {
            battery::tell("low");
            battery::tell(String::from("low"));
            battery::show("low");
            battery::debug("low");
            battery::tell("high");
        }), 4);
    }

    fn what_shows_itself() {
        assert_eq!(came("\"7.2 V\"", || battery::show(Volts(7.2))), 1);
    }

    fn errors() {
        let error: Box<dyn std::error::Error + 'static> = "empty".into();
        assert_eq!(came("\"empty\"", || {
            tracing::event!(name: "told", tracing::Level::INFO, value = &*error);
        }), 1);
    }

    fn what_may_be_missing() {
        assert_eq!(came("7", || {
            battery::tell(Some(7));
            battery::tell(None::<i32>);
            battery::tell(tracing::field::Empty);
        }), 1);
    }

    fn a_value_that_tells_something_itself_while_it_is_written_down() {
        let text = "event told when value == 7.2\nevent asked when value == 1\nproperty order over (told, asked): whenever told, previously asked\n";
        let monitor = watched(text);
        battery::debug(Volts(7.2));
        assert_eq!(verdict(&monitor.finish(), "order"), "holds");
    }
}
