#!/usr/bin/env python3
"""A fault between a robot's program and its base, as a node of ROS 2 of its own: hears /cmd_vel_original, and says on /cmd_vel what becomes of it.

    fault_daemon_ros2.py none | direction-inverted | docking-stuck | backwards

See faults.py for what each does.
"""

import sys

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException

from faults import FAULTS


def main(fault):
    """Hands commands on, altered, for as long as the node lives."""
    rclpy.init()
    node = rclpy.create_node("fault_daemon")
    base = node.create_publisher(Twist, "/cmd_vel", 10)

    def hand_on(command):
        FAULTS[fault](command)
        base.publish(command)

    node.create_subscription(Twist, "/cmd_vel_original", hand_on, 10)
    print("ready", flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    if sys.argv[1:2] == [] or sys.argv[1] not in FAULTS:
        sys.exit(__doc__)
    main(sys.argv[1])
