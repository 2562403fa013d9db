//! A Lego robot that plays soccer, after Harvin, *Runtime Verification of State Diagram for Robotics* (2017): the robot's program, the field that
//! it plays on, what goes wrong, and monitors that the program knows nothing of.
//!
//! # Where to read on
//!
//! [`robot`] is the program, as it would run on a brick; [`field`] stands in for brick and world. [`fault`] spoils a match from outside.
//! [`watch`] listens, judges by `soccer.rv` and recovers. [`game`] plays a match with all of them, [`figures`] compares the events with those
//! that the thesis prints, and [`page`] shows a match.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod robot;

pub mod field;

pub mod fault;

pub mod watch;

pub mod game;

pub mod figures;

pub mod page;
