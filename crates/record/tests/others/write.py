"""Writes the same messages by other people's writers, reads them back by other people's readers, and lists what was written.

Run by .venv/bin/python with an empty folder; leaves expected.json there. ROS 1's own rosbag is run from here, by /usr/bin/python3.
"""

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from mcap_ros2.writer import Writer as Ros2McapWriter
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as Bag1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_typestore

OUT = Path(sys.argv[1])
START = 1_700_000_000_000_000_000
COUNT = 100

JAZZY = get_typestore(Stores.ROS2_JAZZY)
NOETIC = get_typestore(Stores.ROS1_NOETIC)
TYPES = {
    "/odom": "nav_msgs/msg/Odometry",
    "/cmd_vel": "geometry_msgs/msg/Twist",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/joints": "sensor_msgs/msg/JointState",
}


def samples():
    """Topic, log time and wanted values of every message, 50 of each topic a second."""
    for k in range(COUNT):
        t = START + k * 20_000_000
        stamp = t - 1_234_567
        header = {"header.stamp.sec": stamp // 10**9, "header.stamp.nanosec": stamp % 10**9}
        yield "/odom", t, header | {
            "header.frame_id": "odom" * (k % 4),
            "child_frame_id": "base_link",
            "pose.pose.position.x": math.sin(k / 10),
            "pose.pose.orientation.w": math.cos(k / 10),
            "pose.covariance[35]": k / 7,
            "twist.twist.angular.z": -k / 3,
        }
        yield "/cmd_vel", t + 1, {"linear.x": k / 11, "angular.z": -k / 13}
        ranges = [float(np.float32(0.1 * ((j * k) % 97))) for j in range(k % 50)]
        if len(ranges) > 2:
            ranges[1], ranges[2] = "inf", "nan"
        yield "/scan", t + 2, header | {"header.frame_id": "laser", "range_max": 3.5, "ranges": ranges}
        yield "/joints", t + 3, header | {"name": [f"joint{j}" for j in range(k % 5)], "velocity": [], "position": [j / 9 for j in range(k % 5)]}


def message(store, topic, values):
    """The message of those values, all else zero."""
    types = store.types
    seq = {"seq": 7} if store is NOETIC else {}
    v = lambda name, default=0.0: values.get(name, default)
    if topic == "/cmd_vel":
        vec = types["geometry_msgs/msg/Vector3"]
        return types[TYPES[topic]](linear=vec(v("linear.x"), 0.0, 0.0), angular=vec(0.0, 0.0, v("angular.z")))
    stamp = types["builtin_interfaces/msg/Time"](sec=v("header.stamp.sec"), nanosec=v("header.stamp.nanosec"))
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id=v("header.frame_id", ""), **seq)
    if topic == "/scan":
        ranges = np.array([float(x) for x in values["ranges"]], dtype=np.float32)
        return types[TYPES[topic]](header, -1.0, 1.0, 0.1, 0.0, 0.02, 0.1, values["range_max"], ranges, np.zeros(3, np.float32))
    if topic == "/joints":
        array = lambda name: np.array(values.get(name, []), dtype=np.float64)
        return types[TYPES[topic]](header, values["name"], array("position"), array("velocity"), array("effort"))
    vec, point, quat = (types[f"geometry_msgs/msg/{n}"] for n in ("Vector3", "Point", "Quaternion"))
    covariance = np.zeros(36)
    covariance[35] = values["pose.covariance[35]"]
    pose = types["geometry_msgs/msg/Pose"](point(values["pose.pose.position.x"], 2.0, 3.0), quat(0.0, 0.0, 0.0, values["pose.pose.orientation.w"]))
    twist = types["geometry_msgs/msg/Twist"](vec(1.0, 2.0, 3.0), vec(4.0, 5.0, values["twist.twist.angular.z"]))
    with_pose = types["geometry_msgs/msg/PoseWithCovariance"](pose, covariance)
    with_twist = types["geometry_msgs/msg/TwistWithCovariance"](twist, np.ones(36))
    return types[TYPES[topic]](header, values["child_frame_id"], with_pose, with_twist)


def rosbag2(name, part=None, **options):
    """A rosbag2 folder by `rosbags`."""
    writer = Bag2Writer(OUT / name, version=options.pop("version", 9), storage_plugin=options.pop("storage", StoragePlugin.SQLITE3))
    if mode := options.pop("mode", None):
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {topic: writer.add_connection(topic, ty, typestore=JAZZY) for topic, ty in TYPES.items()}
        for k, (topic, t, values) in enumerate(samples()):
            if part is None or part[0] <= k < part[1]:
                writer.write(connections[topic], t, JAZZY.serialize_cdr(message(JAZZY, topic, values), TYPES[topic]))
    return name


