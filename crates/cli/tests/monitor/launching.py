"""Runs a launch file, or a test of launch_testing, with as much of ROS 2's `launch` as examples/live uses.

    launching.py launch FILE [NAME:=VALUE...]    until its input ends; then it is interrupted, as by Ctrl-C
    launching.py test FILE                       as `launch_test FILE` does

Neither PyPI nor Debian has these packages, so that the tests bring their own: what is here does what the packages do with the same words (their sources
of Jazzy were read for it). Where the real ones are installed they are taken, and this only starts them.
"""

import importlib.util
import inspect
import os
import signal
import subprocess
import sys
import threading
import types
import unittest

LIMIT = 120


class LaunchConfiguration:
    def __init__(self, name):
        self.name = name


class DeclareLaunchArgument:
    def __init__(self, name, default_value=None):
        self.name, self.default = name, default_value

    def visit(self, service):
        service.arguments.setdefault(self.name, self.default)


class RegisterEventHandler:
    def __init__(self, handler):
        self.handler = handler

    def visit(self, service):
        service.handlers.append(self.handler)


class ReadyToTest:
    def visit(self, service):
        service.ready.set()


class OnProcessIO:
    def __init__(self, *, target_action=None, on_stdout=None, on_stderr=None):
        self.target, self.on = target_action, {"stdout": on_stdout, "stderr": on_stderr}


class SignalProcess:
    def __init__(self, *, signal_number, process_matcher):
        self.signal, self.matches = signal_number, process_matcher


class LaunchDescription:
    def __init__(self, entities):
        self.entities = entities


class ExecuteProcess:
    def __init__(self, *, cmd, output="log", name=None, sigterm_timeout="5"):
        self.cmd, self.output, self.name, self.patience = cmd, output, name, float(sigterm_timeout)

    def visit(self, service):
        words = [service.arguments[w.name] if isinstance(w, LaunchConfiguration) else w for w in self.cmd]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        service.processes.append(self)
        streams = [("stdout", self.process.stdout), ("stderr", self.process.stderr)]
        self.readers = [threading.Thread(target=self.read, args=(service, *stream)) for stream in streams]
        for reader in self.readers:
            reader.start()

    def read(self, service, stream, pipe):
        for line in pipe:
            if self.output == "screen":
                print(line.decode().rstrip("\n"), flush=True)
            service.told(self, types.SimpleNamespace(text=line, from_stdout=stream == "stdout"), stream)

    def ended(self, patience):
        """Its exit code."""
        code = self.process.wait(patience)
        for reader in self.readers:
            reader.join()
        return code


class LaunchService:
    """Starts what a description has, and keeps what it says."""

    def __init__(self, arguments):
        self.arguments, self.handlers, self.processes, self.outputs = arguments, [], [], {}
        self.ready = threading.Event()

    def visit(self, description):
        for entity in description.entities:
            entity.visit(self)

    def told(self, action, output, stream):
        self.outputs.setdefault(action, []).append(output)
        for handler in self.handlers:
            if handler.target in (None, action) and handler.on[stream]:
                handler.on[stream](output)

    def emit_event(self, event):
        for action in filter(event.matches, self.processes):
            action.process.send_signal(event.signal)

    def shutdown(self):
        for action in self.processes:
            action.process.send_signal(signal.SIGINT)
        for action in self.processes:
            try:
                action.ended(action.patience)
            except subprocess.TimeoutExpired:
                action.process.terminate()
                action.ended(LIMIT)


class ProcInfo:
    def assertWaitForShutdown(self, *, process, timeout=10):
        process.ended(timeout)

    def __getitem__(self, process):
        return types.SimpleNamespace(returncode=process.process.returncode)


def post_shutdown_test():
    def mark(case):
        case.is_after = True
        return case

    return mark


def module(name, **names):
    made = types.ModuleType(name)
    vars(made).update(names)
    sys.modules[name] = made


def provide():
    """The packages under their names, where they are not installed."""
    if importlib.util.find_spec("launch"):
        return False
    module("launch", LaunchDescription=LaunchDescription)
    actions = dict(DeclareLaunchArgument=DeclareLaunchArgument, ExecuteProcess=ExecuteProcess, RegisterEventHandler=RegisterEventHandler)
    module("launch.actions", **actions)
    module("launch.event_handlers", OnProcessIO=OnProcessIO)
    module("launch.events", matches_action=lambda target: lambda action: action is target)
    module("launch.events.process", SignalProcess=SignalProcess)
    module("launch.substitutions", LaunchConfiguration=LaunchConfiguration)
    module("launch_testing.actions", ReadyToTest=ReadyToTest)
    module("launch_testing", post_shutdown_test=post_shutdown_test, actions=sys.modules["launch_testing.actions"])
    return True


def loaded(path):
    spec = importlib.util.spec_from_file_location("launched", path)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def tested(path):
    """Whether all tests of a file pass: those beside the processes, then those that come after."""
    file = loaded(path)
    description, context = file.generate_test_description()
    service = LaunchService({})
    service.visit(description)
    assert service.ready.is_set(), "nothing is ready to test"
    given = {**context, "launch_service": service, "proc_info": ProcInfo(), "proc_output": service.outputs}
    cases = [case for case in vars(file).values() if inspect.isclass(case) and issubclass(case, unittest.TestCase)]

    def run(is_after):
        suite = unittest.TestSuite()
        for case in (case for case in cases if getattr(case, "is_after", False) == is_after):
            for name in unittest.defaultTestLoader.getTestCaseNames(case):
                test = case(name)
                method = getattr(test, name)
                wanted = {key: given[key] for key in inspect.signature(method).parameters}
                setattr(test, name, lambda method=method, wanted=wanted: method(**wanted))
                suite.addTest(test)
        return unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful()

    try:
        beside = run(is_after=False)
    finally:
        service.shutdown()
    return run(is_after=True) and beside


def main(what, path, *words):
    if not provide():
        command = ["launch_test", path] if what == "test" else ["ros2", "launch", path, *words]
        os.execvp(command[0], command)
    if what == "test":
        sys.exit(not tested(path))
    service = LaunchService(dict(word.split(":=", 1) for word in words))
    service.visit(loaded(path).generate_launch_description())
    sys.stdin.read()
    service.shutdown()


main(*sys.argv[1:])
