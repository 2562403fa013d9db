"""A robot for the tests of `lapwing monitor`: it does what standard input tells it, a line each, and prints what it hears.

    robot.py ros1|ros2

    offer TOPIC          publishes numbers (std_msgs/Float64) there from now on
    say TOPIC NUMBER     publishes one
    tell TOPIC TEXT      publishes a text (std_msgs/String) there, which publishes texts from now on
    leave TOPIC          publishes there no more
    hear TOPIC           prints `heard TOPIC NUMBER` for every number that comes
    diagnose             prints `diagnosed NAME LEVEL` for every status on /diagnostics
    serve SERVICE        answers std_srvs/Trigger, and prints `called SERVICE`
    introspect SERVICE   tells the graph of every call of it from now on (ROS 2)
    call SERVICE         calls it, and waits for the answer (ROS 2)

It answers each line with `done`, and ends with its input: so it does not outlive its test.
"""

import sys
import threading


def say(*words):
    print(*words, flush=True)


class Ros1:
    def __init__(self):
        import rospy
        from diagnostic_msgs.msg import DiagnosticArray
        from std_msgs.msg import Float64, String
        from std_srvs.srv import Trigger, TriggerResponse

        self.rospy, self.number, self.text, self.diagnostics = rospy, Float64, String, DiagnosticArray
        self.trigger, self.answer = Trigger, TriggerResponse
        rospy.init_node("robot", disable_signals=True)

    def publisher(self, topic, kind):
        return self.rospy.Publisher(topic, kind, queue_size=100)

    def unpublish(self, publisher):
        publisher.unregister()

    def subscribe(self, topic, kind, heard):
        self.rospy.Subscriber(topic, kind, heard)

    def serve(self, service, called):
        def answer(_):
            called()
            return self.answer(success=True, message="halted")

        self.rospy.Service(service, self.trigger, answer)


class Ros2:
    def __init__(self):
        import rclpy
        from diagnostic_msgs.msg import DiagnosticArray
        from std_msgs.msg import Float64, String
        from std_srvs.srv import Trigger

        self.number, self.text, self.diagnostics, self.trigger = Float64, String, DiagnosticArray, Trigger
        rclpy.init()
        self.services = {}
        self.node = rclpy.create_node("robot")
        threading.Thread(target=rclpy.spin, args=(self.node,), daemon=True).start()

    def publisher(self, topic, kind):
        return self.node.create_publisher(kind, topic, 100)

    def unpublish(self, publisher):
        self.node.destroy_publisher(publisher)

    def subscribe(self, topic, kind, heard):
        self.node.create_subscription(kind, topic, heard, 100)

    def serve(self, service, called):
        def answer(_, response):
            called()
            response.success, response.message = True, "halted"
            return response

        self.services[service] = self.node.create_service(self.trigger, service, answer)

    def introspect(self, service):
        from rclpy.qos import qos_profile_system_default
        from rclpy.service_introspection import ServiceIntrospectionState

        contents = ServiceIntrospectionState.CONTENTS
        self.services[service].configure_introspection(self.node.get_clock(), qos_profile_system_default, contents)

    def call(self, service):
        client = self.node.create_client(self.trigger, service)
        client.wait_for_service()
        client.call(self.trigger.Request())
        self.node.destroy_client(client)


def level(status):
    return status.level[0] if isinstance(status.level, bytes) else status.level


def main():
    robot = {"ros1": Ros1, "ros2": Ros2}[sys.argv[1]]()
    publishers = {}
    say("ready")
    for line in sys.stdin:
        word, *rest = line.split()
        topic = rest[0] if rest else None
        if word == "offer":
            publishers[topic] = robot.publisher(topic, robot.number)
        elif word == "say":
            publishers[topic].publish(robot.number(data=float(rest[1])))
        elif word == "tell":
            if topic not in publishers:
                publishers[topic] = robot.publisher(topic, robot.text)
            publishers[topic].publish(robot.text(data=line.split(maxsplit=2)[2].rstrip("\n")))
        elif word == "leave":
            robot.unpublish(publishers.pop(topic))
        elif word == "hear":
            robot.subscribe(topic, robot.number, lambda message, topic=topic: say("heard", topic, message.data))
        elif word == "diagnose":
            heard = lambda message: [say("diagnosed", s.name.replace(" ", ""), level(s)) for s in message.status]
            robot.subscribe("/diagnostics", robot.diagnostics, heard)
        elif word == "serve":
            robot.serve(topic, lambda topic=topic: say("called", topic))
        elif word == "introspect":
            robot.introspect(topic)
        elif word == "call":
            robot.call(topic)
        say("done")


main()
