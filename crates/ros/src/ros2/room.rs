//! The room that messages have on their way in: what a socket holds until DDS reads it, and what to say where that is too little.

/// How many bytes a socket asks for. The system may allow less: a point cloud that comes at once has room where it does not.
pub const WANTED: usize = 32 << 20;

/// How many bytes the system allows a socket, where it says so.
pub fn allowed() -> Option<usize> {
    std::fs::read_to_string("/proc/sys/net/core/rmem_max").ok()?.trim().parse().ok()
}

/// Whether messages of that size come in so many parts that some are likely to be sent twice.
pub fn is_large(size: usize) -> bool {
    size > LARGE
}

/// Less than this fits into a socket at once on most systems.
const LARGE: usize = 200_000;

/// What helps where messages of a topic are lost that are so large, if it is the room of a socket.
pub fn advice(topic: &str, size: usize, allowed: usize) -> Option<String> {
    let is_tight = size > allowed && allowed < WANTED;
    is_tight.then(|| {
        format!(
            "messages of {topic} have {size} bytes, and this system lets {allowed} wait in a socket: \
             `sudo sysctl -w net.core.rmem_max={WANTED}`, and a new start, give them room"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_is_given_where_the_room_of_a_socket_is_what_is_short() {
        let told = advice("/points", 10_000_000, 212_992).unwrap();
        assert!(told.contains("/points have 10000000 bytes") && told.contains("net.core.rmem_max=33554432"), "{told}");
        assert_eq!(advice("/odom", 700, 212_992), None, "small messages are lost for other reasons");
        assert_eq!(advice("/points", 50_000_000, WANTED), None, "more is not asked for");
    }
}
