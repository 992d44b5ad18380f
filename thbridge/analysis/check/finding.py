"""Values of a check: tools, severities, findings, the structure of a bag; and the interface of rules."""

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
    """A tool for which bags are checked. `rosbag` stands for info, play, check, reindex and the topics of play."""

    ROSBAG = "rosbag"
    RVIZ = "rviz"
    FOXGLOVE = "Foxglove"
    PLOTJUGGLER = "PlotJuggler"
    EVO = "evo"


class FindingSeverity(StrEnum):
    """Severity: a tool fails or shows wrong data (error), it loses something (warning), or a hint (note)."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


ALL = tuple(BagTool)
TF_TYPES = (TFMESSAGE, "tf/tfMessage")
POINT = "geometry_msgs/PointStamped"
STAMPED_POSES = (ODOMETRY, POSE_WITH_COVARIANCE, "geometry_msgs/PoseStamped", "geometry_msgs/TransformStamped", POINT)
EVO_TYPES = (*STAMPED_POSES, *TF_TYPES)
"""Message types from which evo makes trajectories (evo, file_interface.py)."""


NO_TRAJECTORY = "no-trajectory"
"""Rule that finds bags of which evo reads nothing."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A problem of a bag for some tools.

    Attributes:
        rule: short name of the rule that found it.
        severity: its severity.
        tools: the tools concerned.
        topic: the topic, or None when it concerns the whole bag.
        what: the problem as a sentence, without its full stop.
        remedy: the remedy as a clause, without its full stop.
        first_ns: record stamp of the first message concerned, or None when it concerns no message.
        count: number of messages concerned; 0 when it concerns no message.
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
    """A chunk, with the messages counted in it.

    Attributes:
        chunk: its record.
        counts: number of its messages by connection.
        indexed: number of messages by connection, by the index data records behind the chunk.
        start_ns: least stamp in it, or None when it has no message.
        end_ns: greatest stamp.
    """

    chunk: ChunkRecord
    counts: dict[int, int]
    indexed: dict[int, int]
    start_ns: int | None = None
    end_ns: int | None = None


@dataclass(frozen=True, slots=True)
class BagStructure:
    """All of a bag except the contents of its messages.

    Attributes:
        header: the first record; None when it cannot be read.
        connections: every connection by its number.
        counts: number of messages read, by connection.
        chunks: the chunks, in the order of the file.
        index: the chunk info records of the index.
        indexed_connections: number of connection records in the index.
        unreadable: bytes that cannot be read.
        start_ns: least stamp of all messages; None when there are none.
        end_ns: greatest stamp.
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
        """Those of the given tools that read a topic: evo reads only some types."""
        types = {source.msgtype for source in self.connections.values() if source.topic == topic}
        return tools if types.intersection(EVO_TYPES) else tuple(tool for tool in tools if tool is not BagTool.EVO)

    def connections_by_topic(self) -> dict[str, list[ConnectionRecord]]:
        """The connections of each topic, without those that have no message."""
        topics: dict[str, list[ConnectionRecord]] = {}
        for source in self.connections.values():
            if self.counts.get(source.number):
                topics.setdefault(source.topic, []).append(source)
        return topics


@dataclass(frozen=True, slots=True)
class CheckedMessage:
    """A message with the values that rules check.

    Attributes:
        stamp_ns: time of recording.
        reading: the values; empty when the message or its definition cannot be read.
        fault: why its bytes do not fit its type, as a clause; None when they do, or when that is not known.
    """

    stamp_ns: int
    reading: Reading
    fault: str | None = None


MessageHandler = Callable[[CheckedMessage], None]


class MessageRule(Protocol):
    """A rule that reads messages; a new one is made for each bag."""

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Return the function that takes each message of a connection; None to skip the connection."""
        ...

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield the findings, after the last message."""
        ...


class OccurrenceCounter(Generic[K]):
    """Counts occurrences by key, and keeps the stamp of the first of each."""

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
