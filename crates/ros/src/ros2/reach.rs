//! Where to look for robots: the domain, and how far beyond this machine, from ROS 2's own environment variables.

use crate::connector::Refused;

/// Beyond this number the ports of a domain would be no ports (RTPS 2.5, section 9.6.2.3).
const LAST_DOMAIN: u16 = 232;

/// Which graph to join.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// The DDS domain.
    pub domain: u16,
    /// Whether only this machine is spoken to.
    pub loopback_only: bool,
}

impl Reach {
    /// The domain asked for, else `ROS_DOMAIN_ID`, else 0. Only this machine, unless `ROS_AUTOMATIC_DISCOVERY_RANGE` is `SUBNET`
    /// or `SYSTEM_DEFAULT`, or `ROS_LOCALHOST_ONLY`, which is older and of which the former has to be silent, is `0`.
    pub fn new(domain: Option<u16>, variable: impl Fn(&str) -> Option<String>) -> Result<Reach, Refused> {
        let set = |name: &str| variable(name).map(|v| v.trim().to_owned()).filter(|v| !v.is_empty());
        let domain = match (domain, set("ROS_DOMAIN_ID")) {
            (Some(domain), _) => domain,
            (None, Some(text)) => text.parse().map_err(|_| {
                Refused(format!("ROS_DOMAIN_ID is `{text}`, which is no domain: they are 0 to {LAST_DOMAIN}"))
            })?,
            (None, None) => 0,
        };
        if domain > LAST_DOMAIN {
            return Err(Refused(format!("there is no domain {domain}: they are 0 to {LAST_DOMAIN}")));
        }
        let range = set("ROS_AUTOMATIC_DISCOVERY_RANGE").map(|range| range.to_uppercase());
        let loopback_only = match range.as_deref() {
            Some("LOCALHOST") => true,
            Some("SUBNET" | "SYSTEM_DEFAULT") => false,
            Some("OFF") => {
                return Err(Refused(
                    "ROS_AUTOMATIC_DISCOVERY_RANGE is OFF, so that no node can be found: set it to LOCALHOST or SUBNET"
                        .to_owned(),
                ));
            }
            Some(other) => {
                return Err(Refused(format!(
                    "ROS_AUTOMATIC_DISCOVERY_RANGE is `{other}`: it may be LOCALHOST, SUBNET, SYSTEM_DEFAULT or OFF"
                )));
            }
            None => set("ROS_LOCALHOST_ONLY").as_deref() != Some("0"),
        };
        Ok(Reach { domain, loopback_only })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(domain: Option<u16>, set: &[(&str, &str)]) -> Result<Reach, Refused> {
        Reach::new(domain, |name| set.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned()))
    }

    #[test]
    fn only_this_machine_unless_told_otherwise() {
        let home = Reach { domain: 0, loopback_only: true };
        assert_eq!(reach(None, &[]), Ok(home));
        assert_eq!(reach(None, &[("ROS_LOCALHOST_ONLY", "1")]), Ok(home));
        assert_eq!(reach(None, &[("ROS_LOCALHOST_ONLY", "0")]), Ok(Reach { loopback_only: false, ..home }));
        let range = "ROS_AUTOMATIC_DISCOVERY_RANGE";
        assert_eq!(reach(None, &[(range, "subnet")]), Ok(Reach { loopback_only: false, ..home }));
        assert_eq!(reach(None, &[(range, "LOCALHOST"), ("ROS_LOCALHOST_ONLY", "0")]), Ok(home));
        assert!(reach(None, &[(range, "OFF")]).is_err_and(|e| e.0.contains("LOCALHOST")));
        assert!(reach(None, &[(range, "MARS")]).is_err_and(|e| e.0.contains("MARS")));
    }

    #[test]
    fn a_domain_is_asked_for_or_found_in_the_environment() {
        let set = [("ROS_DOMAIN_ID", "42")];
        assert_eq!(reach(None, &set).map(|r| r.domain), Ok(42));
        assert_eq!(reach(Some(7), &set).map(|r| r.domain), Ok(7));
        assert!(reach(Some(233), &[]).is_err_and(|e| e.0.contains("232")));
        assert!(reach(None, &[("ROS_DOMAIN_ID", "seven")]).is_err_and(|e| e.0.contains("seven")));
    }
}
