#!/usr/bin/python3
"""What `lapwing monitor` takes on a robot that runs, measured on real nodes.

    measure.py [ros1|ros2] [load|cloud|beside|rates|soak]...

load      60,000 small messages a second by rospy, 20,000 by rclpy: what came, what was lost, from arrival to verdict
cloud     a point cloud of 10 MB ten times a second, of which the header alone is read (rclpy)
beside    a robot of the simulator, watched by Lapwing and by a script that checks the same at 30 Hz, in one run: processor and memory as ratios
rates     what a publisher and its other subscriber notice of being watched: rates with and without, in alternation
soak      memory over an hour of the simulator's patrol, twenty times as fast as real time (SOAK: so many simulated seconds), and the verdicts

Run by /usr/bin/python3; `LAPWING` names the program, target/release/lapwing by default. The nodes by rclpy run in .venv-jazzy. Nothing is asserted
but that Lapwing sees everything or says what it lost, and that the hour's verdicts are right and its memory stays: how long a thing takes is a
matter of the machine and of what else it does.
"""

import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "examples/turtlebot/live"))

from catch import LIMIT, Processes, Ros1, Ros2, free_port, wait  # noqa: E402  (the example's way to start nodes)

LAPWING = os.environ.get("LAPWING", str(ROOT / "target/release/lapwing"))
JAZZY = ROOT / ".venv-jazzy/bin/python"
SECONDS = 10
# What memory may grow by over the last two thirds of the hour, in megabytes: what is kept of the past fills up to its limits in that time.
GROWTH = 30
TICKS = os.sysconf("SC_CLK_TCK")
PAGE = os.sysconf("SC_PAGE_SIZE")


class Usage:
    """What a process has taken since this was made."""

    def __init__(self, process):
        self.process, self.begin = process, time.monotonic()
        self.start = self.processor()

    def fields(self):
        return Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(") ", 1)[1].split()

    def processor(self):
        fields = self.fields()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def share(self):
        """Of one core."""
        return (self.processor() - self.start) / (time.monotonic() - self.begin)

    def memory(self):
        """Megabytes that are resident."""
        return int(self.fields()[21]) * PAGE / 1e6


