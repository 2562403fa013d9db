#!/usr/bin/python3
"""The properties of robot.rv at 30 Hz, by rospy."""

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from checks import Checks


def main():
    rospy.init_node("checks")
    checks = Checks()
    rospy.Subscriber("/odom", Odometry, checks.hear_odometry, queue_size=1)
    rospy.Subscriber("/cmd_vel", Twist, checks.hear_command, queue_size=1)
    rospy.Subscriber("/scan", LaserScan, lambda message: checks.hear_scan(message, rospy.get_time()), queue_size=1)
    print("ready", flush=True)
    rate = rospy.Rate(30)
    while not rospy.is_shutdown():
        checks.check(rospy.get_time())
        try:
            rate.sleep()
        except rospy.ROSInterruptException:
            break


main()