def split(name):
    """A rosbag2 folder of three files, as rosbag2 makes them when it splits."""
    folder = OUT / name
    folder.mkdir()
    third = COUNT * len(TYPES) // 3
    whole = rosbag2(f"{name}_whole")
    lines = (OUT / whole / "metadata.yaml").read_text().splitlines()
    shutil.rmtree(OUT / whole)
    for k, part in enumerate([(0, third), (third, 2 * third), (2 * third, 10**9)]):
        piece = rosbag2(f"{name}_part{k}", part)
        shutil.move(OUT / piece / f"{piece}.db3", folder / f"{name}_{k}.db3")
        shutil.rmtree(OUT / piece)
    at = next(k for k, line in enumerate(lines) if "relative_file_paths" in line)
    indent = lines[at + 1][: lines[at + 1].index("-")]
    lines[at + 1 : at + 2] = [f"{indent}- {name}_{k}.db3" for k in range(3)]
    (folder / "metadata.yaml").write_text("\n".join(lines) + "\n")
    return name


def without_definitions(name):
    """A bare .db3 as older recorders leave it: no table of definitions."""
    import sqlite3

    rosbag2(f"{name}_folder", version=8)
    shutil.move(OUT / f"{name}_folder" / f"{name}_folder.db3", OUT / f"{name}.db3")
    shutil.rmtree(OUT / f"{name}_folder")
    with sqlite3.connect(OUT / f"{name}.db3") as db:
        db.execute("DROP TABLE IF EXISTS message_definitions")
    return f"{name}.db3"


def mcap_ros2(name, compression):
    """An MCAP file by `mcap` and its own ROS 2 serialiser."""
    with open(OUT / name, "wb") as file:
        writer = Ros2McapWriter(file, chunk_size=20_000, compression=compression)
        schemas = {}
        for topic, t, values in samples():
            if topic not in schemas:
                text, _ = JAZZY.generate_msgdef(TYPES[topic], ros_version=2)
                schemas[topic] = writer.register_msgdef(TYPES[topic], text)
            writer.write_message(topic, schemas[topic], plain(message(JAZZY, topic, values)), t, t)
        writer.finish()
    return name


def plain(value):
    """A message as nested dictionaries."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list):
        return [plain(v) for v in value]
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__ if not name.startswith("__")}
    return value


def mcap_ros1(name):
    """An MCAP file of ROS 1 messages, without chunks and without a summary of channels."""
    with open(OUT / name, "wb") as file:
        writer = McapWriter(file, use_chunking=False, repeat_channels=False, repeat_schemas=False)
        writer.start("ros1", "test")
        channels = {}
        for topic, t, values in samples():
            if topic not in channels:
                text, _ = NOETIC.generate_msgdef(TYPES[topic], ros_version=1)
                schema = writer.register_schema(TYPES[topic].replace("/msg/", "/"), "ros1msg", text.encode())
                channels[topic] = writer.register_channel(topic, "ros1", schema)
            writer.add_message(channels[topic], t, NOETIC.serialize_ros1(message(NOETIC, topic, values), TYPES[topic]).tobytes(), t)
        writer.finish()
    return name


def json_schema(value):
    """The JSON schema of a value."""
    if isinstance(value, dict):
        return {"type": "object", "properties": {k: json_schema(v) for k, v in value.items()}}
    if isinstance(value, list):
        return {"type": "array"}
    return {"type": "string" if isinstance(value, str) else "number"}


def mcap_json(name):
    """An MCAP file of JSON messages."""
    with open(OUT / name, "wb") as file:
        writer = McapWriter(file, compression=CompressionType.LZ4)
        writer.start("", "test")
        channels = {}
        for topic, t, values in samples():
            if topic not in channels:
                schema = json.dumps(json_schema(plain(message(JAZZY, topic, values)))).encode()
                schema = writer.register_schema(TYPES[topic], "jsonschema", schema)
                channels[topic] = writer.register_channel(topic, "json", schema)
            data = json.dumps(plain(message(JAZZY, topic, values))).encode()
            writer.add_message(channels[topic], t, data, t)
        writer.finish()
    return name


def ndjson(name):
    """The same as lines."""
    with open(OUT / name, "w") as file:
        for topic, t, values in samples():
            line = {"t": None, "topic": topic, "type": TYPES[topic], "msg": plain(message(JAZZY, topic, values))}
            file.write(json.dumps(line).replace("null", f"{t // 10**9}.{t % 10**9:09}", 1) + "\n")
    return name


def protobuf(name):
    """An MCAP file of Protobuf messages, by Google's own library; returns what they hold."""
    file = descriptor_pb2.FileDescriptorProto(name="a.proto", package="demo", syntax="proto3")
    field = descriptor_pb2.FieldDescriptorProto
    inner = file.message_type.add(name="Inner")
    inner.field.add(name="y", number=1, type=field.TYPE_SINT32, label=1)
    outer = file.message_type.add(name="Outer")
    for number, (fname, ty, label) in enumerate(
        [("x", field.TYPE_DOUBLE, 1), ("flag", field.TYPE_BOOL, 1), ("text", field.TYPE_STRING, 1), ("nums", field.TYPE_FLOAT, 3),
         ("ints", field.TYPE_INT64, 3), ("big", field.TYPE_UINT64, 1), ("fixed", field.TYPE_SFIXED32, 1), ("raw", field.TYPE_BYTES, 1)], 1):
        outer.field.add(name=fname, number=number, type=ty, label=label)
    outer.field.add(name="inner", number=20, type=field.TYPE_MESSAGE, type_name=".demo.Inner", label=1)
    outer.field.add(name="many", number=21, type=field.TYPE_MESSAGE, type_name=".demo.Inner", label=3)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    cls = message_factory.GetMessageClass(pool.FindMessageTypeByName("demo.Outer"))
    expected = []
    with open(OUT / name, "wb") as out:
        writer = McapWriter(out)
        writer.start("", "test")
        schema = writer.register_schema("demo.Outer", "protobuf", descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString())
        channel = writer.register_channel("/p", "protobuf", schema)
        for k in range(COUNT):
            m = cls(x=k / 3, flag=k % 2 == 1, text="é" * (k % 3), big=k * 10**15, fixed=-k, raw=bytes(range(k % 4)))
            m.nums.extend(j / 2 for j in range(k % 5))
            m.ints.extend(-j for j in range(k % 4))
            many = [-k + j for j in range(k % 3)]
            for y in many:
                m.many.add(y=y)
            if k % 2:
                m.inner.y = -k
            t = START + k * 10**7
            writer.add_message(channel, t, m.SerializeToString(), t)
            expected.append({"topic": "/p", "t": t, "values": {
                "x": k / 3, "flag": k % 2 == 1, "text": "é" * (k % 3), "big": k * 10**15, "fixed": -k, "raw": list(range(k % 4)),
                "nums": [j / 2 for j in range(k % 5)], "ints": [-j for j in range(k % 4)],
                "inner.y": -k if k % 2 else None, "many[1].y": many[1] if len(many) > 1 else None}})
        writer.finish()
    return expected


