//! A Lego robot that plays soccer, after Harvin, *Runtime Verification of State Diagram for Robotics* (2017): the robot's program, the field that
//! it plays on, what goes wrong, and monitors that the program knows nothing of.
//!
//! # Where to read on
//!
//! [`robot`] is the program, as it would run on a brick; [`field`] stands in for brick and world. [`fault`] spoils a match from outside.
//! [`watch`] listens, judges by `soccer.rv` and recovers. [`game`] plays a match with all of them, [`figures`] compares the events with those
//! that the thesis prints, [`costs`] measures what monitoring takes, and [`page`] shows a match.
//!
//! Without the feature `field` there is the robot's program and, with `monitors`, what watches it: what the program `brick` is made of.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod robot;

#[cfg(feature = "field")]
pub mod field;

#[cfg(feature = "field")]
pub mod fault;

#[cfg(feature = "monitors")]
pub mod watch;

#[cfg(feature = "field")]
pub mod game;

#[cfg(feature = "field")]
pub mod figures;

#[cfg(feature = "field")]
pub mod costs;

#[cfg(feature = "field")]
pub mod page;
