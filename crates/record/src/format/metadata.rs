//! `metadata.yaml` of a rosbag2 folder: as much of it as is needed, in the block style in which it is written.

/// What the metadata says.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Metadata {
    /// `sqlite3` or `mcap`.
    pub storage: String,
    /// The files, in order, relative to the folder.
    pub files: Vec<String>,
    /// `zstd`, or nothing.
    pub compression_format: String,
    /// `file`, `message`, or nothing, in small letters.
    pub compression_mode: String,
    /// Topic, type and number of messages.
    pub topics: Vec<(String, String, Option<u64>)>,
}

impl Metadata {
    /// Reads a metadata file, line by line. What is not understood is passed over.
    pub fn parse(text: &str) -> Metadata {
        let mut metadata = Metadata::default();
        let mut list = List::None;
        for line in text.lines() {
            let item = line.trim_start().strip_prefix("- ").map(str::trim);
            let entry = item.unwrap_or_else(|| line.trim());
            match entry.split_once(':').filter(|(_, v)| v.is_empty() || v.starts_with(' ')) {
                Some((key, value)) => list = metadata.entry(key.trim(), value.trim(), list),
                None if item.is_some() && list == List::Paths => metadata.files.push(scalar(entry)),
                None => {}
            }
        }
        metadata
    }

    fn entry(&mut self, key: &str, value: &str, list: List) -> List {
        match key {
            "storage_identifier" => self.storage = scalar(value),
            "compression_format" => self.compression_format = scalar(value),
            "compression_mode" => self.compression_mode = scalar(value).to_ascii_lowercase(),
            "relative_file_paths" => {
                let inline = value.strip_prefix('[').and_then(|v| v.strip_suffix(']'));
                self.files.extend(inline.into_iter().flat_map(|v| v.split(',')).map(scalar).filter(|f| !f.is_empty()));
                return List::Paths;
            }
            "topics_with_message_count" => return List::Topics,
            "files" => return List::None,
            "name" if list == List::Topics => self.topics.push((scalar(value), String::new(), None)),
            "type" if list == List::Topics => self.last_topic(|t| t.1 = scalar(value)),
            "message_count" if list == List::Topics => self.last_topic(|t| t.2 = value.parse().ok()),
            _ if list == List::Topics => return list,
            _ => return List::None,
        }
        if list == List::Topics { list } else { List::None }
    }

    fn last_topic(&mut self, set: impl FnOnce(&mut (String, String, Option<u64>))) {
        if let Some(last) = self.topics.last_mut() {
            set(last);
        }
    }
}

/// Which list the lines belong to.
#[derive(Clone, Copy, PartialEq)]
enum List {
    None,
    Paths,
    Topics,
}

/// A plain or quoted text.
fn scalar(text: &str) -> String {
    let text = text.trim();
    let quoted = ['"', '\''].iter().find_map(|q| text.strip_prefix(*q)?.strip_suffix(*q));
    quoted.unwrap_or(text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rosbag2_writes_is_read() {
        let text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  duration:\n    nanoseconds: 12\n  \
                    message_count: 7\n  topics_with_message_count:\n    - topic_metadata:\n        name: /odom\n        \
                    type: nav_msgs/msg/Odometry\n        serialization_format: cdr\n        \
                    offered_qos_profiles: \"- history: 3\\n  depth: 0\"\n      message_count: 5\n    - topic_metadata:\n        \
                    name: '/scan'\n        type: sensor_msgs/msg/LaserScan\n      message_count: 2\n  compression_format: zstd\n  \
                    compression_mode: FILE\n  relative_file_paths:\n    - bag_0.db3.zstd\n    - \"bag_1.db3.zstd\"\n  files:\n    \
                    - path: bag_0.db3.zstd\n      message_count: 5\n";
        let metadata = Metadata::parse(text);
        assert_eq!(metadata.storage, "sqlite3");
        assert_eq!(metadata.files, ["bag_0.db3.zstd", "bag_1.db3.zstd"]);
        assert_eq!((metadata.compression_format.as_str(), metadata.compression_mode.as_str()), ("zstd", "file"));
        let topics = [("/odom", "nav_msgs/msg/Odometry", Some(5)), ("/scan", "sensor_msgs/msg/LaserScan", Some(2))];
        assert_eq!(metadata.topics, topics.map(|(n, t, c)| (n.to_owned(), t.to_owned(), c)));
        assert_eq!(Metadata::parse("relative_file_paths: [a.db3, 'b.db3']").files, ["a.db3", "b.db3"]);
    }
}
