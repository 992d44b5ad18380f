"""Subscriptions of a node: connections to the publishers of a topic. Broken connections are opened again."""

from __future__ import annotations

import asyncio
import functools
import logging
from asyncio import Transport
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.files.errors import reason_of
from thbridge.rosgraph.sockets.connections import HANDSHAKE_SECONDS, endpoints, keep_alive
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.replies import value_of
from thbridge.rosgraph.wire.links import LinkEnded, LinkRefused, MessageReceived, PublisherAccepted, TopicHeader
from thbridge.rosgraph.wire.outbound import SubscriberLink
from thbridge.rosgraph.wire.slave import TRANSPORT, BusConnection
from thbridge.rosgraph.wire.tcpros import LENGTH_BYTES
from thbridge.sockets.listening import check_room
from thbridge.sockets.warn_once import WarnOnce

PUBLISHER_LIMIT = 256
"""Maximum number of publishers of a topic to which the node connects. A hostile peer could report any number."""

_CONNECTING_LIMIT = 32
"""Maximum number of publishers to which the node connects at the same time."""

_SEGMENT = 16 * 1024
"""Maximum number of bytes that are processed in one round of the event loop. The smallest messages have 4 bytes."""

_FIRST_PAUSE = 0.25
"""Seconds before the first reconnection. This time doubles after each short connection."""

_LAST_PAUSE = 8.0

MessageCallback: TypeAlias = Callable[[bytes, str], None]
"""Callback with a serialized message and the name of its publisher."""

PublisherCallback: TypeAlias = Callable[[str, TopicHeader], None]
"""Callback with the name and the header of a publisher. It is called before the publisher's first message."""


def ignore_publisher(publisher: str, topic: TopicHeader) -> None:
    """Do nothing."""


_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class SubscriptionRequest:
    """Request for a subscription.

    Attributes:
        topic: global name.
        kind: type of its messages, or ``*``.
        md5: the type's md5 sum, or ``*``.
        tcp_nodelay: True to request that publishers send small messages at once.
    """

    topic: str
    kind: str
    md5: str
    tcp_nodelay: bool


class Subscription:
    """Subscription of a topic, with its publishers.

    If the master no longer lists a publisher, the open connection to the publisher remains. But if this connection
    ends, it is not opened again. The reason is that the list of a restarted master is empty at first, although
    publishers still send messages.

    Args:
        caller: this node's name.
        request: topic and type.
        on_message: called with each message. It must not raise exceptions.
        client: client for calls to publishers.
        numbers: numbers of connections, unique within the node.
        on_publisher: called with each publisher that accepts the subscription. It must not raise exceptions.
    """

    def __init__(
        self,
        caller: str,
        request: SubscriptionRequest,
        on_message: MessageCallback,
        client: XmlRpcClient,
        numbers: Iterator[int],
        on_publisher: PublisherCallback = ignore_publisher,
    ) -> None:
        self.request = request
        self._caller = caller
        self._on_message = on_message
        self._on_publisher = on_publisher
        self._client = client
        self._numbers = numbers
        self._named: dict[str, None] = {}
        self._followed: dict[str, asyncio.Task[None]] = {}
        self._listening: dict[str, _Listener] = {}
        self._connecting = asyncio.Semaphore(_CONNECTING_LIMIT)
        self._complaints = WarnOnce(_log)

    def set_publishers(self, uris: Sequence[str]) -> None:
        """Set the current publishers of the topic."""
        if len(uris) > PUBLISHER_LIMIT:
            self._complaints.warn(
                f"{self.request.topic} has more than {PUBLISHER_LIMIT} publishers; some publishers are ignored"
            )
        self._named = dict.fromkeys(uris[:PUBLISHER_LIMIT])
        for uri in self._followed.keys() - self._named.keys() - self._listening.keys():
            self._followed[uri].cancel()
        self._follow_named()

    def _follow_named(self) -> None:
        """Connect to listed publishers up to the limit. When a connection ends, another publisher gets its place."""
        for uri in self._named:
            if len(self._followed) >= PUBLISHER_LIMIT:
                break
            if uri in self._followed:
                continue
            self._followed[uri] = task = asyncio.ensure_future(self._follow(uri))
            task.add_done_callback(functools.partial(self._followed_no_more, uri))

    def _followed_no_more(self, uri: str, task: asyncio.Task[None]) -> None:
        del self._followed[uri]
        self._follow_named()

    def connections(self) -> Iterable[BusConnection]:
        """Return descriptions of the open connections for bus info."""
        return [each.connection(uri, self.request.topic) for uri, each in self._listening.items() if each.open]

    async def stop(self) -> None:
        """Close every connection."""
        self._named = {}
        tasks = [*self._followed.values()]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _follow(self, uri: str) -> None:
        pause = _FIRST_PAUSE
        while uri in self._named:
            listener = _Listener(self._link(), self._on_message, self._on_publisher, next(self._numbers))
            began = asyncio.get_running_loop().time()
            try:
                end = await self._listen(uri, listener)
            finally:
                self._listening.pop(uri, None)
                listener.cut_off()
            if isinstance(end, LinkRefused):
                self._complaints.warn(f"{uri} refuses the subscription to {self.request.topic}: {end.reason}")
            else:
                _log.debug("not subscribed to %s at %s: %s", self.request.topic, uri, end.reason)
            await asyncio.sleep(pause)
            lasted = asyncio.get_running_loop().time() - began
            # A publisher that closes each connection at once must not cause a flood of connections.
            pause = _FIRST_PAUSE if lasted > 2 * _LAST_PAUSE else min(2 * pause, _LAST_PAUSE)

    def _link(self) -> SubscriberLink:
        request = self.request
        return SubscriberLink(self._caller, request.topic, request.kind, request.md5, request.tcp_nodelay)

    async def _listen(self, uri: str, listener: _Listener) -> LinkRefused | LinkEnded:
        """Receive messages of a publisher until the connection ends."""
        # The limit applies only until the publisher's header arrives, not to the open connections.
        async with self._connecting:
            failed = await self._connect(uri, listener)
        if failed is not None:
            return failed
        self._listening[uri] = listener
        return await listener.ended

    async def _connect(self, uri: str, listener: _Listener) -> LinkEnded | None:
        """Connect to a publisher and wait for its header. Return the reason for a failure, or None."""
        # In ROS, a subscriber lists the transports that it supports, and the publisher selects one.
        reply = await self._client.call(uri, "requestTopic", self._caller, self.request.topic, [[TRANSPORT]])
        offered = value_of(uri, reply)
        match offered:
            case [str(transport), str(host), int(port)] if transport == TRANSPORT:
                pass
            case CallFailed():
                return LinkEnded(offered.reason)
            case _:
                return LinkEnded(f"it does not offer {TRANSPORT}")
        try:
            async with asyncio.timeout(HANDSHAKE_SECONDS):
                # Peers choose the publishers and their number, so these connections must leave some descriptors free.
                check_room()
                await asyncio.get_running_loop().create_connection(lambda: listener, host, port)
                await asyncio.wait((listener.accepted, listener.ended), return_when=asyncio.FIRST_COMPLETED)
        except TimeoutError:
            return LinkEnded(f"it does not answer within {HANDSHAKE_SECONDS:g} s")
        except (OSError, OverflowError, UnicodeError) as error:  # The last two: invalid port or host name.
            return LinkEnded(reason_of(error) if isinstance(error, OSError) else str(error))
        return None


