#!/usr/bin/python3
"""The bugs of the thesis and the stop sign, live: real nodes, a fault between them, Lapwing watching, and the same verdicts three times over.

    catch.py ros1 [CASE...]        with rospy, of /usr/bin/python3
    catch.py ros2 [CASE...]        with the Python of a ROS 2 installation, in the domain of ROS_DOMAIN_ID

The cases are healthy, docking-stuck, direction-inverted, backwards and sign-unseen; without one, all. For each the simulator runs as a node, the fault
daemon (fault_daemon.py, fault_daemon_ros2.py) as another, and `lapwing monitor` watches both from outside. Then three reports are compared: what was
said live, what `lapwing check` says of what Lapwing recorded meanwhile, which has to be the same to the nanosecond, and of what the simulator recorded
itself, on which the verdicts have to be the same. A line for each property; the exit code is 0 if all agree and each fault was caught.

`LAPWING` names the program where it is not on the path.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

HERE = Path(__file__).resolve().parent
LAPWING = os.environ.get("LAPWING", "lapwing")
# Nothing takes so long, on however busy a machine, in seconds.
LIMIT = 90

# For how much longer a run is watched where its fault has not shown, in seconds of simulated time: on a busy machine nodes of ROS 2 take a while to
# find each other, and a robot that nobody commands does nothing wrong.
GRACE = 20

# What runs, which specification watches, whether commands go through the daemon, and until when, in seconds of simulated time.
CASES = {
    "healthy": ("docking", "docking.rv", True, 10),
    "docking-stuck": ("docking", "docking.rv", True, 10),
    "direction-inverted": ("turning", "turning.rv", True, 7.5),
    "backwards": ("errand", "forwards.rv", True, 3),
    "sign-unseen": ("stop-sign", "stop_sign.rv", False, 9),
}


def free_port():
    """A port that nobody has."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


class Processes:
    """What was started, which ends with this, the latest first."""

    def __init__(self, environment):
        self.environment, self.all = environment, []

    def start(self, *command, **more):
        process = subprocess.Popen([str(word) for word in command], env=self.environment, **more)
        self.all.append(process)
        return process

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(self.all):
            process.kill()
            process.wait()


class Ros1:
    """A graph with a master of its own."""

    def __init__(self):
        self.port = free_port()
        self.uri = f"http://127.0.0.1:{self.port}"
        self.environment = {"ROS_MASTER_URI": self.uri, "ROS_IP": "127.0.0.1", "ROS_HOSTNAME": "127.0.0.1"}
        self.words = ["--ros1", self.uri]
        self.daemon = ["/usr/bin/python3", HERE / "fault_daemon.py"]

    def begin(self, processes):
        processes.start("rosmaster", "--core", "-p", self.port, stdout=subprocess.DEVNULL)
        wait("the master", lambda: socket.create_connection(("127.0.0.1", self.port)).close() or True)


class Ros2:
    """A domain."""

    def __init__(self):
        self.environment = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        self.words = ["--ros2", "--domain", os.environ.get("ROS_DOMAIN_ID", "0")]
        self.daemon = [sys.executable, HERE / "fault_daemon_ros2.py"]

    def begin(self, processes):
        pass


def wait(what, is_there):
    """Until it is."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        try:
            if is_there():
                return
        except OSError:
            pass
        time.sleep(0.05)
    sys.exit(f"{what} does not come")


def state(port):
    """How things stand for Lapwing."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/state.json", timeout=5) as answer:
        return json.load(answer)


def is_over(case, now):
    """Whether a run has been watched for long enough: its fault has shown, or it will not."""
    passed, until = now["now"], CASES[case][3]
    corrected = [found for found in now["properties"] if not found["name"].startswith("as_written")]
    has_shown = case == "healthy" or all(found["violations"] > 0 for found in corrected)
    return passed >= until and (has_shown or passed >= until + GRACE)


def ended(process):
    """Its standard output, when it was told to end."""
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=LIMIT)[0]


def checked(spec, recording):
    """The report on a recording."""
    done = subprocess.run([LAPWING, "check", spec, recording, "--format", "json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    return json.loads(done.stdout)[0]["properties"]


def watched(graph, case, folder):
    """Runs a case. Gives the properties as they were told live, of Lapwing's recording, and of the simulator's."""
    scenario, spec, is_commanded, until = CASES[case]
    spec, port = HERE.parent / spec, free_port()
    seen, own = Path(folder) / "seen.mcap", Path(folder) / "own.mcap"
    with Processes({**os.environ, **graph.environment, "PYTHONUNBUFFERED": "1"}) as processes:
        graph.begin(processes)
        if is_commanded:
            daemon = processes.start(*graph.daemon, "none" if case == "healthy" else case, stdout=subprocess.PIPE)
            assert daemon.stdout.readline() == b"ready\n"
        more = ["--clock", "sim", "--record", seen, "--format", "json", "--quiet", "--serve", port]
        lapwing = processes.start(LAPWING, "monitor", spec, *graph.words, *more, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        wait("Lapwing", lambda: state(port)["now"] is not None)
        how = ["--outside"] if is_commanded else ["--fault", case]
        # Longer than it is watched: what ends first is the watching, not what is watched.
        run = [scenario, *graph.words, *how, "--duration", f"{until + 30}s", "-o", own, "--quiet"]
        simulator = processes.start(LAPWING, "sim", *run, stderr=subprocess.DEVNULL)
        wait("simulated time", lambda: is_over(case, state(port)))
        live = json.loads(ended(lapwing))[0]["properties"]
        ended(simulator)
    return live, checked(spec, seen), checked(spec, own)


def is_right(case, live, seen, own):
    """Whether the reports agree, and the fault was caught, or a healthy robot found healthy; prints what was found."""
    right = live == seen
    if not right:
        print(f"{case}: what was said live and what is said of the recording differ:\n  {live}\n  {seen}")
    for now, later in zip(live, own):
        wanted = "holds" if case == "healthy" else "violated"
        agrees = now["verdict"] == later["verdict"] and (now["name"].startswith("as_written") or now["verdict"] == wanted)
        cause = f" ({now['cause']})" if now["cause"] else ""
        print(f"{case}: {now['name']} {now['verdict']}{cause} live, {later['verdict']} in the simulator's recording{'' if agrees else ': WRONG'}", flush=True)
        right = right and agrees
    return right


def main(transport, cases):
    """Runs them one after the other."""
    graphs = {"ros1": Ros1, "ros2": Ros2}
    right = True
    for case in cases or CASES:
        with tempfile.TemporaryDirectory() as folder:
            right = is_right(case, *watched(graphs[transport](), case, folder)) and right
    return 0 if right else 1


if __name__ == "__main__":
    if sys.argv[1:2] == [] or sys.argv[1] not in ("ros1", "ros2") or set(sys.argv[2:]) - set(CASES):
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
