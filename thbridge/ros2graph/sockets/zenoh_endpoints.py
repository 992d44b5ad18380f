"""Publishers, subscriptions, servers and clients on zenoh."""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Container
from functools import partial
from math import inf

import zenoh
from zenoh import ext
from zenoh.handlers import Callback

from thbridge.ros2.qos import DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.sockets.carrier import OnMessage, OnRequest
from thbridge.ros2graph.sockets.last_items import ClientShares, LastItems
from thbridge.ros2graph.sockets.zenoh_link import ZenohLink
from thbridge.ros2graph.wire.zenoh.attachments import Attachment
from thbridge.ros2graph.wire.zenoh.graph import UNANNOUNCED
from thbridge.ros2graph.wire.zenoh.keys import EndpointKeys
from thbridge.sockets.warn_once import WarnOnce

_warnings = WarnOnce(logging.getLogger(__name__))

_HEARTBEAT_SECONDS = 0.5
"""Period in which publishers of latched topics repeat the number of their last message, as in rmw_zenoh."""
_PART = 0.25
"""Part of their lifespan by which messages may be kept longer."""
_PRIORITY = zenoh.Priority.DATA_LOW
"""Priority of messages, below that of responses. zenoh has a queue for each priority and peer. In the same queue, a
response that waits for a slow client would delay the messages for all other programs."""
_CALL_SECONDS = 24 * 3600
"""Seconds until a call of a service fails. Results of actions may take long."""
_PAUSE_SECONDS = 0.002
"""Seconds that a thread of zenoh waits after a message or request that was dropped. So floods leave processor time for
the event loop, because Python runs one thread at a time."""
_MOST_WAITING = 32
"""Maximum number of requests of a service that wait for the event loop."""
_MOST_OPEN = 256
"""Maximum number of requests of a service that wait for the event loop, or for their response. See `ClientShares`."""
_REFUSED_BYTES = 1000
"""Number of bytes that a refused request keeps until it is ended, in addition to its content."""


class ZenohWriter:
    """Publisher on zenoh.

    Args:
        count: function that returns the number of matched subscriptions.
    """

    def __init__(self, link: ZenohLink, keys: EndpointKeys, qos: QosProfile, count: Callable[[], int]) -> None:
        self._gid = keys.gid
        self._count = count
        self._number = 0
        self._publishers = _Publishers(link, keys.data, qos)
        self._pending = LastItems(qos.depth, lambda job: link.call(lambda _: job()), self._publishers.put)

    @property
    def readers(self) -> int:
        """Number of matched subscriptions of other programs."""
        return self._count()

    def write(self, message: bytes) -> None:
        """Send a message to all matched subscriptions. This never waits."""
        self._number += 1
        attachment = Attachment(self._number, time.time_ns(), self._gid).write()
        self._pending.push((message, attachment), len(message))


class _Publishers:
    """Publisher of a topic, or several of them one after the other if its messages have a lifespan.

    A publisher of zenoh keeps its last messages as long as it exists. So a publisher gets messages for a part of the
    lifespan only. Then another one replaces it, and it ends when its last message expires.
    """

    def __init__(self, link: ZenohLink, key: str, qos: QosProfile) -> None:
        self._link = link
        self._key = key
        self._qos = qos
        self._lifespan = inf if qos.lifespan_ns is None else qos.lifespan_ns / 1e9
        self._session: zenoh.Session | None = None
        self.declared: deque[tuple[float, zenoh.Publisher | ext.AdvancedPublisher]] = deque()
        link.keep(self)
        link.call(self._declare)

    def put(self, item: tuple[bytes, bytes]) -> None:
        """Send a message and its attachment, on the thread of the link."""
        if self._session is None:
            return
        if not self.declared or time.monotonic() > self.declared[-1][0] + _PART * self._lifespan:
            self._declare(self._session)
        self.declared[-1][1].put(item[0], attachment=item[1])

    def _declare(self, session: zenoh.Session) -> None:
        self._session = session
        self.declared.append((time.monotonic(), _publisher(session, self._key, self._qos)))
        if self._lifespan < inf:
            self._link.call_later((1 + _PART) * self._lifespan, self._expire)

    def _expire(self, _: zenoh.Session) -> None:
        self.declared.popleft()  # zenoh withdraws the declaration of an object that is gone.


