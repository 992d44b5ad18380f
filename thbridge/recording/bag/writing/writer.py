"""Recording of a session in a bag. A program that is killed at any time loses at most the last second."""

import logging
import time
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Self

from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.options import Compression, SplitLimits
from thbridge.recording.bag.records import BagConnection
from thbridge.recording.bag.writing.chunks import Chunk, ChunkBuilder
from thbridge.recording.bag.writing.disk import BEHIND_SECONDS, BagDisk, BagNotWritten
from thbridge.recording.bag.writing.formats import MCAP_FILE, ROS1_BAG
from thbridge.recording.bag.writing.parts import QueuedChunk
from thbridge.recording.bag.writing.worker import JobQueue, WorkerThread
from thbridge.recording.recordings import is_of_ros2
from thbridge.ros.names import CALLER
from thbridge.ros.topics import MessageFilter, RosMessage, Topic
from thbridge.ros2.message_copies import MessageCopy
from thbridge.ros2.recorded_types import recorded_type

SYNC_SECONDS = 0.5
"""Wall time after which all messages so far are forced onto the disk, in seconds. At most one second may be lost; half
of this second is reserved for delays of a busy machine."""

HOLD_SECONDS = 0.1
"""Wall time after which held messages must be written, in seconds. A power failure while a complete chunk overwrites
its preview can cost the chunk and all held messages, together less than a second."""

WHOLE = SplitLimits()
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class ForeignTopic:
    """A topic of another node, with exactly that node's definition.

    Attributes:
        name: name of the topic.
        msgtype: for example "nav_msgs/Odometry".
        md5: md5 sum of the type.
        definition: definition of the type, with the definitions of the types in it.
        caller: name of the node.
        latched: True if late subscribers get the last message.
    """

    name: str
    msgtype: str
    md5: str
    definition: str
    caller: str
    latched: bool


def _nothing() -> None:
    """Do nothing."""


