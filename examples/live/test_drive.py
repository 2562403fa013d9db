"""A test of a robot, watched over by Lapwing. It stands for yours: its robot is a node that publishes how fast it goes.

Run with the Python of a ROS 2 installation: pytest test_drive.py
"""

import os
import pathlib
import time

import pytest
import rclpy
from nav_msgs.msg import Odometry

SPEC = pathlib.Path(__file__).with_name("robot.rv")


@pytest.fixture
def base():
    """The robot. A test asks for it before it asks for Lapwing: then it is there for as long as it is watched."""
    rclpy.init()
    node = rclpy.create_node("base")
    yield node
    node.destroy_node()
    rclpy.shutdown()


def drive(base, speed):
    """Drives for two seconds, once somebody listens: nothing is learnt from a drive that nobody saw."""
    odometry = base.create_publisher(Odometry, "/odom", 10)
    patience = time.monotonic() + 30
    while odometry.get_subscription_count() == 0 and time.monotonic() < patience:
        time.sleep(0.05)
    message = Odometry()
    message.twist.twist.linear.x = speed
    for _ in range(40):
        odometry.publish(message)
        time.sleep(0.05)


def test_drives_slowly_enough(base, lapwing):
    lapwing.watch(SPEC, "--ros2", "--domain", os.environ.get("ROS_DOMAIN_ID", "0"), "--until-first-violation")
    drive(base, float(os.environ.get("SPEED", "0.5")))
