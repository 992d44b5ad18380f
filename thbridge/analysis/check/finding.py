"""Values of a check: tools, severities, findings, structure of a bag; and the interface of rules."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, Protocol, TypeVar

from thbridge.analysis.check.reading import Reading
from thbridge.recording.bag.reading.scan import (
    BagHeaderRecord,
    ChunkInfoRecord,
    ChunkRecord,
    ConnectionRecord,
    UnreadableSpan,
)
from thbridge.ros.messages.types import ODOMETRY, POSE_WITH_COVARIANCE, TFMESSAGE

K = TypeVar("K")


class BagTool(StrEnum):
    """Tool for which bags are checked.

    `rosbag` means its commands info, play, check and reindex, and the topics that its command play publishes.
    """

    ROSBAG = "rosbag"
    RVIZ = "rviz"
    FOXGLOVE = "Foxglove"
    PLOTJUGGLER = "PlotJuggler"
    EVO = "evo"


class FindingSeverity(StrEnum):
    """Severity: a tool fails or shows wrong data (error), it loses data (warning), or this is only a hint (note)."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


ALL = tuple(BagTool)
TF_TYPES = (TFMESSAGE, "tf/tfMessage")
POINT = "geometry_msgs/PointStamped"
STAMPED_POSES = (ODOMETRY, POSE_WITH_COVARIANCE, "geometry_msgs/PoseStamped", "geometry_msgs/TransformStamped", POINT)
EVO_TYPES = (*STAMPED_POSES, *TF_TYPES)
"""Message types that evo reads as trajectories (evo, file_interface.py)."""


NO_TRAJECTORY = "no-trajectory"
"""Name of the rule for bags from which evo reads nothing."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Problem of a bag for some tools.

    Attributes:
        rule: short name of the rule that found the problem.
        severity: severity of the problem.
        tools: tools concerned.
        topic: topic concerned, or None if the problem concerns the whole bag.
        what: problem as a sentence, without full stop.
        remedy: remedy as a clause, without full stop.
        first_ns: record stamp of the first message concerned, or None if there is none.
        count: number of messages concerned; 0 if there are none.
    """

    rule: str
    severity: FindingSeverity
    tools: tuple[BagTool, ...]
    topic: str | None
    what: str
    remedy: str
    first_ns: int | None = None
    count: int = 0


@dataclass(slots=True)
class ScannedChunk:
    """Chunk, with the number of its messages.

    Attributes:
        chunk: record of the chunk.
        counts: number of messages in the chunk, by connection.
        indexed: number of messages by connection, according to the index data records after the chunk.
        start_ns: least stamp in the chunk, or None if there are no messages.
        end_ns: greatest stamp in the chunk, or None if there are no messages.
    """

    chunk: ChunkRecord
    counts: dict[int, int]
    indexed: dict[int, int]
    start_ns: int | None = None
    end_ns: int | None = None


@dataclass(frozen=True, slots=True)
class BagStructure:
    """Bag without the contents of its messages.

    Attributes:
        header: first record; None if it cannot be read.
        connections: connections by number.
        counts: number of messages read, by connection.
        chunks: chunks in the order of the file.
        index: chunk info records of the index.
        indexed_connections: number of connection records in the index.
        unreadable: bytes that cannot be read.
        start_ns: least stamp of all messages; None if there are none.
        end_ns: greatest stamp of all messages; None if there are none.
    """

    header: BagHeaderRecord | None
    connections: dict[int, ConnectionRecord]
    counts: dict[int, int]
    chunks: tuple[ScannedChunk, ...]
    index: tuple[ChunkInfoRecord, ...]
    indexed_connections: int
    unreadable: tuple[UnreadableSpan, ...]
    start_ns: int | None
    end_ns: int | None

    @property
    def seconds(self) -> float:
        """Seconds from the first message to the last."""
        return 0.0 if self.start_ns is None or self.end_ns is None else (self.end_ns - self.start_ns) / 1e9

    def tools_of(self, topic: str, tools: tuple[BagTool, ...]) -> tuple[BagTool, ...]:
        """Return the given tools that can read a topic: evo reads only some types."""
        types = {source.msgtype for source in self.connections.values() if source.topic == topic}
        return tools if types.intersection(EVO_TYPES) else tuple(tool for tool in tools if tool is not BagTool.EVO)

    def connections_by_topic(self) -> dict[str, list[ConnectionRecord]]:
        """Return the connections of each topic; connections without messages are omitted."""
        topics: dict[str, list[ConnectionRecord]] = {}
        for source in self.connections.values():
            if self.counts.get(source.number):
                topics.setdefault(source.topic, []).append(source)
        return topics


@dataclass(frozen=True, slots=True)
class CheckedMessage:
    """Message with the values that rules check.

    Attributes:
        stamp_ns: time of recording.
        reading: values; empty if the message or its definition cannot be read.
        fault: reason why the message's bytes do not match its type, as a clause; None if they match, or if this is
            unknown.
    """

    stamp_ns: int
    reading: Reading
    fault: str | None = None


MessageHandler = Callable[[CheckedMessage], None]


class MessageRule(Protocol):
    """Rule that reads messages; a new object is created for each bag."""

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Return the function that receives each message of a connection. If None, the connection is skipped."""
        ...

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield the findings, after the last message."""
        ...


class OccurrenceCounter(Generic[K]):
    """Counter of occurrences by key, with the stamp of each key's first occurrence."""

    def __init__(self) -> None:
        self._seen: dict[K, tuple[int, int]] = {}

    def add(self, key: K, stamp_ns: int) -> None:
        """Count an occurrence in a message with this stamp."""
        first, count = self._seen.get(key, (stamp_ns, 0))
        self._seen[key] = (first, count + 1)

    def items(self) -> Iterator[tuple[K, int, int]]:
        """Yield each key with the stamp of its first message and the number of occurrences."""
        for key, (first, count) in self._seen.items():
            yield key, first, count
