"""What a fault between a robot's program and its base does to a command, whatever carries it.

The three bugs are those of the thesis, from the ROBUST collection; `lapwing sim --list` says more of each.
"""


def direction_inverted(command):
    """Below 0.012 m/s the base turns the other way (kobuki e964bbb)."""
    if abs(command.linear.x) < 0.012:
        command.angular.z = -command.angular.z


def docking_stuck(command):
    """Below 0.015 m/s the base does not move forwards (kobuki 0416c81)."""
    if abs(command.linear.x) < 0.015:
        command.linear.x = 0.0


def backwards(command):
    """Above 0.03 m/s the base drives backwards (kobuki 1c141a5)."""
    if abs(command.linear.x) > 0.03:
        command.linear.x = -command.linear.x


FAULTS = {
    "none": lambda command: None,
    "direction-inverted": direction_inverted,
    "docking-stuck": docking_stuck,
    "backwards": backwards,
}
