#!/usr/bin/env python3
"""The properties of robot.rv at 30 Hz, by rclpy."""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import LaserScan

from checks import Checks


def main():
    rclpy.init()
    node = rclpy.create_node("checks")
    checks = Checks()
    now = lambda: node.get_clock().now().nanoseconds / 1e9
    node.create_subscription(Odometry, "/odom", checks.hear_odometry, 1)
    node.create_subscription(Twist, "/cmd_vel", checks.hear_command, 1)
    node.create_subscription(LaserScan, "/scan", lambda message: checks.hear_scan(message, now()), 1)
    node.create_timer(1 / 30, lambda: checks.check(now()))
    print("ready", flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


main()
