"""Counts what comes on /flood, by rospy or rclpy: `listen.py ros1|ros2`. Prints `heard N` two seconds after the last message."""

import sys
import threading
import time


def main(which):
    heard, last, lock = [0], [None], threading.Lock()

    def hear(_):
        with lock:
            heard[0] += 1
            last[0] = time.monotonic()

    if which == "ros1":
        import rospy
        from std_msgs.msg import UInt32

        rospy.init_node("listener", disable_signals=True)
        rospy.Subscriber("/flood", UInt32, hear, tcp_nodelay=True)
    else:
        import rclpy
        from geometry_msgs.msg import Twist

        rclpy.init()
        node = rclpy.create_node("listener")
        node.create_subscription(Twist, "/flood", hear, 1000)
        threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    print("ready", flush=True)
    while last[0] is None or time.monotonic() - last[0] < 2:
        time.sleep(0.05)
    print("heard", heard[0], flush=True)


main(sys.argv[1])