class _Listener(asyncio.Protocol):
    """Connection to one publisher. It executes the events of its link."""

    def __init__(
        self, link: SubscriberLink, on_message: MessageCallback, on_publisher: PublisherCallback, number: int
    ) -> None:
        loop = asyncio.get_running_loop()
        self.accepted: asyncio.Future[None] = loop.create_future()
        self.ended: asyncio.Future[LinkRefused | LinkEnded] = loop.create_future()
        self._link = link
        self._on_message = on_message
        self._on_publisher = on_publisher
        self._number = number
        self._transport: Transport | None = None
        self._publisher = ""
        self._bytes = 0
        self._messages = 0
        self._received: deque[bytes] = deque()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if isinstance(transport, Transport):
            self._transport = transport
            keep_alive(transport)
            transport.write(self._link.opening())

    def data_received(self, data: bytes) -> None:
        self._received.extend(data[at : at + _SEGMENT] for at in range(0, len(data), _SEGMENT))
        self._handle_some()

    def _handle_some(self) -> None:
        """Process a part of the received bytes. So a flood of messages leaves time for other work."""
        transport = self._transport
        if transport is None or transport.is_closing() or not self._received:
            return
        self._handle(self._received.popleft())
        if not self._received:
            transport.resume_reading()
            return
        transport.pause_reading()
        asyncio.get_running_loop().call_soon(self._handle_some)

    def _handle(self, data: bytes) -> None:
        for event in self._link.receive(data):
            match event:
                case MessageReceived(message):
                    self._bytes += LENGTH_BYTES + len(message)
                    self._messages += 1
                    self._on_message(message, self._publisher)
                case PublisherAccepted(publisher, topic):
                    self._publisher = publisher
                    self._on_publisher(publisher, topic)
                    self.accepted.set_result(None)
                case LinkRefused() | LinkEnded():
                    self._end(event)
                    self.cut_off()

    def connection_lost(self, exc: Exception | None) -> None:
        self._end(LinkEnded("the connection is closed"))

    @property
    def open(self) -> bool:
        """True while the connection is open."""
        return self._transport is not None and not self._transport.is_closing()

    def cut_off(self) -> None:
        """Close the connection at once."""
        if self._transport is not None:
            self._transport.abort()

    def connection(self, uri: str, topic: str) -> BusConnection:
        """Return the description of this connection for bus info, while it is open."""
        ends = endpoints(self._transport) if self._transport is not None else (0, "", 0, 0)
        return BusConnection(self._number, uri, False, topic, ends, self._bytes, self._messages)

    def _end(self, end: LinkRefused | LinkEnded) -> None:
        if not self.ended.done():
            self.ended.set_result(end)
