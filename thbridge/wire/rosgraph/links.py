"""What both ends of a TCPROS connection agree on: topics, services, what happens on a link, and whether two fit.

Bytes that came go into a link, events come out, to be carried out in their order. No bytes make a link raise, and none
make it hold more than one frame. After `Refused` or `Ended` a link takes no more notice of anything.

===================  ======================================  ==========================================
link                 is                                      says first
===================  ======================================  ==========================================
`InboundLink`        publisher or server, connected to       nothing: the caller's header decides
`SubscriberLink`     subscriber, connects to a publisher     its header (`opening`)
`ServiceClientLink`  client, connects to a server            its header (`opening`)
===================  ======================================  ==========================================
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from thbridge.wire.rosgraph.tcpros import (
    ANY,
    HEADER_LIMIT,
    FrameBuffer,
    HeaderFields,
    MalformedHeader,
    OverlongFrame,
    decode_header,
)

_QUOTED = 200
"""Letters of a stranger's text that are repeated."""


@dataclass(frozen=True, slots=True)
class TopicHeader:
    """What a publisher says about its topic.

    Attributes:
        name: global name, ``/robot1/scan``.
        type: ``sensor_msgs/LaserScan``.
        md5: the type's md5 sum, 32 hexadecimal digits.
        definition: the type's whole text, nested types included, as in bags.
        latched: whether a new subscriber gets the last message at once.
    """

    name: str
    type: str
    md5: str
    definition: str
    latched: bool = False


@dataclass(frozen=True, slots=True)
class ServiceHeader:
    """What a server says about its service.

    Attributes:
        name: global name, ``/static_map``.
        type: ``nav_msgs/GetMap``.
        md5: the service type's md5 sum.
        request_type: ``nav_msgs/GetMapRequest``.
        response_type: ``nav_msgs/GetMapResponse``.
    """

    name: str
    type: str
    md5: str
    request_type: str
    response_type: str


@dataclass(frozen=True, slots=True)
class ServiceFailed:
    """A service's answer that is no response.

    Attributes:
        reason: one sentence for people.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class SendToPeer:
    """Bytes for the other side."""

    data: bytes


@dataclass(frozen=True, slots=True)
class SubscriberAccepted:
    """The caller is a subscriber and awaits messages.

    Attributes:
        topic: what it subscribes to; one of ours.
        caller: the other node's name.
    """

    topic: str
    caller: str


@dataclass(frozen=True, slots=True)
class ServiceRequested:
    """A client's request, to be answered by `InboundLink.respond`; no other comes before that."""

    service: str
    request: bytes


@dataclass(frozen=True, slots=True)
class PublisherAccepted:
    """The publisher has accepted us.

    Attributes:
        caller: the publishing node's name, empty when it does not say.
        topic: what it says about the topic.
    """

    caller: str
    topic: TopicHeader


@dataclass(frozen=True, slots=True)
class MessageReceived:
    """A message of the topic."""

    data: bytes


@dataclass(frozen=True, slots=True)
class ServiceAnswered:
    """The service's answer."""

    answer: bytes | ServiceFailed


@dataclass(frozen=True, slots=True)
class LinkRefused:
    """The two sides do not fit; to be closed once everything is sent. Somebody should be told."""

    reason: str


@dataclass(frozen=True, slots=True)
class LinkEnded:
    """The link has done its work or is of no more use; to be closed once everything is sent."""

    reason: str


InboundEvent: TypeAlias = SendToPeer | SubscriberAccepted | ServiceRequested | LinkRefused | LinkEnded
SubscriberEvent: TypeAlias = PublisherAccepted | MessageReceived | LinkRefused | LinkEnded
ServiceClientEvent: TypeAlias = SendToPeer | ServiceAnswered | LinkRefused | LinkEnded


def take_header(buffer: FrameBuffer) -> HeaderFields | MalformedHeader | None:
    """The header that a connection begins with, None while it is incomplete."""
    body = buffer.take(HEADER_LIMIT)
    if body is None:
        return None
    return MalformedHeader(f"it sends {body} for a header") if isinstance(body, OverlongFrame) else decode_header(body)


def objection(name: str, kind: str, md5: str, theirs: HeaderFields) -> str:
    """Why their header does not fit what we know of a topic or service, else nothing.

    As in ROS the md5 sums alone decide: the same message may go by two names.

    Args:
        name: of the topic or service.
        kind: our type.
        md5: our md5 sum, or `ANY`.
        theirs: the header.
    """
    their_md5 = theirs.get("md5sum")
    if their_md5 is None:
        return "the header has no field md5sum"
    if ANY in (md5, their_md5) or md5 == their_md5:
        return ""
    their_kind = quoted(theirs.get("type", "an unknown type"))
    return f"{name} is {kind} with md5 sum {md5} here, and {their_kind} with md5 sum {quoted(their_md5)} there"


def quoted(text: str) -> str:
    """What a stranger said, fit to be repeated in a log: one line, not too long."""
    return "".join(letter if letter.isprintable() else "?" for letter in text[:_QUOTED])
