"""Makes messages by chance and encodes them by rosbags, as ROS 1 and as ROS 2 do: a line of JSON for each, with its values and its bytes.

Run by .venv/bin/python.
"""

import json
import random
from itertools import count

import numpy as np
from rosbags.typesys import Stores, get_typestore

PACKAGES = ("std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "diagnostic_msgs", "trajectory_msgs", "tf2_msgs", "std_srvs")
INTEGERS = {f"{sign}int{bits}": (bits, not sign) for sign in ("", "u") for bits in (8, 16, 32, 64)}
CHANCE = random.Random(4)


def base(name):
    """A value of a plain type."""
    if name == "bool":
        return CHANCE.random() < 0.5
    if name in ("string", "wstring"):
        return "".join(CHANCE.choice("abc é√") for _ in range(CHANCE.randrange(6)))
    if name in ("float32", "float64"):
        return float(np.float32(CHANCE.uniform(-1e6, 1e6)))
    if name in ("octet", "byte", "char"):
        return CHANCE.randrange(128)
    bits, is_signed = INTEGERS[name]
    bits = min(bits, 53)
    return CHANCE.randrange(-(1 << (bits - 1)), 1 << (bits - 1)) if is_signed else CHANCE.randrange(1 << bits)


def make(store, description):
    """A value by the description of its type: for JSON, and for rosbags."""
    kind, detail = description
    kind = int(kind)
    if kind == 1:  # BASE
        value = base(detail[0])
        return value, value
    if kind == 2:  # NAME
        return message(store, detail)
    inner, length = detail
    number = length if kind == 3 and length else CHANCE.randrange(4)
    pairs = [make(store, inner) for _ in range(number)]
    plain, values = [p for p, _ in pairs], [v for _, v in pairs]
    if int(inner[0]) == 1 and inner[1][0] not in ("string", "wstring"):
        name = {"bool": "bool", "byte": "uint8", "char": "uint8", "octet": "uint8"}.get(inner[1][0], inner[1][0])
        values = np.array(values, dtype=name)
    return plain, values


def message(store, name):
    plain, values = {}, {}
    if name in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"):
        plain = {"sec": CHANCE.randrange(1 << 31), "nanosec": CHANCE.randrange(10**9)}
        return plain, store.types[name](**plain)
    for field, description in store.fielddefs[name][1]:
        if field == "structure_needs_at_least_one_member":
            # What ROS 2 puts into a message without fields; no definition has it.
            values[field] = 0
            continue
        plain[field], values[field] = make(store, description)
    return plain, store.types[name](**values)


def main():
    """ROS 1 and ROS 2, every type of the packages, three messages each."""
    for ros, which in (("ros1", Stores.ROS1_NOETIC), ("cdr", Stores.ROS2_JAZZY)):
        store = get_typestore(which)
        for name in sorted(n for n in store.types if n.split("/")[0] in PACKAGES):
            definition, _ = store.generate_msgdef(name, ros_version=1 if ros == "ros1" else 2)
            if "wstring" in definition:
                continue
            for _ in range(3):
                plain, value = message(store, name)
                data = store.serialize_ros1(value, name) if ros == "ros1" else store.serialize_cdr(value, name, little_endian=True)
                line = {"type": name, "encoding": ros, "definition": definition, "message": plain, "bytes": bytes(data).hex()}
                print(json.dumps(line))


main()
