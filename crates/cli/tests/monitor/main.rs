//! `lapwing monitor` on real graphs: a robot by rospy under a real master, and one by rclpy over Fast DDS. Each test has a master's port or a domain of
//! its own, and everything that it starts ends with it.
//!
//! Needs what `tools/peers.sh`, `tools/ros2.sh` and `tools/browser.sh` install, and `cut` needs network namespaces, which only root can make. Without
//! any of it the tests fail and say so; `-- --skip cut::` leaves out what needs root.
#![cfg(all(feature = "ros1", feature = "ros2", unix))]

mod cut;
#[cfg(feature = "foxglove")]
mod foxglove;
mod graph;
mod guarding;
mod habits;
mod lapwing;
mod page;
mod screen;
mod watching;
mod words;
