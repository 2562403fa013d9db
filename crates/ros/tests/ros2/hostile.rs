//! Datagrams that are no RTPS, or broken RTPS, do the connector no harm: what is published goes on being heard.

use std::net::UdpSocket;
use std::time::{Duration, Instant};

use lapwing_ros::connector::{Cause, Happening};

use crate::peer::{Heard, Peer};

/// The ports of a domain: of discovery to all, and of discovery and of data to one participant (RTPS 2.5, section 9.6.2.3).
fn ports(domain: u16) -> impl Iterator<Item = u16> {
    let base = 7400 + 250 * domain;
    [base, base + 1].into_iter().chain((0..4).flat_map(move |k| [base + 10 + 2 * k, base + 11 + 2 * k]))
}

/// A small generator of pseudo-random numbers (xorshift).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % u64::try_from(n.max(1)).unwrap()).unwrap()
    }

    fn bytes(&mut self, n: usize) -> Vec<u8> {
        (0..n).map(|_| u8::try_from(self.below(256)).unwrap()).collect()
    }
}

/// What participants of the domain announce to one that could be there: datagrams to begin with.
fn announcements(domain: u16) -> Vec<Vec<u8>> {
    let socket = UdpSocket::bind(("127.0.0.1", 7400 + 250 * domain + 10 + 2 * 3)).unwrap();
    socket.set_read_timeout(Some(Duration::from_millis(500))).unwrap();
    let (mut found, mut buffer) = (Vec::new(), vec![0; 65536]);
    let deadline = Instant::now() + Duration::from_secs(20);
    while found.len() < 4 && Instant::now() < deadline {
        if let Ok(length) = socket.recv(&mut buffer) {
            found.push(buffer[..length].to_vec());
        }
    }
    assert!(!found.is_empty(), "nobody announces itself");
    found
}

/// A datagram that is broken somewhere.
fn broken(random: &mut Random, good: &[Vec<u8>]) -> Vec<u8> {
    let mut datagram = good[random.below(good.len())].clone();
    match random.below(5) {
        0 => datagram.truncate(random.below(datagram.len())),
        1 => {
            let length = 1 + random.below(200);
            datagram = [b"RTPS\x02\x03\x01\x0f".to_vec(), random.bytes(12 + length)].concat();
        }
        2 => {
            // Another submessage, with the header of a good datagram.
            datagram.truncate(20);
            let body = 4 * random.below(40);
            datagram.extend([u8::try_from(random.below(0x20)).unwrap(), u8::try_from(random.below(16)).unwrap()]);
            datagram.extend(u16::try_from(random.below(2 * body + 2)).unwrap().to_le_bytes());
            datagram.extend(random.bytes(body));
        }
        _ => {
            for _ in 0..1 + random.below(6) {
                // The first bytes say that it is RTPS at all.
                let at = 20 + random.below(datagram.len() - 20);
                datagram[at] = if random.below(2) == 0 { 0xff } else { u8::try_from(random.below(256)).unwrap() };
            }
        }
    }
    datagram
}

#[test]
fn broken_datagrams_do_no_harm() {
    const DOMAIN: u16 = 141;
    let _peer = Peer::rclpy(DOMAIN, "publish /odom nav_msgs/Odometry --rate 20");
    let mut heard = Heard::on(DOMAIN, &["/odom"]);
    let offer = heard.offer("/odom");
    heard.message(offer.stream);
    let good = announcements(DOMAIN);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut random = Random(0x5eed);
    for round in 0..10_000 {
        let datagram = broken(&mut random, &good);
        for port in ports(DOMAIN) {
            // A port without a socket refuses, and the next send says so.
            let _ = socket.send_to(&datagram, ("127.0.0.1", port));
        }
        if round % 1000 == 0 {
            heard.message(offer.stream);
        }
    }
    // What is in the queue came before the last datagrams.
    while heard.connector.next(Duration::ZERO).is_some() {}
    for _ in 0..20 {
        heard.message(offer.stream);
    }
    let is_broken = |what: &Happening| matches!(what, Happening::Blind { cause: Cause::Disconnected(_), .. });
    assert!(!heard.all.iter().any(|a| is_broken(&a.what)));
}
