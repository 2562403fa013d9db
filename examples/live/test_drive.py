"""A test of a robot, watched over by Lapwing. It stands for yours: its robot is a node that publishes how fast it goes.

Run with the Python of a ROS 2 installation: pytest test_drive.py
"""

import os
import pathlib
import time

import rclpy
from nav_msgs.msg import Odometry

SPEC = pathlib.Path(__file__).with_name("robot.rv")


def drive(speed):
    """Drives for two seconds."""
    rclpy.init()
    node = rclpy.create_node("base")
    odometry = node.create_publisher(Odometry, "/odom", 10)
    message = Odometry()
    message.twist.twist.linear.x = speed
    for _ in range(40):
        odometry.publish(message)
        time.sleep(0.05)
    node.destroy_node()
    rclpy.shutdown()


def test_drives_slowly_enough(lapwing):
    lapwing.watch(SPEC, "--ros2", "--domain", os.environ.get("ROS_DOMAIN_ID", "0"), "--until-first-violation")
    drive(float(os.environ.get("SPEED", "0.5")))
