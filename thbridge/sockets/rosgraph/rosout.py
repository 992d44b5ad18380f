"""The node that roscore runs beside the master: says on one topic again what all nodes log."""

from __future__ import annotations

from thbridge.ros.messages.types import LOG, plain_definition
from thbridge.sockets.rosgraph.node import RosNode

NODE = "/rosout"
LOGGED = "/rosout"
AGGREGATED = "/rosout_agg"


def rosout_node(master_uri: str, host: str) -> RosNode:
    """A node that republishes ``/rosout`` as ``/rosout_agg``, still to be started.

    A tool that shows logs then has one connection instead of one to every node.

    Source: ROS's rosout/rosout.cpp.

    Differs: it writes no file, and logs nothing of its own.

    Args:
        master_uri: of the master.
        host: where the node listens and can be reached.
    """
    log = plain_definition(LOG)
    node = RosNode(NODE, master_uri, host)
    aggregated = node.advertise(AGGREGATED, LOG, log.md5, log.text)

    def heard(message: bytes, publisher: str) -> None:
        aggregated.publish(message)

    node.subscribe(LOGGED, LOG, log.md5, heard)
    return node
