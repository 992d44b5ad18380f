"""Connecting end of a TCPROS connection, which is a subscriber."""

from __future__ import annotations

from enum import Enum, auto

from thbridge.rosgraph.wire.links import (
    LinkEnded,
    LinkRefused,
    MessageReceived,
    PublisherAccepted,
    SubscriberEvent,
    TopicHeader,
    objection,
    quoted,
    take_header,
)
from thbridge.rosgraph.wire.tcpros import (
    BODY_LIMIT,
    FrameBuffer,
    MalformedHeader,
    OverlongFrame,
    encode_header,
)


class _Phase(Enum):
    HANDSHAKE = auto()
    OPEN = auto()
    OVER = auto()


class SubscriberLink:
    """Connection of a subscriber to one publisher.

    Args:
        caller: this node's name.
        topic: global name.
        kind: the expected type, or `ANY`.
        md5: its md5 sum, or `ANY`.
        tcp_nodelay: True to request that the publisher sends small messages at once.
    """

    def __init__(self, caller: str, topic: str, kind: str, md5: str, tcp_nodelay: bool = True) -> None:
        self._asked = {
            "callerid": caller,
            "md5sum": md5,
            "tcp_nodelay": "1" if tcp_nodelay else "0",
            "topic": topic,
            "type": kind,
        }
        self._buffer = FrameBuffer()
        self._phase = _Phase.HANDSHAKE

    def opening(self) -> bytes:
        """Return our header. The subscriber must send it first."""
        return encode_header(self._asked)

    def receive(self, data: bytes) -> list[SubscriberEvent]:
        """Process bytes from the publisher."""
        if self._phase is _Phase.OVER:
            return []
        self._buffer.feed(data)
        events: list[SubscriberEvent] = []
        if self._phase is _Phase.HANDSHAKE:
            accepted = self._judge_header()
            if accepted is None:
                return []
            if not isinstance(accepted, PublisherAccepted):
                return [self._over(accepted)]
            self._phase = _Phase.OPEN
            events.append(accepted)
        while (message := self._buffer.take(BODY_LIMIT)) is not None:
            if isinstance(message, OverlongFrame):
                return [*events, self._over(LinkRefused(f"it sends {message}"))]
            events.append(MessageReceived(message))
        return events

    def _over(self, event: LinkRefused | LinkEnded) -> LinkRefused | LinkEnded:
        self._phase = _Phase.OVER
        self._buffer = FrameBuffer()
        return event

    def _judge_header(self) -> PublisherAccepted | LinkRefused | LinkEnded | None:
        """Return the acceptance if the publisher's header matches our header. Return None while it is incomplete."""
        fields = take_header(self._buffer)
        if fields is None:
            return None
        if isinstance(fields, MalformedHeader):
            return LinkEnded(fields.reason)
        # A publisher that refuses a subscription sends a header with this field.
        if "error" in fields:
            return LinkRefused(quoted(fields["error"]))
        topic, kind, md5 = self._asked["topic"], self._asked["type"], self._asked["md5sum"]
        against = objection(topic, kind, md5, fields)
        if against:
            return LinkRefused(against)
        header = TopicHeader(
            topic,
            fields.get("type", kind),
            fields["md5sum"],
            fields.get("message_definition", ""),
            fields.get("latching") == "1",
        )
        return PublisherAccepted(quoted(fields.get("callerid", "")), header)
