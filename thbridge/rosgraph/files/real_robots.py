"""Recorder of real robots. It stores the robots' own messages unchanged, and the messages of our program.

Messages of robots are not encoded again from our values. The bag contains the robots' own bytes, types and names.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from sim.snapshot import TeamSnapshot
from thbridge.recording.bag.writing.writer import BagWriter, ForeignTopic
from thbridge.ros.messages import pack
from thbridge.ros.messages.pack import RoomLabel
from thbridge.ros.messages.records import Record
from thbridge.ros.messages.session_records import InputRecord, SessionRecord
from thbridge.ros.messages.stamps import stamp_ns, tick_of
from thbridge.ros.names import MAP_FRAME
from thbridge.ros.publisher import messages_of
from thbridge.ros.topics import INPUTS, ROOMS, SESSION, RosMessage
from thbridge.rosgraph.wire import links


class _ForeignMessage(NamedTuple):
    source: ForeignTopic
    stamp_ns: int
    data: bytes


class FleetRecorder:
    """Recorder of a `Fleet` to a bag: the `TrafficRecorder` of the fleet, and also the recorder of the session's ticks.

    Args:
        writer: empty bag. The caller closes it.
        session: first record of the bag.
        rooms: names of the map's rooms.
    """

    def __init__(self, writer: BagWriter, session: SessionRecord, rooms: Sequence[RoomLabel] = ()) -> None:
        self._writer = writer
        self._rooms = rooms
        self._session: SessionRecord | None = session
        self._waiting: list[_ForeignMessage | RosMessage] = []
        self._last_ns = 0

    def received(self, topic: links.TopicHeader, publisher: str, stamp_ns: int, data: bytes) -> None:
        """Queue a message of a robot."""
        source = ForeignTopic(topic.name, topic.type, topic.md5, topic.definition, publisher, topic.latched)
        self._waiting.append(_ForeignMessage(source, stamp_ns, data))

    def sent(self, message: RosMessage) -> None:
        """Queue a message to a robot."""
        self._waiting.append(message)

    def record(self, snapshot: TeamSnapshot, records: Iterable[Record]) -> None:
        """Write the queued messages, then the records of a tick. Raises BagNotWritten."""
        records = tuple(records)
        self.flush()
        at, tick = stamp_ns(snapshot.tick), snapshot.tick
        for record in records:
            if isinstance(record, InputRecord):
                self._write(RosMessage(INPUTS, at, pack.outside_input(tick, record)))
        for record in records:
            for message in messages_of(at, tick, record):
                self._write(message)
        self._writer.sync_if_due()

    def flush(self) -> None:
        """Write the queued messages. Raises BagNotWritten."""
        waiting, self._waiting = self._waiting, []
        for item in waiting:
            self._write(item)
        self._writer.sync_if_due()

    def _write(self, item: _ForeignMessage | RosMessage) -> None:
        if self._session is not None:
            session, self._session = self._session, None
            tick = tick_of(item.stamp_ns)
            self._write(RosMessage(SESSION, item.stamp_ns, pack.session(tick, session)))
            if self._rooms:
                self._write(RosMessage(ROOMS, item.stamp_ns, pack.room_labels(tick, MAP_FRAME, self._rooms)))
        # The time of a tick is up to 20 ms before the messages received in it. But times in a bag must not decrease.
        self._last_ns = max(self._last_ns, item.stamp_ns)
        if isinstance(item, _ForeignMessage):
            self._writer.write_foreign(item.source, self._last_ns, item.data)
        else:
            self._writer.write(item._replace(stamp_ns=self._last_ns))
