"""Broadcast of a session's ROS messages to listeners: a bag, a ROS graph, a watch server."""

from collections.abc import Iterable, Sequence
from typing import Protocol

from sim.common.grid import OccupancyGrid
from sim.team import TeamSnapshot
from thbridge.ros.messages.records import Record
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.publisher import RosMessage, TeamPublisher


class Listener(Protocol):
    """Receiver of a session's messages."""

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        """Receive the messages of one tick. Ticks are in order. If this raises an exception, the session ends."""


class Broadcast:
    """Conversion of ticks into messages, once for all listeners, so that live and recorded messages are equal.

    Args:
        publisher: publisher of the team.
        session: the record from which the session can be replayed. It is sent first.
        grid: the map.
        listeners: receivers of the messages. They get the first messages at once.
    """

    def __init__(
        self, publisher: TeamPublisher, session: SessionRecord, grid: OccupancyGrid, listeners: Iterable[Listener]
    ) -> None:
        self._publisher = publisher
        self._listeners = tuple(listeners)
        self._send(0, publisher.opening(0, session, grid))

    def record(self, snapshot: TeamSnapshot, records: Iterable[Record] = ()) -> None:
        """Send the messages of one tick. Ticks are in order, from 0. Exceptions of listeners are raised."""
        self._send(snapshot.tick, self._publisher.tick(snapshot, records))

    def _send(self, tick: int, messages: Sequence[RosMessage]) -> None:
        for listener in self._listeners:
            listener.take(tick, messages)
