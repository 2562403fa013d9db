"""Lapwing beside the nodes of a ROS 2 robot: ros2 launch watch.launch.py spec:=/path/to/robot.rv

It needs nothing of ROS but the graph. It ends with the other nodes (SIGINT, then SIGTERM, as launch sends them), and reports then.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("spec", default_value="robot.rv"),
        DeclareLaunchArgument("record", default_value="lapwing.mcap"),
        ExecuteProcess(
            name="lapwing",
            cmd=[
                "lapwing", "monitor", LaunchConfiguration("spec"), "--ros2", "--view", "lines",
                "--record", LaunchConfiguration("record"),
            ],
            output="screen",
            # The report takes a moment where much was recorded.
            sigterm_timeout="10",
        ),
    ])
