"""Writes messages.json as ROS 1 bags by ROS 1's own rosbag. Run by /usr/bin/python3 with the folder."""

import json
import sys
from pathlib import Path

import genpy
import rosbag
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState, LaserScan

OUT = Path(sys.argv[1])
TYPES = {"/odom": Odometry, "/cmd_vel": Twist, "/scan": LaserScan, "/joints": JointState}


def message(topic, values):
    """The message of those values, all else zero."""
    made = TYPES[topic]()
    if hasattr(made, "header"):
        made.header.stamp = genpy.Time(values["header.stamp.sec"], values["header.stamp.nanosec"])
    for path, value in values.items():
        if path.startswith("header.stamp"):
            continue
        *way, last = path.replace("[35]", "").split(".")
        at = made
        for name in way:
            at = getattr(at, name)
        if path.endswith("[35]"):
            at.covariance = [0.0] * 35 + [value]
        elif path == "ranges":
            at.ranges = [float(x) for x in value]
        else:
            setattr(at, last, value)
    return made


def main():
    messages = json.loads((OUT / "messages.json").read_text())
    for compression in ("none", "bz2", "lz4"):
        with rosbag.Bag(str(OUT / f"rosbag_{compression}.bag"), "w", compression=compression, chunk_threshold=20_000) as bag:
            for m in messages:
                bag.write(m["topic"], message(m["topic"], m["values"]), genpy.Time(m["t"] // 10**9, m["t"] % 10**9))


main()