class BagWriter:
    """Writer of messages into `PATH.active`, which is renamed to `PATH` (or `NAME_0.bag`, ...) when it is closed.

    Use it as a context manager: the bag is completed even if the block ends with an error. Equal messages give equal
    bytes. Threads compress and write, so a disk that is slow for a while does not delay the session.

    Args:
        path: path of the finished bag: `*.bag`, or `*.mcap` or a folder for the formats of ROS 2.
        definitions: definitions of message types; by default, definitions that are the same on every machine.
        clock: monotonic clock, seconds, for the times of syncing.
        compression: compression of the bag's chunks.
        splitting: limits after which the recording continues in another file.
        make_queue: factory of the two job queues, given a name for each.
        caller: name of the node that publishes the messages.
        keep: filter that returns the messages to write.

    Raises:
        BagNotWritten: the bag exists already, or the folder cannot be written to.
    """

    def __init__(
        self,
        path: Path,
        definitions: Definitions | None = None,
        clock: Callable[[], float] = time.monotonic,
        compression: Compression = Compression.NONE,
        splitting: SplitLimits = WHOLE,
        make_queue: Callable[[str], JobQueue] = WorkerThread,
        caller: str = CALLER,
        keep: MessageFilter = list,
    ) -> None:
        self.path = path
        self._keep = keep
        self._caller = caller
        self._definitions = definitions or Definitions()
        self._clock = clock
        self._splitting = splitting
        self._form = MCAP_FILE if is_of_ros2(path) else ROS1_BAG
        self._connections: dict[Topic | ForeignTopic, BagConnection] = {}
        self._omitted: set[ForeignTopic] = set()
        self._to_cdr: dict[BagConnection, MessageCopy] = {}
        self._latched: dict[BagConnection, bytes] = {}
        self._latched_before: tuple[tuple[BagConnection, bytes], ...] = ()
        self._chunks = ChunkBuilder(self._form.layout)
        self._first_ns: int | None = None
        self._stamp_ns = -1
        self._period = 0
        self._open = True
        self._disk = BagDisk(path, compression, splitting, make_queue, self._form)
        self._synced = self._taken = clock()
        self._fetch: Callable[[], None] = _nothing

    def fetch_with(self, fetch: Callable[[], None]) -> None:
        """Call `fetch` before the bag is completed. The function gives the messages that it still has to this bag."""
        self._fetch = fetch

    @property
    def is_due(self) -> bool:
        """True if all messages so far must be written now, so that a crash loses at most a second."""
        now = self._clock()
        return now - self._taken >= HOLD_SECONDS or now - self._synced >= SYNC_SECONDS

    def write(self, message: RosMessage) -> None:
        """Write one message, unless it is filtered out; a topic's connection is made with its first message.

        Raises:
            BagNotWritten: the disk is full, unavailable or too slow. The bag is closed, and the messages in it are
                kept.
            ValueError: the message is older than the last message, or the bag is closed.
        """
        for topic, stamp_ns, data, _ in self._keep((message,)):
            self._add(topic, stamp_ns, data)

    def write_foreign(self, source: ForeignTopic, stamp_ns: int, data: bytes) -> None:
        """Write one message of another node. Raise the same errors as `write`.

        A recording of ROS 2 omits messages that do not match the definition of their topic, and logs this once.
        """
        if self._form is MCAP_FILE:
            try:
                recorded_type(source.msgtype, source.definition).from_ros1(data)
            except ValueError as error:
                if source not in self._omitted:
                    self._omitted.add(source)
                    _log.warning("%s of %s: messages are not recorded (%s)", source.name, source.caller, error)
                return
        self._add(source, stamp_ns, data)

    def take(self, tick: int, messages: Iterable[RosMessage]) -> None:
        """Write the messages up to a tick, and sync if that is due. Raise the same errors as `write`."""
        kept = self._keep(messages)
        if kept:
            topics, stamps, data, _ = zip(*kept, strict=True)
            begin, count = 0, len(stamps)
            while begin < count:
                stamp_ns = stamps[begin]
                # Stamps are in order, so the messages with an equal stamp follow one after the other.
                end = bisect_right(stamps, stamp_ns, begin)
                self._add_all(topics[begin:end], stamp_ns, data[begin:end])
                begin = end
        self.sync_if_due()
        self._taken = self._clock()

    def sync_if_due(self) -> None:
        """Force everything onto the disk if `SYNC_SECONDS` have passed. Call this at much shorter intervals.

        Raises:
            BagNotWritten: for the same reasons as `write`.
        """
        if not self._open:
            return
        self._check_failures()
        if self._clock() - self._synced < SYNC_SECONDS:
            return
        self._check()
        self._disk.sync(self._piece(self._chunks.snapshot()) if self._chunks.size else None)
        self._synced = self._clock()
        self._check()

    @property
    def is_idle(self) -> bool:
        """True if a copy of this process could continue the recording from here; see `rewind`."""
        return self._open and not self._splitting.wanted and self._disk.is_idle

    def rewind(self) -> None:
        """Continue the recording in a copy of the process that has died, from the point at which the copy was made.

        What the process wrote after this point is dropped.
        """
        self._disk.rewind()

    def close(self) -> None:
        """Complete the bag and give it its final name; a second call does nothing.

        Raises:
            BagNotWritten: the disk is full, unavailable or too slow.
        """
        if not self._open:
            return
        try:
            self._fetch()
        finally:
            self._complete()

    def _complete(self) -> None:
        if not self._open:
            return
        self._give_chunk()
        in_time = self._disk.finish()
        self._check_failures()
        self._open = False
        if not in_time:
            raise self._disk.stuck()
        self._disk.end()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def _add_all(self, topics: Sequence[Topic], stamp_ns: int, messages: Sequence[bytes]) -> None:
        """Add messages of one stamp."""
        self._turn_to(stamp_ns)
        connections = [self._connections.get(topic) or self._connect(topic) for topic in topics]
        if self._to_cdr:
            messages = [self._to_cdr[of](data) for of, data in zip(connections, messages, strict=True)]
        if not self._chunks.add_all(connections, stamp_ns, messages):
            for topic, connection, data in zip(topics, connections, messages, strict=True):
                self._put(topic, connection, stamp_ns, data)
        elif self._splitting.wanted:
            latched = zip(connections, messages, strict=True)
            self._latched.update((connection, data) for connection, data in latched if connection.latching)

    def _add(self, topic: Topic | ForeignTopic, stamp_ns: int, data: bytes) -> None:
        connection = self._connections.get(topic) or self._connect(topic)
        self._put(topic, connection, stamp_ns, self._to_cdr[connection](data) if self._to_cdr else data)

    def _put(self, topic: Topic | ForeignTopic, connection: BagConnection, stamp_ns: int, data: bytes) -> None:
        self._turn_to(stamp_ns)
        self._chunks.add(connection, stamp_ns, data)
        if topic.latched:
            self._latched[connection] = data

    def _turn_to(self, stamp_ns: int) -> None:
        """Prepare for a message with this stamp: check the stamp, and begin another chunk if that is due."""
        if stamp_ns != self._stamp_ns or not self._open:
            self._go_on_to(stamp_ns)
        if not self._chunks.accepts(stamp_ns):
            self._hand_over()

    def _go_on_to(self, stamp_ns: int) -> None:
        """Continue with another stamp."""
        if not self._open:
            raise ValueError(f"{self.path} is closed")
        if self._first_ns is None:
            self._first_ns = stamp_ns
        elif stamp_ns < self._stamp_ns:
            raise ValueError(f"a message at {stamp_ns} ns after a message at {self._stamp_ns} ns")
        self._stamp_ns = stamp_ns
        period = (stamp_ns - self._first_ns) // self._splitting.duration_ns if self._splitting.duration_ns else 0
        if self._chunks.size and period != self._period:
            self._hand_over()
        self._period = period

    def _connect(self, topic: Topic | ForeignTopic) -> BagConnection:
        number = self._form.first_number + len(self._connections)
        if isinstance(topic, ForeignTopic):
            connection = BagConnection(
                number, topic.name, topic.msgtype, topic.md5, topic.definition, topic.caller, topic.latched
            )
        else:
            definition = self._definitions.of(topic.msgtype)
            connection = BagConnection(
                number, topic.name, topic.msgtype, definition.md5, definition.text, self._caller, topic.latched
            )
        if self._form is MCAP_FILE:
            theirs = recorded_type(connection.msgtype, connection.definition)
            connection = replace(connection, msgtype=theirs.name, definition=theirs.definition, md5=theirs.hash)
            self._to_cdr[connection] = theirs.from_ros1
        self._connections[topic] = connection
        return connection

    def _hand_over(self) -> None:
        """Submit the chunk, and check that the disk is fast enough."""
        self._give_chunk()
        self._disk.keep_up()
        self._check()

    def _give_chunk(self) -> None:
        if self._chunks.size:
            piece = self._piece(self._chunks.take())
            self._latched_before = tuple(self._latched.items()) if self._splitting.wanted else ()
            self._disk.append(piece)

    def _piece(self, chunk: Chunk) -> QueuedChunk:
        return QueuedChunk(chunk, self._latched_before, self._period)

    def _check(self) -> None:
        """Raise BagNotWritten when the disk failed or is too slow."""
        self._check_failures()
        if (behind := self._disk.behind) > BEHIND_SECONDS:
            self._complete()
            problem = f"the disk is too slow: it was {behind:.0f} s behind"
            remedy = "the file has everything up to now; record onto a faster disk"
            raise BagNotWritten(self._disk.last, problem, remedy)

    def _check_failures(self) -> None:
        if (failure := self._disk.failure) is not None:
            # The file may be intact: perhaps only its folder was deleted, or another file has its name.
            self._give_chunk()
            self._open = False
            raise self._disk.saved(failure)
