"""Rosout node, which republishes the logs of all nodes on one topic. roscore runs it together with the master."""

from __future__ import annotations

from thbridge.ros.messages.types import LOG, plain_definition
from thbridge.rosgraph.sockets.node import RosNode
from thbridge.sockets.admission import OWN_MACHINE, Admission

NODE = "/rosout"
LOGGED = "/rosout"
AGGREGATED = "/rosout_agg"


def rosout_node(master_uri: str, host: str, admission: Admission = OWN_MACHINE) -> RosNode:
    """Return a node that republishes ``/rosout`` as ``/rosout_agg``. The node is not started yet.

    A tool that shows logs then needs only one connection, instead of a connection to every node.

    Source: ROS's rosout/rosout.cpp.

    Differences from ROS: it writes no file, and has no log of its own.

    Args:
        master_uri: URI of the master.
        host: address on which the node listens and at which other nodes call it.
        admission: decides by address which nodes are accepted.
    """
    log = plain_definition(LOG)
    node = RosNode(NODE, master_uri, host, admission=admission)
    aggregated = node.advertise(AGGREGATED, LOG, log.md5, log.text)

    def on_message(message: bytes, publisher: str) -> None:
        aggregated.publish(message)

    node.subscribe(LOGGED, LOG, log.md5, on_message)
    return node
