"""A client of Foxglove's WebSocket protocol, by the `websockets` library: subscribes to all topics, and prints what comes. Usage: foxglove.py PORT

Ends with its input.
"""

import json
import os
import struct
import sys
import threading

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect


def say(*words):
    print(*words, flush=True)


def told(topic, message):
    if topic == "/lapwing/verdicts":
        if message["type"] == "violation":
            say(topic, message["type"], message["name"], message["values"]["speed"])
    elif topic == "/diagnostics":
        say(topic, *(status["level"] for status in message["status"]))
    else:
        say(topic, *message.values())


threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
def listen(socket):
    topics = {}
    for frame in socket:
        if isinstance(frame, bytes):
            # Opcode 1: a message, with the number of the subscription and its time.
            if frame[0] == 1:
                (subscription,) = struct.unpack_from("<I", frame, 1)
                told(topics[subscription], json.loads(frame[13:]))
            continue
        answer = json.loads(frame)
        if answer["op"] == "serverInfo":
            assert answer["name"] == "Lapwing", answer
            # It only shows: there is nothing that a client could publish or set.
            assert not {"clientPublish", "parameters", "services"} & set(answer["capabilities"]), answer
            socket.send(json.dumps({"op": "advertise", "channels": [{"id": 1, "topic": "/cmd", "encoding": "json", "schemaName": ""}]}))
        elif answer["op"] == "status":
            say("refused", answer["message"])
        elif answer["op"] == "advertise":
            new = [{"id": channel["id"], "channelId": channel["id"]} for channel in answer["channels"]]
            topics.update({channel["id"]: channel["topic"] for channel in answer["channels"]})
            assert all(channel["encoding"] == "json" for channel in answer["channels"]), answer
            socket.send(json.dumps({"op": "subscribe", "subscriptions": new}))


with connect(f"ws://127.0.0.1:{sys.argv[1]}", subprotocols=["foxglove.sdk.v1"]) as socket:
    try:
        listen(socket)
    except ConnectionClosed:
        # Lapwing has ended, as the test wanted.
        pass
