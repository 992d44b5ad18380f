"""Topics that a node publishes, and a queue of messages for each subscriber."""

from __future__ import annotations

import logging
from asyncio import Transport
from collections import deque
from collections.abc import Iterable

from thbridge.rosgraph.sockets.connections import endpoints
from thbridge.rosgraph.wire.links import TopicHeader
from thbridge.rosgraph.wire.slave import BusConnection
from thbridge.rosgraph.wire.tcpros import frame

_log = logging.getLogger(__name__)

WAITING_LIMIT = 1 << 20
"""Maximum number of bytes in the queue for a subscriber, in addition to the message that is being sent. Above it, newer
messages are dropped. A single message may be longer.
"""


class SubscriberQueue:
    """Queue of messages for one subscriber.

    The transport reports when the socket is full (`pause`) and when it is writable again (`resume`). Between these
    reports, messages wait here. All queues refer to the same bytes, so that slow subscribers cost no copies.
    """

    def __init__(self, transport: Transport, topic: str, number: int, caller: str, address: str) -> None:
        # The transport then reports every write that the socket does not accept at once.
        transport.set_write_buffer_limits(high=0)
        self._transport = transport
        self._topic = topic
        self._number = number
        self._caller = caller
        self.address = address
        self._bytes = 0
        self._messages = 0
        self._too_slow = False
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._paused = transport.get_write_buffer_size() > 0

    def write(self, message: bytes) -> bool:
        """Send or queue a framed message. Return False if it was dropped."""
        if not self._paused:
            self._hand_over(message)
            return True
        # An empty queue accepts any message, because a single message may be longer than the limit.
        if self._waiting and self._waiting_bytes + len(message) > WAITING_LIMIT:
            if not self._too_slow:
                self._too_slow = True
                _log.warning("%s reads %s too slowly; some messages are dropped", self._caller, self._topic)
            return False
        self._waiting.append(message)
        self._waiting_bytes += len(message)
        return True

    def pause(self) -> None:
        """Record that the socket is full."""
        self._paused = True

    def resume(self) -> None:
        """Record that the socket is writable again, and send queued messages."""
        self._paused = False
        while self._waiting and not self._paused:  # The transport may pause this queue again at each message.
            message = self._waiting.popleft()
            self._waiting_bytes -= len(message)
            self._hand_over(message)

    def close(self) -> None:
        """Send all queued messages, and then close the connection."""
        for message in self._waiting:
            self._hand_over(message)
        self._waiting.clear()
        self._transport.close()

    def connection(self) -> BusConnection:
        """Return the description of this connection for bus info."""
        ends = endpoints(self._transport)
        return BusConnection(self._number, self._caller, True, self._topic, ends, self._bytes, self._messages)

    @property
    def open(self) -> bool:
        """True while the connection is open."""
        return not self._transport.is_closing()

    def _hand_over(self, message: bytes) -> None:
        if self.open:
            self._transport.write(message)
            self._bytes += len(message)
            self._messages += 1


class Publication:
    """Topic that this node publishes. `RosNode.advertise` returns it.

    Attributes:
        topic: description of the topic.
        dropped: number of messages that were dropped because of a full queue. A message counts once for each
            subscriber with a full queue.
    """

    def __init__(self, topic: TopicHeader) -> None:
        self.topic = topic
        self.dropped = 0
        self._outlets: list[SubscriberQueue] = []
        self._last: bytes | None = None

    @property
    def subscribers(self) -> int:
        """Number of connected subscribers."""
        return len(self._outlets)

    def subscribers_at(self, address: str) -> int:
        """Return the number of subscribers connected from an address."""
        return sum(outlet.address == address for outlet in self._outlets)

    def publish(self, data: bytes) -> None:
        """Send a serialized message to every subscriber, without waiting. This never fails."""
        if not self._outlets and not self.topic.latched:
            return
        message = frame(data)
        if self.topic.latched:
            self._last = message
        for outlet in self._outlets:
            if not outlet.write(message):
                self.dropped += 1

    def add(self, outlet: SubscriberQueue) -> None:
        """Add a subscriber. If the topic is latched, the subscriber gets the last message at once."""
        self._outlets.append(outlet)
        if self._last is not None:
            outlet.write(self._last)

    def remove(self, outlet: SubscriberQueue) -> None:
        """Remove a subscriber."""
        self._outlets.remove(outlet)

    def connections(self) -> Iterable[BusConnection]:
        """Return descriptions of the subscribers' connections for bus info."""
        return [outlet.connection() for outlet in self._outlets if outlet.open]
