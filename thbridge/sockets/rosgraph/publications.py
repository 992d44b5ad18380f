"""Topics that a node publishes, and what waits for each subscriber."""

from __future__ import annotations

import logging
from asyncio import Transport
from collections import deque
from collections.abc import Iterable

from thbridge.sockets.rosgraph.connections import endpoints
from thbridge.wire.rosgraph.links import TopicHeader
from thbridge.wire.rosgraph.slave import BusConnection
from thbridge.wire.rosgraph.tcpros import frame

_log = logging.getLogger(__name__)

WAITING_LIMIT = 1 << 20
"""Bytes of messages that may wait for one subscriber behind the one under way before newer ones are dropped.

A single message may be longer.
"""


class SubscriberQueue:
    """The way to one subscriber.

    Its protocol is told by the transport when the socket takes no more (`pause`) and when it does again (`resume`).
    In between messages wait here as references to the same bytes, so however many subscribers there are, and however
    slow, a message is not copied for them.
    """

    def __init__(self, transport: Transport, topic: str, number: int, caller: str) -> None:
        transport.set_write_buffer_limits(high=0)
        self._transport = transport
        self._topic = topic
        self._number = number
        self._caller = caller
        self._bytes = 0
        self._messages = 0
        self._too_slow = False
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._paused = transport.get_write_buffer_size() > 0

    def write(self, message: bytes) -> bool:
        """Pass a framed message on, now or later; whether that was possible."""
        if not self._paused:
            self._hand_over(message)
            return True
        if self._waiting and self._waiting_bytes + len(message) > WAITING_LIMIT:
            if not self._too_slow:
                self._too_slow = True
                _log.warning("%s reads %s too slowly, and does not get all of it", self._caller, self._topic)
            return False
        self._waiting.append(message)
        self._waiting_bytes += len(message)
        return True

    def pause(self) -> None:
        """Hear that the socket takes no more."""
        self._paused = True

    def resume(self) -> None:
        """Hear that the socket takes more."""
        self._paused = False
        while self._waiting and not self._paused:  # the transport may pause us again at each
            message = self._waiting.popleft()
            self._waiting_bytes -= len(message)
            self._hand_over(message)

    def close(self) -> None:
        """Close the connection once all that waits is sent."""
        for message in self._waiting:
            self._hand_over(message)
        self._waiting.clear()
        self._transport.close()

    def connection(self) -> BusConnection:
        """This link as the node tells of it."""
        ends = endpoints(self._transport)
        return BusConnection(self._number, self._caller, True, self._topic, ends, self._bytes, self._messages)

    @property
    def open(self) -> bool:
        """Whether the connection still stands."""
        return not self._transport.is_closing()

    def _hand_over(self, message: bytes) -> None:
        if self.open:
            self._transport.write(message)
            self._bytes += len(message)
            self._messages += 1


class Publication:
    """A topic that this node publishes; made by `RosNode.advertise`.

    Attributes:
        topic: what is said of it.
        dropped: messages that did not reach a subscriber because too much waited for it already; each counts once
            per such subscriber.
    """

    def __init__(self, topic: TopicHeader) -> None:
        self.topic = topic
        self.dropped = 0
        self._outlets: list[SubscriberQueue] = []
        self._last: bytes | None = None

    @property
    def subscribers(self) -> int:
        """How many are connected."""
        return len(self._outlets)

    def publish(self, data: bytes) -> None:
        """Send a serialised message to every subscriber. It neither waits nor fails, whatever they do."""
        if not self._outlets and not self.topic.latched:
            return
        message = frame(data)
        if self.topic.latched:
            self._last = message
        for outlet in self._outlets:
            if not outlet.write(message):
                self.dropped += 1

    def add(self, outlet: SubscriberQueue) -> None:
        """Take on a subscriber; it gets the last message at once if the topic is latched."""
        self._outlets.append(outlet)
        if self._last is not None:
            outlet.write(self._last)

    def remove(self, outlet: SubscriberQueue) -> None:
        """Forget a subscriber that is gone."""
        self._outlets.remove(outlet)

    def connections(self) -> Iterable[BusConnection]:
        """The subscribers as the node tells of them."""
        return [outlet.connection() for outlet in self._outlets if outlet.open]
