"""Accepting end of a TCPROS connection, which is a publisher or the server of a service."""

from __future__ import annotations

from enum import Enum, auto
from typing import Protocol

from thbridge.rosgraph.wire.links import (
    InboundEvent,
    LinkEnded,
    LinkRefused,
    SendToPeer,
    ServiceFailed,
    ServiceHeader,
    ServiceRequested,
    SubscriberAccepted,
    TopicHeader,
    objection,
    quoted,
    take_header,
)
from thbridge.rosgraph.wire.tcpros import (
    REQUEST_LIMIT,
    FrameBuffer,
    HeaderFields,
    MalformedHeader,
    OverlongFrame,
    encode_header,
    frame,
)


class NodeOffers(Protocol):
    """Topics and services that a node offers."""

    def topic(self, name: str) -> TopicHeader | None:
        """Return the topic of this name if this node publishes it."""

    def service(self, name: str) -> ServiceHeader | None:
        """Return the service of this name if this node serves it."""


class _Phase(Enum):
    HANDSHAKE = auto()
    IDLE = auto()
    ANSWERING = auto()
    DEAF = auto()


class InboundLink:
    """Connection that another node has opened to this node as a publisher or the server of a service.

    Args:
        caller: this node's name.
        offers: topics and services of this node.
    """

    def __init__(self, caller: str, offers: NodeOffers) -> None:
        self._caller = caller
        self._offers = offers
        self._buffer = FrameBuffer()
        self._phase = _Phase.HANDSHAKE
        self._service: ServiceHeader | None = None
        self._persistent = False

    @property
    def handshake_done(self) -> bool:
        """True if the peer has sent its header."""
        return self._phase is not _Phase.HANDSHAKE

    def receive(self, data: bytes) -> list[InboundEvent]:
        """Process received bytes.

        Bytes of a subscriber after its header are ignored, because subscribers send no messages.
        """
        if self._phase is _Phase.DEAF:
            return []
        self._buffer.feed(data)
        match self._phase:
            case _Phase.HANDSHAKE:
                return self._shake_hands()
            case _Phase.IDLE:
                return self._next_request()
            case _:
                if len(self._buffer) > REQUEST_LIMIT:
                    return self._over(LinkEnded("it sends requests faster than they are answered"))
                return []

    def respond(self, answer: bytes | ServiceFailed) -> list[InboundEvent]:
        """Answer the last `ServiceRequested`."""
        if self._phase is not _Phase.ANSWERING:
            return []
        sent: list[InboundEvent] = [SendToPeer(_encode_answer(answer))]
        # By default, TCPROS uses a connection for one call of a service.
        if not self._persistent:
            return sent + self._over(LinkEnded("the request was answered"))
        self._phase = _Phase.IDLE
        return sent + self._next_request()

    def _shake_hands(self) -> list[InboundEvent]:
        fields = take_header(self._buffer)
        if fields is None:
            return []
        if isinstance(fields, MalformedHeader):
            return self._over(LinkEnded(fields.reason))
        if "topic" in fields:
            return self._meet_subscriber(fields)
        if "service" in fields:
            return self._meet_client(fields)
        return self._refuse("the header names neither a topic nor a service")

    def _meet_subscriber(self, fields: HeaderFields) -> list[InboundEvent]:
        topic = self._offers.topic(fields["topic"])
        if topic is None:
            return self._refuse(f"{self._caller} does not publish {quoted(fields['topic'])}")
        against = objection(topic.name, topic.type, topic.md5, fields)
        if against:
            return self._refuse(against)
        self._phase = _Phase.DEAF
        header = encode_header(
            {
                "callerid": self._caller,
                "latching": "1" if topic.latched else "0",
                "md5sum": topic.md5,
                "message_definition": topic.definition,
                "topic": topic.name,
                "type": topic.type,
            }
        )
        return [SendToPeer(header), SubscriberAccepted(topic.name, quoted(fields.get("callerid", "")))]

    def _meet_client(self, fields: HeaderFields) -> list[InboundEvent]:
        service = self._offers.service(fields["service"])
        if service is None:
            return self._refuse(f"{self._caller} does not serve {quoted(fields['service'])}")
        against = objection(service.name, service.type, service.md5, fields)
        if against:
            return self._refuse(against)
        header = SendToPeer(
            encode_header(
                {
                    "callerid": self._caller,
                    "md5sum": service.md5,
                    "request_type": service.request_type,
                    "response_type": service.response_type,
                    "service": service.name,
                    "type": service.type,
                }
            )
        )
        # ROS's tools send probe=1 to read a service's type without calling it.
        if fields.get("probe") == "1":
            return [header, *self._over(LinkEnded("it only requested the header"))]
        self._service = service
        self._persistent = fields.get("persistent", "").lower() in ("1", "true")
        self._phase = _Phase.IDLE
        return [header, *self._next_request()]

    def _next_request(self) -> list[InboundEvent]:
        request = self._buffer.take(REQUEST_LIMIT)
        if request is None or self._service is None:
            return []
        if isinstance(request, OverlongFrame):
            return self._over(LinkEnded(f"it sends {request}"))
        self._phase = _Phase.ANSWERING
        return [ServiceRequested(self._service.name, request)]

    def _refuse(self, reason: str) -> list[InboundEvent]:
        # In TCPROS, a header with the field error refuses a connection, and its text is for people.
        return [SendToPeer(encode_header({"error": reason})), *self._over(LinkRefused(reason))]

    def _over(self, event: LinkRefused | LinkEnded) -> list[InboundEvent]:
        self._phase = _Phase.DEAF
        self._buffer = FrameBuffer()
        return [event]


def _encode_answer(answer: bytes | ServiceFailed) -> bytes:
    # In TCPROS, one byte before the frame is 1 for a response and 0 for a failure.
    match answer:
        case ServiceFailed(reason):
            return b"\x00" + frame(reason.encode(errors="replace"))
        case response:
            return b"\x01" + frame(response)
