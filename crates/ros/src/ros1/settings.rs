//! Where the master is, what this node is called, and under which address others reach it: from arguments, else from the environment
//! as every node of ROS 1 reads it.

use std::net::{IpAddr, TcpListener, UdpSocket};
use std::path::PathBuf;

use super::definitions::Definitions;
use super::names::Names;
use super::net::Endpoint;

/// What a node has to know before it begins.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub master: Endpoint,
    pub names: Names,
    /// What others call the machine on which this node runs.
    pub host: String,
    pub definitions: Definitions,
}

impl Settings {
    /// Reads `ROS_MASTER_URI`, where no other is given, `ROS_IP`, `ROS_HOSTNAME`, `ROS_NAMESPACE`, `ROS_PACKAGE_PATH` and `CMAKE_PREFIX_PATH`.
    pub fn read(
        master: Option<&str>,
        node: &str,
        variable: &dyn Fn(&str) -> Option<String>,
    ) -> Result<Settings, String> {
        let variable = |name: &str| variable(name).filter(|value| !value.is_empty());
        let uri = master.map(str::to_owned).or_else(|| variable("ROS_MASTER_URI"));
        let master = Endpoint::parse(uri.as_deref().unwrap_or("http://127.0.0.1:11311"))
            .map_err(|what| format!("the master's address: {what}"))?;
        let names = Names::new(node, &variable("ROS_NAMESPACE").unwrap_or_default())?;
        let host = variable("ROS_HOSTNAME").or_else(|| variable("ROS_IP")).unwrap_or_else(|| reachable(&master));
        let folders = ["ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH"].into_iter().filter_map(variable);
        let folders = folders.flat_map(|list| list.split(':').map(PathBuf::from).collect::<Vec<_>>()).collect();
        Ok(Settings { master, names, host, definitions: Definitions::new(folders) })
    }

    /// A listener that those reach who may: on loopback alone, where the node is known by such an address.
    pub fn listen(&self) -> std::io::Result<TcpListener> {
        let address = address(&self.host);
        match address {
            Some(address) if address.is_loopback() => TcpListener::bind((address, 0)),
            // An address that others see need not be one of this machine: a router may stand between.
            Some(address) => TcpListener::bind((address, 0)).or_else(|_| TcpListener::bind(("0.0.0.0", 0))),
            None => TcpListener::bind(("0.0.0.0", 0)),
        }
    }
}

fn address(host: &str) -> Option<IpAddr> {
    if host == "localhost" { Some(IpAddr::from([127, 0, 0, 1])) } else { host.parse().ok() }
}

/// The address of this machine as the master sees it; loopback where the master is on it.
fn reachable(master: &Endpoint) -> String {
    let route = || {
        let socket = UdpSocket::bind(("0.0.0.0", 0)).ok()?;
        // Sends nothing: it only asks the system which of its addresses leads there.
        socket.connect((master.host.as_str(), master.port)).ok()?;
        Some(socket.local_addr().ok()?.ip())
    };
    match address(&master.host) {
        Some(address) if address.is_loopback() => "127.0.0.1".to_owned(),
        _ => route().map_or_else(|| "127.0.0.1".to_owned(), |ip| ip.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(master: Option<&str>, environment: &[(&str, &str)]) -> Result<Settings, String> {
        let variable = |name: &str| environment.iter().find(|(n, _)| *n == name).map(|(_, value)| (*value).to_owned());
        Settings::read(master, "lapwing", &variable)
    }

    #[test]
    fn arguments_come_before_the_environment_and_loopback_last() {
        let plain = read(None, &[]).unwrap();
        assert_eq!((plain.master.to_string().as_str(), plain.host.as_str()), ("127.0.0.1:11311", "127.0.0.1"));
        assert!(plain.listen().unwrap().local_addr().unwrap().ip().is_loopback());
        let environment =
            [("ROS_MASTER_URI", "http://localhost:1"), ("ROS_IP", "10.0.0.7"), ("ROS_NAMESPACE", "/robot1")];
        let set = read(None, &environment).unwrap();
        assert_eq!((set.master.port, set.host.as_str(), set.names.node()), (1, "10.0.0.7", "/robot1/lapwing"));
        assert_eq!(read(Some("http://127.0.0.1:2"), &environment).unwrap().master.port, 2);
        assert_eq!(read(None, &[("ROS_IP", "10.0.0.7"), ("ROS_HOSTNAME", "me")]).unwrap().host, "me");
        assert!(read(Some("http://:x"), &[]).unwrap_err().contains("master"));
    }
}
