"""The same with launch_testing: Lapwing is one of the processes, and the test fails by its exit code, with its report above.

    launch_test test_drive_launch.py
"""

import pathlib
import signal
import time
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from launch.actions import ExecuteProcess
from launch.events.process import SignalProcess
from launch.events import matches_action

SPEC = pathlib.Path(__file__).with_name("robot.rv")


def generate_test_description():
    lapwing = ExecuteProcess(cmd=["lapwing", "monitor", str(SPEC), "--ros2", "--view", "lines"], output="screen")
    robot = ExecuteProcess(cmd=["ros2", "launch", "my_robot", "drive.launch.py"], output="screen")
    description = launch.LaunchDescription([lapwing, robot, launch_testing.actions.ReadyToTest()])
    return description, {"lapwing": lapwing}


class Drive(unittest.TestCase):
    def test_drives(self, launch_service, lapwing, proc_info):
        time.sleep(20)  # or whatever the test does with the robot
        launch_service.emit_event(SignalProcess(signal_number=signal.SIGINT, process_matcher=matches_action(lapwing)))
        proc_info.assertWaitForShutdown(process=lapwing, timeout=30)


@launch_testing.post_shutdown_test()
class Verdict(unittest.TestCase):
    def test_nothing_was_violated(self, proc_info, lapwing):
        launch_testing.asserts.assertExitCodes(proc_info, process=lapwing, allowable_exit_codes=[0])
