"""Nodes of ROS 1 for the tests, by rospy. Run by /usr/bin/python3 with the name of what to do; a test ends them.

A node that is ready says so in a line on its standard output; what it hears it prints as lines of JSON.
"""

import importlib
import json
import socket
import struct
import sys
import threading
import time
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

import genpy.dynamic
import rospy
from geometry_msgs.msg import Pose, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from std_srvs.srv import SetBool, SetBoolResponse

MODEL_STATES = """string[] name
geometry_msgs/Pose[] pose
geometry_msgs/Twist[] twist
{ruler}
MSG: geometry_msgs/Pose
Point position
Quaternion orientation
{ruler}
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
{ruler}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
{ruler}
MSG: geometry_msgs/Twist
Vector3 linear
Vector3 angular
{ruler}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
""".format(ruler="=" * 80)


def ready():
    """The test waits for this line."""
    print("ready", flush=True)


def begin(node):
    """rospy wants a name without a namespace."""
    rospy.init_node(node.strip("/"), disable_signals=True)


def talk(node, topic, rate):
    """Odometry whose position counts up."""
    begin(node)
    publisher = rospy.Publisher(topic, Odometry, queue_size=None)
    ready()
    message, count, pause = Odometry(), 0, 1 / float(rate)
    while True:
        message.pose.pose.position.x = count
        publisher.publish(message)
        count += 1
        time.sleep(pause)


def skip(node, topic):
    """Numbers that a publisher with too short a queue leaves out: three of every twenty."""
    begin(node)
    publisher = rospy.Publisher(topic, Odometry, queue_size=None)
    ready()
    message, count = Odometry(), 0
    while True:
        publisher.publish(message)
        count += 1
        if count % 20 == 0:
            publisher.impl.seq += 3
        time.sleep(0.01)


def leave(node, topic, seconds):
    """Publishes for a while, from when somebody listens, and then leaves as it should."""
    begin(node)
    publisher = rospy.Publisher(topic, String, queue_size=10)
    ready()
    while publisher.get_num_connections() == 0:
        time.sleep(0.05)
    end = time.time() + float(seconds)
    while time.time() < end:
        publisher.publish("here")
        time.sleep(0.05)
    rospy.signal_shutdown("done")


def latch(node, topic, text):
    """One message, before anybody listens."""
    begin(node)
    publisher = rospy.Publisher(topic, String, queue_size=1, latch=True)
    publisher.publish(text)
    ready()
    rospy.sleep(3600)


def models(node, topic):
    """A type that is made at run time, as no package of this system has it."""
    states = genpy.dynamic.generate_dynamic("gazebo_msgs/ModelStates", MODEL_STATES)["gazebo_msgs/ModelStates"]
    begin(node)
    publisher = rospy.Publisher(topic, states, queue_size=10)
    ready()
    while True:
        pose = Pose()
        pose.position.x = 1.5
        publisher.publish(states(name=["ground_plane", "robot"], pose=[Pose(), pose], twist=[Twist(), Twist()]))
        time.sleep(0.05)


def serve(node, service):
    """A service that says what it was asked, and fails where it is asked a second time."""
    begin(node)
    asked = []

    def answer(request):
        asked.append(request.data)
        if len(asked) > 1:
            raise rospy.ServiceException("once is enough")
        return SetBoolResponse(success=request.data, message="asked for %s" % request.data)

    rospy.Service(service, SetBool, answer)
    ready()
    rospy.sleep(3600)


def hear(node, topic):
    """Prints what it hears."""
    begin(node)

    def heard(message):
        print(json.dumps({"x": message.linear.x, "z": message.angular.z}), flush=True)

    rospy.Subscriber(topic, Twist, heard, queue_size=100)
    ready()
    rospy.sleep(3600)


def simulated(node):
    """Sets the parameter that Gazebo sets."""
    begin(node)
    rospy.set_param("/use_sim_time", True)
    ready()


def lie(node, topic, master):
    """A publisher that speaks TCPROS wrongly, each time in another way, and at last rightly."""
    listener = socket.create_server(("127.0.0.1", 0))
    api = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    port = listener.getsockname()[1]
    api.register_function(lambda caller, topic, protocols: [1, "", ["TCPROS", "127.0.0.1", port]], "requestTopic")
    api.register_function(lambda caller: [1, "", 1], "getPid")
    threading.Thread(target=api.serve_forever, daemon=True).start()
    fields = {"callerid": node, "topic": topic, "type": "std_msgs/String", "message_definition": "string data\n"}
    right = fields | {"md5sum": String._md5sum}
    wrong = fields | {"md5sum": "0" * 32}

    def header(of):
        parts = [("%s=%s" % pair).encode() for pair in of.items()]
        whole = b"".join(struct.pack("<I", len(part)) + part for part in parts)
        return struct.pack("<I", len(whole)) + whole

    text = b"true at last"
    message = struct.pack("<II", len(text) + 4, len(text)) + text
    says = [struct.pack("<I", 0xFFFFFFFF), b"\x05\0\0\0\xff\xff\0\0x", header(wrong), header(right) + b"\xff" * 64, header(right) + message]
    uri = "http://127.0.0.1:%d/" % api.server_address[1]
    ServerProxy(master).registerPublisher(node, topic, "std_msgs/String", uri)
    ready()
    kept = []
    while True:
        connection, _ = listener.accept()
        connection.recv(4096)
        connection.sendall(says.pop(0) if len(says) > 1 else says[0])
        if len(says) > 1:
            connection.close()
        else:
            kept.append(connection)


def sums():
    """The checksum of every message and service of the packages that are installed here."""
    for package in ("actionlib_msgs", "diagnostic_msgs", "geometry_msgs", "nav_msgs", "rosgraph_msgs", "sensor_msgs", "std_msgs", "tf2_msgs", "trajectory_msgs"):
        module = importlib.import_module(package + ".msg")
        for name in sorted(dir(module)):
            kind = getattr(module, name)
            if getattr(kind, "_type", "").startswith(package + "/"):
                print(json.dumps({"type": kind._type, "sum": kind._md5sum}))


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
