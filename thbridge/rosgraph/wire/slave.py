"""Slave API: a ROS node's answers to the master, to other nodes and to tools.

Inputs are a call and the current description of the node. Outputs are the reply, ``[code, message, value]``, and the
consequence for the node. The codes are those of ROS: 1 for success, 0 for a failure, -1 for an error of the caller.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.rosgraph.wire.xmlrpc import MethodCall, XmlRpcValue

TRANSPORT = "TCPROS"


@dataclass(frozen=True, slots=True)
class BusConnection:
    """Description of an open TCPROS connection of a topic for getBusInfo.

    Attributes:
        id: number of the connection, unique within the node.
        peer: name of the subscriber, or URI of the publisher.
        outgoing: True if this node publishes.
        topic: global name.
        endpoints: local port, remote host, remote port, number of the socket.
        bytes: number of bytes of transmitted messages, including their lengths.
        messages: number of transmitted messages.
    """

    id: int
    peer: str
    outgoing: bool
    topic: str
    endpoints: tuple[int, str, int, int]
    bytes: int
    messages: int


@dataclass(frozen=True, slots=True)
class NodeDescription:
    """Current description of a node.

    Attributes:
        name: global name.
        uri: URI of its slave API.
        master_uri: URI of its master.
        pid: process id.
        tcpros: host and port for TCPROS connections.
        publications: type by topic.
        subscriptions: type by topic.
        parameters: subscribed keys.
        connections: returns the open connections. There may be thousands.
    """

    name: str
    uri: str
    master_uri: str
    pid: int
    tcpros: tuple[str, int]
    publications: Mapping[str, str]
    subscriptions: Mapping[str, str]
    parameters: Iterable[str]
    connections: Callable[[], Iterable[BusConnection]]


@dataclass(frozen=True, slots=True)
class PublishersChanged:
    """Current publishers of a topic, by the URIs of their slave APIs."""

    topic: str
    uris: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ParameterChanged:
    """New value of a parameter.

    Attributes:
        key: global name, without a slash at its end.
        value: the new value. After a deletion, it is an empty dictionary.
        wanted: subscribed keys of the node that are equal to `key` or above it.
    """

    key: str
    value: XmlRpcValue
    wanted: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ShutdownRequested:
    """Request to end. It comes from the master if another node has taken the name, or from ``rosnode kill``."""

    reason: str


Consequence: TypeAlias = PublishersChanged | ParameterChanged | ShutdownRequested


@dataclass(frozen=True, slots=True)
class SlaveReply:
    """Reply to a call, and its consequence for the node."""

    reply: XmlRpcValue
    consequence: Consequence | None = None


def answer_call(call: MethodCall, node: NodeDescription) -> SlaveReply:
    """Answer a call of the slave API."""
    method = _METHODS.get(call.method)
    if method is None:
        return _wrong(f"there is no method {call.method}")
    if not call.params or not isinstance(call.params[0], str):
        return _wrong("the first argument must be the caller's name")
    return method(node, call.params[1:])


def _done(value: XmlRpcValue, message: str = "", consequence: Consequence | None = None) -> SlaveReply:
    return SlaveReply([1, message, value], consequence)


def _wrong(message: str, value: XmlRpcValue = 0) -> SlaveReply:
    return SlaveReply([-1, message, value])


def _get_bus_stats(node: NodeDescription, _: Sequence[XmlRpcValue]) -> SlaveReply:
    # The specification has no number of messages for subscribers, but rospy returns it. So this node does, too.
    by_topic: defaultdict[tuple[str, bool], list[BusConnection]] = defaultdict(list)
    for each in node.connections():
        by_topic[each.topic, each.outgoing].append(each)
    sent: list[XmlRpcValue] = []
    for topic in node.publications:
        links = by_topic[topic, True]
        sent.append([topic, sum(each.bytes for each in links), [[c.id, c.bytes, c.messages, True] for c in links]])
    received: list[XmlRpcValue] = []
    for topic in node.subscriptions:
        links = by_topic[topic, False]
        # In ROS, -1 means that the number of dropped messages is unknown.
        received.append([topic, [[c.id, c.bytes, c.messages, -1, True] for c in links]])
    # The third list is for services. ROS only proposes it, and gives no values.
    return _done([sent, received, []], "bus stats")


def _bus_info(connection: BusConnection) -> XmlRpcValue:
    port, host, other_port, socket = connection.endpoints
    # rosnode parses the ports from this sentence.
    text = f"{TRANSPORT} connection on port {port} to [{host}:{other_port} on socket {socket}]"
    direction = "o" if connection.outgoing else "i"
    return [connection.id, connection.peer, direction, TRANSPORT, connection.topic, True, text]


def _shutdown(node: NodeDescription, params: Sequence[XmlRpcValue]) -> SlaveReply:
    reason = params[0] if params and isinstance(params[0], str) else ""
    return _done(0, "shutdown", ShutdownRequested(reason))


def _param_update(node: NodeDescription, params: Sequence[XmlRpcValue]) -> SlaveReply:
    match params:
        case [str(key), value]:
            key = "/" + key.strip("/")
            # With a slash at the end of both keys, /robot1 does not match /robot10.
            wanted = tuple(each for each in node.parameters if f"{key}/".startswith(f"{each.rstrip('/')}/"))
            if not wanted:
                return _wrong("not subscribed")
            return _done(0, "", ParameterChanged(key, value, wanted))
    return _wrong("paramUpdate requires a key and a value")


def _publisher_update(node: NodeDescription, params: Sequence[XmlRpcValue]) -> SlaveReply:
    match params:
        case [str(topic), list(publishers)]:
            uris = tuple(each for each in publishers if isinstance(each, str))
            if len(uris) == len(publishers):
                return _done(0, "", PublishersChanged(topic, uris))
    return _wrong("publisherUpdate requires a topic and a list of URIs")


def _request_topic(node: NodeDescription, params: Sequence[XmlRpcValue]) -> SlaveReply:
    match params:
        case [str(topic), list(protocols)]:
            if topic not in node.publications:
                return _wrong(f"{node.name} does not publish {topic}", [])
            if any(isinstance(each, list) and each[:1] == [TRANSPORT] for each in protocols):
                host, port = node.tcpros
                return _done([TRANSPORT, host, port], f"ready on {host}:{port}")
            return SlaveReply([0, f"{TRANSPORT} is the only protocol here", []])
    return _wrong("requestTopic requires a topic and a list of protocols", [])


_METHODS: Mapping[str, Callable[[NodeDescription, Sequence[XmlRpcValue]], SlaveReply]] = {
    "getBusInfo": lambda node, _: _done([_bus_info(each) for each in node.connections()], "bus info"),
    "getBusStats": _get_bus_stats,
    "getMasterUri": lambda node, _: _done(node.master_uri),
    "getName": lambda node, _: _done(node.name),
    "getPid": lambda node, _: _done(node.pid),
    "getPublications": lambda node, _: _done(
        [[topic, kind] for topic, kind in node.publications.items()], "publications"
    ),
    "getSubscriptions": lambda node, _: _done(
        [[topic, kind] for topic, kind in node.subscriptions.items()], "subscriptions"
    ),
    "getUri": lambda node, _: _done(node.uri),
    "paramUpdate": _param_update,
    "publisherUpdate": _publisher_update,
    "requestTopic": _request_topic,
    "shutdown": _shutdown,
}

METHODS = frozenset(_METHODS)
"""Names of all methods that `answer_call` supports."""
