"""A fixture for pytest: a test fails where the robot violates a specification while it runs, with Lapwing's explanation.

    def test_drives_to_the_dock(lapwing):
        lapwing.watch("robot.rv", "--ros2")
        ...  # drive the robot

`LAPWING` names the program where it is not on the path.
"""

import json
import os
import signal
import subprocess
import threading

import pytest


class Watch:
    """One run of `lapwing monitor`."""

    def __init__(self, spec, *options):
        command = [os.environ.get("LAPWING", "lapwing"), "monitor", str(spec), *options, "--format", "ndjson"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.events = []
        self.began = threading.Event()
        self.complaints = []
        self.readers = [threading.Thread(target=self._read), threading.Thread(target=self._complain)]
        for reader in self.readers:
            reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.events.append(json.loads(line))
            self.began.set()
        self.began.set()

    def _complain(self):
        self.complaints.extend(self.process.stderr)

    def end(self):
        """Ends it, and gives what went wrong, in words; an empty text where nothing did."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=30)
        for reader in self.readers:
            reader.join()
        self.process.stdout.close()
        self.process.stderr.close()
        if code == 0:
            return ""
        if code not in (1, 3):
            return f"lapwing ended with {code}:\n" + "".join(self.complaints)
        return "\n".join(filter(None, map(explained, self.events)))


def explained(event):
    """A verdict that is no success, in words."""
    if event["type"] != "verdict" or event["verdict"] in ("holds", "satisfied"):
        return None
    lines = [f"{event['file']}:{event['line']}: {event['name']} is {event['verdict']}: {event['text']}"]
    if event["cause"]:
        lines.append(f"    {event['cause']}")
    for violation in event["violations"][:3]:
        values = ", ".join(f"{name} = {value}" for name, value in (violation["values"] or {}).items())
        lines.append(f"    failed at {violation['failed_ns'] / 1e9:.3f} s, {violation['count']} times: {values}")
    return "\n".join(lines)


class Lapwing:
    """What a test gets: it begins to watch when it is told to."""

    def __init__(self):
        self.watches = []

    def watch(self, spec, *options):
        """Watches until the test ends. `options` name the graph: "--ros2", "--domain", "7"."""
        watch = Watch(spec, *options)
        self.watches.append(watch)
        assert watch.began.wait(timeout=30), "lapwing does not begin"
        return watch


@pytest.fixture
def lapwing():
    """Watches over a test."""
    given = Lapwing()
    yield given
    wrong = [text for watch in given.watches if (text := watch.end())]
    if wrong:
        pytest.fail("\n".join(wrong), pytrace=False)
