//! Which live graph a command joins.

use std::path::PathBuf;

use clap::Args;
use lapwing_ros::connector::Connector;

use crate::complain::Complaint;

/// Arguments that name a graph.
#[derive(Debug, Args)]
pub struct Choice {
    /// Join the graph of a ROS 1 master [default: ROS_MASTER_URI, else the one on this machine]
    #[arg(long, value_name = "URI", num_args = 0..=1, conflicts_with = "ros2")]
    pub ros1: Option<Option<String>>,
    /// Join the graph of ROS 2
    #[arg(long)]
    pub ros2: bool,
    /// The domain of ROS 2 [default: ROS_DOMAIN_ID, else 0]
    #[arg(long, value_name = "N", requires = "ros2")]
    pub domain: Option<u16>,
}

impl Choice {
    /// Joins the graph under a name; nothing where none is named.
    pub fn join(&self, node: &str) -> Result<Option<Box<dyn Connector>>, Complaint> {
        self.join_with(node, &[])
    }

    /// The same, with share trees of message definitions that come before those of the environment.
    pub fn join_with(&self, node: &str, trees: &[PathBuf]) -> Result<Option<Box<dyn Connector>>, Complaint> {
        if let Some(uri) = &self.ros1 {
            return ros1(uri.as_deref(), node).map(Some);
        }
        if self.ros2 { ros2(self.domain, node, trees).map(Some) } else { Ok(None) }
    }
}

#[cfg(feature = "ros1")]
fn ros1(uri: Option<&str>, node: &str) -> Result<Box<dyn Connector>, Complaint> {
    lapwing_ros::ros1::connect(uri, node).map_err(|refused| Complaint::new(refused.to_string()))
}

#[cfg(not(feature = "ros1"))]
fn ros1(_: Option<&str>, _: &str) -> Result<Box<dyn Connector>, Complaint> {
    Err(missing("ROS 1", "ros1"))
}

#[cfg(feature = "ros2")]
fn ros2(domain: Option<u16>, node: &str, trees: &[PathBuf]) -> Result<Box<dyn Connector>, Complaint> {
    lapwing_ros::ros2::connect_with(domain, node, trees).map_err(|refused| Complaint::new(refused.to_string()))
}

#[cfg(not(feature = "ros2"))]
fn ros2(_: Option<u16>, _: &str, _: &[PathBuf]) -> Result<Box<dyn Connector>, Complaint> {
    Err(missing("ROS 2", "ros2"))
}

#[cfg(not(all(feature = "ros1", feature = "ros2")))]
fn missing(what: &str, feature: &str) -> Complaint {
    let complaint = Complaint::new(format!("this lapwing was built without {what}"));
    complaint.help(format!("build it with `cargo install --path crates/cli --features {feature}`"))
}
