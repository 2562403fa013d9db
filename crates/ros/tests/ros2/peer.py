"""A ROS 2 node for the tests, made with rclpy: whatever the tests ask for on the command line.

Each command prints `ready` once it is set up and what it hears, a line each, and ends when its standard input does: so no peer outlives its test.
"""

import argparse
import importlib
import os
import sys
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy


def message(name):
    package, _, kind = name.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), kind)


def profile(args):
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=args.depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if args.best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if args.latched else DurabilityPolicy.VOLATILE,
    )


def filled(kind, number):
    """A message in which the number can be recognised, whatever the type."""
    it = message(kind)()
    if kind == "nav_msgs/Odometry":
        it.header.frame_id = "odom"
        it.pose.pose.position.x = number / 4
        it.twist.covariance[35] = float(number)
    elif kind == "geometry_msgs/Twist":
        it.linear.x = number / 4
    elif kind == "shape_msgs/SolidPrimitive":
        it.type = it.CYLINDER
        it.dimensions = [float(number), 0.5]
    elif kind == "sensor_msgs/PointCloud2":
        it.header.frame_id = "lidar"
        it.header.stamp.sec = number
    else:
        it.data = str(number) if kind == "std_msgs/String" else float(number)
    return it


def say(*words):
    print(*words, flush=True)


def spin(node):
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


def publish(node, args):
    publisher = node.create_publisher(message(args.type), args.topic, profile(args))
    it = filled(args.type, 0)
    if args.bytes:
        it.data = bytes(args.bytes)
    say("ready")
    while args.wait_for and publisher.get_subscription_count() < args.wait_for:
        time.sleep(0.02)
    start, number = time.monotonic(), 0
    while rclpy.ok() and (args.count == 0 or number < args.count):
        number += 1
        if args.bytes:
            it.header.stamp.sec = number
        else:
            it = filled(args.type, number)
        publisher.publish(it)
        pause = start + number / args.rate - time.monotonic()
        if pause > 0:
            time.sleep(pause)
    say("published", number, round(time.monotonic() - start, 3))
    while rclpy.ok():
        time.sleep(0.1)


def listen(node, args):
    def heard(it):
        if args.type == "geometry_msgs/Twist":
            say("heard", it.linear.x, it.angular.z)
        elif args.type == "std_msgs/String":
            say("heard", it.data)
        else:
            say("heard", it)

    node.create_subscription(message(args.type), args.topic, heard, profile(args))
    say("ready")
    spin(node)


def serve(node, args):
    from std_srvs.srv import SetBool

    def answer(request, response):
        say("asked", request.data)
        response.success = not request.data
        response.message = f"it was {request.data}"
        return response

    service = node.create_service(SetBool, args.topic, answer)
    if args.introspect:
        from rclpy.service_introspection import ServiceIntrospectionState

        service.configure_introspection(node.get_clock(), profile(args), ServiceIntrospectionState.CONTENTS)
    say("ready")
    spin(node)


def nodes(node, args):
    say("ready")
    while rclpy.ok():
        say("nodes", *sorted(namespace.rstrip("/") + "/" + name for name, namespace in node.get_node_names_and_namespaces()))
        time.sleep(0.1)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("do", choices=["publish", "listen", "serve", "nodes"])
    parser.add_argument("topic", nargs="?", default="/topic")
    parser.add_argument("type", nargs="?", default="std_msgs/String")
    parser.add_argument("--node", default="peer")
    parser.add_argument("--namespace", default="/")
    parser.add_argument("--best-effort", action="store_true")
    parser.add_argument("--latched", action="store_true")
    parser.add_argument("--depth", type=int, default=10)
    parser.add_argument("--rate", type=float, default=50.0)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--bytes", type=int, default=0)
    parser.add_argument("--wait-for", type=int, default=0)
    parser.add_argument("--mute", action="store_true", help="do not describe types")
    parser.add_argument("--introspect", action="store_true")
    args = parser.parse_args()

    # Whoever started this holds the other end: when it is gone, so is this, whatever it is doing.
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    rclpy.init()
    described = Parameter("start_type_description_service", Parameter.Type.BOOL, not args.mute)
    node = Node(args.node, namespace=args.namespace, parameter_overrides=[described])
    if args.do == "publish":
        # The node answers what is asked of it while it publishes.
        threading.Thread(target=spin, args=(node,), daemon=True).start()
    {"publish": publish, "listen": listen, "serve": serve, "nodes": nodes}[args.do](node, args)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
