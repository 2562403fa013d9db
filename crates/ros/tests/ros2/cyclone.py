"""A publisher made with Cyclone DDS itself, without ROS: another vendor, and offers that no node of ROS 2 makes.

Prints `ready`, publishes until its standard input ends.
"""

import argparse
import os
import sys
import threading
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float64, int64, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

LOOPBACK = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>20</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""


@dataclass
@final
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
@final
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3
    angular: Vector3


@dataclass
@final
class Request(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Request_"):
    client: uint64
    number: int64
    data: bool


@dataclass
@final
class Response(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Response_"):
    client: uint64
    number: int64
    success: bool
    message: str


def publish(participant, args):
    policies = [Policy.Reliability.Reliable(duration(seconds=1)), Policy.DataRepresentation(use_cdrv0_representation=not args.xcdr2, use_xcdrv2_representation=args.xcdr2)]
    if args.exclusive:
        policies += [Policy.Ownership.Exclusive, Policy.OwnershipStrength(3)]
    writer = DataWriter(participant, Topic(participant, "rt" + args.topic, Twist), qos=Qos(*policies))
    print("ready", flush=True)
    number = 0
    while True:
        number += 1
        writer.write(Twist(Vector3(number / 4, 0.0, 0.0), Vector3(0.0, 0.0, 1.0)))
        time.sleep(0.02)


def serve(participant, args):
    """A service as rmw_cyclonedds has it: client and number in front of request and answer."""
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False))
    reader = DataReader(participant, Topic(participant, "rq" + args.topic + "Request", Request), qos=qos)
    writer = DataWriter(participant, Topic(participant, "rr" + args.topic + "Reply", Response), qos=qos)
    print("ready", flush=True)
    while True:
        for request in reader.take(N=8):
            if not isinstance(request, Request):  # a client that left
                continue
            print("asked", request.data, flush=True)
            # Somebody else's answer comes first: it is on the topic as well, and not for whoever asked.
            writer.write(Response(request.client + 1, request.number, True, "not yours"))
            writer.write(Response(request.client, request.number, not request.data, f"it was {request.data}"))
        time.sleep(0.01)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("do", choices=["publish", "serve"])
    parser.add_argument("topic")
    parser.add_argument("--exclusive", action="store_true")
    parser.add_argument("--xcdr2", action="store_true")
    args = parser.parse_args()
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    number = int(os.environ["ROS_DOMAIN_ID"])
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    {"publish": publish, "serve": serve}[args.do](participant, args)
    del domain


if __name__ == "__main__":
    main()
