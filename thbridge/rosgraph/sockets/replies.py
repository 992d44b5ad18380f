"""Conversion of the replies of ROS's XML-RPC methods, ``[code, message, value]``, to values or failures."""

from __future__ import annotations

from thbridge.rosgraph.sockets.http_client import CallFailed
from thbridge.rosgraph.wire.xmlrpc import Fault, MethodResponse, XmlRpcValue


def value_of(uri: str, reply: MethodResponse | Fault | CallFailed) -> XmlRpcValue | CallFailed:
    """Return the value in a reply of the master or a node. If the call failed, return the failure."""
    match reply:
        case MethodResponse([1, _, value]):
            return value
        case MethodResponse([int(), str(message), _]):
            return CallFailed(uri, message)
        case MethodResponse():
            return CallFailed(uri, "its answer does not follow ROS's format")
        case Fault(_, text):
            return CallFailed(uri, text)
        case CallFailed():
            return reply
