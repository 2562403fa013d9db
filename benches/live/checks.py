"""The alternative to a monitor: the properties of robot.rv, checked thirty times a second by a script, as a robot's programmer writes it.

The callbacks keep the latest message and no more, so that the script costs what its checks cost. `checks_ros1.py` and `checks_ros2.py` are the nodes.
"""


class Checks:
    """The latest messages, and what has been found."""

    def __init__(self):
        self.odometry = self.command = self.scan = None
        self.scanned = None
        self.commanded_since = None
        self.found = {"slow": 0, "obeys": 0, "clear": 0, "fresh": 0}

    def hear_odometry(self, message):
        self.odometry = message

    def hear_command(self, message):
        self.command = message

    def hear_scan(self, message, now):
        self.scan, self.scanned = message, now

    def check(self, now):
        """One look at everything."""
        if self.odometry is not None:
            speed = self.odometry.twist.twist.linear.x
            self.found["slow"] += speed > 0.5
            if self.command is not None and self.command.linear.x > 0.1:
                if self.commanded_since is None:
                    self.commanded_since = now
                elif now - self.commanded_since >= 1.0:
                    self.found["obeys"] += not speed > 0.02
            else:
                self.commanded_since = None
        if self.scan is not None:
            self.found["clear"] += min(self.scan.ranges) < 0.05
            self.found["fresh"] += not now - self.scanned < 1.0