def bag1(name, compression=None):
    """A ROS 1 bag by `rosbags`."""
    writer = Bag1Writer(OUT / name)
    if compression:
        writer.set_compression(compression)
    with writer:
        connections = {topic: writer.add_connection(topic, ty, typestore=NOETIC) for topic, ty in TYPES.items()}
        for topic, t, values in samples():
            writer.write(connections[topic], t, NOETIC.serialize_ros1(message(NOETIC, topic, values), TYPES[topic]))
    return name


def read_back(name, store):
    """That another reader finds in a recording what was meant to be written."""
    found = []
    with AnyReader([OUT / name], default_typestore=store) as reader:
        for connection, t, data in reader.messages():
            found.append((connection.topic, t, reader.deserialize(data, connection.msgtype)))
    wanted = list(samples())
    assert len(found) == len(wanted), name
    for (topic, t, m), (wanted_topic, wanted_t, values) in zip(found, wanted):
        assert (topic, t) == (wanted_topic, wanted_t), name
        for path, value in values.items():
            at = m
            for part in path.replace("[35]", ".[35]").split("."):
                at = at[35] if part == "[35]" else getattr(at, part)
            same = np.array_equal(np.asarray(at, np.float64), np.array([float(v) for v in value]), equal_nan=True) if isinstance(value, list) and path != "name" else at == value
            assert same, (name, path, at, value)


def main():
    bz2, lz4 = Bag1Writer.CompressionFormat.BZ2, Bag1Writer.CompressionFormat.LZ4
    ros2 = [
        rosbag2("sqlite3"), rosbag2("sqlite3_v8", version=8), rosbag2("sqlite3_file", mode=CompressionMode.FILE),
        rosbag2("sqlite3_message", mode=CompressionMode.MESSAGE), rosbag2("mcap", storage=StoragePlugin.MCAP),
        rosbag2("mcap_file", storage=StoragePlugin.MCAP, mode=CompressionMode.FILE),
        rosbag2("mcap_message", storage=StoragePlugin.MCAP, mode=CompressionMode.MESSAGE),
        rosbag2("mcap_storage", storage=StoragePlugin.MCAP, mode=CompressionMode.STORAGE), split("split"),
    ]
    ros1 = [bag1("none.bag"), bag1("bz2.bag", bz2), bag1("lz4.bag", lz4)]
    expected = [{"topic": topic, "t": t, "values": values} for topic, t, values in samples()]
    (OUT / "messages.json").write_text(json.dumps(expected))
    subprocess.run(["/usr/bin/python3", Path(__file__).with_name("write_ros1.py"), OUT], check=True)
    ros1 += ["rosbag_none.bag", "rosbag_bz2.bag", "rosbag_lz4.bag"]
    for name in ros2:
        if name != "split":  # rosbags reads split bags only where the metadata counts each file
            read_back(name, JAZZY)
    for name in ros1:
        read_back(name, NOETIC)
    others = [
        mcap_ros2("none.mcap", CompressionType.NONE), mcap_ros2("lz4.mcap", CompressionType.LZ4), mcap_ros2("zstd.mcap", CompressionType.ZSTD),
        mcap_ros1("ros1.mcap"), mcap_json("json.mcap"), ndjson("lines.ndjson"), without_definitions("bare"),
    ]
    recordings = [{"name": name, "messages": expected} for name in ros2 + ros1 + others]
    recordings.append({"name": "protobuf.mcap", "messages": protobuf("protobuf.mcap")})
    (OUT / "expected.json").write_text(json.dumps(recordings))


main()
