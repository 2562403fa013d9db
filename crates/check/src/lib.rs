//! From syntax to meaning: names, types, dimensions and scopes; then to a program for the engine.
//!
//! [`load`] follows the files that a specification uses. [`check()`] resolves it into a [`checked::Spec`]: once alone, for what no
//! trace can cure, and once more for the [`TraceShape`] of every trace, whose topics and types are then known. It reports all that
//! it finds and never stops at the first error.
//!
//! ```
//! use lapwing_check::{check, load};
//! use lapwing_diag::SourceMap;
//!
//! let text = "decl speed /odom Odometry.twist.twist.linear.x\nnever speed > 2.0 m/s\n";
//! let mut sources = SourceMap::default();
//! let file = sources.add("robot.rv", text);
//! let parsed = lapwing_syntax::parse(file, text);
//! let loaded = load(&mut sources, parsed.file, &|_| None);
//! let checked = check(&sources, &loaded, None);
//! assert!(!checked.has_errors());
//! assert_eq!(checked.spec.properties[0].name, "line 2");
//! ```

#![forbid(unsafe_code)]

pub mod checked;
pub mod compile;

mod check;
mod definitions;
mod library;
mod load;
mod trace;

mod context;
mod graph;
mod names;
mod settings;

mod declare;
mod event;
mod inputs;
mod machine;
mod message;
mod property;
mod reaction;
mod reads;
mod service;

mod call;
mod constant;
mod duration;
mod expr;
mod place;
mod resolve;
mod temporal;
mod term;
mod world;

mod dims;
mod lint;
mod messages;
mod walk;

pub use check::{Checked, check};
pub use definitions::MessageTypes;
pub use library::{LIBRARIES, Library, ShippedPattern};
pub use load::{Loaded, load};
pub use trace::{COMPONENTS, TraceShape, TraceTopic};
