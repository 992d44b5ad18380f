"""Connecting end of a TCPROS connection: a subscriber's, or a service client's."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum, auto

from thbridge.protocols.rosgraph.links import (
    LinkEnded,
    LinkRefused,
    MessageReceived,
    PublisherAccepted,
    SendToPeer,
    ServiceAnswered,
    ServiceClientEvent,
    ServiceFailed,
    SubscriberEvent,
    TopicHeader,
    objection,
    quoted,
    take_header,
)
from thbridge.protocols.rosgraph.tcpros import (
    BODY_LIMIT,
    FrameBuffer,
    HeaderFields,
    MalformedHeader,
    OverlongFrame,
    encode_header,
    frame,
)


class _Phase(Enum):
    HANDSHAKE = auto()
    OPEN = auto()
    OVER = auto()


class _OutgoingLink:
    """Connection that this node has opened, up to the agreement of both headers.

    Args:
        what: the topic or service, global name.
        asked: our header.
    """

    def __init__(self, what: str, asked: Mapping[str, str]) -> None:
        self._what = what
        self._asked = asked
        self._buffer = FrameBuffer()
        self._phase = _Phase.HANDSHAKE

    def opening(self) -> bytes:
        """Return the header, to be sent once connected."""
        return encode_header(self._asked)

    def _judge_header(self) -> HeaderFields | LinkRefused | LinkEnded | None:
        """Return the other side's header if it matches ours, else the end of the link; None while it is incomplete."""
        fields = take_header(self._buffer)
        if fields is None:
            return None
        if isinstance(fields, MalformedHeader):
            return self._over(LinkEnded(fields.reason))
        if "error" in fields:
            return self._over(LinkRefused(quoted(fields["error"])))
        against = objection(self._what, self._asked.get("type", "the type"), self._asked["md5sum"], fields)
        if against:
            return self._over(LinkRefused(against))
        self._phase = _Phase.OPEN
        return fields

    def _over(self, event: LinkRefused | LinkEnded) -> LinkRefused | LinkEnded:
        self._phase = _Phase.OVER
        self._buffer = FrameBuffer()
        return event


class SubscriberLink(_OutgoingLink):
    """Connection of a subscriber to one publisher.

    Args:
        caller: this node's name.
        topic: global name.
        kind: the type that is expected, or `ANY`.
        md5: its md5 sum, or `ANY`.
        tcp_nodelay: True to ask the publisher to send small messages at once.
    """

    def __init__(self, caller: str, topic: str, kind: str, md5: str, tcp_nodelay: bool = True) -> None:
        asked = {
            "callerid": caller,
            "md5sum": md5,
            "tcp_nodelay": "1" if tcp_nodelay else "0",
            "topic": topic,
            "type": kind,
        }
        super().__init__(topic, asked)

    def receive(self, data: bytes) -> list[SubscriberEvent]:
        """Handle bytes of the publisher."""
        if self._phase is _Phase.OVER:
            return []
        self._buffer.feed(data)
        events: list[SubscriberEvent] = []
        if self._phase is _Phase.HANDSHAKE:
            fields = self._judge_header()
            if not isinstance(fields, dict):
                return [] if fields is None else [fields]
            header = TopicHeader(
                self._what,
                fields.get("type", self._asked["type"]),
                fields["md5sum"],
                fields.get("message_definition", ""),
                fields.get("latching") == "1",
            )
            events.append(PublisherAccepted(quoted(fields.get("callerid", "")), header))
        while (message := self._buffer.take(BODY_LIMIT)) is not None:
            if isinstance(message, OverlongFrame):
                return [*events, self._over(LinkRefused(f"it sends {message}"))]
            events.append(MessageReceived(message))
        return events


class ServiceClientLink(_OutgoingLink):
    """Connection of a client to a server, for one request.

    Args:
        caller: this node's name.
        service: global name.
        md5: the service type's md5 sum, or `ANY`.
        request: the request, serialised.
    """

    def __init__(self, caller: str, service: str, md5: str, request: bytes) -> None:
        super().__init__(service, {"callerid": caller, "md5sum": md5, "service": service})
        self._request = request
        self._ok: int | None = None

    def receive(self, data: bytes) -> list[ServiceClientEvent]:
        """Handle bytes of the server."""
        if self._phase is _Phase.OVER:
            return []
        self._buffer.feed(data)
        events: list[ServiceClientEvent] = []
        if self._phase is _Phase.HANDSHAKE:
            fields = self._judge_header()
            if not isinstance(fields, dict):
                return [] if fields is None else [fields]
            events.append(SendToPeer(frame(self._request)))
        return events + self._take_answer()

    def _take_answer(self) -> list[ServiceClientEvent]:
        if self._ok is None:
            self._ok = self._buffer.take_byte()
        if self._ok is None:
            return []
        body = self._buffer.take(BODY_LIMIT)
        if body is None:
            return []
        if isinstance(body, OverlongFrame):
            return [self._over(LinkEnded(f"it sends {body}"))]
        answer = body if self._ok else ServiceFailed(body.decode(errors="replace"))
        return [ServiceAnswered(answer), self._over(LinkEnded("the request is answered"))]