class ZenohClient:
    """Client of a service on zenoh.

    Args:
        has_server: function that returns True if a server is known.
    """

    def __init__(self, link: ZenohLink, keys: EndpointKeys, has_server: Callable[[], bool]) -> None:
        self._link = link
        self._keys = keys
        self._has_server = has_server
        self._number = 0
        self._closed = False

    @property
    def has_server(self) -> bool:
        """True if a server is known."""
        return self._has_server()

    def call(self, request: bytes, on_response: Callable[[bytes], None]) -> None:
        """Send a request. The callback gets the first response."""
        self._number += 1
        attachment = Attachment(self._number, time.time_ns(), self._keys.gid).write()
        answered = False

        def deliver(response: bytes) -> None:
            nonlocal answered
            if not (answered or self._closed):
                answered = True
                on_response(response)

        pending = LastItems(1, self._link.wake, deliver)

        def take(reply: zenoh.Reply) -> None:
            if reply.ok is not None and not answered:
                response = reply.ok.payload.to_bytes()
                pending.push(response, len(response))

        def send(session: zenoh.Session) -> None:
            session.get(
                self._keys.data,
                Callback(take, indirect=False),
                target=zenoh.QueryTarget.ALL_COMPLETE,
                consolidation=zenoh.ConsolidationMode.NONE,
                timeout=_CALL_SECONDS,
                payload=request,
                attachment=attachment,
            )

        self._link.call(send)

    def close(self) -> None:
        """Leave the graph. No further response is delivered."""
        if not self._closed:
            self._closed = True
            self._link.withdraw(self._keys.liveliness)


def subscribe(
    link: ZenohLink, keys: EndpointKeys, qos: QosProfile, on_message: OnMessage, own: Container[bytes]
) -> None:
    """Subscribe to the messages of other programs.

    Args:
        own: gids of this program's publishers. Their latched messages would arrive, too.
    """
    pending = LastItems[tuple[bytes, bytes]](qos.depth, link.wake, lambda item: on_message(*item))

    def take(sample: zenoh.Sample) -> None:
        attachment = _attachment(sample.attachment, keys.data)
        # The library's enumerations have no single instances, so "is" does not compare them.
        if attachment is not None and attachment.gid not in own and sample.kind == zenoh.SampleKind.PUT:
            message = sample.payload.to_bytes()
            if not pending.push((message, attachment.gid), len(message)):
                _warnings.warn(f"{keys.data}: messages arrive faster than they are read; the last {qos.depth} are kept")
                time.sleep(_PAUSE_SECONDS)

    link.call(lambda session: link.keep(_subscriber(session, keys.data, qos, Callback(take, indirect=False))))


def serve(link: ZenohLink, keys: EndpointKeys, on_request: OnRequest, node_of: Callable[[bytes], str]) -> None:
    """Serve requests of other programs.

    Args:
        node_of: function that returns the name of the node of a client's gid. Clients of a node share its limits.
    """
    places = ClientShares(_MOST_OPEN)

    def begin(item: tuple[bytes, _Response]) -> None:
        on_request(item[0], item[1].gid, item[1])

    pending = LastItems(_MOST_WAITING, link.wake, begin)

    def end(query: zenoh.Query, client: str) -> None:
        kept = 0 if query.payload is None else len(query.payload)
        if not link.reply(client, query.drop, _REFUSED_BYTES + kept):
            query.drop()

    def take(query: zenoh.Query) -> None:
        # The end of a request waits for its client. On this thread, all other clients would wait, too.
        attachment = _attachment(query.attachment, keys.data)
        if attachment is None or query.payload is None:
            end(query, UNANNOUNCED)
            return
        client, request = node_of(attachment.gid), query.payload.to_bytes()
        fits = places.take(client, 1)
        if fits:
            response = _Response(link, keys.data, attachment, query, client, partial(places.give_back, client, 1))
            fits = pending.push((request, response), len(request))
        else:
            end(query, client)
        if not fits:
            _warnings.warn(f"{keys.data}: too many requests wait; further ones are refused")
            time.sleep(_PAUSE_SECONDS)

    def declare(session: zenoh.Session) -> None:
        link.keep(session.declare_queryable(keys.data, Callback(take, indirect=False), complete=True))

    link.call(declare)


