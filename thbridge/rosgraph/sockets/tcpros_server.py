"""TCPROS port of a node. Subscribers to its topics and clients of its services connect to it."""

from __future__ import annotations

import asyncio
import logging
from asyncio import Transport
from collections import Counter, deque
from collections.abc import Awaitable, Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.rosgraph.sockets.connections import HANDSHAKE_SECONDS, close_gently, keep_alive
from thbridge.rosgraph.sockets.publications import WAITING_LIMIT, Publication, SubscriberQueue
from thbridge.rosgraph.wire.inbound import InboundLink
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
)
from thbridge.rosgraph.wire.slave import BusConnection
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.listening import ServerDoor
from thbridge.sockets.warn_once import WarnOnce

CONNECTION_LIMIT = 8192
"""Maximum number of connections of subscribers and clients.

One address may have at most three quarters of this number. This is enough for four recorders of all topics of 64
robots.
"""
_WEIGHT = 4
"""Weight of this server if servers share few file descriptors. It is high, because a recorder has a connection for each
topic."""

TOPIC_LIMIT = 64
"""Maximum number of subscribers of one topic at one address. Each subscriber costs a copy of every message."""

_REQUESTS_AT_ONCE = 4
"""Maximum number of requests of a connection that are answered in one round of the event loop. One segment may contain
tens of thousands of requests."""

ANSWERING_LIMIT = 64
"""Maximum number of pending requests. A client may disconnect and send its request again before it has its answer."""

_FAREWELL_SECONDS = 1.0
"""Seconds at the end in which all subscribers can read their last messages."""

ServiceAnswer: TypeAlias = bytes | ServiceFailed
ServiceHandler: TypeAlias = Callable[[bytes], ServiceAnswer | Awaitable[ServiceAnswer]]
"""Function that answers a serialized request, at once or later."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class _Served:
    service: ServiceHeader
    handler: ServiceHandler


class TcprosServer:
    """Server for the topics and services of a node.

    Args:
        caller: the node's name.
        numbers: numbers of connections, unique within the node.
    """

    def __init__(self, caller: str, numbers: Iterator[int], admission: Admission = OWN_MACHINE) -> None:
        self.admission = admission
        self.caller = caller
        self.numbers = numbers
        self.publications: dict[str, Publication] = {}
        self.complaints = WarnOnce(_log)
        self._services: dict[str, _Served] = {}
        self._connections: dict[_Inbound, None] = {}
        self._addresses: Counter[str] = Counter()
        # New connections may replace these connections, the oldest first.
        self._silent: dict[_Inbound, None] = {}
        self._clients: dict[_Inbound, None] = {}
        self._one_gone = asyncio.Event()
        self._answering: set[asyncio.Task[None]] = set()
        self._door = ServerDoor(CONNECTION_LIMIT, _WEIGHT)

    async def start(self, host: str) -> ListeningAddress | CannotListen:
        """Listen on a free port."""
        try:
            return await self._door.listen(lambda: _Inbound(self), host, 0)
        except (OSError, UnicodeError) as error:
            return CannotListen.because(error, host, 0)

    async def stop(self) -> None:
        """Close the port, cancel pending requests, and close every connection.

        Subscribers have a moment to read the last messages.
        """
        self._door.close()
        for task in self._answering:
            task.cancel()
        for connection in tuple(self._connections):
            connection.close()
        with suppress(TimeoutError):
            async with asyncio.timeout(_FAREWELL_SECONDS):
                while self._connections:
                    self._one_gone.clear()
                    await self._one_gone.wait()
        for connection in tuple(self._connections):
            connection.cut_off()

    def offer(self, topic: TopicHeader) -> Publication:
        """Publish a topic."""
        publication = self.publications[topic.name] = Publication(topic)
        return publication

    def serve(self, service: ServiceHeader, handler: ServiceHandler) -> None:
        """Serve a service."""
        self._services[service.name] = _Served(service, handler)

    def topic(self, name: str) -> TopicHeader | None:
        """Return the topic of this name if this node publishes it."""
        publication = self.publications.get(name)
        return publication.topic if publication else None

    def service(self, name: str) -> ServiceHeader | None:
        """Return the service of this name if this node serves it."""
        served = self._services.get(name)
        return served.service if served else None

    def connections(self) -> Iterable[BusConnection]:
        """Return the subscribers' connections."""
        return [connection for each in self.publications.values() for connection in each.connections()]

    def admit(self, connection: _Inbound) -> bool:
        """Accept a new connection.

        If there are too many connections, close a connection that is not a subscriber's. If there is no such
        connection, reject the new connection.
        """
        most = self._door.most
        crowded = self._addresses[connection.address] >= most * 3 // 4
        if crowded or len(self._connections) >= most:
            limits = f"{most} connections, and {most * 3 // 4} from one address"
            self.complaints.warn(f"a connection is closed: the limits are {limits}")
            # At the limit of one address, another connection of this address must end, so that no other node suffers.
            others = (*self._silent, *self._clients)
            ended = next((one for one in others if not crowded or one.address == connection.address), None)
            if ended is None:
                return False
            ended.cut_off()
            self.forget(ended)
        self._connections[connection] = None
        self._silent[connection] = None
        self._addresses[connection.address] += 1
        return True

    def admit_subscriber(self, connection: _Inbound, topic: str) -> Publication | None:
        """Return the topic to which a connection subscribes, or None if its address has too many subscribers."""
        publication = self.publications[topic]
        if publication.subscribers_at(connection.address) >= TOPIC_LIMIT:
            self.complaints.warn(f"{connection.address} subscribes to {topic} more than {TOPIC_LIMIT} times")
            return None
        self._silent.pop(connection, None)
        return publication

    def admit_client(self, connection: _Inbound) -> None:
        """Record that a connection belongs to a client of a service."""
        if connection in self._silent:
            del self._silent[connection]
            self._clients[connection] = None

    def forget(self, connection: _Inbound) -> None:
        """Remove a closed connection."""
        if connection in self._connections:
            del self._connections[connection]
            self._addresses[connection.address] -= 1
            if not self._addresses[connection.address]:
                del self._addresses[connection.address]
        self._silent.pop(connection, None)
        self._clients.pop(connection, None)
        self._one_gone.set()

    def handle(self, service: str, request: bytes, respond: Callable[[ServiceAnswer], None]) -> ServiceAnswer | None:
        """Answer a request. Return the answer, or None if `respond` will be called with the answer later."""
        try:
            answer = self._services[service].handler(request)
        except Exception:
            return _broken(service)
        if isinstance(answer, bytes | ServiceFailed):
            return answer
        if len(self._answering) >= ANSWERING_LIMIT:
            # Python warns about coroutines that are never awaited, so the answer becomes a cancelled task.
            asyncio.ensure_future(answer).cancel()
            return ServiceFailed(f"{service} has too many pending requests")
        task = asyncio.ensure_future(_answer_in_time(service, answer, respond))
        self._answering.add(task)
        task.add_done_callback(self._answering.discard)
        return None