class Monitor:
    """A run of Lapwing that shows its figures."""

    def __init__(self, graph, processes, spec, *more):
        self.port = free_port()
        command = [LAPWING, "monitor", spec, *graph.words, "--serve", self.port, "--format", "json", "--quiet", "--node", "watching", *more]
        self.process = processes.start(*command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        wait("Lapwing", lambda: self.get("state.json"))

    def get(self, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/{path}", timeout=5) as answer:
            return answer.read().decode()

    def state(self):
        return json.loads(self.get("state.json"))

    def sees(self, topic):
        return any(t["name"] == topic and t["publishers"] > 0 for t in self.state()["topics"])

    def report(self):
        """The properties, when it was told to end."""
        self.process.send_signal(signal.SIGINT)
        return json.loads(self.process.communicate(timeout=LIMIT)[0])[0]["properties"]

    def quiet(self):
        """Waits until no more messages come; gives the figures."""
        seen = -1
        while True:
            state = self.state()
            if state["messages"] == seen:
                return state
            seen = state["messages"]
            time.sleep(1.5)


def environment(graph):
    more = {"PYTHONUNBUFFERED": "1", "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"}
    if isinstance(graph, Ros2):
        more["ROS_DOMAIN_ID"] = graph.words[-1]
    return {**os.environ, **graph.environment, **more}


def spec_of(folder, text):
    path = Path(folder) / "spec.rv"
    path.write_text(text)
    return path


def publisher(graph, processes, what, rate, seconds, subscribers=1):
    """Publishes so many messages a second, once somebody listens."""
    if isinstance(graph, Ros1):
        return processes.start("/usr/bin/python3", ROOT / "crates/ros/examples/ros1_flood.py", rate, seconds, stdout=subprocess.PIPE)
    more = {"small": ["geometry_msgs/Twist", "--depth", 1000], "cloud": ["sensor_msgs/PointCloud2", "--bytes", 10_000_000, "--depth", 5]}[what]
    command = [JAZZY, ROOT / "crates/ros/tests/ros2/peer.py", "publish", "/flood", *more, "--rate", rate, "--count", int(rate * seconds), "--wait-for", subscribers]
    return processes.start(*command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)


def published(process):
    """How many, and how many a second."""
    for line in process.stdout:
        words = line.decode().replace(",", "").split()
        if words[0] == "published":
            number = int(words[1])
            return number, float(words[2]) if "second" in words else number / float(words[2])
    sys.exit("the publisher ended without a word")


def load(graph, what, rate, seconds=SECONDS):
    field = {"small": "Twist.linear.x", "cloud": "PointCloud2.header.stamp.sec"}[what] if isinstance(graph, Ros2) else "UInt32.data"
    with tempfile.TemporaryDirectory() as folder, Processes(environment(graph)) as processes:
        graph.begin(processes)
        monitor = Monitor(graph, processes, spec_of(folder, f"decl value /flood {field}\nsane: never value < 0\n"), "--clock", "wall", "--no-diagnostics")
        # One publisher by rclpy does not come to 20,000 a second on its own.
        parts = 2 if isinstance(graph, Ros2) and what == "small" else 1
        peers = [publisher(graph, processes, what, rate // parts, seconds) for _ in range(parts)]
        wait("the publisher", lambda: monitor.sees("/flood"))
        usage = Usage(monitor.process)
        count, achieved = map(sum, zip(*map(published, peers)))
        share, memory, state = usage.share(), usage.memory(), monitor.quiet()
        latency = state["latency_ms"]
        print(f"{name(graph)}, {what}: {count} published ({achieved:.0f} a second), {state['messages']} came, {state['lost']} said to be lost, "
              f"{count - state['messages'] - state['lost']} unaccounted; arrival to verdict p50 {latency['p50']:.3f} ms, p99 {latency['p99']:.3f} ms; "
              f"{100 * share:.0f} % of a core, {memory:.0f} MB", flush=True)


def beside(graph):
    with Processes(environment(graph)) as processes:
        graph.begin(processes)
        processes.start(LAPWING, "sim", "patrol", *graph.words, "--duration", "300s", "--quiet", stderr=subprocess.DEVNULL)
        python = "/usr/bin/python3" if isinstance(graph, Ros1) else JAZZY
        script = processes.start(python, HERE / f"checks_{name(graph)}.py", stdout=subprocess.PIPE)
        assert script.stdout.readline() == b"ready\n"
        monitor = Monitor(graph, processes, HERE / "robot.rv", "--clock", "wall")
        wait("the robot", lambda: monitor.sees("/scan") and monitor.state()["messages"] > 100)
        ours, theirs, before = Usage(monitor.process), Usage(script), monitor.state()["messages"]
        time.sleep(2 * SECONDS)
        rate = (monitor.state()["messages"] - before) / (2 * SECONDS)
        print(f"{name(graph)}, beside a script at 30 Hz, {rate:.0f} messages a second: Lapwing {100 * ours.share():.1f} % of a core and {ours.memory():.0f} MB, "
              f"the script {100 * theirs.share():.1f} % and {theirs.memory():.0f} MB; the script takes {theirs.share() / ours.share():.1f} times the processor "
              f"and {theirs.memory() / ours.memory():.1f} times the memory", flush=True)


def rates(graph):
    """A publisher at 2,000 a second with one subscriber of its own kind, watched and unwatched in turn."""
    found = {False: [], True: []}
    for turn in range(6):
        is_watched = turn % 2 == 1
        with tempfile.TemporaryDirectory() as folder, Processes(environment(graph)) as processes:
            graph.begin(processes)
            python = "/usr/bin/python3" if isinstance(graph, Ros1) else JAZZY
            listener = processes.start(python, HERE / "listen.py", name(graph), stdout=subprocess.PIPE)
            assert listener.stdout.readline() == b"ready\n"
            if is_watched:
                field = "UInt32.data" if isinstance(graph, Ros1) else "Twist.linear.x"
                monitor = Monitor(graph, processes, spec_of(folder, f"decl value /flood {field}\nsane: never value < 0\n"), "--clock", "wall")
            peer = publisher(graph, processes, "small", 2000, 5, 1 + is_watched)
            count, achieved = published(peer)
            heard = int(re.search(rb"heard (\d+)", listener.communicate(timeout=LIMIT)[0]).group(1))
            seen = monitor.quiet()["messages"] if is_watched else None
            found[is_watched].append((achieved, heard / count, seen))
    for is_watched, all_ in found.items():
        achieved, heard = (statistics.median(one[k] for one in all_) for k in (0, 1))
        print(f"{name(graph)}, {'watched' if is_watched else 'alone'}: {achieved:.1f} a second published, {100 * heard:.2f} % heard by the other subscriber", flush=True)


def soak(graph):
    """An hour in three minutes: the simulator twenty times as fast as real time, everything by its clock, and a scanner that is silent for a minute."""
    seconds = int(os.environ.get("SOAK", "3600"))
    # At this speed a moment in which the machine does something else is seconds long.
    text = (HERE / "robot.rv").read_text().replace("< 1 s", "< 20 s").replace("held for 1 s", "held for 10 s")
    silent = seconds * 2 // 3
    with tempfile.TemporaryDirectory() as folder, Processes(environment(graph)) as processes:
        graph.begin(processes)
        monitor = Monitor(graph, processes, spec_of(folder, text), "--clock", "sim")
        more = ["--duration", f"{seconds + 600}s", "--speed", 20, "--fault", f"silent-scan@{silent}..{silent + 60}", "--quiet"]
        processes.start(LAPWING, "sim", "patrol", *graph.words, *more, stderr=subprocess.DEVNULL)
        usage, seen = Usage(monitor.process), []
        for part in range(1, 7):
            wait("simulated time", lambda: monitor.state()["now"] >= part * seconds / 6)
            seen.append(usage.memory())
        state = monitor.state()
        failed = lambda p: "".join(f" at {v['failed_ns'] / 1e9:.2f} s" for v in p["violations"])
        properties = monitor.report()
        verdicts = ", ".join(f"{p['name']} {p['verdict']}{failed(p)}" for p in properties)
        print(f"{name(graph)}, {seconds} simulated seconds, {state['messages']} messages, {state['lost']} lost: memory after each sixth "
              f"{', '.join(f'{mb:.1f}' for mb in seen)} MB; {verdicts}", flush=True)
        violated = {p["name"]: [v["failed_ns"] / 1e9 for v in p["violations"]] for p in properties if p["verdict"] == "violated"}
        is_right = list(violated) == ["fresh"] and all(silent <= at <= silent + 60 for at in violated["fresh"])
        if not is_right or seen[-1] - seen[1] > GROWTH:
            sys.exit("the verdicts are not those of the fault, or memory grows")


def name(graph):
    return type(graph).__name__.lower()


def main(words):
    which = [w for w in words if w in ("ros1", "ros2")] or ["ros1", "ros2"]
    what = [w for w in words if w not in ("ros1", "ros2")] or ["load", "cloud", "beside", "rates"]
    os.environ.setdefault("ROS_DOMAIN_ID", "198")
    for make in [{"ros1": Ros1, "ros2": Ros2}[w] for w in which]:
        for do in what:
            graph = make()
            if do == "load":
                load(graph, "small", 60_000 if make is Ros1 else 20_000)
            elif do == "cloud":
                if make is Ros2:
                    load(graph, "cloud", 10, 2 * SECONDS)
            else:
                {"beside": beside, "rates": rates, "soak": soak}[do](graph)


if __name__ == "__main__":
    if set(sys.argv[1:]) - {"ros1", "ros2", "load", "cloud", "beside", "rates", "soak"}:
        sys.exit(__doc__)
    main(sys.argv[1:])
