"""A node of rclpy that is driven by lines of JSON: commands come by standard input, events go to standard output.

It runs with the Python of the peer, so it imports nothing of the project.
"""

import importlib
import json
import sys
import threading
import time
from queue import Empty, SimpleQueue

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

events = threading.Lock()


def say(event, **fields):
    """Print an event."""
    with events:
        print(json.dumps({"event": event, **fields}), flush=True)


def interface(name):
    """Return the class of a type, for example std_msgs/msg/String."""
    package, kind, short = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), short)


def profile(wanted):
    """Return a quality of service from [depth, is reliable, is latched]."""
    depth, reliable, latched = wanted
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def described(info):
    """Return what rclpy knows about an endpoint."""
    qos = info.qos_profile
    return {
        "node": info.node_namespace.rstrip("/") + "/" + info.node_name,
        "type": info.topic_type,
        "hash": str(info.topic_type_hash),
        "gid": bytes(info.endpoint_gid).hex(),
        "reliable": qos.reliability == ReliabilityPolicy.RELIABLE,
        "latched": qos.durability == DurabilityPolicy.TRANSIENT_LOCAL,
        "depth": qos.depth,
    }


class Peer:
    """The node, and what it offers."""

    def __init__(self, name, namespace):
        rclpy.init()
        self.node = rclpy.create_node(name, namespace=namespace)
        self.publishers = {}
        self.clients = {}

    def subscribe(self, topic, type_name, qos):
        """Report each message of a topic as hexadecimal digits."""

        def heard(data):
            say("message", topic=topic, data=bytes(data).hex())

        self.node.create_subscription(interface(type_name), topic, heard, profile(qos), raw=True)

    def advertise(self, topic, type_name, qos):
        """Announce a publisher."""
        self.publishers[topic] = self.node.create_publisher(interface(type_name), topic, profile(qos))

    def publish(self, topic, data):
        """Publish a message, given as hexadecimal digits."""
        self.publishers[topic].publish(bytes.fromhex(data))

    def serve(self, service):
        """Serve std_srvs/srv/SetBool. The response has the value of the request."""

        def answer(request, response):
            response.success, response.message = request.data, self.node.get_name()
            return response

        self.node.create_service(interface("std_srvs/srv/SetBool"), service, answer)

    def call(self, service, data):
        """Call a service std_srvs/srv/SetBool, and report the response."""
        kind = interface("std_srvs/srv/SetBool")
        client = self.clients.get(service)
        if client is None:
            client = self.clients[service] = self.node.create_client(kind, service)

        def answered(future):
            say("response", success=future.result().success, message=future.result().message)

        def ask():
            if client.wait_for_service(timeout_sec=30.0):
                client.call_async(kind.Request(data=data)).add_done_callback(answered)
            else:
                say("no service", service=service)

        threading.Thread(target=ask, daemon=True).start()

    def graph(self, node, namespace, topics):
        """Report nodes, and the endpoints of a node and of topics."""
        nodes = self.node.get_node_names_and_namespaces()
        found = {"nodes": sorted(where.rstrip("/") + "/" + name for name, where in nodes)}
        if (node, namespace) in nodes:
            arguments = (node, namespace)
            found["services"] = self.node.get_service_names_and_types_by_node(*arguments)
            found["clients"] = self.node.get_client_names_and_types_by_node(*arguments)
            found["published"] = self.node.get_publisher_names_and_types_by_node(*arguments)
            found["subscribed"] = self.node.get_subscriber_names_and_types_by_node(*arguments)
        found["publishers"] = {
            topic: [described(each) for each in self.node.get_publishers_info_by_topic(topic)] for topic in topics
        }
        found["subscriptions"] = {
            topic: [described(each) for each in self.node.get_subscriptions_info_by_topic(topic)] for topic in topics
        }
        say("graph", **found)


def read(commands):
    """Queue the commands; None at their end."""
    for line in sys.stdin:
        commands.put(json.loads(line))
    commands.put(None)


def main():
    """Run until the commands end."""
    peer = Peer(sys.argv[1], sys.argv[2])
    executor = SingleThreadedExecutor()
    executor.add_node(peer.node)
    commands = SimpleQueue()
    threading.Thread(target=read, args=(commands,), daemon=True).start()
    say("ready", at=time.time())
    while True:
        executor.spin_once(timeout_sec=0.005)
        try:
            command = commands.get_nowait()
        except Empty:
            continue
        if command is None:
            break
        getattr(peer, command.pop("do"))(**command)
    peer.node.destroy_node()
    rclpy.shutdown()


main()
