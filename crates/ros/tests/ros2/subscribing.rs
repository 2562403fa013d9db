//! What is published by others is seen as it was published, whatever their quality of service, and whenever they come and go.

use std::time::{Duration, Instant};

use lapwing_ros::connector::{Cause, Happening};
use lapwing_stream::Value;

use crate::peer::{Heard, PATIENCE, Peer, numbers, values};

const ODOMETRY: [&str; 2] = ["pose.pose.position.x", "twist.covariance[35]"];

#[test]
fn odometry_arrives_as_it_was_published() {
    let _peer = Peer::rclpy(101, "publish /odom nav_msgs/Odometry --node driver --namespace /r1 --depth 1000");
    let mut heard = Heard::on(101, &["/odom"]);
    let offer = heard.offer("/odom");
    assert_eq!(offer.channel.type_name, "nav_msgs/msg/Odometry");
    assert_eq!((offer.channel.encoding.as_str(), offer.channel.messages.as_str()), ("ros2msg", "cdr"));
    assert!(!offer.latched);
    let mut last = None;
    for _ in 0..20 {
        let message = heard.message(offer.stream);
        let read = numbers(&offer.channel, &message, &ODOMETRY);
        assert_eq!(read[0] * 4.0, read[1]);
        if let Some(last) = last.replace(read[1]) {
            assert_eq!(read[1], last + 1.0);
        }
        assert_eq!(values(&offer.channel, &message, &["header.frame_id"]), [Value::from("odom")]);
    }
    assert_eq!(heard.lost(), 0);
}

#[test]
fn sensor_data_is_published_at_best() {
    let _peer = Peer::rclpy(102, "publish /odom nav_msgs/Odometry --best-effort");
    let mut heard = Heard::on(102, &["/odom"]);
    let offer = heard.offer("/odom");
    for _ in 0..5 {
        heard.message(offer.stream);
    }
}

#[test]
fn who_comes_late_gets_what_is_latched() {
    let _peer = Peer::rclpy(103, "publish /mode std_msgs/String --latched --depth 1 --count 1");
    std::thread::sleep(Duration::from_secs(1));
    let mut heard = Heard::on(103, &["/mode"]);
    let offer = heard.offer("/mode");
    assert!(offer.latched);
    let message = heard.message(offer.stream);
    assert_eq!(values(&offer.channel, &message, &["data"]), [Value::from("1")]);
}

/// Each publisher is heard with the best that it offers: the latched message comes, although the other publisher keeps none.
#[test]
fn publishers_may_differ_in_what_they_offer() {
    let _latched = Peer::rclpy(104, "publish /x std_msgs/Float64 --latched --depth 1 --count 1 --node a");
    let _fleeting = Peer::rclpy(104, "publish /x std_msgs/Float64 --best-effort --node b");
    std::thread::sleep(Duration::from_secs(1));
    let mut heard = Heard::on(104, &["/x"]);
    let offer = heard.offer("/x");
    let mut read = Vec::new();
    // What Fast DDS kept, and could not send at first, it sends with its next heartbeat: after three seconds. The other publisher goes on.
    let (begin, mut more) = (Instant::now(), 100);
    while more > 0 {
        let message = heard.message(offer.stream);
        read.extend(numbers(&offer.channel, &message, &["data"]));
        more -= usize::from(read.contains(&1.0));
        assert!(begin.elapsed() < PATIENCE, "what was kept did not come: {read:?}");
    }
    assert_eq!(read.iter().filter(|n| **n == 1.0).count(), 1, "{read:?}");
}

#[test]
fn a_topic_without_publishers_is_told_and_so_is_the_first_one() {
    let mut heard = Heard::on(105, &["/late"]);
    assert_eq!(heard.blind("/late", |_| true), Cause::NoPublisher);
    let _peer = Peer::rclpy(105, "publish /late std_msgs/Float64");
    let offer = heard.offer("/late");
    heard.sees("/late", |cause| *cause == Cause::NoPublisher);
    heard.message(offer.stream);
}

#[test]
fn a_publisher_that_leaves_and_one_that_comes_back() {
    let mut first = Peer::rclpy(106, "publish /odom nav_msgs/Odometry --node driver --depth 1000");
    let mut heard = Heard::on(106, &["/odom"]);
    let offer = heard.offer("/odom");
    heard.message(offer.stream);
    first.interrupt();
    heard.until("nobody publishes", |what| {
        matches!(what, Happening::Publishers { stream, count: 0 } if *stream == offer.stream).then_some(())
    });
    assert_eq!(heard.blind("/odom", |_| true), Cause::NoPublisher);
    let _second = Peer::rclpy(106, "publish /odom nav_msgs/Odometry --node driver --depth 1000");
    heard.sees("/odom", |cause| *cause == Cause::NoPublisher);
    let message = heard.message(offer.stream);
    assert!(numbers(&offer.channel, &message, &ODOMETRY)[1] >= 1.0);
    assert_eq!(heard.lost(), 0);
}

