"""A participant of Cyclone DDS that is driven by lines of JSON, as `rclpy_peer.py` is.

Its services have the form of rmw_cyclonedds: 16 bytes that name the request, before its fields.
"""

import json
import os
import sys
import threading
import time
from dataclasses import dataclass
from queue import Empty, SimpleQueue

os.environ["CYCLONEDDS_URI"] = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>31</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int64, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    """A message with a text."""

    data: str


@dataclass
class Request(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Request_"):
    """A request with its header."""

    client: uint64
    number: int64
    data: bool


@dataclass
class Response(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Response_"):
    """A response with its header."""

    client: uint64
    number: int64
    success: bool
    message: str


def say(event, **fields):
    """Print an event."""
    print(json.dumps({"event": event, **fields}), flush=True)


def profile(wanted):
    """Return a quality of service from [depth, is reliable, is latched]."""
    depth, reliable, latched = wanted
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
    )


SERVICES = [10, True, False]


class Peer:
    """The participant, and what it reads and writes."""

    def __init__(self, domain):
        self.participant = DomainParticipant(domain)
        self.writers = {}
        self.polled = []
        self.numbers = 0

    def writer(self, name, type_name, qos):
        """Return a writer."""
        if name not in self.writers:
            self.writers[name] = DataWriter(self.participant, Topic(self.participant, name, type_name), profile(qos))
        return self.writers[name]

    def read(self, name, type_name, qos, heard):
        """Call a function with each sample of a topic."""
        reader = DataReader(self.participant, Topic(self.participant, name, type_name), profile(qos))
        self.polled.append((reader, heard))

    def subscribe(self, topic, qos):
        """Report each text of a topic."""
        self.read(f"rt{topic}", String, qos, lambda sample: say("message", topic=topic, text=sample.data))

    def advertise(self, topic, qos):
        """Announce a writer."""
        self.writer(f"rt{topic}", String, qos)

    def publish(self, topic, text):
        """Write a text."""
        self.writers[f"rt{topic}"].write(String(text))

    def serve(self, service):
        """Serve std_srvs/srv/SetBool."""
        answers = self.writer(f"rr{service}Reply", Response, SERVICES)
        self.read(
            f"rq{service}Request",
            Request,
            SERVICES,
            lambda request: answers.write(Response(request.client, request.number, request.data, "cyclone")),
        )

    def call(self, service, data):
        """Call std_srvs/srv/SetBool, and report the response."""
        self.numbers += 1
        name = (0x1234_5678_9ABC_DEF0, self.numbers)
        requests = self.writer(f"rq{service}Request", Request, SERVICES)

        def heard(response):
            if (response.client, response.number) == name:
                say("response", success=response.success, message=response.message)

        self.read(f"rr{service}Reply", Response, SERVICES, heard)
        while not requests.get_matched_subscriptions() or not self.polled[-1][0].get_matched_publications():
            time.sleep(0.01)
        requests.write(Request(*name, data))

    def poll(self):
        """Report what has come."""
        for reader, heard in self.polled:
            for sample in reader.take(N=100):
                heard(sample)


def read(commands):
    """Queue the commands; None at their end."""
    for line in sys.stdin:
        commands.put(json.loads(line))
    commands.put(None)


def main():
    """Run until the commands end."""
    peer = Peer(int(os.environ["ROS_DOMAIN_ID"]))
    commands = SimpleQueue()
    threading.Thread(target=read, args=(commands,), daemon=True).start()
    say("ready", at=time.time())
    while True:
        peer.poll()
        try:
            command = commands.get(timeout=0.005)
        except Empty:
            continue
        if command is None:
            break
        getattr(peer, command.pop("do"))(**command)


main()
