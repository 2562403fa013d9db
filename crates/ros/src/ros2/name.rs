//! Names as ROS 2 spells them, and as they lie on the wire: its design article "Topic and Service name mapping to DDS".

/// The topic on the wire of a ROS topic: `/odom` is `rt/odom`.
pub fn topic_on_wire(topic: &str) -> String {
    format!("rt/{}", topic.trim_start_matches('/'))
}

/// The ROS topic of one on the wire, where it is one: not a request, not an answer, and not what DDS uses itself.
pub fn topic(on_wire: &str) -> Option<String> {
    on_wire.strip_prefix("rt/").filter(|rest| !rest.is_empty()).map(|rest| format!("/{rest}"))
}

/// The topic on the wire on which requests to a service are sent: of `/stop`, `rq/stopRequest`.
pub fn requests_on_wire(service: &str) -> String {
    format!("rq/{}Request", service.trim_start_matches('/'))
}

/// The topic on the wire on which a service answers: of `/stop`, `rr/stopReply`.
pub fn answers_on_wire(service: &str) -> String {
    format!("rr/{}Reply", service.trim_start_matches('/'))
}

/// The name on the wire of a type: of `nav_msgs/msg/Odometry` and of `nav_msgs/Odometry`, `nav_msgs::msg::dds_::Odometry_`.
/// `None` where the name is none of ROS.
pub fn type_on_wire(name: &str) -> Option<String> {
    let full = full_type(name)?;
    let (package, rest) = full.split_once('/')?;
    let (kind, ty) = rest.split_once('/')?;
    Some(format!("{package}::{kind}::dds_::{ty}_"))
}

/// The ROS name of a type on the wire. One that is not ROS's own stays what it is.
pub fn type_name(on_wire: &str) -> String {
    let parts: Vec<&str> = on_wire.split("::").collect();
    match parts.as_slice() {
        [package, kind, "dds_", ty] => match ty.strip_suffix('_') {
            Some(ty) => format!("{package}/{kind}/{ty}"),
            None => on_wire.to_owned(),
        },
        _ => on_wire.to_owned(),
    }
}

/// A type's name with all three parts: of `nav_msgs/Odometry`, `nav_msgs/msg/Odometry`. `None` where it is no name of a type.
pub fn full_type(name: &str) -> Option<String> {
    let is_word = |word: &&str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    let parts: Vec<&str> = name.split('/').collect();
    if !parts.iter().all(is_word) {
        return None;
    }
    match parts.as_slice() {
        [package, ty] => Some(format!("{package}/msg/{ty}")),
        [_, _, _] => Some(name.to_owned()),
        _ => None,
    }
}

/// The parts of a service's name: of `std_srvs/srv/Trigger`, `std_srvs` and `Trigger`. Also of `std_srvs/Trigger`.
pub fn service_type(name: &str) -> Option<(&str, &str)> {
    full_type(name)?;
    let (package, rest) = name.split_once('/')?;
    match rest.split_once('/') {
        None => Some((package, rest)),
        Some(("srv", ty)) => Some((package, ty)),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_go_there_and_back() {
        for topic_name in ["/odom", "/r1/odom", "/fibonacci/_action/status", "/add/_service_event"] {
            assert_eq!(topic(&topic_on_wire(topic_name)).as_deref(), Some(topic_name));
        }
        for other in ["rq/addRequest", "rr/addReply", "ros_discovery_info", "DCPSPublication", "rt/", "rt", ""] {
            assert_eq!(topic(other), None, "{other}");
        }
        assert_eq!(requests_on_wire("/r1/stop"), "rq/r1/stopRequest");
        assert_eq!(answers_on_wire("/r1/stop"), "rr/r1/stopReply");
    }

    #[test]
    fn types_go_there_and_back() {
        for name in ["nav_msgs/msg/Odometry", "std_srvs/srv/Trigger_Request", "demo/action/Fibonacci_FeedbackMessage"] {
            assert_eq!(type_name(&type_on_wire(name).unwrap()), name);
        }
        assert_eq!(type_on_wire("nav_msgs/Odometry").as_deref(), Some("nav_msgs::msg::dds_::Odometry_"));
        assert_eq!(type_name("MyModule::Shape"), "MyModule::Shape");
        assert_eq!(type_name("a::msg::dds_::NoUnderscore"), "a::msg::dds_::NoUnderscore");
        for bad in ["Odometry", "a//b", "a/b/c/d", "a/b c", "../x", ""] {
            assert_eq!(type_on_wire(bad), None, "{bad}");
        }
        assert_eq!(service_type("std_srvs/Trigger"), Some(("std_srvs", "Trigger")));
        assert_eq!(service_type("std_srvs/srv/Trigger"), Some(("std_srvs", "Trigger")));
        assert_eq!(service_type("std_msgs/msg/String"), None);
    }
}
