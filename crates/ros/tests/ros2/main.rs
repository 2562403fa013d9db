//! The ROS 2 connector against nodes of others, each test on a domain of its own. `tools/ros2.sh` installs them.

mod definitions;
mod hostile;
mod peer;
mod publishing;
mod subscribing;
