"""Broadcast of a session's ROS messages to listeners: a bag, a ROS graph, a watch server."""

from collections.abc import Callable, Iterable, Sequence
from typing import Protocol, runtime_checkable

from sim.common.grid import OccupancyGrid
from sim.snapshot import TeamSnapshot
from thbridge.ros.messages.records import Record
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.publisher import RosMessage, TeamPublisher

HELD_TICKS = 25
"""Most ticks whose messages are made together. The messages of a recorded tick then take a third less time."""

HELD_OUTPUTS = 250
"""Most outputs of robots whose messages are made together. In real time, this delays a tick by a few milliseconds."""


class Listener(Protocol):
    """Receiver of a session's messages."""

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        """Receive messages up to a tick. Ticks are in order. If this raises an exception, the session ends."""


@runtime_checkable
class PatientListener(Listener, Protocol):
    """Receiver that can wait for the messages of several ticks. It fetches all messages before it needs them."""

    @property
    def is_due(self) -> bool:
        """True if it needs all messages now, for example because a bag must be synced."""

    def fetch_with(self, fetch: Callable[[], None]) -> None:
        """Call `fetch`, which sends all messages so far, before the end of the messages."""


class Broadcast:
    """Conversion of ticks into messages, once for all listeners, so that live and recorded messages are equal.

    If all listeners are patient, the messages of several ticks are made together.

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
        self._held: list[tuple[TeamSnapshot, Sequence[Record]]] = []
        self._patient = [listener for listener in self._listeners if isinstance(listener, PatientListener)]
        all_wait = len(self._patient) == len(self._listeners)
        self._most = min(HELD_TICKS, HELD_OUTPUTS // max(publisher.robots, 1)) if all_wait else 1
        for listener in self._patient:
            listener.fetch_with(self.flush)
        self._send(0, publisher.opening(0, session, grid))

    def record(self, snapshot: TeamSnapshot, records: Iterable[Record] = ()) -> None:
        """Send the messages of one tick, now or later. Ticks are in order, from 0. Exceptions of listeners are raised.

        A snapshot and its records must not change afterwards.
        """
        self._held.append((snapshot.read_costmaps(), tuple(records)))
        if len(self._held) >= self._most or any(listener.is_due for listener in self._patient):
            self.flush()

    def flush(self) -> None:
        """Send the messages of all ticks so far."""
        if self._held:
            held, self._held = self._held, []
            self._send(held[-1][0].tick, self._publisher.ticks(held))

    def _send(self, tick: int, messages: Sequence[RosMessage]) -> None:
        for listener in self._listeners:
            listener.take(tick, messages)
