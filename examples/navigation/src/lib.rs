//! A robot that navigates: eight GenoM3 components, after the case study of Foughali et al. (MEMOCODE 2020), on a simulated robot.
//!
//! [`field`](crate::field) is the floor, `drivers`, [`pom`] and `drive` are codels in Rust, `codels/safety_pilot.c` are those in C. A [`Mission`]
//! runs them all under a specification.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod drive;
mod drivers;
pub mod field;
mod mission;
mod native;
pub mod pom;

pub use mission::{Mission, Went};