class _Inbound(asyncio.Protocol):
    """One connection. It executes the events of its link."""

    def __init__(self, server: TcprosServer) -> None:
        self._server = server
        self._link = InboundLink(server.caller, server)
        self.address = ""
        self._transport: Transport | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._publication: Publication | None = None
        self._outlet: SubscriberQueue | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if not isinstance(transport, Transport):
            return
        self.address = str((transport.get_extra_info("peername") or ("",))[0])  # Empty if the peer has left.
        stranger = self._server.admission.refused(transport)
        if stranger is not None:
            self._server.complaints.warn(f"a node at {stranger} is rejected: its address is in no network of open_to")
            transport.abort()
            return
        if not self._server.admit(self):
            transport.abort()
            return
        self._transport = transport
        keep_alive(transport)
        self._timer = asyncio.get_running_loop().call_later(HANDSHAKE_SECONDS, self._handshake_timed_out)

    def data_received(self, data: bytes) -> None:
        self._perform(self._link.receive(data))

    def pause_writing(self) -> None:
        if self._outlet is not None:
            self._outlet.pause()

    def resume_writing(self) -> None:
        if self._outlet is not None:
            self._outlet.resume()

    def connection_lost(self, exc: Exception | None) -> None:
        self._server.forget(self)
        if self._timer is not None:
            self._timer.cancel()
        if self._publication is not None and self._outlet is not None:
            self._publication.remove(self._outlet)
        # A pending handler continues, because it may already have moved a robot. Its answer is discarded.
        self._transport = None

    def close(self) -> None:
        """Send all data, and then close the connection."""
        if self._outlet is not None:
            self._outlet.close()
        elif self._transport is not None:
            self._transport.close()

    def cut_off(self) -> None:
        """Close the connection at once."""
        if self._transport is not None:
            self._transport.abort()

    def _handshake_timed_out(self) -> None:
        if not self._link.handshake_done:
            _log.debug("a peer is disconnected: it sends no header")
            self.cut_off()

    def _perform(self, events: Iterable[InboundEvent]) -> None:
        waiting = deque(events)
        requests = 0
        while waiting and self._transport is not None:
            requests += isinstance(waiting[0], ServiceRequested)
            if requests > _REQUESTS_AT_ONCE:
                # Until then, the link returns no further events, because it waits for the answer to this request.
                asyncio.get_running_loop().call_soon(self._perform, waiting)
                return
            match waiting.popleft():
                case SendToPeer(data):
                    self._transport.write(data)
                case SubscriberAccepted(topic, caller):
                    self._publication = self._server.admit_subscriber(self, topic)
                    if self._publication is None:
                        self._end(self._transport)
                        return
                    number = next(self._server.numbers)
                    self._outlet = SubscriberQueue(self._transport, topic, number, caller, self.address)
                    self._publication.add(self._outlet)
                case ServiceRequested() if self._transport.get_write_buffer_size() > WAITING_LIMIT:
                    _log.debug("a client is disconnected: it sends requests and does not read the answers")
                    self.cut_off()
                case ServiceRequested(service, request):
                    self._server.admit_client(self)
                    answer = self._server.handle(service, request, self._respond)
                    if answer is not None:
                        waiting.extend(self._link.respond(answer))
                case LinkRefused(reason):
                    self._server.complaints.warn(f"a peer is rejected: {reason}")
                    self._end(self._transport)
                case LinkEnded(reason):
                    _log.debug("a connection ends: %s", reason)
                    self._end(self._transport)

    def _end(self, transport: Transport) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = close_gently(transport)

    def _respond(self, answer: ServiceAnswer) -> None:
        self._perform(self._link.respond(answer))


async def _answer_in_time(
    service: str, pending: Awaitable[ServiceAnswer], respond: Callable[[ServiceAnswer], None]
) -> None:
    try:
        answer = await pending
    except Exception:
        answer = _broken(service)
    respond(answer)


def _broken(service: str) -> ServiceFailed:
    _log.exception("the service %s failed", service)
    return ServiceFailed(f"{service} failed; the log of its node shows the reason")
