"""A node of rclpy that subscribes to all topics of a session, and writes what it gets into a file.

It runs with the Python of the peer, so it imports nothing of the project. Arguments: number of topics to wait for,
seconds to listen, the file, and seconds to wait for the topics.
"""

import importlib
import json
import sys
import time
from pathlib import Path

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def interface(name):
    """Return the class of a type."""
    package, kind, short = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), short)


def offers(node):
    """Return the publishers of the session's topics, by topic."""
    found = {}
    for topic, _ in node.get_topic_names_and_types():
        for info in node.get_publishers_info_by_topic(topic):
            # The names of nodes arrive after their endpoints.
            is_known = not info.node_name.startswith("_NODE_NAME")
            if is_known and info.node_name != node.get_name() and "/_action/" not in topic:
                found[topic, info.topic_type] = info
    return found


def keep(messages, data):
    """Keep a message as hexadecimal digits."""
    messages.append(bytes(data).hex())


def main(expected, seconds, out, patience):
    """Listen, and write the file."""
    rclpy.init()
    node = rclpy.create_node("session_listener")
    end = time.monotonic() + patience
    while len(found := offers(node)) < expected and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
    heard = {}
    for (topic, kind), info in found.items():
        offered = info.qos_profile
        heard[topic] = {
            "type": kind,
            "hash": str(info.topic_type_hash),
            "node": info.node_namespace.rstrip("/") + "/" + info.node_name,
            "reliable": offered.reliability == ReliabilityPolicy.RELIABLE,
            "latched": offered.durability == DurabilityPolicy.TRANSIENT_LOCAL,
            "depth": offered.depth,
            "messages": [],
        }
        wanted = QoSProfile(depth=100, reliability=offered.reliability, durability=offered.durability)
        keep = heard[topic]["messages"].append
        node.create_subscription(
            interface(kind), topic, lambda data, keep=keep: keep(bytes(data).hex()), wanted, raw=True
        )
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
    Path(out).write_text(json.dumps(heard))


main(int(sys.argv[1]), float(sys.argv[2]), sys.argv[3], float(sys.argv[4]) if len(sys.argv) > 4 else 60.0)