class _Response:
    """Function that sends the response to a request, once.

    Responses, and the end of requests without a response, wait for clients that do not read. So both happen on threads
    of their own.

    Args:
        client: name of the client's node.
        give_back: function that gives back the place of this request among those that wait.
    """

    def __init__(
        self,
        link: ZenohLink,
        data: str,
        request: Attachment,
        query: zenoh.Query,
        client: str,
        give_back: Callable[[], None],
    ) -> None:
        self.gid = request.gid
        self._client = client
        self._link = link
        self._data = data
        self._request = request
        self._query: zenoh.Query | None = query
        self._give_back = give_back

    def __call__(self, response: bytes) -> None:
        query = self._query
        if query is None:
            return
        attachment = Attachment(self._request.number, time.time_ns(), self.gid).write()
        send = partial(query.reply, self._data, response, attachment=attachment)
        if self._link.reply(self._client, partial(_end, query, self._give_back, send), len(response)):
            self._query = None
        else:
            _warnings.warn(f"{self._data}: too many responses wait to be sent; some are dropped")

    def __del__(self) -> None:
        query = self._query
        if query is not None:
            link, client, end = self._link, self._client, partial(_end, query, self._give_back)
            # Garbage collection may come here while its thread has any lock, and this call waits for none.
            link.call(lambda _: link.reply(client, end, 0))


def _end(query: zenoh.Query, give_back: Callable[[], None], send: Callable[[], None] = lambda: None) -> None:
    """Send a response, if there is one, and end the request."""
    try:
        send()
        query.drop()
    finally:
        give_back()


def _attachment(data: zenoh.ZBytes | None, key: str) -> Attachment | None:
    """Return the attachment of a message or request. If it is missing or invalid, log this once and return None."""
    attachment = None if data is None else Attachment.read(data.to_bytes())
    if attachment is None:
        _warnings.warn(f"{key}: a message without a valid attachment is dropped; its program is no rmw_zenoh")
    return attachment


def _publisher(session: zenoh.Session, key: str, qos: QosProfile) -> zenoh.Publisher | ext.AdvancedPublisher:
    is_reliable = qos.reliability is DeliveryReliability.RELIABLE
    reliability = zenoh.Reliability.RELIABLE if is_reliable else zenoh.Reliability.BEST_EFFORT
    drop = zenoh.CongestionControl.DROP
    if qos.durability is Durability.VOLATILE:
        return session.declare_publisher(key, reliability=reliability, congestion_control=drop, priority=_PRIORITY)
    misses = ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=_HEARTBEAT_SECONDS)
    return ext.declare_advanced_publisher(
        session,
        key,
        reliability=reliability,
        congestion_control=drop,
        priority=_PRIORITY,
        cache=ext.CacheConfig(max_samples=qos.depth),
        sample_miss_detection=misses if is_reliable else None,
        publisher_detection=True,
    )


def _subscriber(
    session: zenoh.Session, key: str, qos: QosProfile, take: Callback[zenoh.Sample]
) -> zenoh.Subscriber[None] | ext.AdvancedSubscriber[None]:
    origin = zenoh.Locality.REMOTE
    if qos.durability is Durability.VOLATILE:
        return session.declare_subscriber(key, take, allowed_origin=origin)
    recovery = ext.RecoveryConfig(periodic_queries=None, heartbeat=True)
    return ext.declare_advanced_subscriber(
        session,
        key,
        take,
        allowed_origin=origin,
        history=ext.HistoryConfig(detect_late_publishers=True, max_samples=qos.depth),
        recovery=recovery if qos.reliability is DeliveryReliability.RELIABLE else None,
        subscriber_detection=True,
    )
