"""TCPROS links: descriptions of topics and services, events of a link, comparison of two headers.

A link receives bytes and returns events. The events must be executed in order. No bytes can cause a link to raise an
exception, or to store more than one frame. After `LinkRefused` or `LinkEnded`, a link ignores all bytes.

===================  ======================================  ==========================================
link                 role                                    sends first
===================  ======================================  ==========================================
`InboundLink`        publisher or server, called by a peer   nothing: it needs the caller's header
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
"""Maximum number of characters that are quoted from a peer's text."""


@dataclass(frozen=True, slots=True)
class TopicHeader:
    """Description of a topic in a publisher's connection header.

    Attributes:
        name: global name, such as ``/robot1/scan``.
        type: type, such as ``sensor_msgs/LaserScan``.
        md5: the type's md5 sum, 32 hexadecimal digits.
        definition: the type's complete text, including nested types, as in bags.
        latched: True if a new subscriber gets the last message at once.
    """

    name: str
    type: str
    md5: str
    definition: str
    latched: bool = False


@dataclass(frozen=True, slots=True)
class ServiceHeader:
    """Description of a service in a server's connection header.

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
    """Event: bytes must be sent to the peer."""

    data: bytes


@dataclass(frozen=True, slots=True)
class SubscriberAccepted:
    """Event: the peer has subscribed and expects messages.

    Attributes:
        topic: name of one of our topics.
        caller: name of the peer.
    """

    topic: str
    caller: str


@dataclass(frozen=True, slots=True)
class ServiceRequested:
    """Event: a client requests a service. `InboundLink.respond` must answer. Before that, no other request follows."""

    service: str
    request: bytes


@dataclass(frozen=True, slots=True)
class PublisherAccepted:
    """Event: the publisher has accepted our subscription.

    Attributes:
        caller: name of the publisher. Empty if its header contains no name.
        topic: description of the topic in its header.
    """

    caller: str
    topic: TopicHeader


@dataclass(frozen=True, slots=True)
class MessageReceived:
    """Event: a message of the topic has arrived."""

    data: bytes


@dataclass(frozen=True, slots=True)
class LinkRefused:
    """Event: the headers of both ends do not match. Log a warning, and close the link after all data are sent."""

    reason: str


@dataclass(frozen=True, slots=True)
class LinkEnded:
    """Event: the link is finished or broken. Close it after all data are sent."""

    reason: str


InboundEvent: TypeAlias = SendToPeer | SubscriberAccepted | ServiceRequested | LinkRefused | LinkEnded
SubscriberEvent: TypeAlias = PublisherAccepted | MessageReceived | LinkRefused | LinkEnded


def take_header(buffer: FrameBuffer) -> HeaderFields | MalformedHeader | None:
    """Return the header at the beginning of a connection, or None while it is incomplete."""
    body = buffer.take(HEADER_LIMIT)
    if body is None:
        return None
    return MalformedHeader(f"its header is {body}") if isinstance(body, OverlongFrame) else decode_header(body)


def objection(name: str, kind: str, md5: str, theirs: HeaderFields) -> str:
    """Return the difference between a peer's header and our topic or service. Return an empty text if they match.

    As in ROS, only the md5 sums are compared, because the same message may have two names.

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
    return f"{name} has md5 sum {md5} here ({kind}), but {quoted(their_md5)} at the peer ({their_kind})"


def quoted(text: str) -> str:
    """Return a peer's text in a form that is safe for logs: one line of limited length."""
    return "".join(letter if letter.isprintable() else "?" for letter in text[:_QUOTED])
