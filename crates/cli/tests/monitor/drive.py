"""A robot of ROS 2 that drives as fast as it is told, and says `driven` once somebody has seen it: drive.py SPEED. It drives on until it is interrupted."""

import sys
import time

import rclpy
from nav_msgs.msg import Odometry

rclpy.init(signal_handler_options=rclpy.SignalHandlerOptions.NO)
node = rclpy.create_node("base")
odometry = node.create_publisher(Odometry, "/odom", 10)
message = Odometry()
message.twist.twist.linear.x = float(sys.argv[1])
seen = 0
try:
    while True:
        odometry.publish(message)
        seen += odometry.get_subscription_count() > 0
        if seen == 40:
            print("driven", flush=True)
        time.sleep(0.05)
except KeyboardInterrupt:
    pass
