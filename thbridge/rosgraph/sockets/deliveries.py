"""Queues of the master's notifications to nodes. Nodes may be slow, silent or gone."""

from __future__ import annotations

import asyncio
import logging
from collections import OrderedDict
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from thbridge.rosgraph.wire.master import NodeShutdown, Notification, ParamUpdate, PublisherUpdate
from thbridge.sockets.warn_once import WarnOnce

AT_ONCE = 32
"""Maximum number of calls in progress to nodes that have answered the last call. The same limit applies to the calls to
all other nodes."""

MOST_WAITING = 65_536
"""Maximum number of notifications in all queues."""

_MOST_KNOWN = 4096
"""Maximum number of stored addresses that have answered."""

_Subject: TypeAlias = tuple[str, str, str]

_log = logging.getLogger(__name__)


@dataclass(slots=True)
class _Lane:
    """Addresses that wait for their turn, and number of calls in progress."""

    line: OrderedDict[str, None] = field(default_factory=OrderedDict)
    busy: int = 0


class Deliveries:
    """Queues of notifications. Each address gets its notifications in order, one at a time.

    A later notification about the same topic or parameter replaces the earlier one and moves to the end of the queue.
    Addresses that answered the last call are separate from all other addresses. So silent nodes delay only each other.

    Args:
        deliver: calls a node and returns True if the node answered.
    """

    def __init__(self, deliver: Callable[[Notification], Awaitable[bool]]) -> None:
        self._deliver = deliver
        self._waiting: dict[str, OrderedDict[_Subject, Notification]] = {}
        self._count = 0
        self._known: OrderedDict[str, None] = OrderedDict()
        self._answering, self._others = _Lane(), _Lane()
        self._calls: set[asyncio.Task[None]] = set()
        self._stopped = False
        self._complaints = WarnOnce(_log)

    @property
    def calls(self) -> int:
        """Number of calls in progress."""
        return len(self._calls)

    def post(self, notification: Notification) -> None:
        """Queue a notification.

        If too many notifications wait, drop those for an address that did not answer the last call.
        """
        address = _address_of(notification.api)
        if self._count >= MOST_WAITING and not self._drop_some(address):
            return
        waiting = self._waiting.get(address)
        if waiting is None:
            waiting = self._waiting[address] = OrderedDict()
            self._line_up(address)
        subject = _subject(notification)
        # Only the present state is of use to the node, so the earlier notification is not needed.
        self._count += waiting.pop(subject, None) is None
        waiting[subject] = notification

    async def stop(self) -> None:
        """Drop all notifications that are not delivered yet."""
        self._stopped = True
        for call in self._calls:
            call.cancel()
        await asyncio.gather(*self._calls, return_exceptions=True)

    def _drop_some(self, address: str) -> bool:
        self._complaints.warn(f"more than {MOST_WAITING} notifications wait for nodes; some notifications are dropped")
        if not self._others.line:
            return False
        dropped, _ = self._others.line.popitem(last=False)
        self._count -= len(self._waiting.pop(dropped))
        return True

    def _line_up(self, address: str) -> None:
        lane = self._answering if address in self._known else self._others
        lane.line[address] = None
        self._call_next(lane)

    def _call_next(self, lane: _Lane) -> None:
        while lane.line and lane.busy < AT_ONCE and not self._stopped:
            address, _ = lane.line.popitem(last=False)
            lane.busy += 1
            call = asyncio.get_running_loop().create_task(self._call(lane, address))
            self._calls.add(call)
            call.add_done_callback(self._calls.discard)

    async def _call(self, lane: _Lane, address: str) -> None:
        waiting = self._waiting[address]
        _, notification = waiting.popitem(last=False)
        self._count -= 1
        answered = False
        try:
            answered = await self._deliver(notification)
        finally:
            lane.busy -= 1
            self._remember(address, answered)
            # The address goes to the end of the line, so that all addresses take turns.
            if waiting:
                self._line_up(address)
            else:
                del self._waiting[address]
            self._call_next(lane)

    def _remember(self, address: str, answered: bool) -> None:
        # It is inserted again at the end, so that the first address is the one without an answer for longest.
        self._known.pop(address, None)
        if answered:
            self._known[address] = None
            if len(self._known) > _MOST_KNOWN:
                self._known.popitem(last=False)


def _address_of(api: str) -> str:
    """Return the host and port of a URI, without its path."""
    return api.partition("//")[2].partition("/")[0]


def _subject(notification: Notification) -> _Subject:
    match notification:
        case PublisherUpdate(api, topic, _):
            return api, "topic", topic
        case ParamUpdate(api, key, _):
            return api, "parameter", key
        case NodeShutdown(api, node, _):
            return api, "node", node
