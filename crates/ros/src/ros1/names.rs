//! Names on the graph: absolute, relative to a namespace, private to a node.

/// The names of a node, from which others are resolved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Names {
    node: String,
}

impl Names {
    /// Those of the node of that name, which begins in the namespace where it is relative. Says what is wrong with a name that is none.
    pub fn new(node: &str, namespace: &str) -> Result<Names, String> {
        let node = if node.starts_with('/') { node.to_owned() } else { format!("{namespace}/{node}") };
        let node = tidy(&node);
        if is_name(&node) {
            return Ok(Names { node });
        }
        Err(format!(
            "`{node}` is no name of a node: write letters, digits and underscores, a letter first, with slashes between namespaces, as in `/lapwing`"
        ))
    }

    /// The name of the node, absolute.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// The absolute form of a name: `~verdicts` and `~/verdicts` are below the node, `odom` is in its namespace.
    pub fn resolve(&self, name: &str) -> String {
        let namespace = self.node.rsplit_once('/').map_or("", |(namespace, _)| namespace);
        match name.strip_prefix('~') {
            Some(private) => tidy(&format!("{}/{private}", self.node)),
            None if name.starts_with('/') => tidy(name),
            None => tidy(&format!("{namespace}/{name}")),
        }
    }
}

/// One slash in front, one between any two parts, none at the end.
fn tidy(name: &str) -> String {
    name.split('/').filter(|part| !part.is_empty()).fold(String::new(), |whole, part| whole + "/" + part)
}

fn is_name(absolute: &str) -> bool {
    let is_part = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_alphabetic())
            && part.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
    };
    absolute.len() > 1 && absolute.split('/').skip(1).all(is_part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_resolved() {
        let names = Names::new("lapwing", "/robot1").unwrap();
        assert_eq!(names.node(), "/robot1/lapwing");
        for (name, resolved) in [
            ("/odom", "/odom"),
            ("odom", "/robot1/odom"),
            ("//a//b/", "/a/b"),
            ("~verdicts", "/robot1/lapwing/verdicts"),
            ("~/verdicts", "/robot1/lapwing/verdicts"),
        ] {
            assert_eq!(names.resolve(name), resolved);
        }
        assert_eq!(Names::new("/a/b", "/ns").unwrap().node(), "/a/b");
        for wrong in ["", "/", "1a", "a b", "a/1", "a-b", "<a>"] {
            assert!(Names::new(wrong, "").is_err(), "{wrong:?}");
        }
    }
}