/// Killed, a publisher cannot say goodbye: that it is gone shows when its lease runs out. Its successor is heard at once.
#[test]
fn a_publisher_that_is_killed_and_started_again() {
    let first = Peer::rclpy(107, "publish /odom nav_msgs/Odometry --depth 1000");
    let mut heard = Heard::on(107, &["/odom"]);
    let offer = heard.offer("/odom");
    heard.message(offer.stream);
    first.kill();
    while heard.connector.next(Duration::from_millis(500)).is_some() {}
    let _second = Peer::rclpy(107, "publish /odom nav_msgs/Odometry --depth 1000");
    let message = heard.message(offer.stream);
    assert!(numbers(&offer.channel, &message, &ODOMETRY)[1] >= 1.0);
    assert_eq!(heard.lost(), 0);
}

#[test]
fn topics_of_robots_that_appear_later_are_offered() {
    let mut heard = Heard::on(108, &[]);
    let _one = Peer::rclpy(108, "publish odom nav_msgs/Odometry --namespace /r1 --node driver");
    let offered = |what: &Happening, topic: &str| match what {
        Happening::Stream(offer) if offer.channel.topic == topic => Some(offer.channel.ty.is_err()),
        _ => None,
    };
    assert!(heard.until("/r1/odom", |what| offered(what, "/r1/odom")), "nobody asked for its definition");
    heard.connector.subscribe(&["/r1/odom".to_owned()]);
    let one = heard.offer("/r1/odom");
    heard.message(one.stream);
    let _two = Peer::rclpy(108, "publish odom nav_msgs/Odometry --namespace /r2 --node driver");
    assert!(heard.until("/r2/odom", |what| offered(what, "/r2/odom")));
    heard.connector.subscribe(&["/r2/odom".to_owned()]);
    let two = heard.offer("/r2/odom");
    assert_ne!(one.stream, two.stream);
    heard.message(two.stream);
}

#[test]
fn another_vendor_without_ros() {
    let _peer = Peer::cyclone(109, "publish /cmd_vel");
    let mut heard = Heard::on(109, &["/cmd_vel"]);
    let offer = heard.offer("/cmd_vel");
    assert_eq!(offer.channel.type_name, "geometry_msgs/msg/Twist");
    let message = heard.message(offer.stream);
    let read = numbers(&offer.channel, &message, &["linear.x", "angular.z"]);
    assert!(read[0] > 0.0 && read[1] == 1.0, "{read:?}");
}

#[test]
fn what_cannot_be_had_is_named() {
    let _peer = Peer::cyclone(110, "publish /cmd_vel --exclusive");
    let mut heard = Heard::on(110, &["/cmd_vel"]);
    let Cause::Incompatible(why) = heard.blind("/cmd_vel", |cause| *cause != Cause::NoPublisher) else { panic!() };
    assert!(why.contains("OWNERSHIP"), "{why}");
    let _other = Peer::cyclone(110, "publish /cmd_vel --xcdr2");
    let Cause::Incompatible(why) = heard.blind("/cmd_vel", |cause| *cause != Cause::NoPublisher) else { panic!() };
    assert!(why.contains("XCDR2"), "{why}");
}

/// Readers of large messages follow one another: nothing is told twice for it, nothing out of order, and nothing is missing without a word.
#[test]
fn readers_of_large_messages_follow_one_another_unnoticed() {
    let _peer =
        Peer::rclpy(111, "publish /points sensor_msgs/PointCloud2 --bytes 250000 --rate 60 --depth 50 --wait-for 1");
    let mut heard = Heard::on(111, &["/points"]);
    let offer = heard.offer("/points");
    let (mut last, mut missing) = (None, 0.0);
    // A reader is followed after 48 messages, and the one before ends a second later.
    for _ in 0..200 {
        let message = heard.message(offer.stream);
        let number = numbers(&offer.channel, &message, &["header.stamp.sec"])[0];
        if let Some(last) = last.replace(number) {
            assert!(number > last, "{number} after {last}");
            missing += number - last - 1.0;
        }
    }
    assert_eq!(heard.lost() as f64, missing);
}
