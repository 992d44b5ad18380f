"""Replies of ROS's XML-RPC methods, ``[code, message, value]``, as values or failures."""

from __future__ import annotations

from thbridge.sockets.rosgraph.http_client import CallFailed
from thbridge.wire.rosgraph.xmlrpc import Fault, Response, XmlRpcValue


def value_of(uri: str, reply: Response | Fault | CallFailed) -> XmlRpcValue | CallFailed:
    """What a call to the master or a node returned, or why it returned nothing."""
    match reply:
        case Response([1, _, value]):
            return value
        case Response([int(), str(message), _]):
            return CallFailed(uri, message)
        case Response():
            return CallFailed(uri, "its answer is not one of ROS")
        case Fault(_, text):
            return CallFailed(uri, text)
        case CallFailed():
            return reply
