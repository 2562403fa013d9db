"""Publishes small numbered messages on /flood as fast as it is told to, by rospy: `ros1_flood.py RATE SECONDS`. Run by /usr/bin/python3.

Says at the end how many it published, and at which rate: what the machine can do depends on what else it does.
"""

import sys
import time

import rospy
from std_msgs.msg import UInt32


def main(rate, seconds):
    rospy.init_node("flood", disable_signals=True)
    # Without a size the publisher writes at once and drops nothing.
    publisher = rospy.Publisher("/flood", UInt32, queue_size=None, tcp_nodelay=True)
    while publisher.get_num_connections() == 0:
        time.sleep(0.05)
    begin, count = time.time(), 0
    while time.time() - begin < seconds:
        due = int((time.time() - begin) * rate)
        while count < due:
            publisher.publish(count)
            count += 1
        time.sleep(0.001)
    print("published %d, %.0f a second" % (count, count / (time.time() - begin)), flush=True)
    time.sleep(1)


main(float(sys.argv[1]), float(sys.argv[2]))
