"""Reads a recording by rosbags, by the definitions that it carries, and prints what it found.

Arguments: the recording, and a JSON object of topics with the fields that are wanted. Prints an array of [time, topic, values].
"""

import json
import re
import sys
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader


def follow(message, path):
    for part in re.findall(r"\w+", path):
        message = message[int(part)] if part.isdigit() else getattr(message, part)
    return message


def plain(value):
    if isinstance(value, np.ndarray):
        return [plain(v) for v in value.tolist()]
    if isinstance(value, list):
        return [plain(v) for v in value]
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return value


wanted = json.loads(sys.argv[2])
found = []
with AnyReader([Path(sys.argv[1])]) as reader:
    for connection, time, raw in reader.messages():
        message = reader.deserialize(raw, connection.msgtype)
        values = [plain(follow(message, path)) for path in wanted[connection.topic]]
        found.append([time, connection.topic, values])
json.dump(found, sys.stdout)
