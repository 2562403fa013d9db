#!/usr/bin/python3
"""A fault between a robot's program and its base, as a node of ROS 1 of its own: hears /cmd_vel_original, and says on /cmd_vel what becomes of it.

    fault_daemon.py none | direction-inverted | docking-stuck | backwards

See faults.py for what each does.
"""

import sys

import rospy
from geometry_msgs.msg import Twist

from faults import FAULTS


def main(fault):
    """Hands commands on, altered, for as long as the node lives."""
    rospy.init_node("fault_daemon", disable_signals=__name__ != "__main__")
    base = rospy.Publisher("/cmd_vel", Twist, queue_size=10, tcp_nodelay=True)

    def hand_on(command):
        FAULTS[fault](command)
        base.publish(command)

    rospy.Subscriber("/cmd_vel_original", Twist, hand_on, queue_size=10, tcp_nodelay=True)
    print("ready", flush=True)
    rospy.spin()


if __name__ == "__main__":
    if sys.argv[1:2] == [] or sys.argv[1] not in FAULTS:
        sys.exit(__doc__)
    main(sys.argv[1])
