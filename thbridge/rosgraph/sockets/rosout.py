"""Rosout node, which roscore runs together with the master: it republishes the logs of all nodes on one topic."""

from __future__ import annotations

from thbridge.ros.messages.types import LOG, plain_definition
from thbridge.rosgraph.sockets.node import RosNode
from thbridge.sockets.admission import OWN_MACHINE, Admission

NODE = "/rosout"
LOGGED = "/rosout"
AGGREGATED = "/rosout_agg"


def rosout_node(master_uri: str, host: str, admission: Admission = OWN_MACHINE) -> RosNode:
    """Return a node, not started yet, that republishes ``/rosout`` as ``/rosout_agg``.

    A tool that shows logs then needs only one connection, instead of a connection to every node.

    Source: ROS's rosout/rosout.cpp.

    Differs: it writes no file, and has no log of its own.

    Args:
        master_uri: URI of the master.
        host: address to listen on and to be called at.
        admission: decides by address which nodes are accepted.
    """
    log = plain_definition(LOG)
    node = RosNode(NODE, master_uri, host, admission=admission)
    aggregated = node.advertise(AGGREGATED, LOG, log.md5, log.text)

    def on_message(message: bytes, publisher: str) -> None:
        aggregated.publish(message)

    node.subscribe(LOGGED, LOG, log.md5, on_message)
    return node
