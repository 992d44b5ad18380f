"""TCPROS links: descriptions of topics and services, events of a link, and the comparison of two headers.

A link gets received bytes and returns events, which must be executed in order. No bytes can make a link raise an
exception, or store more than one frame. After `LinkRefused` or `LinkEnded`, a link ignores everything.

===================  ======================================  ==========================================
link                 role                                    sends first
===================  ======================================  ==========================================
`InboundLink`        publisher or server, connected to       nothing: the caller's header decides
`SubscriberLink`     subscriber, connects to a publisher     its header (`opening`)
===================  ======================================  ==========================================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from thbridge.rosgraph.wire.tcpros import (
    ANY,
    HEADER_LIMIT,
    FrameBuffer,
    HeaderFields,
    MalformedHeader,
    OverlongFrame,
    decode_header,
)

_QUOTED = 200
"""Largest number of characters quoted from a peer's text."""


@dataclass(frozen=True, slots=True)
class TopicHeader:
    """Topic as in a publisher's connection header.

    Attributes:
        name: global name, such as ``/robot1/scan``.
        type: type, such as ``sensor_msgs/LaserScan``.
        md5: the type's md5 sum, 32 hexadecimal digits.
        definition: the type's whole text, including nested types, as in bags.
        latched: True if a new subscriber gets the last message at once.
    """

    name: str
    type: str
    md5: str
    definition: str
    latched: bool = False


@dataclass(frozen=True, slots=True)
class ServiceHeader:
    """Service as in a server's connection header.

    Attributes:
        name: global name, such as ``/static_map``.
        type: type, such as ``nav_msgs/GetMap``.
        md5: the service type's md5 sum.
        request_type: type of the request, such as ``nav_msgs/GetMapRequest``.
        response_type: type of the response, such as ``nav_msgs/GetMapResponse``.
    """

    name: str
    type: str
    md5: str
    request_type: str
    response_type: str


@dataclass(frozen=True, slots=True)
class ServiceFailed:
    """Failure of a service call.

    Attributes:
        reason: one sentence for people.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class SendToPeer:
    """Bytes to be sent to the other side."""

    data: bytes


@dataclass(frozen=True, slots=True)
class SubscriberAccepted:
    """The other node has subscribed and expects messages.

    Attributes:
        topic: one of our topics.
        caller: the other node's name.
    """

    topic: str
    caller: str


@dataclass(frozen=True, slots=True)
class ServiceRequested:
    """Request of a client, to be answered by `InboundLink.respond`. No other request comes before the answer."""

    service: str
    request: bytes


@dataclass(frozen=True, slots=True)
class PublisherAccepted:
    """The publisher has accepted our subscription.

    Attributes:
        caller: name of the publishing node; empty if its header has none.
        topic: topic as in its header.
    """

    caller: str
    topic: TopicHeader


@dataclass(frozen=True, slots=True)
class MessageReceived:
    """Message of the topic."""

    data: bytes


@dataclass(frozen=True, slots=True)
class LinkRefused:
    """The two headers do not match. Close the link after everything is sent, and log a warning."""

    reason: str


@dataclass(frozen=True, slots=True)
class LinkEnded:
    """The link is finished or broken. Close it after everything is sent."""

    reason: str


InboundEvent: TypeAlias = SendToPeer | SubscriberAccepted | ServiceRequested | LinkRefused | LinkEnded
SubscriberEvent: TypeAlias = PublisherAccepted | MessageReceived | LinkRefused | LinkEnded


def take_header(buffer: FrameBuffer) -> HeaderFields | MalformedHeader | None:
    """Return the header at the beginning of a connection; None while it is incomplete."""
    body = buffer.take(HEADER_LIMIT)
    if body is None:
        return None
    return MalformedHeader(f"it sends {body} for a header") if isinstance(body, OverlongFrame) else decode_header(body)


def objection(name: str, kind: str, md5: str, theirs: HeaderFields) -> str:
    """Return the mismatch between a peer's header and our topic or service; empty if they match.

    As in ROS, only the md5 sums decide, because the same message may have two names.

    Args:
        name: name of the topic or service.
        kind: our type.
        md5: our md5 sum, or `ANY`.
        theirs: the peer's header.
    """
    their_md5 = theirs.get("md5sum")
    if their_md5 is None:
        return "the header has no field md5sum"
    if ANY in (md5, their_md5) or md5 == their_md5:
        return ""
    their_kind = quoted(theirs.get("type", "an unknown type"))
    return f"{name} is {kind} with md5 sum {md5} here, and {their_kind} with md5 sum {quoted(their_md5)} there"


def quoted(text: str) -> str:
    """Return a peer's text in a form that is safe for logs: one line, not too long."""
    return "".join(letter if letter.isprintable() else "?" for letter in text[:_QUOTED])
