//! Live robots: what happens on a ROS graph comes in, what a reaction says goes out. No ROS has to be installed, and no message type
//! is known at compile time.
//!
//! - [`connector`]: what a transport says and takes, the same for each.
//! - [`inbox`]: the bounded queue between the threads that receive and the one that judges.
//! - [`server`]: takes connections in.
//! - `ros1` (with the feature of that name): a node of a ROS 1 graph.
//! - `ros2` (with the feature of that name): a node of a ROS 2 graph.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod connector;
pub mod inbox;
#[cfg(feature = "ros1")]
pub mod ros1;
#[cfg(feature = "ros2")]
pub mod ros2;
pub mod server;
