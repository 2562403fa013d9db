"""The same with launch_testing: Lapwing watches beside the robot, and the test fails with its report.

    launch_test test_drive_launch.py

`LAPWING` names the program where it is not on the path, and `ROBOT` the command that starts the robot: put yours in its place.
"""

import os
import pathlib
import shlex
import signal
import threading
import unittest

import launch
import launch_testing
import launch_testing.actions
from launch.actions import ExecuteProcess, RegisterEventHandler
from launch.event_handlers import OnProcessIO
from launch.events import matches_action
from launch.events.process import SignalProcess

SPEC = pathlib.Path(__file__).with_name("robot.rv")
LAPWING = os.environ.get("LAPWING", "lapwing")
ROBOT = os.environ.get("ROBOT", "ros2 launch my_robot drive_test.launch.py")

# The robot of this test says `driven` when it has driven. Yours may tell it by a topic, or be told what to do by the test.
DRIVEN = threading.Event()


def listen(output):
    if b"driven" in output.text:
        DRIVEN.set()


def generate_test_description():
    lapwing = ExecuteProcess(cmd=[LAPWING, "monitor", str(SPEC), "--ros2", "--view", "lines"], output="screen", sigterm_timeout="30")
    robot = ExecuteProcess(cmd=shlex.split(ROBOT), output="screen")
    listening = RegisterEventHandler(OnProcessIO(target_action=robot, on_stdout=listen))
    ready = launch_testing.actions.ReadyToTest()
    return launch.LaunchDescription([listening, lapwing, robot, ready]), {"lapwing": lapwing}


class Drive(unittest.TestCase):
    def test_drives(self, launch_service, lapwing, proc_info):
        self.assertTrue(DRIVEN.wait(timeout=120), "the robot does not drive")
        # Lapwing ends before the robot does: what it watches is there as long as it watches.
        launch_service.emit_event(SignalProcess(signal_number=signal.SIGINT, process_matcher=matches_action(lapwing)))
        proc_info.assertWaitForShutdown(process=lapwing, timeout=30)


@launch_testing.post_shutdown_test()
class Verdict(unittest.TestCase):
    def test_nothing_was_violated(self, proc_info, proc_output, lapwing):
        report = b"".join(output.text for output in proc_output[lapwing]).decode()
        self.assertEqual(proc_info[lapwing].returncode, 0, f"\n{report}")
